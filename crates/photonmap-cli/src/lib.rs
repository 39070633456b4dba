//! The parts of the program `photonmap`: its commands, and what the studies of this project share with it
//! (backends, pictures in files, reports, error measures).
#![deny(unsafe_code)]
// `eprintln!` panics where standard error cannot be written; `say!` does not.
#![warn(clippy::print_stderr)]

#[macro_use]
pub mod stderr;

pub mod args;
pub mod atomic_write;
pub mod backend;
pub mod command;
pub mod denoise;
pub mod difference;
pub mod exposure;
pub mod exr_file;
pub mod fault;
pub mod flip;
pub mod forecast_text;
pub mod load;
pub mod memory;
pub mod mitsuba;
pub mod npy;
pub mod outputs;
pub mod png_file;
pub mod progress;
pub mod relmse;
pub mod report;
pub mod signals;
pub mod stdout;
pub mod summary;
pub mod tonemap;
pub(crate) mod watch;
