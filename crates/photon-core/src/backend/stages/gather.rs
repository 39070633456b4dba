//! Stages of final gathering.

use crate::backend::stages::{EstimateParams, Pass};
use crate::backend::{Backend, TransportBackend};
use crate::error::Result;
use crate::requirements::map_kind::PerMap;
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::layout::{Estimate, Photon, Query};

/// The photon maps of a pass, each with its estimate parameters.
// Exhaustive: as `Batch`.
#[derive(Debug)]
pub struct Maps<'a, B: Backend> {
    /// The maps that were built.
    pub photons: PerMap<Option<(&'a B::PhotonMap, EstimateParams)>>,
    /// Irradiance from all maps, precomputed at every n-th photon and stored as its power. If present, final-gather rays take
    /// [`Estimate::flux`] of this map as irradiance where it has a photon, and elsewhere estimate from the others.
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

    /// Like [`crate::Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// Indirect light by final gathering.
///
/// The stage reads the maps with an estimator of its own, not with [`crate::MapStages::estimator`]: on the CPU
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

    /// Number of rays of the last [`FinalGather::gather`] that were to go on where they met the last surface that
    /// [`crate::Settings::max_bounces`] allows.
    ///
    /// # Errors
    /// Errors of the backend, including deferred ones.
    fn truncated(&mut self, on: &mut B) -> Result<u64>;

    /// Like [`crate::Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}
