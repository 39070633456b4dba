//! Searches on the device against backend-cpu's.

mod estimates;
mod inputs;
mod maps;
mod neighbours;

/// Mesa's device in software ends the loops of an invocation after 65 535 turns in sum: searches there
/// are of what fits.
fn at_most(on: &crate::Vulkan, in_software: usize, otherwise: usize) -> usize {
    if on.limits().name.contains("llvmpipe") { in_software } else { otherwise }
}
