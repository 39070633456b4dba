//! Photon mapping, the part that is the same on every backend.
#![forbid(unsafe_code)]

mod caster;

pub use caster::{Hit, Ray, RayCaster};
pub use glam;
