//! The stages of a pass. Each is object-safe for a fixed backend, so that a user may swap one.

use std::ops::Range;

use crate::backend::tally::Tally;
use crate::backend::{Backend, TransportBackend};
use crate::error::{Error, Result};
use crate::requirements::map_kind::PerMap;
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::SceneView;
use crate::scene::layout::{Camera, ErrorMoments, Estimate, Photon, PhotonRay, Query};
use crate::scene::solids::Solids;
use crate::settings::RandomKind;
use crate::settings::kernel::Kernel;

/// Which paths of which pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// The pass.
    pub pass: Pass,
    /// Numbers of the paths within the pass.
    pub paths: Range<u32>,
}

/// The key of a pass's random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// Key of all random numbers.
    pub seed: u64,
    /// Number of the pass, from 0.
    pub index: u32,
    /// Which random numbers photons get.
    pub random: RandomKind,
}

/// A camera and the picture that it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The camera, its right and up vectors fitted to the picture's aspect.
    pub camera: Camera,
    /// Pixels across, ≥ 1.
    pub width: u32,
    /// Pixels down, ≥ 1.
    pub height: u32,
}

impl View {
    /// The same, with the media of `scene` that the camera lies in. [`crate::Pipeline`] does this; a caller that runs
    /// [`EyeTracer`] by itself does it once.
    #[must_use]
    pub fn within(mut self, scene: &SceneView<'_>) -> Self {
        self.camera.media = Solids::of(scene).at(self.camera.origin).bits();
        self
    }
}

/// How photons near a query become an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateParams {
    /// Which photons.
    pub search: Search,
    /// How they are weighted.
    pub kernel: Kernel,
    /// Factor on every query's radius, > 0.
    pub radius_scale: f32,
    /// A photon counts if its surface's normal and the query's have at least this cosine; −1 lets
    /// all count.
    pub min_normal_cosine: f32,
    /// A photon counts if its distance from the query's plane is at most this share of the radius, > 0;
    /// 1 lets all of the ball count. Below 1 for [`Search::Radius`] alone.
    pub max_plane_distance: f32,
}

impl EstimateParams {
    /// By `search` alone: over each query's own radius, with equal weights, and no photon turned away for its
    /// normal or its distance from the query's plane.
    ///
    /// What differs is said by struct update: `EstimateParams { min_normal_cosine: 0.7, ..EstimateParams::new(Search::Radius) }`.
    #[must_use]
    pub const fn new(search: Search) -> Self {
        Self { search, kernel: Kernel::Constant, radius_scale: 1.0, min_normal_cosine: -1.0, max_plane_distance: 1.0 }
    }

    /// Whether photons are turned away for their distance from the query's plane.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.max_plane_distance < 1.0
    }

    /// Checks that photons are turned away for what the rule knows of.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] for a plane distance that is no positive number, or with a rule that has no radius of
    /// its own.
    pub fn validate(&self) -> Result<()> {
        // NaN is not greater either.
        if !(self.max_plane_distance > 0.0) {
            return Err(Error::InvalidSetting {
                name: "max-plane-distance",
                value: self.max_plane_distance.to_string(),
                hint: "must be greater than 0; 1 takes the whole ball",
            });
        }
        if !self.is_flat() || self.search == Search::Radius {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "max-plane-distance",
            value: format!("{}, with {:?}", self.max_plane_distance, self.search),
            hint: "is a share of a radius that is given: take the estimator of a radius, or 1",
        })
    }

    /// [`Self::validate`], of a map that keeps so much of its photons: [`Search::Paper`] reads their directions.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`].
    pub fn validate_for(&self, photon_format: PhotonFormat) -> Result<()> {
        self.validate()?;
        if !matches!(self.search, Search::Paper { .. }) || photon_format == PhotonFormat::Full {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "the paper's estimator",
            value: format!("asked of a map that keeps {}", photon_format.name()),
            hint: "it reads directions: keep photons whole",
        })
    }

    /// [`Self::validate`], for [`RadianceEstimator::estimate_with_moments`].
    ///
    /// # Errors
    /// [`Error::InvalidSetting`], for every rule but [`Search::Radius`] too.
    pub fn validate_moments(&self) -> Result<()> {
        if self.search != Search::Radius {
            return Err(Error::InvalidSetting {
                name: "errors",
                value: format!("asked of {:?}", self.search),
                hint: "can be told of estimates within a radius alone",
            });
        }
        self.validate()
    }
}

/// Which photons count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// All within the radius.
    Radius,
    /// The `k` nearest within the radius. If there are k, the farthest sets the radius and does
    /// not count itself, which makes the estimate free of bias: (k−1)/(π r_k²). If there are
    /// fewer, all count over the full radius.
    KNearest {
        /// ≥ 2.
        k: u32,
    },
    /// The nearest within the radius, ties by lower number, alone: [`Estimate::flux`] is its power, and
    /// stands for itself. For maps of what is known at points, such as irradiance.
    NearestPhoton,
    /// Equation (2) of Lin and Wang 2010: the `max` nearest within the radius, each times its
    /// cosine and `factor`, over π r²; 0 with fewer than `threshold`.
    Paper {
        /// ≥ 1.
        max: u32,
        /// Least count.
        threshold: u32,
        /// Free scale.
        factor: f32,
    },
}

