//! Scattering at surfaces: one implementation for photons, camera paths and gather rays; `bsdf.glsl` is its twin.
//!
//! [`Bsdf`] describes a surface at one path vertex. Callers choose a lobe, get its weight, and sample a
//! direction, in this order, so that a path that ends needs no direction. Weights apply to flux, and are
//! the same in both directions of travel. Radiance also changes by the squared ratio of indices at refraction: that is not
//! in the weights; [`crate::radiance_scale`] applies it once, where the path ends.

use glam::Vec3;

use crate::fresnel::{fresnel, reflect, refract, schlick_rise, sheet_reflectance};
use crate::requirements::features::Features;
use crate::sampling;
use crate::scene::material::{Material, MaterialKind};
use crate::scene::media::Interface;

/// Most total reflections of a path that may meet `max_bounces` surfaces; one more truncates it. Light that is trapped in a
/// solid meets thousands of surfaces, for nothing, and a GPU waits for the longest path.
#[inline]
#[must_use]
pub const fn most_total_reflections(max_bounces: u32) -> u32 {
    let part = max_bounces / 16;
    if part > 64 { part } else { 64 }
}

/// Throughput below which Russian roulette may end a camera path, and the light beyond its end is not missed:
/// [`crate::EyeTracer::truncated`].
pub const NEGLIGIBLE_THROUGHPUT: f32 = 1e-6;

/// Russian roulette for a camera path of this throughput, by a random word: the factor on the throughput, or `None` if the path
/// ends. Paths that go on have about [`NEGLIGIBLE_THROUGHPUT`] in their brightest channel, or what they had if that is more.
#[inline]
#[must_use]
pub fn russian_roulette(throughput: Vec3, word: u32) -> Option<f32> {
    const ALL: f32 = 4_294_967_296.0;
    let chance = throughput.max_element() / NEGLIGIBLE_THROUGHPUT;
    if chance >= 1.0 {
        return Some(1.0);
    }
    // The number of words with which it goes on, of which the factor is the exact inverse.
    let words = (chance * ALL) as u32;
    (word < words).then(|| ALL / words as f32)
}

/// A component of a [`Bsdf`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// Exhaustive: backends must follow each.
pub enum Lobe {
    /// Lambertian reflection. Camera paths end here, and photons are stored unless the surface is black.
    Diffuse,
    /// Reflection in the mirror direction; at glossy surfaces also about it, by [`crate::Glossy`].
    SpecularReflection,
    /// Transmission in the refracted direction only.
    SpecularTransmission,
}

/// Scattering of a surface at one path vertex.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    kind: MaterialKind,
    albedo: Vec3,
    eta: f32,
    reflectance: f32,
    cos_transmitted: f32,
    is_active: bool,
}

impl Bsdf {
    /// The lobes of `material` for a path that arrives with `cosine` ≥ 0 to the normal. `interface` is from
    /// [`crate::interface`]; a kind that is not in `features` is treated as Lambertian.
    #[inline(always)]
    #[must_use]
    pub fn new(features: Features, material: &Material, cosine: f32, interface: &Interface) -> Self {
        let mut bsdf = Self {
            kind: MaterialKind::Lambert,
            albedo: material.albedo.into(),
            eta: interface.eta,
            reflectance: 0.0,
            cos_transmitted: 0.0,
            is_active: interface.is_active,
        };
        match material.kind() {
            // Glossy surfaces are `Glossy`'s: what is left of them here is Lambertian.
            MaterialKind::Lambert | MaterialKind::Glossy => {}
            MaterialKind::Mirror => {
                if features.contains(Features::MIRROR) {
                    bsdf.kind = MaterialKind::Mirror;
                    bsdf.reflectance = 1.0;
                    bsdf.albedo += (1.0 - bsdf.albedo) * (material.metallic * schlick_rise(cosine));
                }
            }
            MaterialKind::Dielectric => {
                if features.contains(Features::DIELECTRIC) {
                    let fresnel = fresnel(cosine, interface.eta);
                    bsdf.kind = MaterialKind::Dielectric;
                    bsdf.reflectance = fresnel.reflectance;
                    bsdf.cos_transmitted = fresnel.cos_transmitted;
                }
            }
            MaterialKind::Thin => {
                if features.contains(Features::THIN) {
                    bsdf.kind = MaterialKind::Thin;
                    bsdf.reflectance = sheet_reflectance(fresnel(cosine, interface.eta).reflectance);
                }
            }
        }
        bsdf
    }

