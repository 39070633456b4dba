//! Pictures: EXR, PNG and npy files, written as a whole or not at all; exposure, tone curves, denoising, and measures of
//! difference. The program `photonmap` and the interfaces for Python and C share them.
#![deny(unsafe_code)]
#![warn(clippy::print_stderr)]

pub mod atomic_write;
pub mod denoise;
pub mod difference;
pub mod exposure;
pub mod exr_file;
pub mod fault;
pub mod flip;
pub mod npy;
pub mod png_file;
pub mod relmse;
pub mod tonemap;