/// Sends photons out from the lights.
pub trait Emitter<B: TransportBackend>: Send {
    /// Replaces `rays` with one ray per path of the batch.
    ///
    /// # Errors
    /// What the backend raises.
    fn emit(&mut self, on: &mut B, scene: &B::Scene, batch: &Batch, rays: &mut B::Buffer<PhotonRay>) -> Result<()>;
}

/// Follows photons through the scene.
pub trait Tracer<B: TransportBackend>: Send {
    /// Follows `rays` and appends a photon to one of `deposits` at each diffuse surface met, in
    /// order of path, then bounce; of each as much as the buffer keeps.
    ///
    /// # Errors
    /// What the backend raises. A full buffer is no error here; it shows in [`Backend::fill`].
    fn trace(
        &mut self,
        on: &mut B,
        scene: &B::Scene,
        batch: &Batch,
        rays: &B::Buffer<PhotonRay>,
        deposits: Deposits<'_, B>,
    ) -> Result<()>;

    /// What became of all paths since the last call. Blocks.
    ///
    /// # Errors
    /// Deferred errors surface here.
    fn take_tally(&mut self, on: &mut B) -> Result<Tally>;

    /// The least of a photon that this stage can work with. Whoever brings a stage of their own gets whole
    /// records unless they override it; see [`Backend::alloc_photons`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// Where the photons of each map go; `None` for a map that is not called for.
pub type Deposits<'a, B> = PerMap<Option<&'a mut <B as Backend>::Buffer<Photon>>>;

/// Arranges photons for search.
pub trait KdTreeBuilder<B: Backend>: Send {
    /// Consumes the photons; the map owns them.
    ///
    /// # Errors
    /// [`crate::Error::InvalidInput`] names a photon that is not finite.
    fn build(&mut self, on: &mut B, photons: B::Buffer<Photon>) -> Result<B::PhotonMap>;

    /// Gives the storage back, emptied, for the next pass.
    fn reclaim(&mut self, map: B::PhotonMap) -> B::Buffer<Photon>;

    /// As [`Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// Estimates the irradiance at queries.
///
/// Swapped in [`MapStages`], it reads the maps at what the camera sees, finds the derived radii, and fills irradiance
/// points. It is not asked where final-gather rays land: see [`FinalGather`].
pub trait RadianceEstimator<B: Backend>: Send {
    /// Replaces `estimates` with one per query.
    ///
    /// # Errors
    /// What the backend raises.
    fn estimate(
        &mut self,
        on: &mut B,
        map: &B::PhotonMap,
        queries: &B::Buffer<Query>,
        gather: &EstimateParams,
        estimates: &mut B::Buffer<Estimate>,
    ) -> Result<()>;

    /// The same, and what the same photons say about the error: replaces `error_moments` too. For
    /// [`Search::Radius`] alone.
    ///
    /// # Errors
    /// What the backend raises; [`Error::InvalidSetting`] for another rule, or from an estimator that
    /// cannot tell, which is what this does unless it is overridden.
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

    /// A radius within which a typical photon has `neighbours` others on its side, normalised
    /// space: the median over a fixed sample, or a quarter of the scene if that is not enough for half of
    /// them. `None` if there are no more photons than that.
    ///
    /// # Errors
    /// What the backend raises.
    fn neighbour_radius(
        &mut self,
        on: &mut B,
        map: &B::PhotonMap,
        neighbours: u32,
        min_normal_cosine: f32,
    ) -> Result<Option<f32>>;

