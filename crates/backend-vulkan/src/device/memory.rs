//! Buffers, reached by address, freed when nothing uses them any more.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use photon_core::{Error, Result};

use super::fault::during;
use super::logical::Device;
use super::spare::Spare;

/// A buffer.
#[derive(Debug)]
pub(crate) struct Memory {
    device: Arc<Device>,
    buffer: vk::Buffer,
    /// `None` if it is a host's.
    allocation: Option<Allocation>,
    offset: u64,
    bytes: u64,
    /// Bytes that the buffer was made with; 0 if nobody else can use it.
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
    /// A new one of at least 4 bytes.
    pub(crate) fn new(device: &Arc<Device>, label: &str, bytes: u64, location: MemoryLocation) -> Result<Self> {
        // A length that no device has would wrap in the driver.
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
                // What is kept for others may be what is missing.
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
        // SAFETY: the buffer was just made.
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
                // SAFETY: nothing has used it.
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
        // SAFETY: only named; a block of many buffers has no label of its own.
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

    /// A stretch of a host's buffer.
    ///
    /// # Safety
    /// The buffer belongs to the same device, has the usages `SHADER_DEVICE_ADDRESS`, `TRANSFER_SRC`
    /// and `TRANSFER_DST`, holds `offset + bytes` bytes, and outlives this.
    pub(crate) unsafe fn foreign(device: &Arc<Device>, buffer: vk::Buffer, offset: u64, bytes: u64) -> Self {
        let address = address(device, buffer) + offset;
        Self { device: device.clone(), buffer, allocation: None, offset, bytes, whole: 0, address }
    }

    /// Where kernels find it.
    pub(crate) fn address(&self) -> u64 {
        self.address
    }

    /// How large it is.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    pub(crate) fn buffer(&self) -> vk::Buffer {
        self.buffer
    }

    /// Where it begins in its buffer.
    pub(crate) fn offset(&self) -> u64 {
        self.offset
    }

    /// What the host sees of it, if it does.
    pub(crate) fn mapped(&mut self) -> Option<&mut [u8]> {
        self.allocation.as_mut().and_then(Allocation::mapped_slice_mut)
    }
}

fn address(device: &Device, buffer: vk::Buffer) -> u64 {
    let info = vk::BufferDeviceAddressInfo::default().buffer(buffer);
    // SAFETY: the buffer is bound and was made for this use.
    unsafe { device.raw.get_buffer_device_address(&info) }
}

/// The labels of errors are static. Those of buffers are few: each that an error names is kept once.
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
