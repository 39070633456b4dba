//! Numbers that host code and kernels of this backend share. `cargo xtask constants` compiles this file as well, and
//! writes them to `shaders-glsl/device/constants.glsl`; therefore it refers to nothing else in the crate.

/// Prefix sum: words per invocation.
pub(crate) const SCAN_ITEMS: u32 = 16;

/// Radix sort: keys per invocation.
pub(crate) const SORT_ITEMS: u32 = 16;
/// Radix sort: values of a digit.
pub(crate) const SORT_DIGITS: u32 = 256;
/// Radix sort: maximum number of subgroups per workgroup.
pub(crate) const SORT_SUBGROUPS: u32 = 8;

/// Lists of photons: photons per tile.
pub(crate) const LIST_TILE: u32 = 2048;
/// Lists of photons: maximum length of a segment that a single workgroup splits completely.
pub(crate) const LIST_SHORT: u32 = 1024;

/// Paused searches: maximum number of subgroups per dispatch.
pub(crate) const PAUSE_SUBGROUPS: u32 = 4096;
/// Paused searches: words of saved state per invocation.
pub(crate) const PAUSE_WORDS: u32 = 160;

/// Film: sums of the first surface, each with a high and a low plane.
pub(crate) const FIRST_LOW: u32 = 8;
/// Film: sums of a pixel's error statistics, likewise.
pub(crate) const ERROR_LOW: u32 = 4;
/// Film: sums of a pixel's photon moments, likewise.
pub(crate) const MOMENTS_LOW: u32 = 7;
