//! The stages of a pass. Each is object-safe for a fixed backend, so that a user may replace one.

use std::ops::Range;

use crate::backend::tally::Tally;
use crate::backend::{Backend, TransportBackend};
use crate::error::{Error, Result};
use crate::requirements::map_kind::PerMap;
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::SceneView;
use crate::scene::camera::Camera;
use crate::scene::layout::{ErrorMoments, Estimate, Photon, PhotonRay, Query};
use crate::scene::solids::Solids;
use crate::settings::RandomKind;
use crate::settings::kernel::Kernel;

/// A range of paths of one pass.
#[derive(Clone, Debug, PartialEq)]
// Exhaustive: written as a literal by callers of stages, which must state every field.
pub struct Batch {
    /// The pass.
    pub pass: Pass,
    /// Indices of the paths within the pass.
    pub paths: Range<u32>,
}

/// The key of a pass's random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// Exhaustive: as `Batch`.
pub struct Pass {
    /// Key of all random numbers.
    pub seed: u64,
    /// Index of the pass, from 0.
    pub index: u32,
    /// Which random numbers photon paths use.
    pub random: RandomKind,
}

/// A camera and the size of its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: as `Batch`.
pub struct View {
    /// The camera, its right and up vectors scaled to the aspect ratio of the picture.
    pub camera: Camera,
    /// Width in pixels, ≥ 1.
    pub width: u32,
    /// Height in pixels, ≥ 1.
    pub height: u32,
}

impl View {
    /// The same view, with the media of `scene` that the camera lies in. [`crate::Pipeline`] calls this; a
    /// caller that runs [`EyeTracer`] directly has to call it once.
    #[must_use]
    pub fn within(mut self, scene: &SceneView<'_>) -> Self {
        self.camera.media = Solids::of(scene).at(self.camera.origin).bits();
        self
    }
}

/// How radiance is estimated from the photons near a query.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: written as a literal with `..EstimateParams::new(search)`.
pub struct EstimateParams {
    /// Which photons count.
    pub search: Search,
    /// How photons are weighted by distance.
    pub kernel: Kernel,
    /// Factor on every query's radius, > 0.
    pub radius_scale: f32,
    /// A photon counts if the cosine between its surface's normal and the query's is at least this; −1: all
    /// photons count.
    pub min_normal_cosine: f32,
    /// A photon counts if its distance from the query's plane is at most this share of the radius, > 0; 1:
    /// all photons in the ball count. Below 1 only with [`Search::Radius`].
    pub max_plane_distance: f32,
    /// Photons are weighted by [`crate::shading_normal::cosine_ratio`] with [`Query::shading_normal`]; needs
    /// [`PhotonFormat::Full`]. Only in scenes with [`crate::Features::SHADING_NORMALS`].
    pub shading_normals: bool,
}

impl EstimateParams {
    /// Parameters for `search` with defaults: each query's own radius, the constant kernel, and no photon
    /// rejected for its normal or its distance from the query's plane.
    ///
    /// Use struct update to change some of them: `EstimateParams { min_normal_cosine: 0.7,
    /// ..EstimateParams::new(Search::Radius) }`.
    #[must_use]
    pub const fn new(search: Search) -> Self {
        Self {
            search,
            kernel: Kernel::Constant,
            radius_scale: 1.0,
            min_normal_cosine: -1.0,
            max_plane_distance: 1.0,
            shading_normals: false,
        }
    }

    /// Whether photons are rejected for their distance from the query's plane.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.max_plane_distance < 1.0
    }

    /// Checks `max_plane_distance`, alone and against the search.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] for a plane distance that is not a positive number, or below 1 with a
    /// search other than [`Search::Radius`].
    pub fn validate(&self) -> Result<()> {
        // Negated, so that NaN is refused too.
        if !(self.max_plane_distance > 0.0) {
            return Err(Error::InvalidSetting {
                name: "max-plane-distance",
                value: self.max_plane_distance.to_string(),
                hint: "must be greater than 0; with 1, all photons in the ball count",
            });
        }
        if !self.is_flat() || self.search == Search::Radius {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "max-plane-distance",
            value: format!("{}, with {:?}", self.max_plane_distance, self.search),
            hint: "is a share of a given radius: use the radius estimator, or 1",
        })
    }

    /// [`Self::validate`], for a map with this photon format: [`Search::Paper`] and shading normals need the
    /// directions of photons.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`].
    pub fn validate_for(&self, photon_format: PhotonFormat) -> Result<()> {
        self.validate()?;
        let paper = matches!(self.search, Search::Paper { .. });
        if !(paper || self.shading_normals) || photon_format == PhotonFormat::Full {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: if paper { "the paper's estimator" } else { "an estimate with shading normals" },
            value: format!("used with a map that stores {}", photon_format.name()),
            hint: "it needs the directions of photons: use the full photon format",
        })
    }

    /// [`Self::validate`], for [`RadianceEstimator::estimate_with_moments`].
    ///
    /// # Errors
    /// [`Error::InvalidSetting`], also for any search but [`Search::Radius`].
    pub fn validate_moments(&self) -> Result<()> {
        if self.search != Search::Radius {
            return Err(Error::InvalidSetting {
                name: "errors",
                value: format!("enabled, with {:?}", self.search),
                hint: "can be estimated only with the radius estimator",
            });
        }
        self.validate()
    }
}

