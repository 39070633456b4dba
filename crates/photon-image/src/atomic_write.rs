//! Atomic file writes ([`photon_film::atomic_write`]), with the errors of the program.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

pub use photon_film::atomic_write::Failure;

use crate::fault::Fault;

/// Writes a file through `save`: [`photon_film::atomic_write::write`].
///
/// # Errors
/// [`Fault::Failure`] names the file and why it could not be written.
pub fn write(path: &Path, save: impl FnOnce(&mut BufWriter<File>) -> Result<(), Failure>) -> Result<(), Fault> {
    photon_film::atomic_write::write(path, save).map_err(|why| Fault::writing(path, why))
}

/// Writes bytes, with the same guarantees.
///
/// # Errors
/// Those of [`write()`].
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    photon_film::atomic_write::write_bytes(path, bytes).map_err(|why| Fault::writing(path, why))
}

/// Checks that [`write()`] could start, so that an invalid path is reported before an hour of rendering.
///
/// # Errors
/// [`Fault::Input`], which names the file and the reason.
pub fn check(path: &Path) -> Result<(), Fault> {
    photon_film::atomic_write::check(path)
        .map_err(|why| Fault::input(format!("{}: cannot be written: {why}", path.display())))
}
