//! The CPU backend of the photon mapper: every stage on a pool of threads.
//!
//! The picture does not depend on the number of threads, on how paths are shared out among them, or
//! on the size of batches: not in a single bit.
#![deny(unsafe_code)]

mod backend;
mod cpu;
mod film;
pub mod index;
mod map;
mod scene;
mod stages;
mod transport;

pub use cpu::{Cpu, CpuBuffer};
pub use film::CpuFilm;
pub use map::CpuMap;
pub use scene::CpuScene;

/// The examples of the README, compiled and run as doctests; not part of the library.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The examples of the guide, likewise.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/getting-started.md")]
struct GettingStarted;
