//! Radii of each pixel: whether there are any, and their updates after passes.

use super::Pipeline;
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::radius::bandwidth;
use crate::settings::{Bandwidth, Settings};

impl<B: TransportBackend> Pipeline<B> {
    /// The factors on radii, if each pixel has its own.
    pub(super) fn own_radii(settings: &Settings) -> Option<(bandwidth::Radii, Option<B::Buffer<u32>>)> {
        (settings.bandwidth == Bandwidth::PerPixel)
            .then(|| (bandwidth::Radii::new(settings.alpha, settings.kernel.second_radius_noise()), None))
    }

    /// Updates the factors on radii, if that is due.
    pub(super) fn update_own_radii(&mut self) -> Result<()> {
        if let Some((radii, factors)) = &mut self.bandwidth
            && let Some(update) = radii.due(self.passes)
        {
            self.on.mark(Some(Stage::Film));
            let is_done = self.on.update_radii(&mut self.film, &update, factors)?;
            let bits = if is_done { None } else { Some(radii.learn(&self.on.read_film(&self.film)?, &update)) };
            // Before the upload, which may fail: no pass is learnt from twice.
            radii.updated(&update);
            if let Some(bits) = bits {
                *factors = Some(self.on.upload("radii of pixels", &bits)?);
            }
            self.on.mark(None);
        }
        Ok(())
    }
}
