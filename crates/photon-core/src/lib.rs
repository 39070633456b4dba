//! Photon mapping, the part that is the same on every backend.
//!
//! Records, random numbers, physics, settings, the traits that a backend implements, and the loop
//! that drives them. No threads, no input or output, no ray-tracing structure.
#![forbid(unsafe_code)]

mod caster;
mod error;
mod features;
mod kernel;
mod layout;
mod progressive;
mod requirements;
mod scene;
mod settings;
mod units;

pub use caster::{Hit, Ray, RayCaster};
pub use error::{Error, Result};
pub use features::Features;
pub use glam;
pub use kernel::Kernel;
pub use layout::{Camera, Element, Estimate, Facet, Light, Material, Photon, PhotonRay, Query};
pub use progressive::radius_squared_factor;
pub use requirements::{Requirements, light_features, material_features};
pub use scene::{SceneView, light_probability, light_starts, pick_light};
pub use settings::{Direct, Estimator, IndexKind, Indirect, Paper, RandomKind, Settings, Sharing};
pub use units::Units;
