//! Photon tracing: paths are followed through the scene, and photons stored in path order.
//!
//! Paths are traced in chunks, each in rounds of a limited number of surfaces: invocations append photons to a
//! shared buffer in any order and count them per path; prefix sums of the counts then give the final position
//! of each photon. Rounds bound how long a dispatch runs. Some drivers silently end long loops: lavapipe (of
//! Mesa 22) after 65 535 iterations in total, which is why [`TracePlan::surfaces`] and [`TracePlan::quota`] are
//! bounded.

use bytemuck::{Pod, Zeroable};
use photon_core::{
    Batch, Deposits, Features, MapKind, MediaFeatures, PerMap, Photon, PhotonFormat, PhotonRay, Result, Scheduling,
    Settings, Tally, Tracer,
};

use super::tally::{AIMED_FATES, FATES, tally, words};
use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::scan::Scan;
use crate::scene::VulkanScene;
use crate::shaders;
use crate::vulkan::Vulkan;

/// Rounds between two checks whether any path is still active.
const LOOK: u32 = 4;
/// Invocations per workgroup of all kernels except the tracing kernel.
const GROUP: u32 = 128;
/// Maximum number of paths in a chunk: enough to keep a GPU busy; it bounds the duration of a dispatch. If a
/// chunk stores more photons than fit in the scratch buffer, it is traced again with fewer paths; but not with
/// fewer than `SHORTEST`.
const LONGEST: u64 = 1 << 22;
const SHORTEST: u64 = 1 << 13;

/// Traces photons.
#[derive(Debug)]
pub(crate) struct VulkanTracer {
    scheduling: Scheduling,
    max_bounces: u32,
    /// Number of fates, of aimed paths or of others.
    fates: usize,
    /// Whether photons are those of [`photon_core::GlossCaustics`].
    reflections: bool,
    scan: Scan,
    /// Current maximum number of paths in a chunk, adapted to the photons stored so far.
    longest: u64,
    scratch: Option<TraceScratch>,
    /// Words of the tally, and the number of paths they cover.
    sums: Memory,
    emitted: u64,
}

/// Scratch buffers for one chunk.
#[derive(Debug)]
struct TraceScratch {
    paths: u64,
    places: u64,
    photons: Memory,
    owners: Memory,
    stored: Memory,
    endings: Memory,
    states: Memory,
    /// Indices of active paths, double-buffered.
    waiting: Memory,
    /// Next free photon slot; a word for each map's number of photons; then two words for each of two rounds.
    cursors: Memory,
    chunk: Memory,
}

/// Byte offsets within `TraceScratch::cursors`.
const PLACE: u64 = 0;
const TOTALS: u64 = 4;
const ROUNDS: u64 = (TOTALS + 4 * MAPS as u64).next_multiple_of(8);
const CURSORS: u64 = ROUNDS + 16;

/// Maps that photons are stored in.
const MAPS: usize = MapKind::COUNT;
/// Bytes of `State` of trace.comp.
const STATE: u64 = (4 * (13 + MAPS as u64)).next_multiple_of(16);

/// The buffer of each map that is required.
type Targets<'a> = PerMap<Option<&'a VulkanBuffer<Photon>>>;

/// `Chunk` of trace.comp.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Chunk {
    stored: u64,
    endings: u64,
    states: u64,
    seed: [u32; 2],
    pass: u32,
    first: u32,
    count: u32,
    pad: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct TracePush {
    chunk: u64,
    scene: u64,
    rays: u64,
    photons: u64,
    owners: u64,
    place: u64,
    now: u64,
    then: u64,
    waiting: u64,
    left: u64,
    quota: u32,
    surfaces: u32,
    begins: u32,
    places: u32,
    max_bounces: u32,
    pad: u32,
}

pushed!(
    trace_push_layout: TracePush => STAGES_TRACE,
    chunk scene rays photons owners place now then waiting left quota surfaces begins places max_bounces pad
);

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct TallyPush {
    rays: u64,
    endings: u64,
    stored: u64,
    sums: u64,
    first: u32,
    count: u32,
}

pushed!(tally_push_layout: TallyPush => STAGES_TALLY, rays endings stored sums first count);

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct ScatterPush {
    photons: u64,
    owners: u64,
    offsets: u64,
    cursors: u64,
    to: [u64; MAPS],
    fills: [u64; MAPS],
    count: u32,
    places: u32,
}

