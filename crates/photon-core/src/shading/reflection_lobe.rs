//! The reflection of a glossy surface as density estimation weights photons by it; `reflection_lobe.glsl` is the twin.
//!
//! A query for a reflection has the parameters of the material in two of its words, from which [`ReflectionLobe`]
//! evaluates [`crate::Glossy`] without the base. The radiance that it estimates is
//! `Σ Φ f(ω_o, ω_i) c(ω_i)/|ω_i·n_g| / (π r²)`: photons arrive with a density in proportion to |ω_i·n_g|, so that the
//! cosine must not be multiplied once more. The ratio is [`shading_normal::cosine_ratio`].
//!
//! Anisotropy is in a third word, [`crate::anisotropy::pack`]. The words of a sheen are marked as such; its colour is in the
//! throughput of the query.

mod several;

use glam::Vec3;

use crate::scene::material::Material;
use crate::shading::albedo_table::AlbedoTable;
use crate::shading::anisotropy::{self, Anisotropic};
use crate::shading::glossy::multiple_scattering;
use crate::shading::layers::Layers;
use crate::shading::sheen_lobe::Charlie;
use crate::shading::{clearcoat, ggx, sampling, shading_normal, sheen};

pub use several::Vectors;
pub(crate) use several::vector;

/// The reflection of a glossy surface towards one direction.
#[derive(Clone, Copy, Debug)]
pub struct ReflectionLobe {
    alpha: f32,
    /// Of the albedos.
    roughness: f32,
    anisotropic: Option<Anisotropic>,
    f0: Vec3,
    f90: f32,
    /// Multiple scattering: `m F_ms (1 − E_o) / (1 − Ē)`.
    multiple: Vec3,
    /// The shading normal and two vectors perpendicular to it.
    frame: [Vec3; 3],
    /// Towards the viewer, in this frame.
    wo: Vec3,
    /// That of a sheen instead of all else.
    sheen: Option<Charlie>,
}

/// Bits of both words which are 1 only for a sheen: more steps than the root of any F0.
const SHEEN_MARK: [u32; 2] = [255 << 24, 7 << 29];

/// Steps between 0 and 1 of the roots of colours, and of the share of metal.
const STEPS: f32 = 255.0;
/// Steps of the root of the coat's F0, which is 1/5 for an index of 1.5: 11 bits.
const COAT_STEPS: f32 = 2040.0;
/// Steps of the coat's weight: 7 bits.
const WEIGHT_STEPS: f32 = 127.0;
/// Steps of the roughness: 14 bits.
const ROUGHNESS_STEPS: f32 = 16_383.0;

/// Parameters of a material: base colour, or without metal that of the coat's F0; share of metal, roughness, F0 and weight of
/// the coat.
#[derive(Clone, Copy)]
struct Parameters {
    color: Vec3,
    metallic: f32,
    roughness: f32,
    coat_f0: f32,
    weight: f32,
}

impl Parameters {
    #[inline]
    fn unpack([colors, rest]: [u32; 2]) -> Self {
        let part = |word: u32, shift: u32| (word >> shift & 255) as f32 / STEPS;
        let root = Vec3::new(part(colors, 0), part(colors, 8), part(colors, 16));
        let coat_root = (colors >> 24 | rest >> 29 << 8) as f32 / COAT_STEPS;
        Self {
            color: root * root,
            metallic: part(rest, 14),
            roughness: (rest & 0x3FFF) as f32 / ROUGHNESS_STEPS,
            coat_f0: coat_root * coat_root,
            weight: (rest >> 22 & 127) as f32 / WEIGHT_STEPS,
        }
    }

    #[inline]
    fn pack(&self) -> [u32; 2] {
        // A host's textures may have values above 1.
        let steps = |value: f32, most: f32| (value.min(1.0) * most + 0.5) as u32;
        let [r, g, b] = self.color.to_array().map(|c| steps(c.sqrt(), STEPS));
        let (coat, weight) = (steps(self.coat_f0.sqrt(), COAT_STEPS), steps(self.weight, WEIGHT_STEPS));
        let (roughness, metallic) = (steps(self.roughness, ROUGHNESS_STEPS), steps(self.metallic, STEPS));
        [r | g << 8 | b << 16 | coat << 24, roughness | metallic << 14 | weight << 22 | coat >> 8 << 29]
    }

    #[inline]
    fn f0(&self) -> Vec3 {
        let coat = if self.metallic == 0.0 { self.color } else { Vec3::ONE };
        self.color * self.metallic + coat * (self.coat_f0 * (1.0 - self.metallic))
    }
}

