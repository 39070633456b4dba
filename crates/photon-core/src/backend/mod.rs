//! The interface of a backend: its buffers, its films ([`FilmBackend`]), and the construction of its
//! stages.

pub(crate) mod announcement;
pub mod kd_tree;
pub(crate) mod memory;
pub(crate) mod observer;
pub(crate) mod stages;
pub(crate) mod stop;
pub(crate) mod tally;

use crate::backend::announcement::Announcement;
use crate::backend::memory::Costs;
use crate::backend::stages::{Emitter, MapStages, Stages, Tracer};
use crate::backend::stop::StopCondition;
use crate::error::Result;
use crate::projection::ProjectionMap;
use crate::requirements::Requirements;
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::SceneView;
use crate::scene::layout::{Element, Photon, Query};
use crate::settings::{IndexKind, Settings};

mod film;

pub use film::FilmBackend;

/// Allocates and transfers buffers. Not object-safe, on purpose: buffers are associated types, so that
/// nothing has to be downcast.
pub trait Backend: Sized + Send + 'static {
    /// Elements of one type, with fixed capacity; the current length is stored with the data.
    type Buffer<T: Element>: Send;
    /// Photons arranged for search.
    type PhotonMap: Send;

    /// Short name: `cpu`, `vulkan`.
    fn name(&self) -> &'static str;

    /// Description of the device, for reports.
    fn device(&self) -> String;

    /// Allocates an empty buffer.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    fn alloc<T: Element>(&mut self, label: &'static str, capacity: u64) -> Result<Self::Buffer<T>>;

    /// Allocates an empty buffer of photons of which only the fields in `photon_format` have to be stored.
    /// Tracers that append to it drop the other fields, and so does a map that is built from it; it cannot
    /// be downloaded unless the format is [`PhotonFormat::Full`]. A backend without shorter formats stores
    /// full photons.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    fn alloc_photons(
        &mut self,
        label: &'static str,
        capacity: u64,
        photon_format: PhotonFormat,
    ) -> Result<Self::Buffer<Photon>> {
        let _ = photon_format;
        self.alloc(label, capacity)
    }

    /// Allocates a buffer that holds `data`.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    fn upload<T: Element>(&mut self, label: &'static str, data: &[T]) -> Result<Self::Buffer<T>>;

    /// Replaces the contents of `to` with those of the buffer. Blocks until all work enqueued before is
    /// done.
    ///
    /// # Errors
    /// Deferred errors surface here; [`crate::Error::CapacityExceeded`] if more was appended than fits;
    /// [`crate::Error::InvalidSetting`] if photons are not stored in full: [`Backend::alloc_photons`].
    fn download<T: Element>(&mut self, from: &Self::Buffer<T>, to: &mut Vec<T>) -> Result<()>;

    /// Length and capacity of a buffer. Blocks like [`Backend::download`].
    ///
    /// # Errors
    /// Deferred errors surface here.
    fn fill<T: Element>(&mut self, buffer: &Self::Buffer<T>) -> Result<Fill>;

    /// Empties a buffer, without freeing its storage.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    fn clear<T: Element>(&mut self, buffer: &mut Self::Buffer<T>) -> Result<()>;

    /// The stages that do not need a scene.
    ///
    /// # Errors
    /// [`crate::Error::Backend`] if they cannot be built.
    fn map_stages(&mut self, index: IndexKind) -> Result<MapStages<Self>>;

    /// Attributes the work that follows to `stage` in [`Backend::timings`]; `None`: to no stage.
    fn mark(&mut self, stage: Option<Stage>);

    /// Seconds spent in each stage since the last call. Blocks.
    ///
    /// # Errors
    /// Deferred errors surface here.
    fn timings(&mut self) -> Result<StageTimings>;
}

/// A backend that can also trace photons through a scene.
pub trait TransportBackend: FilmBackend {
    /// A scene, prepared for tracing.
    type Scene: Send;

