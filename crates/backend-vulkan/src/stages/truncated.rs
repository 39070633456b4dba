//! Number of truncated paths, counted on the device.

use photon_core::{Features, Result};

use crate::device::Memory;
use crate::vulkan::Vulkan;

/// Counts paths that end at the maximum path length.
#[derive(Debug)]
pub(crate) struct TruncatedPaths {
    counter: Memory,
    /// Whether something in the scene lets paths go on; otherwise the counter is not read.
    goes_on: bool,
}

impl TruncatedPaths {
    pub(crate) fn new(on: &mut Vulkan) -> Result<Self> {
        Ok(Self { counter: on.memory("truncated paths", 8)?, goes_on: false })
    }

    /// Starts at 0, or where it was if `continues`, for paths in a scene with these features, and returns the address of the
    /// counter.
    pub(crate) fn start(&mut self, on: &mut Vulkan, features: Features, continues: bool) -> Result<u64> {
        self.goes_on = features.intersects(Features::SPECULAR.union(Features::ROUGH_GLASS));
        if self.goes_on && !continues {
            on.fill_words(&self.counter, 0, 8, 0)?;
        }
        Ok(self.counter.address())
    }

    /// Submits all commands, waits, and returns the number of paths.
    pub(crate) fn read(&self, on: &mut Vulkan) -> Result<u64> {
        let mut bytes = [0; 8];
        if self.goes_on {
            on.read(&self.counter, 0, &mut bytes)?;
        }
        Ok(u64::from_le_bytes(bytes))
    }
}