/// Which photons near a query count.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: every backend must implement each.
pub enum Search {
    /// All photons within the radius.
    Radius,
    /// The `k` nearest photons within the radius. If there are k, the farthest sets the radius and does not
    /// count itself, which makes the estimate unbiased: (k−1)/(π r_k²). If there are fewer, all count, with
    /// the full radius.
    KNearest {
        /// ≥ 2.
        k: u32,
    },
    /// Only the nearest photon within the radius, ties broken by the lower index: [`Estimate::flux`] is its
    /// power, as it is. For maps of values known at points, such as irradiance.
    NearestPhoton,
    /// Equation (2) of Lin and Wang 2010: the `max` nearest photons within the radius, each times its
    /// cosine and `factor`, divided by π r²; 0 with fewer than `threshold`.
    Paper {
        /// ≥ 1.
        max: u32,
        /// Minimum number of photons.
        threshold: u32,
        /// Scale factor.
        factor: f32,
    },
}

/// Emits photons from the lights.
pub trait Emitter<B: TransportBackend>: Send {
    /// Replaces `rays` with one ray per path of the batch.
    ///
    /// # Errors
    /// Errors of the backend.
    fn emit(&mut self, on: &mut B, scene: &B::Scene, batch: &Batch, rays: &mut B::Buffer<PhotonRay>) -> Result<()>;
}

/// Traces photons through the scene.
pub trait Tracer<B: TransportBackend>: Send {
    /// Traces `rays`, and appends a photon to one of `deposits` at each diffuse surface met, ordered by
    /// path, then bounce; of each photon the fields that the buffer stores.
    ///
    /// # Errors
    /// Errors of the backend. A full buffer is not an error here; it shows in [`Backend::fill`].
    fn trace(
        &mut self,
        on: &mut B,
        scene: &B::Scene,
        batch: &Batch,
        rays: &B::Buffer<PhotonRay>,
        deposits: Deposits<'_, B>,
    ) -> Result<()>;

    /// Counts and flux of all paths since the last call. Blocks.
    ///
    /// # Errors
    /// Deferred errors surface here.
    fn take_tally(&mut self, on: &mut B) -> Result<Tally>;

    /// The smallest photon format that this stage can work with. Stages of users get full photons unless
    /// they override this; see [`Backend::alloc_photons`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// The buffer for the photons of each map; `None` for a map that is not required.
pub type Deposits<'a, B> = PerMap<Option<&'a mut <B as Backend>::Buffer<Photon>>>;

/// Arranges photons for searching.
pub trait KdTreeBuilder<B: Backend>: Send {
    /// Builds a map from the photons, and takes ownership of them.
    ///
    /// # Errors
    /// [`crate::Error::InvalidInput`] names a photon with a number that is not finite.
    fn build(&mut self, on: &mut B, photons: B::Buffer<Photon>) -> Result<B::PhotonMap>;

    /// Returns the storage of a map, emptied, for the next pass.
    fn reclaim(&mut self, map: B::PhotonMap) -> B::Buffer<Photon>;

    /// Like [`Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// Estimates the irradiance at queries.
///
/// A replacement in [`MapStages`] is used for the visible points of camera paths, for derived radii, and to
/// precompute irradiance. It is not used at the hits of final-gather rays: see [`FinalGather`].
pub trait RadianceEstimator<B: Backend>: Send {
    /// Replaces the contents of `estimates` with one estimate per query.
    ///
    /// # Errors
    /// Errors of the backend.
    fn estimate(
        &mut self,
        on: &mut B,
        map: &B::PhotonMap,
        queries: &B::Buffer<Query>,
        gather: &EstimateParams,
        estimates: &mut B::Buffer<Estimate>,
    ) -> Result<()>;

