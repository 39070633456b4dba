//! Many messages of one kind on standard error.

use std::fmt::Display;

use photon_scene::summed_up;

/// Prints messages on standard error, each behind the prefix.
pub fn say<T: Display>(prefix: &str, messages: &[T]) {
    for line in summed_up(messages) {
        say!("{prefix}{line}");
    }
}
