//! Numbers that the host code and the kernels of the Vulkan backend share.

use super::file::Group;

// Shared with the backend as a file, so that this program can run while the backend does not compile for want of
// new shaders.
#[path = "../../../crates/backend-vulkan/src/constants.rs"]
mod backend_vulkan;

use backend_vulkan::{
    ERROR_BIAS, ERROR_BIAS_SQUARE, ERROR_LOW, ERROR_NARROW, ERROR_NARROW_SQUARE, FIRST_ALBEDO, FIRST_DEPTH, FIRST_HITS,
    FIRST_LOW, FIRST_NORMAL, FIRST_SQUARE, LIST_SHORT, LIST_TILE, MOMENTS_LOW, MOMENTS_POWER, MOMENTS_POWER_SQUARED,
    MOMENTS_QUADRUPOLE, MOMENTS_SLOPE, MOMENTS_STRAY, PAUSE_SUBGROUPS, PAUSE_WORDS, SCAN_ITEMS, SORT_DIGITS,
    SORT_ITEMS, SORT_SUBGROUPS,
};

/// The constants of `device/constants.glsl`.
pub(super) fn groups() -> Vec<Group> {
    vec![
        ("Prefix sums: words per invocation.", vec![("SCAN_ITEMS", SCAN_ITEMS.into())]),
        (
            "Radix sort: keys per invocation, values of a digit, maximum number of subgroups per workgroup.",
            vec![
                ("SORT_ITEMS", SORT_ITEMS.into()),
                ("SORT_DIGITS", SORT_DIGITS.into()),
                ("SORT_SUBGROUPS", SORT_SUBGROUPS.into()),
            ],
        ),
        (
            "Lists of photons: photons per tile, maximum length of a segment that one workgroup splits completely.",
            vec![("LIST_TILE", LIST_TILE.into()), ("LIST_SHORT", LIST_SHORT.into())],
        ),
        (
            "Paused searches: maximum number of subgroups per dispatch, words of saved state per invocation.",
            vec![("PAUSE_SUBGROUPS", PAUSE_SUBGROUPS.into()), ("PAUSE_WORDS", PAUSE_WORDS.into())],
        ),
        (
            "Film: planes of high parts of sums about the first surface, how many planes further on their low parts are, \
             and the plane of hits.",
            vec![
                ("FIRST_NORMAL", FIRST_NORMAL.into()),
                ("FIRST_ALBEDO", FIRST_ALBEDO.into()),
                ("FIRST_DEPTH", FIRST_DEPTH.into()),
                ("FIRST_SQUARE", FIRST_SQUARE.into()),
                ("FIRST_LOW", FIRST_LOW.into()),
                ("FIRST_HITS", FIRST_HITS.into()),
            ],
        ),
        (
            "Film: the same of error statistics.",
            vec![
                ("ERROR_BIAS", ERROR_BIAS.into()),
                ("ERROR_BIAS_SQUARE", ERROR_BIAS_SQUARE.into()),
                ("ERROR_NARROW", ERROR_NARROW.into()),
                ("ERROR_NARROW_SQUARE", ERROR_NARROW_SQUARE.into()),
                ("ERROR_LOW", ERROR_LOW.into()),
            ],
        ),
        (
            "Film: the same of the photon moments of a map.",
            vec![
                ("MOMENTS_POWER", MOMENTS_POWER.into()),
                ("MOMENTS_POWER_SQUARED", MOMENTS_POWER_SQUARED.into()),
                ("MOMENTS_SLOPE", MOMENTS_SLOPE.into()),
                ("MOMENTS_QUADRUPOLE", MOMENTS_QUADRUPOLE.into()),
                ("MOMENTS_STRAY", MOMENTS_STRAY.into()),
                ("MOMENTS_LOW", MOMENTS_LOW.into()),
            ],
        ),
    ]
}
