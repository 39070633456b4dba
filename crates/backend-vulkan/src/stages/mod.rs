//! The stages of a pass.

pub(crate) mod area;
pub(crate) mod direct;
pub(crate) mod emit;
pub(crate) mod eye;
pub(crate) mod final_gather;
pub(crate) mod irradiance;
pub(crate) mod medium_direct;
mod tally;
pub(crate) mod trace;
mod trace_plan;
mod truncated;

pub use trace_plan::TracePlan;
