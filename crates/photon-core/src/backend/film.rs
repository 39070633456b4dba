//! Films of a backend: sums over passes, to which estimates are added.

use super::Backend;
use crate::backend::stages::no_errors;
use crate::error::Result;
use crate::film::display::{Display, DisplayImage};
use crate::film::{Film, Layer};
use crate::radius::bandwidth::RadiusUpdate;
use crate::requirements::map_kind::MapKind;
use crate::scene::layout::{ErrorMoments, Estimate, Query};
use crate::scene::units::Units;

/// A backend with films. Not object-safe, like [`Backend`].
///
/// A film has two parts: the sums over finished passes, and the contributions of the current pass, which
/// [`FilmBackend::end_pass`] moves into the sums and [`FilmBackend::abandon_pass`] discards.
pub trait FilmBackend: Backend {
    /// A film, in the memory of the backend.
    type Film: Send;

    /// Allocates an empty film of a scene with these units.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`], [`crate::Error::InvalidSetting`] for a size without pixels.
    fn film(&mut self, units: Units, width: u32, height: u32) -> Result<Self::Film>;

    /// Adds `query.throughput × estimate.irradiance(paths)` to `layer` of each query's pixel.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    fn accumulate(
        &mut self,
        film: &mut Self::Film,
        layer: Layer,
        queries: &Self::Buffer<Query>,
        estimates: &Self::Buffer<Estimate>,
        paths: u64,
    ) -> Result<()>;

    /// Enables error statistics in the film, and allocates memory for them. Called before the first pass,
    /// and only if errors are to be estimated.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`]; [`crate::Error::InvalidSetting`] if the backend does not support it.
    fn keep_errors(&mut self, _film: &mut Self::Film) -> Result<()> {
        Err(no_errors())
    }

    /// Adds the error statistics of the `estimates` that were added to `layer` to each query's pixel.
    ///
    /// # Errors
    /// Those of [`FilmBackend::keep_errors`].
    fn accumulate_errors(
        &mut self,
        _film: &mut Self::Film,
        _kind: MapKind,
        _queries: &Self::Buffer<Query>,
        _estimates: &Self::Buffer<Estimate>,
        _error_moments: &Self::Buffer<ErrorMoments>,
        _paths: u64,
    ) -> Result<()> {
        Err(no_errors())
    }

    /// Adds what the stages of the camera have left of `samples` camera samples that were traced together
    /// ([`crate::TransportBackend::samples_together`]) to the current pass, one after another. Not called with one sample.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    fn add_samples(&mut self, _film: &mut Self::Film, _samples: u32) -> Result<()> {
        Ok(())
    }

    /// Divides the light that the current pass has added to `layers` by the number of its camera samples, which has added to them
    /// that often. From now on, each pass of the film counts so many camera paths of a pixel. Not called with one sample.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    fn average_samples(&mut self, film: &mut Self::Film, layers: &[Layer], samples: u32) -> Result<()>;

    /// Ends a pass: its contributions now count in the mean.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    fn end_pass(&mut self, film: &mut Self::Film) -> Result<()>;

    /// Discards what the current pass has added since the last [`FilmBackend::end_pass`]. Where several films exist, the memory
    /// that is reported for the film is afterwards that of this one.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    fn abandon_pass(&mut self, film: &mut Self::Film) -> Result<()>;

    /// Empties the film: sums over finished passes, and the current pass.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    fn clear_film(&mut self, film: &mut Self::Film) -> Result<()>;

    /// Reads back the film so far. Blocks.
    ///
    /// # Errors
    /// Deferred errors surface here.
    fn read_film(&mut self, film: &Self::Film) -> Result<Film>;

    /// Updates the factors on the radii of pixels from the error statistics of the film, as [`crate::PixelRadii::learn`] does:
    /// `factors` are bits of `f32`, the last ones that this method returned, `None` for the factor 1 in all pixels. Returns
    /// whether it did: by default not, and the host does it from the whole film. A backend does so for all updates of a film
    /// or for none.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`], [`crate::Error::DeviceLost`].
    fn update_radii(
        &mut self,
        _film: &mut Self::Film,
        _update: &RadiusUpdate,
        _factors: &mut Option<Self::Buffer<u32>>,
    ) -> Result<bool> {
        Ok(false)
    }

    /// Reads back the picture so far as it is shown; with `clamp`, radiance is clamped to `[0, 1]` before the exposure.
    /// Blocks. By default made of the whole film.
    ///
    /// # Errors
    /// Those of [`Display::validate`]; deferred errors surface here.
    fn read_display(&mut self, film: &mut Self::Film, display: &Display, clamp: bool) -> Result<DisplayImage> {
        display.validate()?;
        Ok(self.read_film(film)?.display_clamped(display, clamp))
    }
}