impl ReflectionLobe {
    /// Packs a glossy `material` with `layers`, as evaluated at the point of a query, into the words [`crate::Query::media`] and
    /// [`crate::Query::coat`]. Also returns the factor on the throughput that corrects the quantization of F0. Of mixtures with
    /// metal, a specular colour is in this factor alone.
    #[inline]
    #[must_use]
    pub fn pack(material: &Material, layers: &Layers) -> ([u32; 2], Vec3) {
        let coat = layers.coat_f0(material);
        let coat_f0 = coat.max_element();
        let metallic = material.metallic;
        let is_metallic = metallic * STEPS + 0.5 >= 1.0;
        let color = match is_metallic {
            true => material.albedo.into(),
            false if coat_f0 > 0.0 => coat / coat_f0,
            false => Vec3::ONE,
        };
        let packed = Parameters { color, metallic, roughness: material.roughness, coat_f0, weight: material.specular };
        let words = packed.pack();
        let is = Parameters::unpack(words).f0();
        let wanted = Vec3::from(material.albedo) * metallic + coat * (1.0 - metallic);
        // Where F0 is so small that a step is a large part of it, F90 matters more.
        (words, Vec3::select(is.cmpgt(Vec3::splat(MIN_F0)), wanted / is, Vec3::ONE))
    }

    /// The same for the reflection of the clearcoat alone.
    #[inline]
    #[must_use]
    pub fn pack_clearcoat(layers: &Layers) -> ([u32; 2], Vec3) {
        Self::pack(&clearcoat::reflector(layers), &Layers::NONE)
    }

    /// The words of the sheen of `layers`: the throughput must be multiplied by its colour.
    #[inline]
    #[must_use]
    pub fn pack_sheen(layers: &Layers) -> [u32; 2] {
        let roughness = layers.sheen_roughness.clamp(sheen::MIN_ROUGHNESS, 1.0);
        [SHEEN_MARK[0], SHEEN_MARK[1] | (roughness * ROUGHNESS_STEPS + 0.5) as u32]
    }

    /// The lobe with these words, towards `wo` at a surface with the shading normal `normal`.
    #[inline]
    #[must_use]
    pub fn new(words: [u32; 2], wo: Vec3, normal: Vec3) -> Self {
        Self::with_anisotropy(words, 0, wo, normal)
    }

    /// The same; `anisotropy` is from [`anisotropy::pack`] with the same `normal`, or without anisotropy any other word
    /// below 2³¹.
    #[inline]
    #[must_use]
    pub fn with_anisotropy(words: [u32; 2], anisotropy: u32, wo: Vec3, normal: Vec3) -> Self {
        let table = AlbedoTable::get();
        let parameters = Parameters::unpack(words);
        let Parameters { color, metallic, weight, .. } = parameters;
        let anisotropic = anisotropy::unpack(anisotropy, normal)
            .and_then(|(strength, tangent)| Anisotropic::new(parameters.roughness, strength, tangent));
        let roughness =
            anisotropic.map_or(parameters.roughness, |found| anisotropy::equivalent_roughness(found.widths));
        let (tangent, bitangent) =
            anisotropic.as_ref().map_or_else(|| sampling::basis(normal), |found| found.frame(normal));
        let wo = Vec3::new(wo.dot(tangent), wo.dot(bitangent), wo.dot(normal));
        let directional = table.directional(wo.z.clamp(0.0, 1.0), roughness);
        let (multiple, _) = multiple_scattering(color, metallic, directional, table.mean(roughness));
        Self {
            alpha: (roughness * roughness).max(ggx::MIN_ALPHA),
            roughness,
            anisotropic,
            f0: parameters.f0(),
            f90: metallic + weight * (1.0 - metallic),
            multiple,
            frame: [tangent, bitangent, normal],
            wo,
            sheen: (words[0] & SHEEN_MARK[0] == SHEEN_MARK[0] && words[1] & SHEEN_MARK[1] == SHEEN_MARK[1])
                .then(|| Charlie::new(parameters.roughness, wo.z.clamp(0.0, 1.0))),
        }
    }

    /// The factor on the power of a photon that came from the direction `wi`, on a surface with the geometric normal
    /// `geometric`: BSDF times ratio of cosines. 0 for directions below the shading or the geometric surface.
    #[inline]
    #[must_use]
    pub fn weight(&self, wi: Vec3, geometric: Vec3) -> Vec3 {
        let [tangent, bitangent, normal] = self.frame;
        let ratio = shading_normal::cosine_ratio(wi, geometric, normal);
        let (o, i) = (self.wo, Vec3::new(wi.dot(tangent), wi.dot(bitangent), wi.dot(normal)));
        let half = o + i;
        let length = half.length();
        if !(ratio > 0.0 && o.z > 0.0 && i.z > 0.0 && length > 0.0) {
            return Vec3::ZERO;
        }
        let h = half / length;
        if let Some(sheen) = &self.sheen {
            return Vec3::splat(sheen.evaluate(o, i, h) * ratio);
        }
        let across = (1.0 - o.dot(h)).clamp(0.0, 1.0);
        let square = across * across;
        let grazing = square * square * across;
        let fresnel = self.f0 * (1.0 - grazing) + Vec3::splat(self.f90 * grazing);
        let single = match &self.anisotropic {
            None => ggx::distribution(self.alpha, h) * ggx::visibility(self.alpha, o.z, i.z),
            Some(anisotropic) => anisotropic.single(o, i, h).0,
        };
        let albedo = AlbedoTable::get().directional(i.z.min(1.0), self.roughness);
        let lost = (1.0 - (albedo.x + albedo.y)).max(0.0);
        (fresnel * single + self.multiple * (lost * std::f32::consts::FRAC_1_PI)) * ratio
    }
}

