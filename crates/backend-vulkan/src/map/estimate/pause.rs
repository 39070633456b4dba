//! Searches in several dispatches, on devices that end long loops: `search_pause.glsl`.

use photon_core::Result;

use crate::device::Memory;
use crate::vulkan::Vulkan;

/// Subgroups of a dispatch at most: the shader's `PAUSE_SUBGROUPS`.
pub(super) const SUBGROUPS: u64 = 4096;
/// Words that an invocation writes down: the shader's `PAUSE_WORDS`.
const WORDS: u64 = 160;
/// The count of walks that paused, and a word for each subgroup.
const HEAD: u64 = (1 + SUBGROUPS) * 4;

/// Where walks that pause are written down.
#[derive(Debug, Default)]
pub(super) struct PausedSearches {
    memory: Option<Memory>,
}

impl PausedSearches {
    /// Room for new walks of so many invocations; its address.
    pub(super) fn room(&mut self, on: &mut Vulkan, invocations: u64) -> Result<u64> {
        let bytes = HEAD + invocations * WORDS * 4;
        let memory = match self.memory.take().filter(|memory| memory.bytes() >= bytes) {
            Some(memory) => memory,
            None => on.memory("paused searches", bytes)?,
        };
        on.fill(&memory, 0, HEAD, 0)?;
        Ok(self.memory.insert(memory).address())
    }

    /// Calls `dispatch` until no walk pauses any more.
    pub(super) fn all(&self, on: &mut Vulkan, dispatch: impl Fn(&mut Vulkan) -> Result<()>) -> Result<()> {
        let Some(memory) = &self.memory else { return Ok(()) };
        loop {
            dispatch(on)?;
            let mut paused = [0_u32];
            on.read(memory, 0, bytemuck::bytes_of_mut(&mut paused))?;
            if paused[0] == 0 {
                return Ok(());
            }
            on.fill(memory, 0, 4, 0)?;
        }
    }
}
