//! What a backend is: where buffers live, where films live ([`FilmBackend`]), and how stages come by them.

pub(crate) mod memory;
pub(crate) mod observer;
pub(crate) mod stages;
pub(crate) mod tally;

use crate::backend::memory::Costs;
use crate::backend::stages::{Emitter, MapStages, Stages, Tracer};
use crate::error::Result;
use crate::projection::ProjectionMap;
use crate::requirements::Requirements;
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::SceneView;
use crate::scene::layout::{Element, Photon, Query};
use crate::settings::{IndexKind, Settings};

mod film;

pub use film::FilmBackend;

/// Where buffers live and how they are filled. Not object-safe, on purpose: buffers are types, so
/// that nothing is downcast.
pub trait Backend: Sized + Send + 'static {
    /// Elements of one kind, of fixed capacity; the length is kept where the data are.
    type Buffer<T: Element>: Send;
    /// Photons arranged for search.
    type PhotonMap: Send;

    /// Short name: `cpu`, `vulkan`.
    fn name(&self) -> &'static str;

    /// The device in words, for reports.
    fn device(&self) -> String;

    /// An empty buffer.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    fn alloc<T: Element>(&mut self, label: &'static str, capacity: u64) -> Result<Self::Buffer<T>>;

    /// An empty buffer of photons of which no more than `photon_format` need be stored. What a tracer appends to it
    /// is cut short; a map that is built from it keeps as much; it cannot be downloaded unless that is
    /// [`PhotonFormat::Full`]. A backend without shorter records stores whole ones.
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

    /// A buffer that holds `data`.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`].
    fn upload<T: Element>(&mut self, label: &'static str, data: &[T]) -> Result<Self::Buffer<T>>;

    /// Replaces `to` with what the buffer holds. Blocks until everything enqueued before is done.
    ///
    /// # Errors
    /// Deferred errors surface here; [`crate::Error::CapacityExceeded`] if more was appended than fits;
    /// [`crate::Error::InvalidSetting`] of photons that were cut short: [`Backend::alloc_photons`].
    fn download<T: Element>(&mut self, from: &Self::Buffer<T>, to: &mut Vec<T>) -> Result<()>;

    /// How full a buffer is. Blocks likewise.
    ///
    /// # Errors
    /// Deferred errors surface here.
    fn fill<T: Element>(&mut self, buffer: &Self::Buffer<T>) -> Result<Fill>;

    /// Empties a buffer; it keeps its storage.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    fn clear<T: Element>(&mut self, buffer: &mut Self::Buffer<T>) -> Result<()>;

    /// The stages that need no scene.
    ///
    /// # Errors
    /// [`crate::Error::Backend`] if they cannot be built.
    fn map_stages(&mut self, index: IndexKind) -> Result<MapStages<Self>>;

    /// What follows belongs to `stage`, for [`Backend::timings`]; `None`: to none.
    fn mark(&mut self, stage: Option<Stage>);

    /// Seconds spent in each stage since the last call. Blocks.
    ///
    /// # Errors
    /// Deferred errors surface here.
    fn timings(&mut self) -> Result<StageTimings>;
}

/// A backend that can also find out what photons hit.
pub trait TransportBackend: FilmBackend {
    /// A scene, ready to be traced.
    type Scene: Send;

    /// Paths that are traced at a time: enough to keep it busy, few enough for the memory of their
    /// rays, 48 bytes each, and for an observer who wants to stop. The result does not depend on it.
    fn batch(&self) -> u32 {
        1 << 18
    }

    /// What it keeps in memory at the height of a pass, if maps keep so much of a photon.
    fn costs(&self, photon_format: PhotonFormat) -> Costs {
        // As stored and as arranged for search.
        let photon = 96 + 2 * photon_format.bytes();
        Costs { photon, under_way: 100, path: 200, pixel: 1200, query: 200 }
    }

    /// Brings a scene to the device, after [`SceneView::validate`].
    ///
    /// # Errors
    /// What that finds; [`crate::Error::MissingFeatures`] if it needs more than `required`;
    /// [`crate::Error::OutOfMemory`].
    fn prepare(&mut self, scene: &SceneView<'_>, required: &Requirements) -> Result<Self::Scene>;

    /// All stages, built for `required`.
    ///
    /// # Errors
    /// [`crate::Error::Backend`] if they cannot be built.
    fn stages(&mut self, required: &Requirements, settings: &Settings) -> Result<Stages<Self>>;

    /// Stages for paths that are aimed as `projection`, which is not empty, says: an emitter, and a tracer that
    /// ends paths at the first diffuse surface. `None`: it has none, and the usual paths do it.
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

    /// Multiplies the radius of each query by its pixel's factor, given as the bits of an `f32`.
    ///
    /// # Errors
    /// [`crate::Error::InvalidSetting`] from a backend that cannot.
    fn scale_radii(&mut self, _queries: &mut Self::Buffer<Query>, _factors: &Self::Buffer<u32>) -> Result<()> {
        Err(crate::Error::InvalidSetting {
            name: "bandwidth",
            value: "per pixel".into(),
            hint: "this backend has one for all pixels",
        })
    }

    /// What is allocated now: label and bytes.
    fn memory(&self, scene: &Self::Scene) -> Vec<(String, u64)>;

    /// Makes it ready for another render, after everything of the last was dropped: waits for what is
    /// under way, and forgets what reports told of it.
    ///
    /// # Errors
    /// Deferred errors surface here.
    fn reset(&mut self) -> Result<()> {
        self.timings().map(drop)
    }
}

/// An emitter of aimed paths, and their tracer.
pub type AimedStages<B> = (Box<dyn Emitter<B>>, Box<dyn Tracer<B>>);

/// How full a buffer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fill {
    /// Elements that it holds.
    pub length: u64,
    /// Elements that were to be appended; more than `length` if it overflowed.
    pub needed: u64,
    /// Elements that fit.
    pub capacity: u64,
}

/// The stages of a pass, for timing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// The scene is brought to the device, and its ray-tracing structure built.
    Prepare,
    /// Photons leave the lights.
    Emit,
    /// They are followed through the scene.
    Trace,
    /// They are arranged for search.
    Build,
    /// Camera paths.
    Eye,
    /// Shadow rays.
    Direct,
    /// Radiance from the maps.
    Estimate,
    /// Final gathering.
    Gather,
    /// Sums over passes.
    Film,
}

impl Stage {
    /// In the order of their work.
    pub const ALL: [Self; 9] = [
        Self::Prepare,
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

    /// Adds seconds to `stage`.
    pub fn add(&mut self, stage: Stage, seconds: f64) {
        self.0[stage as usize] += seconds;
    }

    /// Adds another's.
    pub fn merge(&mut self, other: &Self) {
        for stage in Stage::ALL {
            self.add(stage, other.get(stage));
        }
    }
}
