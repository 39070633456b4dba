//! The CPU's pipeline once more, in f64: what the f32 that ships is compared with.
//!
//! A twin in the tests, as the kernels in GLSL are twins of Rust, and neither generic code nor a feature: the code
//! that ships stays as it is and as fast, whoever reads it meets one type of number, and the twin is free to do what
//! f32 only approximates (sines of the system's library, rays that skip the triangle they leave instead of a step off
//! it). It takes the same random words, so that both walk the same path until rounding parts them.

pub mod optics;
pub mod path;
pub mod scene;
pub mod tree;

pub use path::{End, Landing, Start, Twin, emit};
pub use scene::{Described, Wide};
