//! Scattering, sampling and the geometry of shading.

pub(crate) mod albedo_table;
pub mod alpha;
pub mod area;
mod bias;
pub(crate) mod bsdf;
pub mod clearcoat;
pub(crate) mod environment;
pub mod fresnel;
pub mod ggx;
pub mod glossy;
pub(crate) mod interaction;
pub(crate) mod layers;
pub mod light_sampler;
pub mod light_tree;
pub mod math;
pub mod octahedral;
pub mod offset;
pub mod random;
pub(crate) mod reflection_lobe;
pub mod rough_glass;
pub(crate) mod rough_glass_table;
pub mod sampling;
pub mod shade;
pub mod shading_normal;
pub mod sobol;
pub mod solid_angle;
pub mod texture;
