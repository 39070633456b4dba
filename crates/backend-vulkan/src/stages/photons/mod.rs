//! Photons leave the lights and are followed until they end.

mod emit;
mod plan;
mod tally;
mod trace;

pub(crate) use emit::{VulkanAimedEmitter, VulkanEmitter};
pub use plan::TracePlan;
pub(crate) use trace::VulkanTracer;

use photon_core::RandomKind;

/// The kernels' number of a generator: `RANDOM_*` of constants.glsl.
const fn random_number(kind: RandomKind) -> u32 {
    kind as u32
}