    /// The reflected share at surfaces that both reflect and transmit; `None` if there is a single lobe.
    #[inline]
    #[must_use]
    pub fn split(&self) -> Option<f32> {
        self.kind.transmits().then_some(self.reflectance)
    }

    /// Whether a smooth boundary reflects all light: total internal reflection.
    #[inline]
    #[must_use]
    pub fn is_total(&self) -> bool {
        self.kind == MaterialKind::Dielectric && self.reflectance >= 1.0
    }

    /// The lobe that `u`, uniform in `[0, 1)`, selects. If there is a single lobe, `u` is not used.
    #[inline]
    #[must_use]
    pub fn choose(&self, u: f32) -> Lobe {
        match self.kind {
            MaterialKind::Lambert | MaterialKind::Glossy => Lobe::Diffuse,
            MaterialKind::Mirror => Lobe::SpecularReflection,
            MaterialKind::Dielectric | MaterialKind::Thin => {
                if u < self.reflectance {
                    Lobe::SpecularReflection
                } else {
                    Lobe::SpecularTransmission
                }
            }
        }
    }

    /// Factor on the throughput after [`Self::choose`] returned `lobe`, whose probability is divided out; each channel
    /// in `[0, 1]`.
    #[inline]
    #[must_use]
    pub fn weight(&self, lobe: Lobe) -> Vec3 {
        match lobe {
            Lobe::Diffuse => self.albedo,
            Lobe::SpecularReflection => {
                if self.kind.transmits() {
                    Vec3::ONE
                } else {
                    self.albedo
                }
            }
            Lobe::SpecularTransmission => {
                if self.is_active {
                    self.albedo
                } else {
                    Vec3::ONE
                }
            }
        }
    }

    /// The sampled direction of a path that arrives along `incoming`; `normal` is on the side that it came
    /// from. `u` and `v` are uniform in `[0, 1)`, and are only used for [`Lobe::Diffuse`].
    #[inline]
    #[must_use]
    pub fn direction(&self, lobe: Lobe, incoming: Vec3, normal: Vec3, u: f32, v: f32) -> Vec3 {
        match lobe {
            Lobe::Diffuse => sampling::cosine_hemisphere(normal, u, v),
            Lobe::SpecularReflection => reflect(incoming, normal),
            Lobe::SpecularTransmission => {
                if self.kind == MaterialKind::Thin {
                    incoming
                } else {
                    refract(incoming, normal, self.eta, self.cos_transmitted)
                }
            }
        }
    }

