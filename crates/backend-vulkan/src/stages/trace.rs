//! Photon tracing: paths are followed through the scene, and photons stored in path order.
//!
//! Paths are traced in chunks, each in rounds of a limited number of surfaces and collisions: invocations append photons to a
//! shared buffer in any order and count them per path; prefix sums of the counts then give the final position
//! of each photon. Rounds bound how long a dispatch runs. Some drivers silently end long loops: lavapipe (of
//! Mesa 22) after 65 535 iterations in total, which is why [`TracePlan::surfaces`] and [`TracePlan::quota`] are
//! bounded.

mod push;
mod scratch;

use photon_core::flight::{FOCUSED_DEPOSITS, MAX_COLLISIONS};
use photon_core::{
    Batch, Deposits, MapKind, MediaDeposits, MediaFeatures, PerMap, Photon, PhotonFormat, PhotonRay, RandomKind,
    Requirements, Result, Scheduling, Settings, Tally, Tracer,
};

use self::push::{
    AdvanceConstants, AdvancePush, Chunk, ReorderConstants, ScatterPush, TallyConstants, TallyPush, TraceConstants,
    TracePush,
};
use self::scratch::{CURSORS, MAPS, PLACE, ROUNDS, TOTALS, TraceScratch};
use super::tally::{WORDS, tally};
use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::scan::Scan;
use crate::scene::{SceneKind, VulkanScene};
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
    max_bounces: u32,
    paths: PhotonPaths,
    scan: Scan,
    /// Current maximum number of paths in a chunk, adapted to the photons stored so far.
    longest: u64,
    scratch: Option<TraceScratch>,
    /// Words of the tally, and the number of paths they cover.
    sums: Memory,
    emitted: u64,
}

/// Kind of photon paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhotonPaths {
    scheduling: Scheduling,
    /// Whether paths are aimed: they end at the first diffuse surface.
    is_aimed: bool,
    /// Whether photons are those of [`photon_core::GlossCaustics`].
    reflections: bool,
    /// [`photon_core::Requirements::caustic_roughness`].
    caustic_roughness: Option<f32>,
}

/// One element for each map of photons on surfaces, then for each of photons in media. Light straight from a light source leaves
/// none in media: there, its element is that of the photons on surfaces that were last scattered in a medium.
pub(crate) type Places<T> = [PerMap<T>; 2];

/// The buffer of each map that is required.
type Targets<'a> = Places<Option<&'a VulkanBuffer<Photon>>>;

/// The elements of all maps, by their numbers in kernels.
fn numbered<T>(places: Places<T>) -> [T; MAPS] {
    let [[a, b, c], [d, e, f]] = places.map(PerMap::into_array);
    [a, b, c, d, e, f]
}

/// Bits of the maps that are required, by their numbers.
fn bits<T>(places: &Places<Option<T>>) -> u32 {
    let [surfaces, media] = places.each_ref().map(|maps| maps.each_ref().map(|map| map.is_some()).bits());
    surfaces | media << MapKind::COUNT
}

impl VulkanTracer {
    pub(crate) fn new(on: &mut Vulkan, settings: &Settings, paths: PhotonPaths) -> Result<Self> {
        let bytes = 4 * WORDS as u64;
        let sums = on.memory("tally", bytes)?;
        on.fill_words(&sums, 0, bytes, 0)?;
        Ok(Self {
            max_bounces: settings.max_bounces,
            paths,
            scan: Scan::new(on)?,
            longest: LONGEST,
            scratch: None,
            sums,
            emitted: 0,
        })
    }
}

/// Maximum number of paths of an invocation. Where devices end long loops, it is 1 in media with grids: walks through grids are
/// loops too, each as long as there are cells along a ray.
fn quota(on: &Vulkan, scene: &SceneKind) -> u64 {
    let walks_grids = on.limits().loop_turns > 0 && scene.media.contains(MediaFeatures::GRIDS);
    if walks_grids { 1 } else { on.trace_plan.quota }
}

impl PhotonPaths {
    /// All paths that are not aimed.
    pub(crate) fn new(settings: &Settings) -> Self {
        let scheduling = settings.scheduling;
        Self { scheduling, is_aimed: false, reflections: false, caustic_roughness: None }
    }

    /// Aimed paths, which end at the first diffuse surface.
    pub(crate) fn aimed(settings: &Settings) -> Self {
        Self { is_aimed: true, ..Self::new(settings) }
    }

