//! Buffers that were dropped, kept for a while for whoever wants one as large: a pass allocates what the
//! pass before it freed, and a driver takes a millisecond for that.

use ash::vk;
use gpu_allocator::vulkan::Allocation;

/// Waits for the device that a buffer is kept unused: those of a few passes, of which each has dozens.
const PATIENCE: u32 = 256;

/// A buffer that nobody uses.
#[derive(Debug)]
pub(crate) struct Spare {
    pub(crate) buffer: vk::Buffer,
    pub(crate) allocation: Allocation,
    pub(crate) address: u64,
    /// Bytes that it was made with.
    pub(crate) size: u64,
    /// Waits since it was dropped.
    idle: u32,
}

impl Spare {
    /// One that others may have, or that is to be freed as soon as the device is done with it.
    pub(crate) fn new(buffer: vk::Buffer, allocation: Allocation, address: u64, size: u64, keep: bool) -> Self {
        Self { buffer, allocation, address, size, idle: if keep { 0 } else { PATIENCE } }
    }
}

/// All of them.
#[derive(Debug, Default)]
pub(crate) struct Spares {
    all: Vec<Spare>,
}

impl Spares {
    /// The one that fits best and wastes at most an eighth.
    pub(crate) fn take(&mut self, size: u64) -> Option<Spare> {
        let fits = |spare: &&Spare| spare.size >= size && spare.size - size <= size / 8;
        let best = self.all.iter().filter(fits).map(|spare| spare.size).min()?;
        // The one dropped last is the likeliest to be in a cache.
        let at = self.all.iter().rposition(|spare| spare.size == best)?;
        Some(self.all.remove(at))
    }

    /// Takes those in that the device is done with; returns those that waited for too long.
    pub(crate) fn exchange(&mut self, dropped: Vec<Spare>) -> Vec<Spare> {
        self.all.extend(dropped);
        for spare in &mut self.all {
            spare.idle += 1;
        }
        self.all.extract_if(.., |spare| spare.idle > PATIENCE).collect()
    }

    /// Gives all of them up.
    pub(crate) fn drain(&mut self) -> Vec<Spare> {
        std::mem::take(&mut self.all)
    }
}
