//! How a surface scatters: which of the three rules applies at a path vertex, for photons, camera paths and gather rays;
//! `scattering.glsl` is the twin.
//!
//! A path meets a surface once its material has been evaluated at the point ([`crate::shade`]) and the media on both sides
//! are known ([`crate::interface`]). [`Scattering::at`] then decides, here alone, what happens; a new rule is a new case,
//! which the compiler then makes every path handle.

use glam::Vec3;

use crate::requirements::features::Features;
use crate::scene::material::{Material, MaterialKind};
use crate::scene::media::Interface;
use crate::shading::bsdf::Bsdf;
use crate::shading::glossy::Glossy;
use crate::shading::layers::Layers;
use crate::shading::rough_glass::RoughGlass;
use crate::shading::rough_glass_table::RoughGlassTable;

/// Scattering of a surface at one path vertex.
#[derive(Clone, Copy, Debug)]
// Exhaustive: backends must follow each.
pub enum Scattering {
    /// Diffuse reflection, mirrors and smooth glass.
    Simple(Bsdf),
    /// A reflection about the mirror direction over a diffuse base.
    Glossy(Glossy),
    /// Reflection and transmission by microfacets.
    RoughGlass(RoughGlass),
}

/// Where a path meets a surface, and from where.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::exhaustive_structs, reason = "callers make it")]
pub struct Vertex<'a> {
    /// Evaluated at the point.
    pub material: &'a Material,
    /// Likewise.
    pub layers: &'a Layers,
    /// Unit vector to where the path came from.
    pub wo: Vec3,
    /// Cosine of `wo` to the shading normal, ≥ 0.
    pub cosine: f32,
    /// The media on both sides.
    pub interface: &'a Interface,
    /// Whether the path carries light, as photons do: [`Glossy::at`].
    pub carries_light: bool,
}

impl Scattering {
    /// The rule for a surface. A kind that is not in `features` is treated as Lambertian.
    #[inline(always)]
    #[must_use]
    pub fn at(features: Features, table: &RoughGlassTable, vertex: &Vertex<'_>) -> Self {
        let Vertex { material, layers, wo, cosine, interface, carries_light } = *vertex;
        if features.contains(Features::GLOSSY) && material.kind() == MaterialKind::Glossy {
            return Self::Glossy(Glossy::at(material, layers, cosine, wo, carries_light));
        }
        if features.contains(Features::ROUGH_GLASS)
            && let Some(glass) = RoughGlass::new(table, material, cosine, interface)
        {
            return Self::RoughGlass(glass);
        }
        Self::Simple(Bsdf::new(features, material, cosine, interface))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::media::MediumStack;

    /// Each kind of material has its rule; without the feature, a surface is Lambertian.
    #[test]
    fn every_kind_has_one_rule() {
        let table = RoughGlassTable::default();
        let vacuum = MediumStack::VACUUM;
        let interface =
            Interface { eta: 1.5, before: vacuum, transmitted: vacuum, is_active: true, is_too_deep: false };
        for kind in MaterialKind::ALL {
            for roughness in [0.0, 0.5] {
                let material =
                    Material { kind: kind as u32, albedo: [0.5; 3], ior: 1.5, roughness, ..Material::default() };
                let wo = Vec3::new(0.6, 0.0, 0.8);
                let vertex = Vertex {
                    material: &material,
                    layers: &Layers::NONE,
                    wo,
                    cosine: wo.z,
                    interface: &interface,
                    carries_light: false,
                };
                let rule = Scattering::at(Features::ALL, &table, &vertex);
                let fits = match rule {
                    Scattering::Glossy(_) => kind == MaterialKind::Glossy,
                    Scattering::RoughGlass(_) => kind.transmits() && roughness > 0.0,
                    Scattering::Simple(bsdf) => {
                        kind != MaterialKind::Glossy
                            && (!kind.transmits() || roughness == 0.0)
                            && bsdf.split().is_some() == kind.transmits()
                    }
                };
                assert!(fits, "{kind:?}, roughness {roughness}: {rule:?}");
                let plain = Scattering::at(Features::DIFFUSE, &table, &vertex);
                assert!(matches!(plain, Scattering::Simple(bsdf) if bsdf.split().is_none()), "{kind:?}: {plain:?}");
            }
        }
    }
}
