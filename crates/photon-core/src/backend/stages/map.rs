//! Stages that build photon maps and estimate from them.

use crate::backend::Backend;
use crate::backend::stages::EstimateParams;
use crate::error::{Error, Result};
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::layout::{ErrorMoments, Estimate, Photon, Query};

/// Arranges photons for searching.
pub trait KdTreeBuilder<B: Backend>: Send {
    /// Builds a map from the photons, and takes ownership of them.
    ///
    /// # Errors
    /// [`crate::Error::InvalidInput`] names a photon with a number that is not finite.
    fn build(&mut self, on: &mut B, photons: B::Buffer<Photon>) -> Result<B::PhotonMap>;

    /// Returns the storage of a map, emptied, for the next pass.
    fn reclaim(&mut self, map: B::PhotonMap) -> B::Buffer<Photon>;

    /// Like [`crate::Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }
}

/// Estimates the irradiance at queries.
///
/// A replacement in [`crate::MapStages`] is used for the visible points of camera paths, for derived radii, and to
/// precompute irradiance. It is not used at the hits of final-gather rays: see [`crate::FinalGather`].
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
    /// Only with [`crate::Search::Radius`].
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

    /// Like [`crate::Tracer::required_format`].
    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Full
    }

    /// Whether it supports [`EstimateParams::reflection`]; otherwise it is never set, and the light that
    /// [`crate::GlossCaustics`] would find is missing.
    fn weighs_reflections(&self) -> bool {
        false
    }
}

/// Per-query estimates and optional error statistics.
// Exhaustive: as `Batch`.
#[derive(Debug)]
pub struct EstimateBuffers<'a, B: Backend> {
    /// One estimate per query.
    pub estimates: &'a mut B::Buffer<Estimate>,
    /// One per query; `None` if errors are not estimated.
    pub error_moments: Option<&'a mut B::Buffer<ErrorMoments>>,
}

/// The error of a stage that does not support error statistics.
pub(crate) fn no_errors() -> Error {
    Error::InvalidSetting {
        name: "errors",
        value: "enabled".into(),
        hint: "these stages do not support them: use those of the backend, with the radius estimator",
    }
}
