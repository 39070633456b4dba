//! The parts of the program `photonmap`: its commands, and what the studies of this project share with it
//! (backends, pictures in files, reports, error measures).
#![deny(unsafe_code)]
// `eprintln!` panics where standard error cannot be written; `say!` does not.
#![warn(clippy::print_stderr)]

#[macro_use]
pub mod stderr;

pub mod args;
pub mod backend;
pub mod command;
pub mod fault;
pub mod forecast_text;
pub mod load;
pub mod memory;
pub mod mitsuba;
pub mod outputs;
pub mod progress;
pub mod report;
pub mod signals;
pub mod stdout;
pub mod summary;
pub(crate) mod watch;

pub use photon_image::{atomic_write, denoise, difference, exposure, exr_file, flip, npy, png_file, relmse, tonemap};