pushed!(scatter_push_layout: ScatterPush => STAGES_TRACE_REORDER, photons owners offsets cursors to fills count places);

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct AdvancePush {
    totals: u64,
    needed: [u64; MAPS],
}

pushed!(advance_push_layout: AdvancePush => STAGES_TRACE_ADVANCE, totals needed);

specialized!(
    trace_constants: TraceConstants => STAGES_TRACE,
    0 features: Features, 2 random: u32, 3 wanted: u32, 4 dynamic: bool, 5 busy: u32, 6 aimed: bool,
    7 media: MediaFeatures, 8 reflections: bool, 10 shared_groups: u32
);

specialized!(tally_constants: TallyConstants => STAGES_TALLY, 3 wanted: u32, 4 fates: u32);

specialized!(reorder_constants: ReorderConstants => STAGES_TRACE_REORDER, 2 format: u32);

specialized!(advance_constants: AdvanceConstants => STAGES_TRACE_ADVANCE, 3 wanted: u32);

impl VulkanTracer {
    pub(crate) fn new(on: &mut Vulkan, settings: &Settings) -> Result<Self> {
        Self::with_fates(on, settings, FATES)
    }

    /// Constructs a tracer for aimed paths, which end at the first diffuse surface.
    pub(crate) fn aimed(on: &mut Vulkan, settings: &Settings) -> Result<Self> {
        Self::with_fates(on, settings, AIMED_FATES)
    }

    /// Constructs a tracer for [`photon_core::GlossCaustics`]: aimed or not, paths end at the first surface that is not
    /// perfectly specular.
    pub(crate) fn for_reflections(on: &mut Vulkan, settings: &Settings) -> Result<Self> {
        Ok(Self { reflections: true, ..Self::aimed(on, settings)? })
    }

    fn with_fates(on: &mut Vulkan, settings: &Settings, fates: usize) -> Result<Self> {
        let bytes = 4 * words(fates) as u64;
        let sums = on.memory("tally", bytes)?;
        on.fill_words(&sums, 0, bytes, 0)?;
        Ok(Self {
            scheduling: settings.scheduling,
            max_bounces: settings.max_bounces,
            fates,
            reflections: false,
            scan: Scan::new(on)?,
            longest: LONGEST,
            scratch: None,
            sums,
            emitted: 0,
        })
    }

    /// Allocates scratch buffers for chunks of `paths` paths and `places` photons.
    fn scratch(&mut self, on: &mut Vulkan, paths: u64, places: u64) -> Result<()> {
        if self.scratch.as_ref().is_some_and(|scratch| scratch.paths >= paths && scratch.places >= places) {
            return Ok(());
        }
        self.scratch = None;
        let long = self.max_bounces > on.trace_plan.surfaces;
        let scratch = TraceScratch {
            paths,
            places,
            photons: on.memory("photons in no order", places * size_of::<Photon>() as u64)?,
            owners: on.memory("owners of photons", places * 8)?,
            stored: on.memory("photons per path", paths * MAPS as u64 * 4)?,
            endings: on.memory("ends of paths", paths * 16)?,
            states: on.memory("paths under way", if long { paths * STATE } else { 0 })?,
            waiting: on.memory("paths under way", if long { paths * 8 } else { 0 })?,
            cursors: on.memory("cursors", CURSORS)?,
            chunk: on.memory("stretch", size_of::<Chunk>() as u64)?,
        };
        let label = match (self.reflections, self.fates == AIMED_FATES) {
            (true, _) => "tracing reflected photons",
            (false, true) => "tracing aimed photons",
            (false, false) => "tracing",
        };
        let path = 4 * MAPS as u64 + 16 + if long { STATE + 8 } else { 0 };
        on.note_memory(label, places * 40 + paths * path);
        self.scratch = Some(scratch);
        Ok(())
    }
}

impl Tracer<Vulkan> for VulkanTracer {
    fn trace(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        batch: &Batch,
        rays: &VulkanBuffer<PhotonRay>,
        mut deposits: Deposits<'_, Vulkan>,
    ) -> Result<()> {
        let count = on.length(rays)?;
        let mut first = 0;
        while first < count {
            let chunk = self.longest.min(count - first);
            let targets = deposits.each_ref().map(Option::as_deref);
            let places = on.trace_plan.places.min(self.most(&targets, chunk));
            self.scratch(on, chunk, places)?;
            if self.chunk(on, scene, batch, rays, &mut deposits, first, chunk)? {
                first += chunk;
            }
        }
        self.emitted += count;
        for (_, target) in deposits {
            let Some(target) = target else { continue };
            target.touch();
        }
        Ok(())
    }

