//! A reference implementation of the CPU pipeline in f64, with which the shipped f32 code is compared.
//!
//! It is a separate twin in the tests, as the GLSL kernels are twins of the Rust code, rather than generic code or
//! a feature: the shipped code stays unchanged and as fast, its readers meet only one number type, and the twin may
//! do exactly what f32 only approximates (the system library's sines; rays that skip the triangle they leave
//! instead of an offset from it). It takes the same random words, so both trace the same path until rounding makes
//! them diverge.

pub mod optics;
pub mod path;
pub mod scene;
pub mod tree;

pub use path::{End, Landing, Start, Twin, emit};
pub use scene::{Described, Wide};
