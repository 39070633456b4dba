//! Numbers that the host code and the kernels of the Vulkan backend share.

use super::file::Group;

// Shared with the backend as a file, so that this program can run while the backend does not compile for want of
// new shaders.
#[path = "../../../crates/backend-vulkan/src/constants.rs"]
mod backend_vulkan;

use backend_vulkan::{
    ERROR_LOW, FIRST_LOW, LIST_SHORT, LIST_TILE, MOMENTS_LOW, PAUSE_SUBGROUPS, PAUSE_WORDS, SCAN_ITEMS, SORT_DIGITS,
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
            "Film: sums of the first surface, of error statistics and of photon moments, each with two planes.",
            vec![("FIRST_LOW", FIRST_LOW.into()), ("ERROR_LOW", ERROR_LOW.into()), ("MOMENTS_LOW", MOMENTS_LOW.into())],
        ),
    ]
}