    /// What irradiance is multiplied by for its contribution to the pixel: `throughput · albedo / π`.
    #[inline]
    #[must_use]
    pub fn diffuse_throughput(&self, throughput: Vec3) -> Vec3 {
        throughput * self.albedo * std::f32::consts::FRAC_1_PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::media::MediumStack;

    /// Paths that go on stand for all, however few they are; the darkest end, whatever the word.
    #[test]
    fn roulette_keeps_the_mean() {
        for throughput in [2e-6, 1e-6, 9e-7, 3e-9, 1e-12, 1e-15] {
            let of =
                |word: u64| u32::try_from(word).ok().and_then(|word| russian_roulette(Vec3::splat(throughput), word));
            // The first word with which the path ends.
            let (mut low, mut high) = (0_u64, 1_u64 << 32);
            while low < high {
                let middle = u64::midpoint(low, high);
                if of(middle).is_some() { low = middle + 1 } else { high = middle }
            }
            let factor = f64::from(of(0).unwrap());
            assert!(
                (factor * low as f64 * 0.5_f64.powi(32) - 1.0).abs() < 1e-7,
                "{throughput}: {factor} with {low} words"
            );
            assert!(throughput * factor as f32 >= 0.999 * NEGLIGIBLE_THROUGHPUT);
        }
        for throughput in [0.0, f32::from_bits(1), 1e-37] {
            assert_eq!(russian_roulette(Vec3::splat(throughput), 0), None, "{throughput}");
        }
    }

    /// White furnace: with an albedo of 1, the sum over the lobes of probability times weight is 1.
    #[test]
    fn lobes_keep_all_of_the_light() {
        let vacuum = MediumStack::VACUUM;
        for kind in MaterialKind::ALL {
            let material = Material { kind: kind as u32, albedo: [1.0; 3], ior: 1.5, ..Material::default() };
            for cosine in [0.0, 1e-3, 0.3, 1.0] {
                let interface =
                    Interface { eta: 1.5, before: vacuum, transmitted: vacuum, is_active: true, is_too_deep: false };
                let bsdf = Bsdf::new(Features::ALL, &material, cosine, &interface);
                let total = match bsdf.split() {
                    None => bsdf.weight(bsdf.choose(0.5)),
                    Some(share) => {
                        bsdf.weight(Lobe::SpecularReflection) * share
                            + bsdf.weight(Lobe::SpecularTransmission) * (1.0 - share)
                    }
                };
                assert!((total - Vec3::ONE).abs().max_element() < 1e-6, "{kind:?} {cosine}");
            }
        }
    }

    /// Schlick 1994, equation 15: at the cosine 0.2, (1 − 0.2)⁵ = 0.32768.
    #[test]
    fn mirrors_of_metal_brighten_towards_grazing() {
        let vacuum = MediumStack::VACUUM;
        let interface =
            Interface { eta: 1.0, before: vacuum, transmitted: vacuum, is_active: true, is_too_deep: false };
        for (metallic, cosine, expected) in
            [(0.0, 0.2, 0.5), (1.0, 0.2, 0.663_84), (1.0, 1.0, 0.5), (1.0, 0.0, 1.0), (0.5, 0.2, 0.581_92)]
        {
            let kind = MaterialKind::Mirror as u32;
            let material = Material { kind, albedo: [0.5; 3], metallic, ..Material::default() };
            let bsdf = Bsdf::new(Features::ALL, &material, cosine, &interface);
            let found = bsdf.weight(bsdf.choose(0.5));
            assert!((found - Vec3::splat(expected)).abs().max_element() < 1e-6, "{metallic} {cosine}: {found}");
        }
    }

    #[test]
    fn an_inactive_boundary_neither_bends_nor_tints() {
        let vacuum = MediumStack::VACUUM;
        let material =
            Material { kind: MaterialKind::Dielectric as u32, albedo: [0.5; 3], ior: 1.5, ..Material::default() };
        let interface =
            Interface { eta: 1.0, before: vacuum, transmitted: vacuum, is_active: false, is_too_deep: false };
        let bsdf = Bsdf::new(Features::ALL, &material, 0.4, &interface);
        let along = Vec3::new(0.6, 0.0, -0.8);
        assert_eq!(bsdf.choose(0.0), Lobe::SpecularTransmission);
        assert_eq!(bsdf.weight(Lobe::SpecularTransmission), Vec3::ONE);
        assert_eq!(bsdf.direction(Lobe::SpecularTransmission, along, Vec3::Z, 0.0, 0.0), along);
        let there = Bsdf::new(Features::ALL, &material, 0.4, &Interface { is_active: true, ..interface });
        assert_eq!(there.weight(Lobe::SpecularTransmission), Vec3::splat(0.5));
    }
}