    fn take_tally(&mut self, on: &mut Vulkan) -> Result<Tally> {
        let mut words = vec![0_u32; words(self.fates)];
        on.read(&self.sums, 0, bytemuck::cast_slice_mut(&mut words))?;
        on.fill_words(&self.sums, 0, 4 * words.len() as u64, 0)?;
        Ok(tally(&words, self.fates, std::mem::take(&mut self.emitted)))
    }

    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Mono
    }
}

impl VulkanTracer {
    /// Returns false if the photons did not fit in the scratch buffer: the chunk is discarded and must be
    /// repeated with fewer paths.
    #[expect(clippy::too_many_arguments, reason = "a part of `trace`, with what it was called with")]
    fn chunk(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        batch: &Batch,
        rays: &VulkanBuffer<PhotonRay>,
        deposits: &mut Deposits<'_, Vulkan>,
        first: u64,
        count: u64,
    ) -> Result<bool> {
        let targets = deposits.each_ref().map(Option::as_deref);
        let wanted = targets.map(|target| target.is_some());
        let pass = batch.pass;
        let plan = on.trace_plan;
        let constants = TraceConstants {
            features: scene.features(),
            random: pass.random as u32,
            wanted: wanted.bits(),
            dynamic: self.scheduling == Scheduling::Dynamic,
            busy: plan.busy,
            aimed: self.fates == AIMED_FATES,
            media: scene.media(),
            reflections: self.reflections,
            shared_groups: plan.shared_groups,
        };
        let trace = on.kernel(&shaders::STAGES_TRACE, plan.group, &constants)?;
        loop {
            let Some(scratch) = &self.scratch else { return Ok(false) };
            on.fill_words(&scratch.cursors, 0, CURSORS, 0)?;
            let chunk = Chunk {
                stored: scratch.stored.address(),
                endings: scratch.endings.address(),
                states: scratch.states.address(),
                seed: [pass.seed as u32, (pass.seed >> 32) as u32],
                pass: pass.index,
                first: first as u32,
                count: count as u32,
                pad: 0,
            };
            on.write(&scratch.chunk, 0, bytemuck::bytes_of(&chunk))?;
            self.rounds(on, scratch, (scene.address(), rays.data_address()), &trace, count)?;
            if self.most(&targets, count) <= scratch.places {
                break;
            }
            // Photons can be missing only here, so only here is their number read back.
            let mut stored = [0_u32];
            on.read(&scratch.cursors, PLACE, bytemuck::bytes_of_mut(&mut stored))?;
            let stored = u64::from(stored[0]);
            if stored <= scratch.places {
                break;
            }
            if count > SHORTEST {
                self.longest = (count * scratch.places / stored * 7 / 8).max(SHORTEST);
                return Ok(false);
            }
            self.scratch(on, count, stored + stored / 8)?;
        }
        self.arrange(on, rays, targets, first, count)?;
        Ok(true)
    }

    /// Upper bound on the photons of `count` paths that must be stored. Photons beyond the capacity of all maps
    /// together are not needed: then one map has overflowed, and its content does not matter.
    fn most(&self, targets: &Targets<'_>, count: u64) -> u64 {
        let held = targets.values().flatten().map(|target| target.capacity()).sum::<u64>();
        // An aimed path stores at most one photon, at its end.
        let each = if self.fates == AIMED_FATES { 1 } else { u64::from(self.max_bounces) };
        held.min(count * each)
    }

