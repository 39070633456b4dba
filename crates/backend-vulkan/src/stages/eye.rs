//! Camera paths, traced to the first diffuse surface.

use photon_core::random::Domain;
use photon_core::{
    Camera, EyeBuffers, EyeTracer, Features, MediaFeatures, Pass, QUERIES_PER_PIXEL, Query, Requirements, Result,
    Settings, View, segments_per_pixel,
};

use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::film::VulkanFilm;
use crate::film::samples::SampleLight;
use crate::scan::Scan;
use crate::scene::{SceneKind, VulkanScene};
use crate::shaders;
use crate::stages::truncated::TruncatedPaths;
use crate::vulkan::Vulkan;

/// Invocations per workgroup.
const GROUP: u32 = 128;
/// Maximum number of splits of a camera path in scenes with glass or glossy surfaces.
const SPLITS: u32 = QUERIES_PER_PIXEL.ilog2();

/// Traces camera paths through mirrors and glass. A path splits at the first two surfaces that have two lobes, dielectric
/// or glossy, as on the CPU.
///
/// Each pixel has slots for the maximum number of queries, and of segments in media that scatter light, and fills some of
/// them; a prefix sum then computes the compacted positions, so that they are in pixel order regardless of the order of
/// execution. The slots are in the buffer itself if it is large enough: a chunk of slots at a time is compacted into scratch
/// memory and copied back, never beyond where it came from.
#[derive(Debug)]
pub(crate) struct VulkanEye {
    max_bounces: u32,
    paths: EyePaths,
    scan: Scan,
    camera: Memory,
    truncated: TruncatedPaths,
    query_slots: Option<EyeScratch>,
    segment_slots: Option<EyeScratch>,
}

/// Kind of camera paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EyePaths {
    hides_background: bool,
    /// Whether paths leave queries for the reflection of glossy surfaces, instead of all else:
    /// [`photon_core::GlossCaustics`].
    reflections: bool,
    /// Maximum number of segments in media that scatter light that paths leave for each pixel; 0: none.
    segments: u32,
    /// [`photon_core::Requirements::terminator_offset`].
    terminator_offset: bool,
    /// [`Requirements::caustic_roughness`].
    caustic_roughness: Option<f32>,
}

/// Scratch buffers for the slots of one image size.
#[derive(Debug)]
struct EyeScratch {
    counts: Memory,
    offsets: Memory,
    /// One chunk of queries or, if their buffer is too small for all slots, all of them.
    queries: Memory,
    /// Log2 of the number of slots for each pixel.
    places_log2: u32,
    /// Whether the slots are in the buffer itself.
    in_place: bool,
}

parameters! {
    struct EyePush => STAGES_EYE {
        scene: u64,
        camera: u64,
        first: u64,
        emission: u64,
        found: u64,
        counts: u64,
        segments: u64,
        segment_counts: u64,
        seed: u64,
        truncated: u64,
        pass: u32,
        domain: u32,
        width: u32,
        height: u32,
        start_row: u32,
        end_row: u32,
        max_bounces: u32,
        samples: u32,
    }
}

parameters! {
    struct CompactPush => STAGES_EYE_COMPACT {
        found: u64,
        counts: u64,
        offsets: u64,
        to: u64,
        capacity: u32,
        start: u32,
        count: u32,
        padding: u32,
    }
}

parameters! {
    struct SettlePush => STAGES_EYE_SETTLE {
        from: u64,
        queries: u64,
        offsets: u64,
        total: u64,
        start: u32,
        end: u32,
        pixels: u32,
        padding: u32,
    }
}

specialized!(
    eye_constants: EyeConstants => STAGES_EYE,
    0 features: Features, 2 max_splits: u32, 3 paths_log2: u32, 4 tile_rows_log2: u32, 5 media: MediaFeatures,
    6 weighed: u32, 7 hides_background: bool, 8 reflections: bool,
    9 terminator_offset: bool, 11 caustic_roughness: u32, 12 marked: bool, 13 segments: u32;
    default shared_groups
);

specialized!(compact_constants: CompactConstants => STAGES_EYE_COMPACT, 2 places_log2: u32);

impl VulkanEye {
    /// Constructs a tracer for camera paths.
    pub(crate) fn new(on: &mut Vulkan, settings: &Settings, paths: EyePaths) -> Result<Self> {
        let camera = on.memory("camera", size_of::<Camera>() as u64)?;
        let (scan, truncated) = (Scan::new(on)?, TruncatedPaths::new(on)?);
        Ok(Self {
            max_bounces: settings.max_bounces,
            paths,
            scan,
            camera,
            truncated,
            query_slots: None,
            segment_slots: None,
        })
    }
}

impl EyePaths {
    /// All camera paths.
    pub(crate) fn new(settings: &Settings, required: &Requirements) -> Self {
        Self {
            hides_background: settings.transparent_background,
            reflections: false,
            segments: if required.media.contains(MediaFeatures::SCATTERING) { segments_per_pixel(required) } else { 0 },
            terminator_offset: required.terminator_offset,
            caustic_roughness: required.caustic_roughness(settings),
        }
    }

