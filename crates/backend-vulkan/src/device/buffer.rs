//! Typed device buffers.

use std::cell::Cell;
use std::marker::PhantomData;

use ash::vk;
use photon_core::{Element, Photon, PhotonFormat, Result};

use crate::device::Memory;
use crate::vulkan::Vulkan;

/// A device buffer of elements of one type, of fixed capacity. The number of elements is stored on the device
/// in two words: how many were to be appended, and how many fit.
#[derive(Debug)]
pub struct VulkanBuffer<T> {
    pub(crate) data: Memory,
    /// `[needed, capacity, 0, 0]`.
    pub(crate) count: Memory,
    capacity: u64,
    label: &'static str,
    /// `needed`, if the host knows it.
    known: Cell<Option<u64>>,
    /// Whether the content was supplied by the caller and must be validated.
    pub(crate) foreign: bool,
    photon_format: PhotonFormat,
    kind: PhantomData<fn() -> T>,
}

impl<T> VulkanBuffer<T> {
    /// Address of the elements on the device; for photons in a reduced format see
    /// [`VulkanBuffer::photon_format`].
    #[must_use]
    pub fn data_address(&self) -> u64 {
        self.data.address()
    }

    /// Address of the two words that hold the number of elements.
    #[must_use]
    pub fn count_address(&self) -> u64 {
        self.count.address()
    }

    /// Maximum number of elements.
    #[must_use]
    pub fn capacity(&self) -> u64 {
        self.capacity
    }

    /// Which parts of a photon the buffer stores. With the full format each photon is one record; otherwise the
    /// buffer holds an array of rows of position and normal, `capacity` long, followed by an array of the
    /// reduced powers.
    #[must_use]
    pub fn photon_format(&self) -> PhotonFormat {
        self.photon_format
    }

    /// The label of the buffer, used in error messages and reports.
    #[must_use]
    pub fn label(&self) -> &'static str {
        self.label
    }

    /// A kernel changes the number of elements: discards the number known to the host.
    pub(crate) fn touch(&mut self) {
        self.known.set(None);
    }

    /// The number of elements was written on the device: the host knows it as well.
    pub(crate) fn is_now(&mut self, length: u64) {
        self.known.set(Some(length));
    }
}

impl<T: Element> VulkanBuffer<T> {
    /// Allocates an empty buffer.
    pub(crate) fn new(on: &mut Vulkan, label: &'static str, capacity: u64) -> Result<Self> {
        Self::of(on, label, capacity, size_of::<T>() as u64)
    }

    /// As `new`, with `each` bytes per element.
    fn of(on: &mut Vulkan, label: &'static str, capacity: u64, each: u64) -> Result<Self> {
        let bytes = capacity.saturating_mul(each);
        // Element counts are 32-bit words on the device.
        if capacity > u64::from(u32::MAX) {
            return Err(photon_core::Error::OutOfMemory { label, bytes });
        }
        let data = match on.memory(label, bytes) {
            Err(photon_core::Error::OutOfMemory { bytes, .. }) => {
                return Err(photon_core::Error::OutOfMemory { label, bytes });
            }
            other => other?,
        };
        on.note_memory(label, bytes);
        Self::around(on, data, label, capacity, 0)
    }

    fn around(on: &mut Vulkan, data: Memory, label: &'static str, capacity: u64, length: u64) -> Result<Self> {
        let count = on.memory("count", 16)?;
        let mut buffer = Self {
            data,
            count,
            capacity,
            label,
            known: Cell::new(None),
            foreign: false,
            photon_format: PhotonFormat::Full,
            kind: PhantomData,
        };
        on.set_length(&mut buffer, length)?;
        Ok(buffer)
    }

    /// Wraps a host's buffer of `length` elements from byte `offset` on, without copying.
    ///
    /// # Errors
    /// [`photon_core::Error::OutOfMemory`], [`photon_core::Error::InvalidInput`] if the offset is not a
    /// multiple of 16.
    ///
    /// # Safety
    /// `buffer` was created on the device that `on` uses, with the usages `SHADER_DEVICE_ADDRESS`,
    /// `TRANSFER_SRC` and `TRANSFER_DST`, and its memory was allocated with the flag `DEVICE_ADDRESS`. It holds
    /// `length` elements at `offset`, outlives this buffer, and the commands that wrote it were submitted
    /// earlier to the same queue, with a barrier to all commands.
    pub unsafe fn from_raw(on: &mut Vulkan, buffer: vk::Buffer, offset: u64, length: u64) -> Result<Self> {
        if !offset.is_multiple_of(16) || length > u64::from(u32::MAX) {
            return Err(photon_core::Error::InvalidInput {
                what: "host buffer at byte",
                index: offset,
                why: format!("{length} elements; the offset must be a multiple of 16, the length below 2^32"),
            });
        }
        // SAFETY: as the caller guarantees.
        let data = unsafe { Memory::foreign(&on.device, buffer, offset, length * size_of::<T>() as u64) };
        let mut buffer = Self::around(on, data, "a host's", length, length)?;
        buffer.foreign = true;
        Ok(buffer)
    }
}

impl VulkanBuffer<Photon> {
    /// Allocates an empty photon buffer for the given photon format.
    pub(crate) fn photons(
        on: &mut Vulkan,
        label: &'static str,
        capacity: u64,
        photon_format: PhotonFormat,
    ) -> Result<Self> {
        Ok(Self { photon_format, ..Self::of(on, label, capacity, photon_format.bytes())? })
    }

    /// Byte offsets of a photon's position and power.
    pub(crate) fn offsets(&self, index: u64) -> [u64; 2] {
        let (place, flux) = (PhotonFormat::POSITION_NORMAL_BYTES, self.photon_format.flux_bytes());
        match self.photon_format {
            PhotonFormat::Full => [index * (place + flux), index * (place + flux) + place],
            PhotonFormat::NoDirection | PhotonFormat::Mono => [index * place, self.capacity * place + index * flux],
        }
    }
}

impl Vulkan {
    /// The number of elements in a buffer: known on the host, or read back.
    pub(crate) fn length<T>(&mut self, buffer: &VulkanBuffer<T>) -> Result<u64> {
        Ok(self.needed(buffer)?.min(buffer.capacity))
    }

    /// The number of elements that were to be appended, whether or not they fit.
    pub(crate) fn needed<T>(&mut self, buffer: &VulkanBuffer<T>) -> Result<u64> {
        if let Some(known) = buffer.known.get() {
            return Ok(known);
        }
        let mut words = [0_u32; 1];
        self.read(&buffer.count, 0, bytemuck::bytes_of_mut(&mut words))?;
        let needed = u64::from(words[0]);
        buffer.known.set(Some(needed));
        Ok(needed)
    }

    /// Sets the number of elements in a buffer.
    pub(crate) fn set_length<T>(&mut self, buffer: &mut VulkanBuffer<T>, length: u64) -> Result<()> {
        let words = [length as u32, buffer.capacity.min(u64::from(u32::MAX)) as u32, 0, 0];
        self.write(&buffer.count, 0, bytemuck::bytes_of(&words))?;
        buffer.known.set(Some(length));
        Ok(())
    }
}