    /// Whether it is a GPU, where many paths take hardly longer than few.
    fn is_gpu(&self) -> bool {
        false
    }

    /// Number of paths that are traced at a time: enough to keep the device busy, but few enough to limit
    /// the memory of their rays (48 bytes each) and the delay until an observer can stop. The result does
    /// not depend on it.
    fn batch(&self) -> u32 {
        1 << 18
    }

    /// Most photons of a map for which memory suffices anyway: the rule of settings asks for no more. By default without limit.
    fn most_photons(&self) -> u64 {
        u64::MAX
    }

    /// Number of camera samples of a picture of so many pixels that are traced together: as many as keep the device busy. The
    /// result does not depend on it.
    fn samples_together(&self, _pixels: u64) -> u32 {
        1
    }

    /// Lets stages end with [`crate::Error::Cancelled`] when the condition is met, until this is called with `None`. What has
    /// been recorded for a device may still be executed. By default stages are not interrupted.
    fn stop_when(&mut self, _condition: Option<StopCondition>) {}

    /// Upper bounds of the memory in use at the peak of a pass, if maps store photons in `photon_format`.
    fn costs(&self, photon_format: PhotonFormat) -> Costs {
        // As stored, and as arranged for searching.
        let photon = 96 + 2 * photon_format.bytes();
        Costs { photon, under_way: 100, path: 200, pixel: 1200, query: 200 }
    }

    /// Uploads a scene to the device, after [`SceneView::validate`]. Of `required` it may depend on the features of scene and
    /// media, shadow rays and their offset: a scene is kept for settings that differ in other things
    /// ([`crate::Pipeline::with_settings`]).
    ///
    /// # Errors
    /// Those of [`SceneView::validate`]; [`crate::Error::MissingFeatures`] if the scene needs more than
    /// `required`; [`crate::Error::OutOfMemory`].
    fn prepare(&mut self, scene: &SceneView<'_>, required: &Requirements) -> Result<Self::Scene>;

    /// All stages, built for `required`.
    ///
    /// # Errors
    /// [`crate::Error::Backend`] if they cannot be built.
    fn stages(&mut self, required: &Requirements, settings: &Settings) -> Result<Stages<Self>>;

    /// Says what passes by the stages of [`TransportBackend::stages`] will ask, before the scene is prepared: to compile kernels
    /// meanwhile. It may be repeated when more is known. Results do not depend on it.
    ///
    /// # Errors
    /// [`crate::Error::Backend`].
    fn announce(&mut self, _announcement: &Announcement<'_>) -> Result<()> {
        Ok(())
    }

    /// Stages for paths that are aimed with `projection`, which is not empty: an emitter, and a tracer that
    /// ends paths at the first diffuse surface. `None`: the backend has no such stages, and the ordinary
    /// paths fill the map.
    ///
    /// # Errors
    /// [`crate::Error::Backend`] if they cannot be built; [`crate::Error::OutOfMemory`].
    fn aimed(
        &mut self,
        _required: &Requirements,
        _settings: &Settings,
        _projection: &ProjectionMap,
    ) -> Result<Option<AimedStages<Self>>> {
        Ok(None)
    }

    /// Multiplies the radius of each query by the factor of its pixel, given as the bits of an `f32`.
    ///
    /// # Errors
    /// [`crate::Error::InvalidSetting`] if the backend does not support it.
    fn scale_radii(&mut self, _queries: &mut Self::Buffer<Query>, _factors: &Self::Buffer<u32>) -> Result<()> {
        Err(crate::Error::InvalidSetting {
            name: "bandwidth",
            value: "per pixel".into(),
            hint: "this backend has one radius for all pixels",
        })
    }

    /// Current allocations: label and bytes.
    fn memory(&self, scene: &Self::Scene) -> Vec<(String, u64)>;

    /// Prepares the backend for another render, after everything of the previous one was dropped: waits for
    /// pending work, and clears the statistics that reports have read.
    ///
    /// # Errors
    /// Deferred errors surface here.
    fn reset(&mut self) -> Result<()> {
        self.timings().map(drop)
    }
}

/// An emitter of aimed paths, and the tracer for them.
pub type AimedStages<B> = (Box<dyn Emitter<B>>, Box<dyn Tracer<B>>);

/// Length and capacity of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// Exhaustive: a backend must state every field.
pub struct Fill {
    /// Number of elements stored.
    pub length: u64,
    /// Number of elements that were to be appended; more than `length` if the buffer overflowed.
    pub needed: u64,
    /// Maximum number of elements.
    pub capacity: u64,
}

/// The stages of a pass, for timing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stage {
    /// The scene is checked, and its tables are made and uploaded to the device.
    Prepare,
    /// The ray-tracing structure is built.
    Bvh,
    /// Directions of lights that meet specular surfaces are marked.
    Project,
    /// Kernels are compiled, or found in the cache on disk: the first time that they are needed.
    Compile,
    /// Photons are emitted from the lights.
    Emit,
    /// Photons are traced through the scene.
    Trace,
    /// Photons are arranged for searching.
    Build,
    /// Camera paths are traced.
    Eye,
    /// Direct light is estimated with shadow rays.
    Direct,
    /// Radiance is estimated from the maps.
    Estimate,
    /// Final gathering.
    Gather,
    /// Results are added to the film.
    Film,
}