    /// Those of [`photon_core::GlossCaustics`].
    pub(crate) fn for_reflections(settings: &Settings, required: &Requirements) -> Self {
        Self { hides_background: false, reflections: true, segments: 0, ..Self::new(settings, required) }
    }

    /// Requests the kernel of the paths, and those that compact what they leave.
    pub(crate) fn announce(&self, on: &mut Vulkan, scene: &SceneKind, view: &View) {
        self.kernel(on, scene, view);
        compact_kernels(on, splits(features(scene, view)));
        if self.segments > 0 {
            compact_kernels(on, self.segments.ilog2());
        }
    }

    fn kernel(&self, on: &mut Vulkan, scene: &SceneKind, view: &View) -> ComputePipeline {
        let features = features(scene, view);
        let caustic_roughness = self.caustic_roughness.filter(|&least| least <= scene.roughest_caustic);
        let constants = EyeConstants {
            features,
            max_splits: splits(features),
            paths_log2: SPLITS,
            tile_rows_log2: tile_rows_log2(view),
            media: scene.media,
            weighed: if features.intersects(Features::FOLLOWED) { scene.weighed } else { 0 },
            hides_background: self.hides_background,
            reflections: self.reflections,
            terminator_offset: self.terminator_offset && scene.has_vertex_normals,
            caustic_roughness: caustic_roughness.map_or(u32::MAX, f32::to_bits),
            marked: caustic_roughness.is_some() && scene.has_lights_without_extent,
            segments: self.segments,
        };
        on.kernel(&shaders::STAGES_EYE, GROUP, &constants)
    }
}

fn compact_kernels(on: &mut Vulkan, places_log2: u32) -> [ComputePipeline; 2] {
    [
        on.kernel(&shaders::STAGES_EYE_COMPACT, GROUP, &CompactConstants { places_log2 }),
        on.kernel(&shaders::STAGES_EYE_SETTLE, GROUP, &()),
    ]
}

/// Features of the kernel: the lens is that of the view.
fn features(scene: &SceneKind, view: &View) -> Features {
    scene.features.without(Features::THIN_LENS).union(view.camera.features())
}

fn splits(features: Features) -> u32 {
    if features.splits_camera_paths() { SPLITS } else { 0 }
}

/// Rows of tiles of 32 pixels, as square as possible.
fn tile_rows_log2(view: &View) -> u32 {
    if view.height >= 4 { 2 } else { 0 }
}

/// Whether camera paths find light themselves, and may add to [`photon_core::Layer::Emission`].
pub(crate) fn finds_light(scene: &SceneKind, view: &View) -> bool {
    let emits = Features::AREA_LIGHTS.union(Features::ENVIRONMENT).union(Features::SUN).union(Features::FOLLOWED);
    features(scene, view).intersects(emits)
}

impl EyeTracer<Vulkan> for VulkanEye {
    fn trace_eye(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        view: &View,
        pass: Pass,
        film: &mut VulkanFilm,
        EyeBuffers { queries, mut segments }: EyeBuffers<'_, Vulkan>,
    ) -> Result<()> {
        film.check_size(view.width, view.height)?;
        let pixels = view.width * view.height * pass.samples;
        let label = if self.paths.reflections { "camera paths for reflections" } else { "camera paths" };
        let places_log2 = splits(features(&scene.kind, view));
        let query_slots = EyeScratch::for_slots(&mut self.query_slots, on, label, (pixels, places_log2), queries)?;
        // Without a buffer for segments, paths leave none.
        let most_segments = if segments.is_some() { self.paths.segments } else { 0 };
        let mut segment_slots = None;
        if let Some(segments) = &segments
            && most_segments > 0
        {
            let (slots, size) = (&mut self.segment_slots, (pixels, most_segments.ilog2()));
            segment_slots = Some(EyeScratch::for_slots(slots, on, "camera paths in media", size, segments)?);
        }
        let [segments_at, segment_counts] = match (&segment_slots, &segments) {
            (Some(slots), Some(segments)) => [slots.found(segments), slots.counts.address()],
            _ => [0; 2],
        };

        let truncated = self.truncated.start(on, features(&scene.kind, view), pass.sample > 0)?;
        on.write(&self.camera, 0, bytemuck::bytes_of(&view.camera))?;
        let emission =
            if finds_light(&scene.kind, view) { film.places(on, SampleLight::Emission, pass.samples)? } else { 0 };
        let first = film.first_places(on, pass.samples)?;
        let tile_rows = tile_rows_log2(view);
        let look = EyePaths { segments: most_segments, ..self.paths }.kernel(on, &scene.kind, view);
        let rows = (on.dispatch_limits.pixels / view.width).max(1).next_multiple_of(1 << tile_rows);
        let height = view.height * pass.samples;
        for start_row in (0..height).step_by(rows as usize) {
            let end_row = start_row.saturating_add(rows).min(height);
            let push = EyePush {
                scene: scene.address(),
                camera: self.camera.address(),
                first,
                emission,
                found: query_slots.found(queries),
                counts: query_slots.counts.address(),
                segments: segments_at,
                segment_counts,
                seed: pass.seed,
                truncated,
                pass: pass.index,
                domain: Domain::Eye as u32 | pass.sample << 16,
                width: view.width,
                height: view.height,
                start_row,
                end_row,
                max_bounces: self.max_bounces,
                samples: pass.samples,
            };
            let tiles_down = (end_row - start_row).div_ceil(1 << tile_rows);
            let tiles = u64::from(view.width.div_ceil(32 >> tile_rows)) * u64::from(tiles_down);
            on.dispatch(&look, &push, (tiles * 32).div_ceil(u64::from(GROUP)))?;
        }
        close_ranks(on, &mut self.scan, query_slots, queries, pixels)?;
        if let (Some(slots), Some(segments)) = (segment_slots, &mut segments) {
            close_ranks(on, &mut self.scan, slots, segments, pixels)?;
        }
        Ok(())
    }

