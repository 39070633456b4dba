//! Stages of media that scatter light.

use crate::backend::TransportBackend;
use crate::backend::stages::{DirectLight, EstimateBuffers};
use crate::error::Result;
use crate::scene::layout::Query;
use crate::settings::kernel::Kernel;

/// Parameters of estimates along segments.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: as `Batch`.
pub struct BeamParams {
    /// Weight of photons by their distance from the segment.
    pub kernel: Kernel,
    /// Radius around the segment, normalised, > 0; times [`Query::radius`], but at most half a mean free path.
    pub radius: f32,
}

/// The beam radiance estimate of Jarosz, Zwicker and Jensen (2008): radiance that is scattered towards the start of a segment
/// by all photons of a medium around it.
pub trait BeamEstimator<B: TransportBackend>: Send {
    /// Replaces the contents of `buffers` with those of `segments`, which are those of [`crate::Segment`]:
    /// [`crate::Estimate::flux`] is the sum over the photons of `map` within the radius, in the medium of the segment and between
    /// its planes, of `W(d²/r²)·T·f·power`, where T is the transmittance to [`crate::Segment::distance`], and f the phase
    /// function. Error moments have `T·f·power` as the power of a photon, and the offset from its foot.
    ///
    /// # Errors
    /// Errors of the backend.
    fn estimate(
        &mut self,
        on: &mut B,
        scene: &B::Scene,
        map: &B::PhotonMap,
        segments: &B::Buffer<Query>,
        params: &BeamParams,
        buffers: EstimateBuffers<'_, B>,
    ) -> Result<()>;
}

/// Stages for media that scatter light. Their photons have maps of their own, in [`crate::PhotonFormat::Full`], with the index
/// of the medium as [`crate::Photon::normal`].
///
/// Light that reaches a medium straight from a light source is found by shadow rays, the rest by photons.
#[expect(missing_debug_implementations, reason = "boxed stages")]
// Exhaustive: as `Stages`.
pub struct MediaStages<B: TransportBackend> {
    /// Adds light of light sources that is scattered once along segments to [`crate::Layer::Direct`].
    pub direct: Box<dyn DirectLight<B>>,
    /// Estimates from the maps.
    pub estimator: Box<dyn BeamEstimator<B>>,
}
