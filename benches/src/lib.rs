//! Shared by the benchmarks.

pub mod load;
