// Numbers that Rust and GLSL share. Written by `cargo xtask constants`.
#ifndef DEVICE_CONSTANTS_GLSL
#define DEVICE_CONSTANTS_GLSL

// Prefix sums: words per invocation.
const uint SCAN_ITEMS = 16u;

// Radix sort: keys per invocation, values of a digit, maximum number of subgroups per workgroup.
const uint SORT_ITEMS = 16u;
const uint SORT_DIGITS = 256u;
const uint SORT_SUBGROUPS = 8u;

// Lists of photons: photons per tile, maximum length of a segment that one workgroup splits completely.
const uint LIST_TILE = 2048u;
const uint LIST_SHORT = 1024u;

// Paused searches: maximum number of subgroups per dispatch, words of saved state per invocation.
const uint PAUSE_SUBGROUPS = 4096u;
const uint PAUSE_WORDS = 160u;

// Film: planes of high parts of sums about the first surface, how many planes further on their low parts are, and the plane of hits.
const uint FIRST_NORMAL = 0u;
const uint FIRST_ALBEDO = 3u;
const uint FIRST_DEPTH = 6u;
const uint FIRST_SQUARE = 7u;
const uint FIRST_LOW = 8u;
const uint FIRST_HITS = 16u;

// Film: the same of error statistics.
const uint ERROR_BIAS = 0u;
const uint ERROR_BIAS_SQUARE = 1u;
const uint ERROR_NARROW = 2u;
const uint ERROR_NARROW_SQUARE = 3u;
const uint ERROR_LOW = 4u;

// Film: the same of the photon moments of a map.
const uint MOMENTS_POWER = 0u;
const uint MOMENTS_POWER_SQUARED = 1u;
const uint MOMENTS_SLOPE = 2u;
const uint MOMENTS_QUADRUPOLE = 4u;
const uint MOMENTS_STRAY = 6u;
const uint MOMENTS_LOW = 7u;

#endif
