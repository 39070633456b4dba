//! Photons leave the lights and are followed until they end.

mod emit;
mod ends;
mod plan;
mod trace;

pub(crate) use emit::{VulkanAimedEmitter, VulkanEmitter};
pub use plan::TracePlan;
pub(crate) use trace::VulkanTracer;

use photon_core::RandomKind;

/// The kernels' number of a generator.
fn random_number(kind: RandomKind) -> u32 {
    match kind {
        RandomKind::Counter => 0,
        RandomKind::Lcg => 1,
        RandomKind::Sobol => 2,
    }
}
