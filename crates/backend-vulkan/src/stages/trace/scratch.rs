//! Scratch buffers of photon tracing.

use photon_core::{MapKind, MediaFeatures, Photon, Result};

use super::VulkanTracer;
use super::push::Chunk;
use crate::device::Memory;
use crate::scene::SceneKind;
use crate::vulkan::Vulkan;

/// Scratch buffers for one chunk.
#[derive(Debug)]
pub(super) struct TraceScratch {
    pub(super) paths: u64,
    pub(super) places: u64,
    pub(super) photons: Memory,
    pub(super) owners: Memory,
    pub(super) stored: Memory,
    pub(super) endings: Memory,
    pub(super) states: Memory,
    /// Indices of active paths, double-buffered.
    pub(super) waiting: Memory,
    /// Next free photon slot; a word for each map's number of photons; then two words for each of two rounds.
    pub(super) cursors: Memory,
    pub(super) chunk: Memory,
}

/// Byte offsets within `TraceScratch::cursors`.
pub(super) const PLACE: u64 = 0;
pub(super) const TOTALS: u64 = 4;
pub(super) const ROUNDS: u64 = (TOTALS + 4 * MAPS as u64).next_multiple_of(8);
pub(super) const CURSORS: u64 = ROUNDS + 16;

/// Maps that photons are stored in, on surfaces and in media.
pub(super) const MAPS: usize = 2 * MapKind::COUNT;
/// Bytes of `State` of trace.comp.
const STATE: u64 = (4 * (13 + MapKind::COUNT as u64)).next_multiple_of(16);

impl VulkanTracer {
    /// Allocates scratch buffers for chunks of `paths` paths in this kind of scene, and `places` photons.
    pub(super) fn scratch(&mut self, on: &mut Vulkan, paths: u64, places: u64, scene: &SceneKind) -> Result<()> {
        if self.scratch.as_ref().is_some_and(|scratch| scratch.paths >= paths && scratch.places >= places) {
            return Ok(());
        }
        self.scratch = None;
        let long = self.events(scene) > on.trace_plan.surfaces;
        let counts = if scene.media.contains(MediaFeatures::SCATTERING) { MAPS } else { MapKind::COUNT };
        let counts = 4 * counts as u64;
        let scratch = TraceScratch {
            paths,
            places,
            photons: on.memory("photons in no order", places * size_of::<Photon>() as u64)?,
            owners: on.memory("owners of photons", places * 8)?,
            stored: on.memory("photons per path", paths * counts)?,
            endings: on.memory("ends of paths", paths * 16)?,
            states: on.memory("paths under way", if long { paths * STATE } else { 0 })?,
            waiting: on.memory("paths under way", if long { paths * 8 } else { 0 })?,
            cursors: on.memory("cursors", CURSORS)?,
            chunk: on.memory("stretch", size_of::<Chunk>() as u64)?,
        };
        let label = match (self.paths.reflections, self.paths.is_aimed) {
            (true, _) => "tracing reflected photons",
            (false, true) => "tracing aimed photons",
            (false, false) => "tracing",
        };
        let path = counts + 16 + if long { STATE + 8 } else { 0 };
        on.note_memory(label, places * 40 + paths * path);
        self.scratch = Some(scratch);
        Ok(())
    }
}