    /// Traces the paths of a chunk to their ends, a limited number of surfaces per round.
    fn rounds(
        &self,
        on: &mut Vulkan,
        scratch: &TraceScratch,
        (scene, rays): (u64, u64),
        trace: &ComputePipeline,
        count: u64,
    ) -> Result<()> {
        let plan = on.trace_plan;
        let group = u64::from(plan.group);
        // As many invocations as fit the device, but enough for all paths.
        let threads = plan.threads.max(count.div_ceil(plan.quota)).min(count).next_multiple_of(group);
        // With dynamic scheduling, how many paths an invocation takes is not fixed; twice the quota is always
        // enough.
        let quota = count.div_ceil(threads) as u32 * if self.scheduling == Scheduling::Dynamic { 2 } else { 1 };
        let round = |number: u32| scratch.cursors.address() + ROUNDS + u64::from(number % 2) * 8;
        let list = |number: u32| scratch.waiting.address() + u64::from(number % 2) * scratch.paths * 4;
        let rounds = self.max_bounces.div_ceil(plan.surfaces);
        for number in 0..rounds {
            if number > 0 {
                // The counters that the next round will use are those of the previous one.
                on.fill_words(&scratch.cursors, ROUNDS + u64::from((number + 1) % 2) * 8, 8, 0)?;
            }
            let push = TracePush {
                chunk: scratch.chunk.address(),
                scene,
                rays,
                photons: scratch.photons.address(),
                owners: scratch.owners.address(),
                place: scratch.cursors.address() + PLACE,
                now: round(number),
                then: round(number + 1),
                waiting: list(number),
                left: list(number + 1),
                quota,
                surfaces: plan.surfaces,
                begins: u32::from(number == 0),
                places: scratch.places as u32,
                max_bounces: self.max_bounces,
                pad: 0,
            };
            on.dispatch(trace, &push, threads / group)?;
            if number % LOOK == LOOK - 1 && number + 1 < rounds {
                let mut left = [0_u32];
                let offset = ROUNDS + u64::from((number + 1) % 2) * 8 + 4;
                on.read(&scratch.cursors, offset, bytemuck::bytes_of_mut(&mut left))?;
                if left[0] == 0 {
                    break;
                }
            }
        }
        Ok(())
    }

    /// Sums the path statistics and copies the stored photons to their final positions.
    fn arrange(
        &mut self,
        on: &mut Vulkan,
        rays: &VulkanBuffer<PhotonRay>,
        targets: Targets<'_>,
        first: u64,
        count: u64,
    ) -> Result<()> {
        let Some(scratch) = &self.scratch else { return Ok(()) };
        let wanted = targets.map(|target| target.is_some());
        let push = TallyPush {
            rays: rays.data_address(),
            endings: scratch.endings.address(),
            stored: scratch.stored.address(),
            sums: self.sums.address(),
            first: first as u32,
            count: count as u32,
        };
        let sum = on.kernel(
            &shaders::STAGES_TALLY,
            GROUP,
            &TallyConstants { wanted: wanted.bits(), fates: self.fates as u32 },
        )?;
        on.dispatch(&sum, &push, count.div_ceil(u64::from(GROUP) * 16).min(512))?;
        if !wanted.any() {
            return Ok(());
        }
        for (kind, _) in wanted.iter().filter(|(_, wanted)| **wanted) {
            let map = kind as u64;
            let part = scratch.stored.address() + map * count * 4;
            self.scan.exclusive(on, part, part, count, scratch.cursors.address() + TOTALS + map * 4)?;
        }
        let address = |of: fn(&VulkanBuffer<Photon>) -> u64| targets.map(|target| target.map_or(0, of)).into_array();
        let push = ScatterPush {
            photons: scratch.photons.address(),
            owners: scratch.owners.address(),
            offsets: scratch.stored.address(),
            cursors: scratch.cursors.address(),
            to: address(VulkanBuffer::data_address),
            fills: address(VulkanBuffer::count_address),
            count: count as u32,
            places: scratch.places as u32,
        };
        let formats = |(kind, target): (MapKind, &Option<&VulkanBuffer<Photon>>)| {
            target.map_or(0, |to| to.photon_format().number()) << (2 * kind as u32)
        };
        let format = targets.iter().map(formats).sum();
        let scatter = on.kernel(&shaders::STAGES_TRACE_REORDER, 256, &ReorderConstants { format })?;
        on.dispatch(&scatter, &push, scratch.places.div_ceil(256).min(2048))?;
        let push =
            AdvancePush { totals: scratch.cursors.address() + TOTALS, needed: address(VulkanBuffer::count_address) };
        let advance = on.kernel(&shaders::STAGES_TRACE_ADVANCE, 32, &AdvanceConstants { wanted: wanted.bits() })?;
        on.dispatch(&advance, &push, 1)
    }
}