    fn truncated(&mut self, on: &mut Vulkan) -> Result<u64> {
        self.truncated.read(on)
    }
}

/// Compacts queries from the slots of their pixels.
fn close_ranks(
    on: &mut Vulkan,
    scan: &mut Scan,
    scratch: &EyeScratch,
    queries: &mut VulkanBuffer<Query>,
    pixels: u32,
) -> Result<()> {
    let (counts, offsets) = (scratch.counts.address(), scratch.offsets.address());
    scan.exclusive(on, counts, offsets, u64::from(pixels), queries.count_address())?;
    queries.touch();
    let EyeScratch { places_log2, in_place, .. } = *scratch;
    let [compact, settle] = compact_kernels(on, places_log2);
    let chunk = if in_place { (on.dispatch_limits.places >> places_log2).max(1) } else { pixels };
    for start in (0..pixels).step_by(chunk as usize) {
        let count = chunk.min(pixels - start);
        let groups = (u64::from(count) << places_log2).div_ceil(u64::from(GROUP));
        let (found, to) = (queries.data_address(), scratch.queries.address());
        let (found, to, capacity) =
            if in_place { (found, to, count << places_log2) } else { (to, found, queries.capacity() as u32) };
        let push = CompactPush { found, counts, offsets, to, capacity, start, count, padding: 0 };
        on.dispatch(&compact, &push, groups)?;
        if in_place {
            let push = SettlePush {
                from: scratch.queries.address(),
                queries: queries.data_address(),
                offsets,
                total: queries.count_address(),
                start,
                end: start + count,
                pixels,
                padding: 0,
            };
            on.dispatch(&settle, &push, groups)?;
        }
    }
    Ok(())
}

impl EyeScratch {
    /// Room for so many pixels with 2 to the power of `places_log2` slots each, whose contents go into `buffer`; that of `kept`,
    /// if it is enough.
    fn for_slots<'a>(
        kept: &'a mut Option<Self>,
        on: &mut Vulkan,
        label: &'static str,
        (pixels, places_log2): (u32, u32),
        buffer: &VulkanBuffer<Query>,
    ) -> Result<&'a Self> {
        let places = u64::from(pixels) << places_log2;
        let in_place = buffer.capacity() >= places;
        let chunk = u64::from(on.dispatch_limits.places >> places_log2).max(1) << places_log2;
        let apart = if in_place { places.min(chunk) } else { places };
        let (words, bytes) = (u64::from(pixels) * 4, apart * size_of::<Query>() as u64);
        let made = match kept.take().filter(|kept| kept.counts.bytes() >= words && kept.queries.bytes() >= bytes) {
            Some(kept) => Self { places_log2, in_place, ..kept },
            None => {
                let (counts, offsets) = (on.memory(label, words)?, on.memory(label, words)?);
                let queries = on.memory(label, bytes)?;
                on.note_memory(label, bytes + 2 * words);
                Self { counts, offsets, queries, places_log2, in_place }
            }
        };
        Ok(kept.insert(made))
    }

    /// Address of the slots for the contents of `buffer`.
    fn found(&self, buffer: &VulkanBuffer<Query>) -> u64 {
        if self.in_place { buffer.data_address() } else { self.queries.address() }
    }
}

parameters! {
    struct RadiiPush => STAGES_EYE_RADII {
        queries: u64,
        count: u64,
        factors: u64,
        pixels: u32,
        padding: u32,
    }
}

/// The kernel of [`scale_radii`].
pub(crate) fn radii_kernel(on: &mut Vulkan) -> ComputePipeline {
    on.kernel(&shaders::STAGES_EYE_RADII, GROUP, &())
}

/// Multiplies each query's radius by its pixel's factor.
pub(crate) fn scale_radii(on: &mut Vulkan, queries: &VulkanBuffer<Query>, factors: &VulkanBuffer<u32>) -> Result<()> {
    let kernel = radii_kernel(on);
    let push = RadiiPush {
        queries: queries.data_address(),
        count: queries.count_address(),
        factors: factors.data_address(),
        pixels: factors.capacity() as u32,
        padding: 0,
    };
    on.dispatch(&kernel, &push, queries.capacity().div_ceil(u64::from(GROUP)))
}
