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

/// Film: the first of the three planes of the normal of the first surface; below, each sum has a plane of high parts
/// here, and one of low parts [`FIRST_LOW`] planes further on.
pub(crate) const FIRST_NORMAL: u32 = 0;
/// Film: the first of the three planes of the albedo of the first surface.
pub(crate) const FIRST_ALBEDO: u32 = 3;
/// Film: the plane of the depth of the first surface.
pub(crate) const FIRST_DEPTH: u32 = 6;
/// Film: the plane of the squares of the radiance of passes.
pub(crate) const FIRST_SQUARE: u32 = 7;
/// Film: number of sums of the first surface.
pub(crate) const FIRST_LOW: u32 = 8;
/// Film: the plane of the number of hits, which are words, behind the sums of the first surface.
pub(crate) const FIRST_HITS: u32 = 2 * FIRST_LOW;

/// Film: the plane of the bias in error statistics; each sum has two planes, as those of the first surface.
pub(crate) const ERROR_BIAS: u32 = 0;
/// Film: the plane of the squared biases of passes.
pub(crate) const ERROR_BIAS_SQUARE: u32 = 1;
/// Film: the plane of the bias at the narrow radius.
pub(crate) const ERROR_NARROW: u32 = 2;
/// Film: the plane of its squares.
pub(crate) const ERROR_NARROW_SQUARE: u32 = 3;
/// Film: number of sums of error statistics.
pub(crate) const ERROR_LOW: u32 = 4;

/// Film: the plane of the power in the photon moments of a map; members are as in `PhotonMoments`, and each sum has two
/// planes.
pub(crate) const MOMENTS_POWER: u32 = 0;
/// Film: the plane of the squared power.
pub(crate) const MOMENTS_POWER_SQUARED: u32 = 1;
/// Film: the first of the two planes of the slope.
pub(crate) const MOMENTS_SLOPE: u32 = 2;
/// Film: the first of the two planes of the quadrupole.
pub(crate) const MOMENTS_QUADRUPOLE: u32 = 4;
/// Film: the plane of the photons off the plane of the surface.
pub(crate) const MOMENTS_STRAY: u32 = 6;
/// Film: number of sums of photon moments.
pub(crate) const MOMENTS_LOW: u32 = 7;
