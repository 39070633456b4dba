//! `photonmap scenes`

use std::fmt::Write as _;

use crate::fault::Fault;
use crate::stdout;

/// Lists the built-in scenes.
///
/// # Errors
/// [`Fault::Failure`] if standard output cannot be written.
pub fn run() -> Result<(), Fault> {
    let mut text = String::new();
    for (name, description) in photon_scene::builtin_names() {
        let _ = writeln!(text, "{name:<20} {description}");
    }
    stdout::write(text.as_bytes())
}