/// The largest F0 that [`ReflectionLobe::pack`] leaves as its steps make it.
const MIN_F0: f32 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{SplitMix64, unit_f32};
    use crate::scene::material::MaterialKind;
    use crate::shading::glossy::{Glossy, limited};

    fn material(metallic: f32, roughness: f32, ior: f32, specular: f32, color: [f32; 3]) -> Material {
        Material {
            kind: MaterialKind::Glossy as u32,
            albedo: color,
            metallic,
            roughness,
            specular,
            ior,
            ..Material::default()
        }
    }

    const NORMAL: Vec3 = Vec3::new(0.48, 0.6, -0.64);
    const GEOMETRIC: Vec3 = Vec3::new(0.6, 0.48, -0.64);

    /// The largest difference of weight times |cosine| from [`Glossy::evaluate`], relative to the value, over directions.
    fn worst(material: &Material, changed: &Material, geometric: Vec3) -> f32 {
        let mut numbers = SplitMix64(3);
        let mut above = || {
            let mut number = || unit_f32(numbers.word() as u32);
            sampling::about(NORMAL, 0.98 * number(), number())
        };
        let (words, factor) = ReflectionLobe::pack(changed, &Layers::NONE);
        (0..500)
            .map(|_| {
                let (wo, wi) = (above(), above());
                let found = ReflectionLobe::new(words, wo, NORMAL).weight(wi, geometric) * factor;
                let found = found * wi.dot(geometric).max(0.0);
                let exact = Glossy::new(material, &Layers::NONE, wo.dot(NORMAL)).evaluate(wo, wi, NORMAL).value;
                let exact = exact * limited(wi, geometric, NORMAL);
                ((found - exact).abs() / exact.max_element().max(1e-3)).max_element()
            })
            .fold(0.0, f32::max)
    }

    #[test]
    fn photons_are_weighted_by_the_bsdf() {
        let exact = [
            material(0.0, 0.447, 1.5, 1.0, [0.8, 0.2, 0.1]),
            material(1.0, 0.6, 1.5, 1.0, [1.0; 3]),
            material(1.0, 1.0, 1.5, 1.0, [0.0; 3]),
            material(0.0, 0.1, 0.0, 1.0, [0.5; 3]),
        ];
        let inexact = [
            material(1.0, 0.5, 1.5, 1.0, [0.9, 0.3, 0.05]),
            material(1.0, 1.0, 1.5, 1.0, [0.95, 0.6, 0.3]),
            material(0.37, 0.3, 1.5, 1.0, [0.7, 0.4, 0.2]),
            material(0.0, 0.5, 1.33, 0.7, [0.7, 0.4, 0.2]),
        ];
        for (material, most) in exact.iter().map(|m| (m, 1e-3)).chain(inexact.iter().map(|m| (m, 1e-2))) {
            for geometric in [NORMAL, GEOMETRIC] {
                let found = worst(material, material, geometric);
                assert!(found < most, "{material:?}: {found}");
            }
            // A different roughness exceeds the bound.
            let changed = Material { roughness: material.roughness * 0.95, ..*material };
            assert!(worst(material, &changed, NORMAL) > 1e-2, "{material:?}");
        }
    }

    #[test]
    fn directions_below_the_surface_and_black_surfaces_are_finite() {
        for metallic in [0.0, 1.0] {
            for roughness in [0.0, 1e-4, 1.0] {
                for ior in [0.0, 1.0, 1.5] {
                    let (words, factor) =
                        ReflectionLobe::pack(&material(metallic, roughness, ior, 1.0, [0.0; 3]), &Layers::NONE);
                    assert!(factor.is_finite());
                    for wo in [NORMAL, -NORMAL, GEOMETRIC] {
                        let lobe = ReflectionLobe::new(words, wo, NORMAL);
                        for wi in [NORMAL, -NORMAL, GEOMETRIC, -wo] {
                            let weight = lobe.weight(wi, GEOMETRIC);
                            assert!(weight.is_finite() && weight.min_element() >= 0.0, "{weight}");
                        }
                    }
                }
            }
        }
    }
}
