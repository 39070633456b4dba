//! Shared by the benchmarks.

#[cfg(feature = "embree")]
pub mod embree;
pub mod load;