    /// As [`Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// What a stage says that knows nothing of errors.
pub(crate) fn no_errors() -> Error {
    Error::InvalidSetting {
        name: "errors",
        value: "asked for".into(),
        hint: "these stages cannot tell them: take those of the backend, and estimates within a radius",
    }
}

/// Follows camera paths to the first diffuse surface.
pub trait EyeTracer<B: TransportBackend>: Send {
    /// Adds the lights seen to the film, with depth, normal and albedo, and replaces `queries`.
    ///
    /// # Errors
    /// What the backend raises.
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
    /// Adds to [`crate::Layer::Direct`] of the film what `shadow_rays` rays per query find.
    ///
    /// # Errors
    /// What the backend raises.
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

/// What an estimator told of each query.
#[derive(Debug)]
pub struct EstimateBuffers<'a, B: Backend> {
    /// As many as there are queries.
    pub estimates: &'a mut B::Buffer<Estimate>,
    /// Likewise, if errors are told.
    pub error_moments: Option<&'a mut B::Buffer<ErrorMoments>>,
}

/// Finds out how much of an estimate's disc lies on the surface.
pub trait AreaProbe<B: TransportBackend>: Send {
    /// Multiplies each estimate's [`Estimate::radius_squared`] by the share of its disc that lies on the
    /// query's surface and can be seen from above the query, as [`crate::area`] says; `gather` is how
    /// the estimates were made. What errors are told by, if it is there, is divided by the shares of its own
    /// discs: [`ErrorMoments::wide`] and [`ErrorMoments::narrow`] are multiplied by the first share over theirs.
    ///
    /// # Errors
    /// What the backend raises.
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

/// The photon maps of a pass, each with how it is read.
#[derive(Debug)]
pub struct Maps<'a, B: Backend> {
    /// Those that were built.
    pub photons: PerMap<Option<(&'a B::PhotonMap, EstimateParams)>>,
    /// Irradiance by all of them, at every so-manieth photon, as its power: if it is there, rays ask
    /// it alone, for what [`Estimate::flux`] says.
    pub irradiance: Option<(&'a B::PhotonMap, EstimateParams)>,
    /// Paths that filled each map: all that were emitted, or those that were aimed.
    pub paths: PerMap<u64>,
}

/// Finds irradiance at the places of photons, for final-gather rays (Christensen 1999).
pub trait IrradiancePoints<B: Backend>: Send {
    /// Appends to `queries` every `every`-th photon's place, in the order of the map, in which
    /// neighbours stand together, with its normal, a radius of 1, and its number in `queries` as its
    /// path.
    ///
    /// # Errors
    /// What the backend raises.
    fn places(&mut self, on: &mut B, map: &B::PhotonMap, every: u32, queries: &mut B::Buffer<Query>) -> Result<()>;

    /// Adds what one map's `estimates` say to the power of as many `points`; the first map's replace
    /// them, with the queries' places and normals.
    ///
    /// # Errors
    /// What the backend raises.
    fn add(
        &mut self,
        on: &mut B,
        queries: &B::Buffer<Query>,
        estimates: &B::Buffer<Estimate>,
        paths: u64,
        first: bool,
        points: &mut B::Buffer<Photon>,
    ) -> Result<()>;

    /// As [`Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// Indirect light by final gathering.
///
/// The stage reads the maps with an estimator of its own, not with [`MapStages::estimator`]: on the CPU rays and
/// estimates are one loop, on Vulkan the stage owns an estimator whose buffers are sized for its rays. Whoever swaps
/// the estimator and gathers has to swap this stage too. Only [`IrradiancePoints`] are filled by the swapped one.
pub trait FinalGather<B: TransportBackend>: Send {
    /// Adds to [`crate::Layer::Indirect`] of the film what `rays` rays per query find in the maps
    /// where they land.
    ///
    /// # Errors
    /// What the backend raises.
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

    /// As [`Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// The stages that need no scene. Swap a field to bring your own.
#[expect(missing_debug_implementations, reason = "boxed stages")]
pub struct MapStages<B: Backend> {
    /// Arranges photons.
    pub builder: Box<dyn KdTreeBuilder<B>>,
    /// Reads them, but not for final-gather rays: see [`FinalGather`].
    pub estimator: Box<dyn RadianceEstimator<B>>,
}

/// Paths of light that are aimed at mirrors and glass, and fill the caustic map alone.
#[expect(missing_debug_implementations, reason = "boxed stages")]
pub struct Aimed<B: TransportBackend> {
    /// Sends photons out where [`crate::ProjectionMap`] says.
    pub emitter: Box<dyn Emitter<B>>,
    /// Follows them to the first diffuse surface, and stores those that met something specular before.
    pub tracer: Box<dyn Tracer<B>>,
    /// How many in a pass; none if no light could shine on anything specular.
    pub paths: u32,
}

/// All stages. Swap a field to bring your own.
///
/// Fields are independent with one exception: [`Stages::gather`] does not use the estimator of [`Stages::map`] but
/// reads the maps itself, so that another estimator needs another [`FinalGather`] where indirect light is gathered.
#[expect(missing_debug_implementations, reason = "boxed stages")]
pub struct Stages<B: TransportBackend> {
    /// Sends photons out.
    pub emitter: Box<dyn Emitter<B>>,
    /// Follows them.
    pub tracer: Box<dyn Tracer<B>>,
    /// Follows camera paths.
    pub eye: Box<dyn EyeTracer<B>>,
    /// Shadow rays; `None` if not called for.
    pub direct: Option<Box<dyn DirectLight<B>>>,
    /// Final gathering; `None` if not called for.
    pub gather: Option<Box<dyn FinalGather<B>>>,
    /// What final-gather rays find, found beforehand; `None` if not called for.
    pub irradiance: Option<Box<dyn IrradiancePoints<B>>>,
    /// The area of estimates; `None` if not called for.
    pub area: Option<Box<dyn AreaProbe<B>>>,
    /// Paths of its own for the caustic map; `None`: it is filled by the others.
    pub aimed: Option<Aimed<B>>,
    /// Photon maps.
    pub map: MapStages<B>,
}
