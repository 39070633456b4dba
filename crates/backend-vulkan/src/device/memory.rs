//! Device buffers, accessed by address and freed when the device no longer uses them.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use photon_core::{Error, Result};

use super::fault::during;
use super::logical::Device;
use super::spare::Spare;

/// A device buffer.
#[derive(Debug)]
pub(crate) struct Memory {
    device: Arc<Device>,
    buffer: vk::Buffer,
    /// `None` for a host's buffer.
    allocation: Option<Allocation>,
    offset: u64,
    bytes: u64,
    /// Size the buffer was created with; 0 if it cannot be reused.
    whole: u64,
    address: u64,
}

const USES: vk::BufferUsageFlags = vk::BufferUsageFlags::from_raw(
    vk::BufferUsageFlags::STORAGE_BUFFER.as_raw()
        | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS.as_raw()
        | vk::BufferUsageFlags::INDIRECT_BUFFER.as_raw()
        | vk::BufferUsageFlags::TRANSFER_SRC.as_raw()
        | vk::BufferUsageFlags::TRANSFER_DST.as_raw(),
);

impl Memory {
    /// Allocates a buffer of at least 4 bytes.
    pub(crate) fn new(device: &Arc<Device>, label: &str, bytes: u64, location: MemoryLocation) -> Result<Self> {
        // A length beyond what any device has would overflow in the driver.
        let limit = device.limits.max_allocation;
        if bytes > limit {
            return Err(Error::AllocationTooLarge { label: interned(label), bytes, limit });
        }
        if !device.injection.allocate() {
            return Err(Error::OutOfMemory { label: interned(label), bytes });
        }
        let size = bytes.max(4).next_multiple_of(16);
        if location == MemoryLocation::GpuOnly {
            let spare = device.spares.lock().unwrap_or_else(PoisonError::into_inner).take(size);
            if let Some(Spare { buffer, allocation, address, size: whole, .. }) = spare {
                device.name(buffer, label);
                let device = device.clone();
                return Ok(Self {
                    device,
                    buffer,
                    allocation: Some(allocation),
                    offset: 0,
                    bytes: size,
                    whole,
                    address,
                });
            }
        }
        match Self::allocate(device, label, size, location) {
            Err(Error::OutOfMemory { .. }) => {
                // Spare buffers may occupy the memory that is missing.
                device.free_spares();
                Self::allocate(device, label, size, location)
            }
            made => made,
        }
    }

    fn allocate(device: &Arc<Device>, label: &str, size: u64, location: MemoryLocation) -> Result<Self> {
        let out = || Error::OutOfMemory { label: interned(label), bytes: size };
        let info = vk::BufferCreateInfo::default().size(size).usage(USES).sharing_mode(vk::SharingMode::EXCLUSIVE);
        // SAFETY: the device is alive.
        let buffer = unsafe { device.raw.create_buffer(&info, None) }.map_err(|_| out())?;
        // SAFETY: the buffer was just created.
        let requirements = unsafe { device.raw.get_buffer_memory_requirements(buffer) };
        let allocation =
            device.allocator.lock().unwrap_or_else(PoisonError::into_inner).as_mut().ok_or(Error::DeviceLost).and_then(
                |allocator| {
                    let desc = AllocationCreateDesc {
                        name: label,
                        requirements,
                        location,
                        linear: true,
                        allocation_scheme: AllocationScheme::GpuAllocatorManaged,
                    };
                    allocator.allocate(&desc).map_err(|_| out())
                },
            );
        let allocation = match allocation {
            Ok(allocation) => allocation,
            Err(error) => {
                // SAFETY: the buffer has not been used.
                unsafe { device.raw.destroy_buffer(buffer, None) };
                return Err(error);
            }
        };
        // SAFETY: the memory is large enough and of a type that the requirements allow.
        let bound = unsafe { device.raw.bind_buffer_memory(buffer, allocation.memory(), allocation.offset()) };
        if let Err(result) = bound {
            let spare = Spare::new(buffer, allocation, 0, size, false);
            device.graveyard.lock().unwrap_or_else(PoisonError::into_inner).push(spare);
            return Err(during("binding memory")(result));
        }
        device.name(buffer, label);
        // SAFETY: the handle is only named; a memory block shared by many buffers has no label of its own.
        device
            .name(unsafe { allocation.memory() }, if allocation.is_dedicated() { label } else { "a block of buffers" });
        let address = address(device, buffer);
        let whole = if location == MemoryLocation::GpuOnly { size } else { 0 };
        Ok(Self {
            device: device.clone(),
            buffer,
            allocation: Some(allocation),
            offset: 0,
            bytes: size,
            whole,
            address,
        })
    }

    /// Wraps a range of a host's buffer.
    ///
    /// # Safety
    /// The buffer belongs to the same device, has the usages `SHADER_DEVICE_ADDRESS`, `TRANSFER_SRC`
    /// and `TRANSFER_DST`, holds `offset + bytes` bytes, and outlives this.
    pub(crate) unsafe fn foreign(device: &Arc<Device>, buffer: vk::Buffer, offset: u64, bytes: u64) -> Self {
        let address = address(device, buffer) + offset;
        Self { device: device.clone(), buffer, allocation: None, offset, bytes, whole: 0, address }
    }

    /// Its device address.
    pub(crate) fn address(&self) -> u64 {
        self.address
    }

    /// Its size in bytes.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    pub(crate) fn buffer(&self) -> vk::Buffer {
        self.buffer
    }

    /// Byte offset within its Vulkan buffer.
    pub(crate) fn offset(&self) -> u64 {
        self.offset
    }

    /// Whether it is the device's own memory.
    pub(crate) fn is_device_local(&self) -> bool {
        let properties = self.allocation.as_ref().map(Allocation::memory_properties);
        properties.is_some_and(|properties| properties.contains(vk::MemoryPropertyFlags::DEVICE_LOCAL))
    }

    /// The content, if the memory is mapped by the host.
    pub(crate) fn mapped(&mut self) -> Option<&mut [u8]> {
        self.allocation.as_mut().and_then(Allocation::mapped_slice_mut)
    }
}

fn address(device: &Device, buffer: vk::Buffer) -> u64 {
    let info = vk::BufferDeviceAddressInfo::default().buffer(buffer);
    // SAFETY: the buffer is bound and was created with this usage.
    unsafe { device.raw.get_buffer_device_address(&info) }
}

/// Labels in errors are `'static`. Distinct buffer labels are few: each one that an error names is leaked once.
fn interned(label: &str) -> &'static str {
    static INTERNED: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut all = INTERNED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = all.get(label) {
        return known;
    }
    let new: &'static str = Box::leak(label.into());
    all.insert(new);
    new
}

impl Drop for Memory {
    fn drop(&mut self) {
        if let Some(allocation) = self.allocation.take() {
            let spare = Spare::new(self.buffer, allocation, self.address, self.whole, self.whole > 0);
            self.device.graveyard.lock().unwrap_or_else(PoisonError::into_inner).push(spare);
        }
    }
}
