//! Film files: the sums of a render, in a stored zip of NumPy arrays and `film.json`.
//!
//! A film file knows which passes it contains and what they depend on ([`FilmKey`]). A render is continued from it with
//! the bits of an undisturbed one ([`photon_core::Blocks::remaining`]), and files from several machines are merged
//! ([`merge()`]). `numpy.load` opens them. `docs/films.md` describes the format.
#![forbid(unsafe_code)]

pub mod atomic_write;
mod camera;
mod column;
mod error;
mod header;
mod key;
mod merge;
mod npy;
mod read;
mod tally;
mod words;
mod write;

pub use error::{FilmFileError, shown};
pub use header::{FORMAT, FilmInfo, Maker, device_names};
pub use key::FilmKey;
pub use merge::merge;
pub use read::{load, load_from, read_info};
pub use tally::{tally_from_text, tally_to_text};
pub use words::FilmWords;
pub use write::{save, save_to};

#[cfg(test)]
mod tests;
