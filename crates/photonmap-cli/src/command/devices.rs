//! `photonmap devices`

use crate::backend;
use crate::fault::Fault;
use crate::stdout;

/// Lists the Vulkan devices, one per line, and what each lacks.
///
/// # Errors
/// [`Fault::Input`] if there is no Vulkan loader or driver.
pub fn run() -> Result<(), Fault> {
    stdout::write((backend::list()?.join("\n") + "\n").as_bytes())
}
