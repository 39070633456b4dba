//! Dropped buffers, kept for a while for reuse: a pass allocates the buffer sizes that the previous pass freed,
//! and an allocation by the driver takes a millisecond.

use ash::vk;
use gpu_allocator::vulkan::Allocation;

/// Number of device waits that an unused buffer is kept for: those of a few passes, each of which has dozens.
const PATIENCE: u32 = 256;

/// A buffer that is not in use.
#[derive(Debug)]
pub(crate) struct Spare {
    pub(crate) buffer: vk::Buffer,
    pub(crate) allocation: Allocation,
    pub(crate) address: u64,
    /// Size in bytes it was created with.
    pub(crate) size: u64,
    /// Number of device waits since it was dropped.
    idle: u32,
}

impl Spare {
    /// A dropped buffer, to be kept for reuse (`keep`) or freed as soon as the device no longer uses it.
    pub(crate) fn new(buffer: vk::Buffer, allocation: Allocation, address: u64, size: u64, keep: bool) -> Self {
        Self { buffer, allocation, address, size, idle: if keep { 0 } else { PATIENCE } }
    }
}

/// All spare buffers.
#[derive(Debug, Default)]
pub(crate) struct Spares {
    all: Vec<Spare>,
}

impl Spares {
    /// Returns the smallest buffer that fits and wastes at most an eighth.
    pub(crate) fn take(&mut self, size: u64) -> Option<Spare> {
        let fits = |spare: &&Spare| spare.size >= size && spare.size - size <= size / 8;
        let best = self.all.iter().filter(fits).map(|spare| spare.size).min()?;
        // The most recently dropped one is the most likely to be cached.
        let at = self.all.iter().rposition(|spare| spare.size == best)?;
        Some(self.all.remove(at))
    }

    /// Adds buffers that the device no longer uses; returns those that have been unused for too long.
    pub(crate) fn exchange(&mut self, dropped: Vec<Spare>) -> Vec<Spare> {
        self.all.extend(dropped);
        for spare in &mut self.all {
            spare.idle += 1;
        }
        self.all.extract_if(.., |spare| spare.idle > PATIENCE).collect()
    }

    /// Removes and returns all of them.
    pub(crate) fn drain(&mut self) -> Vec<Spare> {
        std::mem::take(&mut self.all)
    }
}
