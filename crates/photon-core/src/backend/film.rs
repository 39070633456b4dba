//! Where pictures in progress live: sums over passes, which estimates are added to.

use super::Backend;
use crate::backend::stages::no_errors;
use crate::error::Result;
use crate::film::{Film, Layer};
use crate::requirements::map_kind::MapKind;
use crate::scene::SceneView;
use crate::scene::layout::{ErrorMoments, Estimate, Query};

/// A backend that keeps films. Not object-safe, as [`Backend`] is not.
///
/// A film has two parts: the sums over finished passes, and what the present pass has added, which
/// [`FilmBackend::end_pass`] moves into the sums and [`FilmBackend::abandon_pass`] drops.
pub trait FilmBackend: Backend {
    /// A picture in progress, where the backend keeps it.
    type Film: Send;

    /// An empty film.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`], [`crate::Error::InvalidSetting`] for a size without pixels.
    fn film(&mut self, scene: &SceneView<'_>, width: u32, height: u32) -> Result<Self::Film>;

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

    /// From here on the film keeps what tells errors: memory is allocated for it. Called before the
    /// first pass, and only if errors are asked for.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`]; [`crate::Error::InvalidSetting`] from a backend that cannot.
    fn keep_errors(&mut self, _film: &mut Self::Film) -> Result<()> {
        Err(no_errors())
    }

    /// Adds to each query's pixel what `error_moments` tell of the `estimates` that were folded into `layer`.
    ///
    /// # Errors
    /// As [`FilmBackend::keep_errors`].
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

    /// Ends a pass: from here on it counts in the mean.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    fn end_pass(&mut self, film: &mut Self::Film) -> Result<()>;

    /// Forgets what the present pass has added since the last [`FilmBackend::end_pass`].
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    fn abandon_pass(&mut self, film: &mut Self::Film) -> Result<()>;

    /// The picture so far. Blocks.
    ///
    /// # Errors
    /// Deferred errors surface here.
    fn read_film(&mut self, film: &Self::Film) -> Result<Film>;
}
