//! Stages of light paths.

use crate::backend::stages::Batch;
use crate::backend::tally::Tally;
use crate::backend::{Backend, TransportBackend};
use crate::error::Result;
use crate::requirements::map_kind::PerMap;
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::layout::{Photon, PhotonRay};

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
    /// On each stretch in a medium that scatters light, or at collisions there, it appends photons to one of `in_media.inside`, in the
    /// same order, with the index of the medium as [`Photon::normal`]: their expected power is that of the light scattered there. Stretches that begin at a
    /// light source have none, so that the map of direct light stays empty. Aimed paths never collide, and lose what is
    /// attenuated. [`Self::take_tally`] counts the photons of `deposits` only.
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
        in_media: MediaDeposits<'_, B>,
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

/// The buffers for photons of light that media scatter.
#[expect(missing_debug_implementations, reason = "buffers of a backend")]
// Exhaustive: as `Stages`.
pub struct MediaDeposits<'a, B: Backend> {
    /// For photons in media.
    pub inside: Deposits<'a, B>,
    /// For the photons of [`crate::MapKind::Global`] on surfaces whose light was last scattered in a medium: since then it has met
    /// only specular surfaces.
    pub onto_surfaces: Option<&'a mut B::Buffer<Photon>>,
}

impl<B: Backend> Default for MediaDeposits<'_, B> {
    fn default() -> Self {
        Self { inside: Deposits::<B>::default(), onto_surfaces: None }
    }
}
