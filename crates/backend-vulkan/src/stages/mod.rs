//! The stages of a pass.

pub(crate) mod area;
pub(crate) mod direct;
pub(crate) mod eye;
pub(crate) mod final_gather;
pub(crate) mod irradiance;
pub(crate) mod photons;