    /// Those of [`photon_core::GlossCaustics`]: aimed or not, they end at the first surface that is not perfectly specular.
    pub(crate) fn for_reflections(settings: &Settings, required: &Requirements) -> Self {
        let caustic_roughness = required.caustic_roughness(settings);
        Self { reflections: true, caustic_roughness, ..Self::aimed(settings) }
    }

    /// The kernel that traces paths.
    fn kernel(&self, on: &mut Vulkan, scene: &SceneKind, random: RandomKind, wanted: u32) -> ComputePipeline {
        let plan = on.trace_plan;
        let constants = TraceConstants {
            features: scene.features,
            random: random as u32,
            wanted,
            dynamic: self.scheduling == Scheduling::Dynamic,
            busy: plan.busy,
            aimed: self.is_aimed,
            media: scene.media,
            reflections: self.reflections,
            shared_groups: plan.shared_groups,
            all_lights: self.caustic_roughness.is_some_and(|least| least <= scene.roughest_caustic),
        };
        on.kernel(&shaders::STAGES_TRACE, plan.group, &constants)
    }

    /// The kernels that sum what became of paths, and put photons in order.
    fn arranging(&self, on: &mut Vulkan, formats: Places<Option<PhotonFormat>>) -> [ComputePipeline; 3] {
        let wanted = bits(&formats);
        let number = |format: Option<PhotonFormat>| format.map_or(0, PhotonFormat::number);
        let format = (0..).zip(numbered(formats)).map(|(map, format)| number(format) << (2 * map)).sum();
        // The tally counts photons on surfaces only.
        let counted = wanted & ((1 << MapKind::COUNT) - 1);
        [
            on.kernel(&shaders::STAGES_TALLY, GROUP, &TallyConstants { wanted: counted }),
            on.kernel(&shaders::STAGES_TRACE_REORDER, 256, &ReorderConstants { format }),
            on.kernel(&shaders::STAGES_TRACE_ADVANCE, 32, &AdvanceConstants { wanted }),
        ]
    }

    /// Requests all kernels for paths that fill maps of these formats.
    pub(crate) fn announce(
        &self,
        on: &mut Vulkan,
        scene: &SceneKind,
        random: RandomKind,
        formats: Places<Option<PhotonFormat>>,
    ) {
        self.kernel(on, scene, random, bits(&formats));
        self.arranging(on, formats);
    }
}

impl Tracer<Vulkan> for VulkanTracer {
    fn trace(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        batch: &Batch,
        rays: &VulkanBuffer<PhotonRay>,
        deposits: Deposits<'_, Vulkan>,
        in_media: MediaDeposits<'_, Vulkan>,
    ) -> Result<()> {
        let MediaDeposits { mut inside, onto_surfaces } = in_media;
        inside[MapKind::Direct] = onto_surfaces;
        // Kernels for other scenes have no media.
        let scatters = scene.kind.media.contains(MediaFeatures::SCATTERING);
        let deposits = [deposits, if scatters { inside } else { PerMap::default() }];
        let count = on.length(rays)?;
        let mut first = 0;
        while first < count {
            let chunk = self.longest.min(count - first);
            let targets = deposits.each_ref().map(|maps| maps.each_ref().map(Option::as_deref));
            let places = on.trace_plan.places.min(self.most(&targets, chunk));
            self.scratch(on, chunk, places, &scene.kind)?;
            if self.chunk(on, scene, batch, rays, targets, first, chunk)? {
                first += chunk;
            }
        }
        self.emitted += count;
        numbered(deposits).into_iter().flatten().for_each(|target| target.touch());
        Ok(())
    }

