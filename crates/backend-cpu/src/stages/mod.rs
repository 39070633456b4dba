//! The stages of a pass.

pub(crate) mod area;
pub(crate) mod beam_estimate;
mod camera_ray;
pub(crate) mod clear_disc;
pub(crate) mod direct;
pub(crate) mod emit;
pub(crate) mod error_moments;
pub(crate) mod estimate;
pub(crate) mod eye;
mod eye_batch;
mod eye_glossy;
mod eye_rough_glass;
mod eye_segments;
pub(crate) mod final_gather;
pub(crate) mod irradiance;
pub(crate) mod light_sample;
pub(crate) mod light_sampler;
pub(crate) mod light_tree;
pub(crate) mod medium_direct;
pub(crate) mod photon_powers;
pub(crate) mod trace;
mod trace_batch;
