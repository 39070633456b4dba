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

// Film: sums of the first surface, of error statistics and of photon moments, each with two planes.
const uint FIRST_LOW = 8u;
const uint ERROR_LOW = 4u;
const uint MOMENTS_LOW = 7u;

#endif
