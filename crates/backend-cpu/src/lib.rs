//! The CPU backend of the photon mapper: runs every stage on a thread pool.
//!
//! The rendered image is bit-identical for any number of threads, any distribution of paths over the threads, and
//! any batch size.
#![deny(unsafe_code)]

mod backend;
mod caster;
mod cpu;
mod film;
pub mod index;
mod map;
mod scene;
mod shading;
mod stages;
mod stretches;
mod transport;

pub use cpu::{Cpu, CpuBuffer};
pub use film::CpuFilm;
pub use map::CpuMap;
pub use scene::CpuScene;

/// The example in the README, compiled and run as a doctest; not part of the library.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
