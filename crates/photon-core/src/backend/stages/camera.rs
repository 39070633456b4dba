//! Stages of camera paths, and of rays from where they end.

use crate::backend::stages::{EstimateBuffers, EstimateParams, Pass, View};
use crate::backend::{Backend, TransportBackend};
use crate::error::Result;
use crate::scene::layout::Query;

/// Buffers that camera paths fill.
// Exhaustive: as `Batch`.
#[derive(Debug)]
pub struct EyeBuffers<'a, B: Backend> {
    /// Visible points.
    pub queries: &'a mut B::Buffer<Query>,
    /// [`crate::Segment`]s in media that scatter light, at most [`crate::segments_per_pixel`] for each pixel; `None` unless
    /// they are required.
    pub segments: Option<&'a mut B::Buffer<Query>>,
}

/// Traces camera paths to the first diffuse surface.
pub trait EyeTracer<B: TransportBackend>: Send {
    /// Adds the emission seen by the camera in the samples of `pass` to the film, with depth, normal and albedo, and replaces the
    /// contents of `buffers`. Several samples are in the film after [`crate::FilmBackend::add_samples`]; the queries and segments
    /// of one follow those of the one before, and their pixels are numbered on, as of pictures below one another.
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
        buffers: EyeBuffers<'_, B>,
    ) -> Result<()>;

    /// Number of paths since [`EyeTracer::trace_eye`] of the last sample 0 that were to go on where they met the last surface that
    /// [`crate::Settings::max_bounces`] allows, with a throughput of at least [`crate::NEGLIGIBLE_THROUGHPUT`]. The light beyond
    /// is missing from the film.
    ///
    /// # Errors
    /// Errors of the backend, including deferred ones.
    fn truncated(&mut self, on: &mut B) -> Result<u64>;
}

/// Direct light by next-event estimation.
pub trait DirectLight<B: TransportBackend>: Send {
    /// Adds the direct light found by `shadow_rays` rays per query to [`crate::Layer::Direct`] of the film; of several samples
    /// as [`EyeTracer::trace_eye`].
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

/// Estimates which part of an estimate's disc lies on the surface.
pub trait AreaProbe<B: TransportBackend>: Send {
    /// Multiplies each [`crate::Estimate::radius_squared`] by the share of its disc that lies on the query's
    /// surface and is visible from above the query, as [`crate::area`] defines it; `gather` are the
    /// parameters of the estimates. Error statistics, if present, are divided by the shares of their own
    /// discs: [`crate::ErrorMoments::wide`] and [`crate::ErrorMoments::narrow`] are multiplied by the ratio of the first
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