    fn take_tally(&mut self, on: &mut Vulkan) -> Result<Tally> {
        let mut words = [0_u32; WORDS];
        on.read(&self.sums, 0, bytemuck::cast_slice_mut(&mut words))?;
        on.fill_words(&self.sums, 0, 4 * words.len() as u64, 0)?;
        Ok(tally(&words, std::mem::take(&mut self.emitted)))
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
        targets: Targets<'_>,
        first: u64,
        count: u64,
    ) -> Result<bool> {
        let pass = batch.pass;
        let trace = self.paths.kernel(on, &scene.kind, pass.random, bits(&targets));
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
            self.rounds(on, scratch, (scene, rays.data_address()), &trace, count)?;
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
            self.scratch(on, count, stored + stored / 8, &scene.kind)?;
        }
        self.arrange(on, rays, targets, first, count)?;
        Ok(true)
    }

    /// Upper bound on the photons of `count` paths that must be stored. Photons beyond the capacity of all maps
    /// together are not needed: then one map has overflowed, and its content does not matter.
    fn most(&self, targets: &Targets<'_>, count: u64) -> u64 {
        let held = targets.iter().flat_map(PerMap::values).flatten().map(|target| target.capacity()).sum::<u64>();
        let stretches = u64::from(self.max_bounces);
        // An aimed path stores at most one photon on surfaces, at its end.
        let on_surfaces = if self.paths.is_aimed { 1 } else { stretches };
        // After the first collision one photon for each stretch.
        let focused = stretches * u64::from(FOCUSED_DEPOSITS) + u64::from(MAX_COLLISIONS) + 1;
        let in_media = if targets[1].values().any(Option::is_some) { focused } else { 0 };
        let on_surfaces = on_surfaces * if targets[1][MapKind::Direct].is_some() { 2 } else { 1 };
        held.min(count.saturating_mul(on_surfaces + in_media))
    }

    /// Maximum number of surfaces and collisions of a path.
    fn events(&self, scene: &SceneKind) -> u32 {
        let collisions = if scene.media.contains(MediaFeatures::SCATTERING) { MAX_COLLISIONS + 1 } else { 0 };
        self.max_bounces.saturating_add(collisions)
    }

    /// Traces the paths of a chunk to their ends, a limited number of surfaces and collisions per round.
    fn rounds(
        &self,
        on: &mut Vulkan,
        scratch: &TraceScratch,
        (scene, rays): (&VulkanScene, u64),
        trace: &ComputePipeline,
        count: u64,
    ) -> Result<()> {
        let plan = on.trace_plan;
        let group = u64::from(plan.group);
        // As many invocations as fit the device, but enough for all paths.
        let threads = plan.threads.max(count.div_ceil(quota(on, &scene.kind))).min(count).next_multiple_of(group);
        // With dynamic scheduling, how many paths an invocation takes is not fixed; twice the quota is always
        // enough.
        let quota = count.div_ceil(threads) as u32 * if self.paths.scheduling == Scheduling::Dynamic { 2 } else { 1 };
        let round = |number: u32| scratch.cursors.address() + ROUNDS + u64::from(number % 2) * 8;
        let list = |number: u32| scratch.waiting.address() + u64::from(number % 2) * scratch.paths * 4;
        let rounds = self.events(&scene.kind).div_ceil(plan.surfaces);
        for number in 0..rounds {
            if number > 0 {
                // The counters that the next round will use are those of the previous one.
                on.fill_words(&scratch.cursors, ROUNDS + u64::from((number + 1) % 2) * 8, 8, 0)?;
            }
            let push = TracePush {
                chunk: scratch.chunk.address(),
                scene: scene.address(),
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
        let wanted = bits(&targets);
        let push = TallyPush {
            rays: rays.data_address(),
            endings: scratch.endings.address(),
            stored: scratch.stored.address(),
            sums: self.sums.address(),
            first: first as u32,
            count: count as u32,
        };
        let formats = targets.map(|maps| maps.map(|target| target.map(VulkanBuffer::photon_format)));
        let [sum, scatter, advance] = self.paths.arranging(on, formats);
        on.dispatch(&sum, &push, count.div_ceil(u64::from(GROUP) * 16).min(512))?;
        if wanted == 0 {
            return Ok(());
        }
        for map in (0..MAPS as u64).filter(|map| wanted >> map & 1 != 0) {
            let part = scratch.stored.address() + map * count * 4;
            self.scan.exclusive(on, part, part, count, scratch.cursors.address() + TOTALS + map * 4)?;
        }
        let address = |of: fn(&VulkanBuffer<Photon>) -> u64| numbered(targets).map(|target| target.map_or(0, of));
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
        on.dispatch(&scatter, &push, scratch.places.div_ceil(256).min(2048))?;
        let push =
            AdvancePush { totals: scratch.cursors.address() + TOTALS, needed: address(VulkanBuffer::count_address) };
        on.dispatch(&advance, &push, 1)
    }
}