impl Stage {
    /// All stages, in order of execution; kernels are compiled wherever they are first needed.
    pub const ALL: [Self; 12] = [
        Self::Prepare,
        Self::Bvh,
        Self::Project,
        Self::Compile,
        Self::Emit,
        Self::Trace,
        Self::Build,
        Self::Eye,
        Self::Direct,
        Self::Estimate,
        Self::Gather,
        Self::Film,
    ];

    /// Name for reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Prepare => "prepare",
            Self::Bvh => "bvh",
            Self::Project => "project",
            Self::Compile => "compile",
            Self::Emit => "emit",
            Self::Trace => "trace",
            Self::Build => "build",
            Self::Eye => "eye",
            Self::Direct => "direct",
            Self::Estimate => "estimate",
            Self::Gather => "gather",
            Self::Film => "film",
        }
    }
}

/// Seconds per stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageTimings([f64; Stage::ALL.len()]);

impl StageTimings {
    /// Seconds spent in `stage`.
    #[must_use]
    pub fn get(&self, stage: Stage) -> f64 {
        self.0[stage as usize]
    }

    /// Seconds spent in all stages but [`Stage::Compile`], which later passes do not repeat.
    #[must_use]
    pub fn total(&self) -> f64 {
        Stage::ALL.into_iter().filter(|&stage| stage != Stage::Compile).map(|stage| self.get(stage)).sum()
    }

    /// The stages whose work depends on the scene alone: [`crate::Pipeline::with_settings`] and [`crate::Pipeline::restart`] do
    /// not repeat it.
    pub(crate) const OF_SCENE: [Stage; 3] = [Stage::Prepare, Stage::Bvh, Stage::Project];

    /// Seconds spent in the other stages, without [`Stage::Compile`].
    #[must_use]
    pub fn without_scene(&self) -> f64 {
        let is_other = |stage: &Stage| *stage != Stage::Compile && !Self::OF_SCENE.contains(stage);
        Stage::ALL.into_iter().filter(is_other).map(|stage| self.get(stage)).sum()
    }

    /// Adds seconds to `stage`.
    pub fn add(&mut self, stage: Stage, seconds: f64) {
        self.0[stage as usize] += seconds;
    }

    /// Adds the timings of `other`.
    pub fn merge(&mut self, other: &Self) {
        for stage in Stage::ALL {
            self.add(stage, other.get(stage));
        }
    }
}
