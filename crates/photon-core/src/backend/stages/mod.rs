//! The stages of a pass. Each is object-safe for a fixed backend, so that a user may replace one.

mod camera;
mod gather;
mod map;
mod media;
mod params;
mod pass;
mod photons;

use crate::backend::{Backend, TransportBackend};

pub use camera::{AreaProbe, DirectLight, EyeBuffers, EyeTracer};
pub use gather::{FinalGather, IrradiancePoints, Maps};
pub(crate) use map::no_errors;
pub use map::{EstimateBuffers, KdTreeBuilder, RadianceEstimator};
pub use media::{BeamEstimator, BeamParams, MediaStages};
pub use params::{EstimateParams, Search};
pub use pass::{Batch, Pass, View};
pub use photons::{Deposits, Emitter, MediaDeposits, Tracer};

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
// Exhaustive: as `Stages`.
#[expect(missing_debug_implementations, reason = "boxed stages")]
pub struct Aimed<B: TransportBackend> {
    /// Emits photons in the directions of the [`crate::ProjectionMap`].
    pub emitter: Box<dyn Emitter<B>>,
    /// Traces photons to the first diffuse surface, and stores those that met something specular before.
    pub tracer: Box<dyn Tracer<B>>,
    /// Number of aimed paths per pass; 0 if no light can reach a specular surface.
    pub paths: u32,
}

/// Stages for light that reaches a glossy surface from a point, spot or directional light by way of perfect mirrors and
/// smooth glass alone, as its reflection shows it: no camera path that follows the reflection can find such a light. With
/// [`crate::Requirements::gloss_caustics_of_all_lights`], likewise for all other lights where the reflection is rough enough
/// ([`crate::gloss_caustics`]); camera paths of [`Stages::eye`] then do not add them.
///
/// The photons have a map of their own, in [`crate::PhotonFormat::Full`], whose estimates
/// ([`EstimateParams::reflection`]) are added to [`crate::Layer::Caustic`].
#[expect(missing_debug_implementations, reason = "boxed stages")]
// Exhaustive: as `Stages`.
pub struct GlossCaustics<B: TransportBackend> {
    /// Traces the paths of the caustic map once more, to the first surface that is not perfectly specular. There it stores
    /// a photon of the full power that arrives, as [`crate::MapKind::Caustic`], if the surface is glossy, and the path has
    /// such a light, and met something specular before. Where all lights count, photons are marked.
    pub tracer: Box<dyn Tracer<B>>,
    /// Traces camera paths which leave a query for the reflection at each glossy surface, weighted by the probability that
    /// it is left, and none at other surfaces; adds nothing to the film.
    pub eye: Box<dyn EyeTracer<B>>,
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
    /// Caustics as glossy surfaces reflect them; `None` if not required, or if the backend has no such stages.
    pub gloss_caustics: Option<GlossCaustics<B>>,
    /// Media that scatter light; `None` if not required.
    pub media: Option<MediaStages<B>>,
    /// Photon maps.
    pub map: MapStages<B>,
}
