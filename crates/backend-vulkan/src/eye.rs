//! Camera paths, to the first diffuse surface.

use bytemuck::{Pod, Zeroable};
use photon_core::{Camera, EyeTracer, Features, Layer, Pass, QUERIES_PER_PIXEL, Query, Result, View};

use crate::buffer::VulkanBuffer;
use crate::device::Memory;
use crate::film::VulkanFilm;
use crate::scan::Scan;
use crate::scene::VulkanScene;
use crate::shaders;
use crate::vulkan::Vulkan;

/// Invocations per workgroup.
const GROUP: u32 = 128;
/// Places for queries that stand side by side before they close ranks: 128 MiB.
const PLACES: u32 = 1 << 21;
/// Splits of a path where there is glass.
const SPLITS: u32 = QUERIES_PER_PIXEL.ilog2();

/// Follows camera paths through mirrors and glass, some hundred thousand pixels at a time.
///
/// Each pixel has as many places as it can have queries, and fills some of them; a prefix sum then
/// says where they go, so that queries stand in order of pixels whatever ran when.
#[derive(Debug)]
pub(crate) struct VulkanEye {
    max_bounces: u32,
    scan: Scan,
    camera: Memory,
    places: Option<Places>,
}

/// Room for one stretch of pixels.
#[derive(Debug)]
struct Places {
    /// Pixels that fit.
    pixels: u32,
    queries: Memory,
    counts: Memory,
    offsets: Memory,
    total: Memory,
    /// How many queries stand before each stretch.
    before: Memory,
    stretches: u64,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct EyePush {
    scene: u64,
    camera: u64,
    first: u64,
    emission: u64,
    found: u64,
    counts: u64,
    seed: u64,
    pass: u32,
    width: u32,
    height: u32,
    start: u32,
    count: u32,
    max_bounces: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct CompactPush {
    found: u64,
    counts: u64,
    offsets: u64,
    total: u64,
    before: u64,
    queries: u64,
    capacity: u32,
    pixels: u32,
}

impl VulkanEye {
    /// For paths of so many surfaces at most.
    pub(crate) fn new(on: &mut Vulkan, max_bounces: u32) -> Result<Self> {
        let camera = on.memory("camera", size_of::<Camera>() as u64)?;
        Ok(Self { max_bounces, scan: Scan::new(on)?, camera, places: None })
    }
}

impl EyeTracer<Vulkan> for VulkanEye {
    fn trace_eye(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        view: &View,
        pass: Pass,
        film: &mut VulkanFilm,
        queries: &mut VulkanBuffer<Query>,
    ) -> Result<()> {
        film.check_size(view.width, view.height)?;
        let features = scene.features();
        let splits = if splits(features) { SPLITS } else { 0 };
        let pixels = view.width * view.height;
        let stretch = (PLACES >> splits).min(pixels);
        let stretches = u64::from(pixels.div_ceil(stretch));
        if !self.places.as_ref().is_some_and(|places| places.fit(stretch, splits, stretches)) {
            self.places = None;
            self.places = Some(Places::new(on, stretch, splits, stretches)?);
        }
        let Some(places) = &self.places else { return Ok(()) };
        on.write(&self.camera, 0, bytemuck::bytes_of(&view.camera))?;
        on.fill(&places.before, 0, 4, 0)?;
        let emission =
            if features.contains(Features::AREA_LIGHTS) { film.layer_address(on, Layer::Emission)? } else { 0 };
        let look = on.kernel(&shaders::CAMERA_EYE, &[features.bits(), GROUP, splits, SPLITS])?;
        let compact = on.kernel(&shaders::CAMERA_COMPACT, &[0, GROUP, splits])?;
        for number in 0..stretches {
            let start = number as u32 * stretch;
            let count = stretch.min(pixels - start);
            let push = EyePush {
                scene: scene.address(),
                camera: self.camera.address(),
                first: film.first_address(),
                emission,
                found: places.queries.address(),
                counts: places.counts.address(),
                seed: pass.seed,
                pass: pass.index,
                width: view.width,
                height: view.height,
                start,
                count,
                max_bounces: self.max_bounces,
            };
            on.dispatch(&look, &push, u64::from(count.div_ceil(GROUP)))?;
            let (counts, offsets) = (places.counts.address(), places.offsets.address());
            self.scan.exclusive(on, counts, offsets, u64::from(count), places.total.address())?;
            let push = CompactPush {
                found: places.queries.address(),
                counts,
                offsets,
                total: places.total.address(),
                before: places.before.address() + number * 4,
                queries: queries.data_address(),
                capacity: queries.capacity() as u32,
                pixels: count,
            };
            on.dispatch(&compact, &push, u64::from((count << splits).div_ceil(GROUP)))?;
        }
        on.copy(&places.before, stretches * 4, &queries.count, 0, 4)?;
        queries.touch();
        Ok(())
    }
}

impl Places {
    fn new(on: &mut Vulkan, pixels: u32, splits: u32, stretches: u64) -> Result<Self> {
        let words = u64::from(pixels) * 4;
        let bytes = (u64::from(pixels) << splits) * size_of::<Query>() as u64;
        on.note_memory("camera paths", bytes + 2 * words);
        Ok(Self {
            pixels,
            queries: on.memory("camera paths", bytes)?,
            counts: on.memory("camera paths", words)?,
            offsets: on.memory("camera paths", words)?,
            total: on.memory("camera paths", 4)?,
            before: on.memory("camera paths", (stretches + 1) * 4)?,
            stretches,
        })
    }

    fn fit(&self, pixels: u32, splits: u32, stretches: u64) -> bool {
        let bytes = (u64::from(pixels) << splits) * size_of::<Query>() as u64;
        self.pixels >= pixels && self.queries.bytes() >= bytes && self.stretches >= stretches
    }
}

/// Whether camera paths can split.
fn splits(features: Features) -> bool {
    features.intersects(Features::DIELECTRIC.union(Features::THIN))
}
