//! Searches split into several dispatches, on devices that end long loops: `search_pause.glsl`.

use photon_core::Result;

use crate::constants::{PAUSE_SUBGROUPS, PAUSE_WORDS};
use crate::device::Memory;
use crate::vulkan::Vulkan;

/// Maximum number of subgroups per dispatch.
pub(super) const SUBGROUPS: u64 = PAUSE_SUBGROUPS as u64;
/// Size of the header: the count of paused traversals, and one word for each subgroup.
const HEAD: u64 = (1 + SUBGROUPS) * 4;

/// Storage for the state of paused traversals.
#[derive(Debug, Default)]
pub(super) struct PausedSearches {
    memory: Option<Memory>,
}

impl PausedSearches {
    /// Allocates and clears storage for the given number of invocations; returns its address.
    pub(super) fn room(&mut self, on: &mut Vulkan, invocations: u64) -> Result<u64> {
        let bytes = HEAD + invocations * u64::from(PAUSE_WORDS) * 4;
        let memory = match self.memory.take().filter(|memory| memory.bytes() >= bytes) {
            Some(memory) => memory,
            None => on.memory("paused searches", bytes)?,
        };
        on.fill_words(&memory, 0, HEAD, 0)?;
        Ok(self.memory.insert(memory).address())
    }

    /// Calls `dispatch` until no traversal is paused.
    pub(super) fn all(&self, on: &mut Vulkan, dispatch: impl Fn(&mut Vulkan) -> Result<()>) -> Result<()> {
        let Some(memory) = &self.memory else { return Ok(()) };
        loop {
            dispatch(on)?;
            let mut paused = [0_u32];
            on.read(memory, 0, bytemuck::bytes_of_mut(&mut paused))?;
            if paused[0] == 0 {
                return Ok(());
            }
            on.fill_words(memory, 0, 4, 0)?;
        }
    }
}
