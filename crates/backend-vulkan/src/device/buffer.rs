//! Elements of one kind, on the device.

use std::cell::Cell;
use std::marker::PhantomData;

use ash::vk;
use photon_core::{Element, Photon, PhotonFormat, Result};

use crate::device::Memory;
use crate::vulkan::Vulkan;

/// Elements of one kind, of fixed capacity. How many there are is kept beside them on the device:
/// two words, how many were to be appended and how many fit.
#[derive(Debug)]
pub struct VulkanBuffer<T> {
    pub(crate) data: Memory,
    /// `[needed, capacity, 0, 0]`.
    pub(crate) count: Memory,
    capacity: u64,
    label: &'static str,
    /// `needed`, while the host knows it.
    known: Cell<Option<u64>>,
    /// Whether its content came from the caller, and may be anything.
    pub(crate) foreign: bool,
    photon_format: PhotonFormat,
    kind: PhantomData<fn() -> T>,
}

impl<T> VulkanBuffer<T> {
    /// Where kernels find the elements; if they are photons that are cut short, see
    /// [`VulkanBuffer::photon_format`].
    #[must_use]
    pub fn data_address(&self) -> u64 {
        self.data.address()
    }

    /// Where kernels find the two words.
    #[must_use]
    pub fn count_address(&self) -> u64 {
        self.count.address()
    }

    /// How many elements fit.
    #[must_use]
    pub fn capacity(&self) -> u64 {
        self.capacity
    }

    /// How much it holds of a photon. Of whole ones each is a record; otherwise the places of all, rows of
    /// position and normal, come first, as many as fit, then what is kept of their powers.
    #[must_use]
    pub fn photon_format(&self) -> PhotonFormat {
        self.photon_format
    }

    /// What it is for.
    #[must_use]
    pub fn label(&self) -> &'static str {
        self.label
    }

    /// A kernel changes how many there are: what the host knew is out of date.
    pub(crate) fn touch(&mut self) {
        self.known.set(None);
    }

    /// The device has been told how many there are.
    pub(crate) fn is_now(&mut self, length: u64) {
        self.known.set(Some(length));
    }
}

impl<T: Element> VulkanBuffer<T> {
    /// An empty one.
    pub(crate) fn new(on: &mut Vulkan, label: &'static str, capacity: u64) -> Result<Self> {
        Self::of(on, label, capacity, size_of::<T>() as u64)
    }

    /// The same, with so many bytes to an element.
    fn of(on: &mut Vulkan, label: &'static str, capacity: u64, each: u64) -> Result<Self> {
        let bytes = capacity.saturating_mul(each);
        // Numbers of elements are words on the device.
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

    /// A host's elements, `length` of them from byte `offset` on, where they lie.
    ///
    /// # Errors
    /// [`photon_core::Error::OutOfMemory`], [`photon_core::Error::InvalidInput`] if the offset is not
    /// a multiple of 16.
    ///
    /// # Safety
    /// `buffer` was made on the device that `on` works on, with the usages `SHADER_DEVICE_ADDRESS`,
    /// `TRANSFER_SRC` and `TRANSFER_DST`; its memory with the flag `DEVICE_ADDRESS`; it holds what is
    /// said, outlives this, and what wrote it has been submitted, with a barrier to all commands, on
    /// the same queue before.
    pub unsafe fn from_raw(on: &mut Vulkan, buffer: vk::Buffer, offset: u64, length: u64) -> Result<Self> {
        if !offset.is_multiple_of(16) || length > u64::from(u32::MAX) {
            return Err(photon_core::Error::InvalidInput {
                what: "host buffer at byte",
                index: offset,
                why: format!("{length} elements; the offset must be a multiple of 16, the length below 2^32"),
            });
        }
        // SAFETY: as the caller promises.
        let data = unsafe { Memory::foreign(&on.device, buffer, offset, length * size_of::<T>() as u64) };
        let mut buffer = Self::around(on, data, "a host's", length, length)?;
        buffer.foreign = true;
        Ok(buffer)
    }
}

impl VulkanBuffer<Photon> {
    /// An empty one for so much of each photon.
    pub(crate) fn photons(
        on: &mut Vulkan,
        label: &'static str,
        capacity: u64,
        photon_format: PhotonFormat,
    ) -> Result<Self> {
        Ok(Self { photon_format, ..Self::of(on, label, capacity, photon_format.bytes())? })
    }

    /// Where position and power of a photon stand, in bytes.
    pub(crate) fn offsets(&self, index: u64) -> [u64; 2] {
        let (place, flux) = (PhotonFormat::POSITION_NORMAL_BYTES, self.photon_format.flux_bytes());
        match self.photon_format {
            PhotonFormat::Full => [index * (place + flux), index * (place + flux) + place],
            PhotonFormat::NoDirection | PhotonFormat::Mono => [index * place, self.capacity * place + index * flux],
        }
    }
}

impl Vulkan {
    /// How many elements a buffer holds: known, or read back.
    pub(crate) fn length<T>(&mut self, buffer: &VulkanBuffer<T>) -> Result<u64> {
        Ok(self.needed(buffer)?.min(buffer.capacity))
    }

    /// How many were to be appended.
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

    /// Says how many elements a buffer holds.
    pub(crate) fn set_length<T>(&mut self, buffer: &mut VulkanBuffer<T>, length: u64) -> Result<()> {
        let words = [length as u32, buffer.capacity.min(u64::from(u32::MAX)) as u32, 0, 0];
        self.write(&buffer.count, 0, bytemuck::bytes_of(&words))?;
        buffer.known.set(Some(length));
        Ok(())
    }
}