    /// The same, and replaces the contents of `error_moments` with error statistics from the same photons.
    /// Only with [`Search::Radius`].
    ///
    /// # Errors
    /// Errors of the backend; [`Error::InvalidSetting`] for another search, or if the estimator does not
    /// support it, as in this default implementation.
    fn estimate_with_moments(
        &mut self,
        _on: &mut B,
        _map: &B::PhotonMap,
        _queries: &B::Buffer<Query>,
        _gather: &EstimateParams,
        _estimates: &mut B::Buffer<Estimate>,
        _error_moments: &mut B::Buffer<ErrorMoments>,
    ) -> Result<()> {
        Err(no_errors())
    }

    /// Median distance to the n-th nearest photon facing the same way, n = `neighbours`, in normalised
    /// space, over a fixed sample of photons; at most a quarter of the scene, which is returned if half of
    /// the sample have fewer neighbours within that distance. `None` if there are no more than n photons.
    ///
    /// # Errors
    /// Errors of the backend.
    fn neighbour_radius(
        &mut self,
        on: &mut B,
        map: &B::PhotonMap,
        neighbours: u32,
        min_normal_cosine: f32,
    ) -> Result<Option<f32>>;

    /// Like [`Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// The error of a stage that does not support error statistics.
pub(crate) fn no_errors() -> Error {
    Error::InvalidSetting {
        name: "errors",
        value: "enabled".into(),
        hint: "these stages do not support them: use those of the backend, with the radius estimator",
    }
}

/// Traces camera paths to the first diffuse surface.
pub trait EyeTracer<B: TransportBackend>: Send {
    /// Adds the emission seen by the camera to the film, with depth, normal and albedo, and replaces the
    /// contents of `queries` with the visible points.
    ///
    /// # Errors
    /// Errors of the backend.
    fn trace_eye(
        &mut self,
        on: &mut B,
        scene: &B::Scene,
        view: &View,
        pass: Pass,
        film: &mut B::Film,
        queries: &mut B::Buffer<Query>,
    ) -> Result<()>;
}

/// Direct light by next-event estimation.
pub trait DirectLight<B: TransportBackend>: Send {
    /// Adds the direct light found by `shadow_rays` rays per query to [`crate::Layer::Direct`] of the film.
    ///
    /// # Errors
    /// Errors of the backend.
    fn light(
        &mut self,
        on: &mut B,
        scene: &B::Scene,
        pass: Pass,
        queries: &B::Buffer<Query>,
        shadow_rays: u32,
        film: &mut B::Film,
    ) -> Result<()>;
}

/// Per-query estimates and optional error statistics.
#[derive(Debug)]
pub struct EstimateBuffers<'a, B: Backend> {
    /// One estimate per query.
    pub estimates: &'a mut B::Buffer<Estimate>,
    /// One per query; `None` if errors are not estimated.
    pub error_moments: Option<&'a mut B::Buffer<ErrorMoments>>,
}

/// Estimates which part of an estimate's disc lies on the surface.
pub trait AreaProbe<B: TransportBackend>: Send {
    /// Multiplies each [`Estimate::radius_squared`] by the share of its disc that lies on the query's
    /// surface and is visible from above the query, as [`crate::area`] defines it; `gather` are the
    /// parameters of the estimates. Error statistics, if present, are divided by the shares of their own
    /// discs: [`ErrorMoments::wide`] and [`ErrorMoments::narrow`] are multiplied by the ratio of the first
    /// share to theirs.
    ///
    /// # Errors
    /// Errors of the backend.
    fn correct(
        &mut self,
        on: &mut B,
        scene: &B::Scene,
        pass: Pass,
        queries: &B::Buffer<Query>,
        gather: &EstimateParams,
        buffers: EstimateBuffers<'_, B>,
    ) -> Result<()>;
}

/// The photon maps of a pass, each with its estimate parameters.
#[derive(Debug)]
pub struct Maps<'a, B: Backend> {
    /// The maps that were built.
    pub photons: PerMap<Option<(&'a B::PhotonMap, EstimateParams)>>,
    /// Irradiance from all maps, precomputed at every n-th photon and stored as its power. If present,
    /// final-gather rays use only this map, and take [`Estimate::flux`] as irradiance.
    pub irradiance: Option<(&'a B::PhotonMap, EstimateParams)>,
    /// Number of paths that filled each map: all that were emitted, or those that were aimed.
    pub paths: PerMap<u64>,
}

/// Precomputes irradiance at the positions of photons, for final-gather rays (Christensen 1999).
pub trait IrradiancePoints<B: Backend>: Send {
    /// Appends the position of every `every`-th photon to `queries`, in the order of the map, in which
    /// neighbours are close together, with the photon's normal, a radius of 1, and the query's index in
    /// `queries` as its path.
    ///
    /// # Errors
    /// Errors of the backend.
    fn places(&mut self, on: &mut B, map: &B::PhotonMap, every: u32, queries: &mut B::Buffer<Query>) -> Result<()>;

    /// Adds the irradiance in one map's `estimates` to the power of as many `points`; those of the first
    /// map replace the points, with the positions and normals of the queries.
    ///
    /// # Errors
    /// Errors of the backend.
    fn add(
        &mut self,
        on: &mut B,
        queries: &B::Buffer<Query>,
        estimates: &B::Buffer<Estimate>,
        paths: u64,
        first: bool,
        points: &mut B::Buffer<Photon>,
    ) -> Result<()>;

    /// Like [`Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// Indirect light by final gathering.
///
/// The stage reads the maps with an estimator of its own, not with [`MapStages::estimator`]: on the CPU
/// rays and estimates are one loop, on Vulkan the stage owns an estimator whose buffers are sized for its
/// rays. To replace the estimator for gathered light, replace this stage too. Only [`IrradiancePoints`] use
/// the replacement.
pub trait FinalGather<B: TransportBackend>: Send {
    /// Adds the radiance that `rays` rays per query find, estimated from the maps at their hits, to
    /// [`crate::Layer::Indirect`] of the film.
    ///
    /// # Errors
    /// Errors of the backend.
    #[expect(
        clippy::too_many_arguments,
        reason = "each is a resource of its own; a struct would be taken apart at once"
    )]
    fn gather(
        &mut self,
        on: &mut B,
        scene: &B::Scene,
        maps: &Maps<'_, B>,
        pass: Pass,
        queries: &B::Buffer<Query>,
        rays: u32,
        film: &mut B::Film,
    ) -> Result<()>;

    /// Like [`Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// The stages that do not need a scene. Replace a field to use an implementation of your own.
#[expect(missing_debug_implementations, reason = "boxed stages")]
// Exhaustive: as `Stages`.
pub struct MapStages<B: Backend> {
    /// Builds maps from photons.
    pub builder: Box<dyn KdTreeBuilder<B>>,
    /// Estimates from the maps, but not at the hits of final-gather rays: see [`FinalGather`].
    pub estimator: Box<dyn RadianceEstimator<B>>,
}

/// Stages for light paths that are aimed at mirrors and glass, and fill only the caustic map.
#[expect(missing_debug_implementations, reason = "boxed stages")]
pub struct Aimed<B: TransportBackend> {
    /// Emits photons in the directions of the [`crate::ProjectionMap`].
    pub emitter: Box<dyn Emitter<B>>,
    /// Traces photons to the first diffuse surface, and stores those that met something specular before.
    pub tracer: Box<dyn Tracer<B>>,
    /// Number of aimed paths per pass; 0 if no light can reach a specular surface.
    pub paths: u32,
}

/// All stages. Replace a field to use an implementation of your own.
///
/// Fields are independent, with one exception: [`Stages::gather`] does not use the estimator of
/// [`Stages::map`] but reads the maps itself, so that another estimator needs another [`FinalGather`] if
/// indirect light is gathered.
#[expect(missing_debug_implementations, reason = "boxed stages")]
// Exhaustive: a backend must say for each stage whether it has one.
pub struct Stages<B: TransportBackend> {
    /// Emits photons.
    pub emitter: Box<dyn Emitter<B>>,
    /// Traces photons.
    pub tracer: Box<dyn Tracer<B>>,
    /// Traces camera paths.
    pub eye: Box<dyn EyeTracer<B>>,
    /// Shadow rays; `None` if not required.
    pub direct: Option<Box<dyn DirectLight<B>>>,
    /// Final gathering; `None` if not required.
    pub gather: Option<Box<dyn FinalGather<B>>>,
    /// Precomputed irradiance for final-gather rays; `None` if not required.
    pub irradiance: Option<Box<dyn IrradiancePoints<B>>>,
    /// Corrects the area of estimates; `None` if not required.
    pub area: Option<Box<dyn AreaProbe<B>>>,
    /// Separate paths for the caustic map; `None`: the other paths fill it.
    pub aimed: Option<Aimed<B>>,
    /// Photon maps.
    pub map: MapStages<B>,
}
