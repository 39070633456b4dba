//! Glossy surfaces: GGX reflection over a diffuse base; `glossy.glsl` is the twin.
//!
//! The metallic-roughness model of glTF 2.0 (appendix B) with the share of metal m, base colour c and, with the index n and
//! weight w of the coat, `F0 = m c + (1 − m) w min(s ((n−1)/(n+1))², 1)` and `F90 = m + (1 − m) w` in Schlick's factor, where s
//! is the specular colour, usually white. Three parts add up:
//! - single scattering, `F D G2 / (4 cos_o cos_i)` ([`crate::ggx`]);
//! - multiple scattering of the metal, `m F_ms (1 − E_o)(1 − E_i) / (π (1 − Ē))` (Kulla and Conty 2017) with
//!   `F_ms = F̄² Ē / (1 − F̄ (1 − Ē))`: a white metal loses nothing;
//! - the base, `(1 − m) c/π (1 − S_o)(1 − S_i) / (1 − S̄)` with the directional albedo S of the coat (Kelemen and
//!   Szirmay-Kalos 2001): a white base under any colourless coat loses nothing. S is that of the largest channel of F0.
//!
//! All are reciprocal. The base is Lambertian for photons that are stored with the factor `(1 − S_i)/(1 − S̄)`, that of
//! [`Coat::entering`], so that density estimation needs no BSDF.
//!
//! A sheet may transmit light diffusely: a share of its base has the BTDF `(1 − m) f τ/π (1 − S_o)(1 − S_i) / (1 − S̄)`
//! towards the other side, with the same coat there, and `(1 − f) c` in place of c: `KHR_materials_diffuse_transmission`.
//!
//! Over all of these may be a sheen ([`crate::sheen`]), and over that a clearcoat ([`crate::clearcoat`]).
//!
//! Single scattering may be anisotropic ([`crate::anisotropy`]); albedos are then those of its equivalent roughness.

use glam::{Vec2, Vec3};

use crate::scene::material::Material;
use crate::shading::albedo_table::AlbedoTable;
use crate::shading::anisotropy::{self, Anisotropic};
use crate::shading::clearcoat::Clearcoat;
use crate::shading::layers::Layers;
use crate::shading::shading_normal;
use crate::shading::sheen::{self, Sheen};
use crate::shading::{clearcoat, ggx, sampling};

#[cfg(test)]
pub(super) mod tests;

/// The coat over the base of a glossy surface, packed into 32 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coat(u32);

impl Coat {
    /// Steps between 0 and 1 of roughness, of F0 and of F90.
    pub const STEPS: [f32; 3] = [1023.0, 4095.0, 1023.0];

    /// A coat of roughness, F0 and F90 in `[0, 1]`.
    #[inline]
    #[must_use]
    pub fn new(roughness: f32, f0: f32, f90: f32) -> Self {
        let bits = |value: f32, most: f32| (value * most + 0.5) as u32;
        let [roughness_steps, f0_steps, f90_steps] = Self::STEPS;
        Self(bits(roughness, roughness_steps) | bits(f0, f0_steps) << 10 | bits(f90, f90_steps) << 22)
    }

    /// The coat with these bits: [`crate::Query::coat`].
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// The bits, for a record.
    #[inline]
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Roughness, F0 and F90.
    #[inline]
    fn unpack(self) -> (f32, f32, f32) {
        let part = |bits: u32, most: f32| bits as f32 / most;
        let [roughness_steps, f0_steps, f90_steps] = Self::STEPS;
        (part(self.0 & 1023, roughness_steps), part(self.0 >> 10 & 4095, f0_steps), part(self.0 >> 22, f90_steps))
    }

    /// The factor on light that arrives at the base with `cosine` to the normal, compared with a base without a coat:
    /// `(1 − S)/(1 − S̄)`, whose mean over the hemisphere is 1; 1 without a coat.
    #[inline]
    #[must_use]
    pub fn entering(self, cosine: f32) -> f32 {
        if self.0 == 0 {
            return 1.0;
        }
        if sheen::is_packed(self.0) {
            return sheen::entering(self.0, cosine);
        }
        if clearcoat::is_packed(self.0) {
            return clearcoat::entering(self.0, cosine);
        }
        let (roughness, f0, f90) = self.unpack();
        let table = AlbedoTable::get();
        let mean = 1.0 - reflected(table.mean(roughness), f0, f90);
        let through = 1.0 - reflected(table.directional(cosine.clamp(0.0, 1.0), roughness), f0, f90);
        if mean > MIN_SHARE { through / mean } else { 0.0 }
    }
}

/// Below this share of light, a division by it is left out, and nothing passes.
pub const MIN_SHARE: f32 = 1e-6;

/// `F0 A + F90 B`.
#[inline]
fn reflected(albedo: Vec2, f0: f32, f90: f32) -> f32 {
    f0 * albedo.x + f90 * albedo.y
}

/// A glossy surface as a path meets it.
#[derive(Clone, Copy, Debug)]
pub struct Glossy {
    alpha: f32,
    /// Of the albedos.
    roughness: f32,
    anisotropic: Option<Anisotropic>,
    f0: Vec3,
    f90: f32,
    /// Multiple scattering: `m F_ms (1 − E_o) / (1 − Ē)`.
    multiple: Vec3,
    /// Probability that multiple scattering is sampled rather than single scattering.
    multiple_probability: f32,
    diffuse: Vec3,
    /// As `diffuse`, for light from the other side.
    transmitted: Vec3,
    /// Probability of transmission among both.
    transmission_probability: f32,
    specular_probability: f32,
    coat: Coat,
    sheen: Option<Sheen>,
    /// Probability that the sheen is sampled rather than the reflection below it.
    sheen_probability: f32,
    clearcoat: Clearcoat,
    /// Its shading normal; 0 for that of the surface below.
    coat_normal: Vec3,
    /// Whether the path carries light rather than importance.
    carries_light: bool,
    /// What the clearcoat lets through from the direction of the path.
    through: f32,
    /// Probability that the clearcoat's reflection is sampled rather than the one below it.
    clearcoat_probability: f32,
}

/// The reflection in one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Reflected {
    /// BSDF times the cosine to the shading normal, linear RGB; without the base.
    pub value: Vec3,
    /// Density per solid angle with which [`Glossy::sample`] chooses the direction.
    pub pdf: f32,
}

/// Multiple scattering of the metal, `m F_ms (1 − E_o) / (1 − Ē)`, for its color, its share m, and the albedos for the
/// direction o and on average; and `1 − Ē`.
#[inline]
pub(crate) fn multiple_scattering(color: Vec3, metallic: f32, directional: Vec2, mean: Vec2) -> (Vec3, f32) {
    let lost = 1.0 - (directional.x + directional.y);
    let mean_total = mean.x + mean.y;
    let mean_lost = 1.0 - mean_total;
    let average = color + (Vec3::ONE - color) * (1.0 / 21.0);
    let repeated = average * average * mean_total / (Vec3::ONE - average * mean_lost);
    let multiple = if mean_lost > MIN_SHARE { repeated * (metallic * lost.max(0.0) / mean_lost) } else { Vec3::ZERO };
    (multiple, mean_lost)
}

impl Glossy {
    /// The surface of `material` with `layers`, both evaluated at the point, for a path that arrives with `cosine` > 0 to the
    /// shading normal.
    #[inline]
    #[must_use]
    pub fn new(material: &Material, layers: &Layers, cosine: f32) -> Self {
        Self::with_coat_normal(material, layers, cosine, (Vec3::ZERO, cosine))
    }

    /// The same for a path that arrives from the direction `wo`, with a clearcoat that may have a normal of its own; with
    /// `carries_light` it is that of a photon.
    #[inline]
    #[must_use]
    pub fn at(material: &Material, layers: &Layers, cosine: f32, wo: Vec3, carries_light: bool) -> Self {
        if layers.coat_normal == Vec3::ZERO || layers.clearcoat == 0.0 {
            return Self::new(material, layers, cosine);
        }
        let normal = shading_normal::bend(layers.coat_normal, wo);
        Self { carries_light, ..Self::with_coat_normal(material, layers, cosine, (normal, wo.dot(normal))) }
    }

    #[inline]
    fn with_coat_normal(
        material: &Material,
        layers: &Layers,
        cosine: f32,
        (coat_normal, coat_cosine): (Vec3, f32),
    ) -> Self {
        let table = AlbedoTable::get();
        let (metallic, weight) = (material.metallic, material.specular);
        let anisotropic = Anisotropic::of(layers, material.roughness);
        let roughness = anisotropic.map_or(material.roughness, |found| anisotropy::equivalent_roughness(found.widths));
        let color = Vec3::from(material.albedo);
        let directional = table.directional(cosine.min(1.0), roughness);
        let mean = table.mean(roughness);
        let colored_f0 = layers.coat_f0(material);
        let coat_f0 = colored_f0.max_element();
        let dielectric = 1.0 - metallic;
        let f0 = color * metallic + colored_f0 * dielectric;
        let f90 = metallic + weight * dielectric;
        let (multiple, mean_lost) = multiple_scattering(color, metallic, directional, mean);
        let multiple_albedo = multiple * mean_lost;
        let specular = f0 * directional.x + Vec3::splat(f90 * directional.y) + multiple_albedo;
        let through = 1.0 - reflected(directional, coat_f0, weight);
        let mut diffuse = color * (dielectric * through.max(0.0));
        let (mut transmitted, mut transmission_probability) = (Vec3::ZERO, 0.0);
        let mut coat = Coat::new(roughness, coat_f0, weight);
        let (mut most_specular, mut most_diffuse) = (specular.max_element(), diffuse.max_element());
        if layers.diffuse_transmission > 0.0 {
            let share = layers.diffuse_transmission;
            transmitted = layers.transmission_color * (share * (dielectric * through.max(0.0)));
            diffuse *= 1.0 - share;
            let most_transmitted = transmitted.max_element();
            most_diffuse = diffuse.max_element() + most_transmitted;
            // As with a metal below: a sheet that only transmits must not count as a mixture.
            transmission_probability =
                if diffuse == Vec3::ZERO { f32::from(most_transmitted > 0.0) } else { most_transmitted / most_diffuse };
        }
        let multiple_probability =
            if most_specular > 0.0 { multiple_albedo.max_element() / most_specular } else { 0.0 };
        let clearcoat = Clearcoat::of(layers);
        let sheen = Sheen::of(layers, cosine.min(1.0));
        let mut sheen_probability = 0.0;
        if let Some(sheen) = &sheen {
            coat = Coat(sheen::pack(roughness, coat_f0, weight, sheen, clearcoat));
            let through = sheen.through();
            diffuse *= through;
            transmitted *= through;
            most_diffuse *= through;
            let reflected = 1.0 - through;
            most_specular = reflected + through * most_specular;
            sheen_probability = if most_specular > 0.0 { reflected / most_specular } else { 0.0 };
        }
        let (mut under, mut clearcoat_probability) = (1.0, 0.0);
        if clearcoat.weight > 0.0 {
            if sheen.is_none() {
                coat = Coat(clearcoat::pack(roughness, coat_f0, weight, clearcoat));
            }
            let above = clearcoat.through(cosine.min(1.0));
            diffuse *= above;
            transmitted *= above;
            most_diffuse *= above;
            under = if coat_normal == Vec3::ZERO { above } else { clearcoat.through(coat_cosine.min(1.0)) };
            let reflected = 1.0 - under;
            most_specular = reflected + under * most_specular;
            clearcoat_probability = if most_specular > 0.0 { reflected / most_specular } else { 0.0 };
        }
        // Devices may round x/x below 1, and a metal must not count as a mixture.
        let specular_probability = if most_diffuse > 0.0 {
            most_specular / (most_specular + most_diffuse)
        } else if most_specular > 0.0 {
            1.0
        } else {
            0.0
        };
        Self {
            alpha: (roughness * roughness).max(ggx::MIN_ALPHA),
            roughness,
            anisotropic,
            f0,
            f90,
            multiple,
            multiple_probability,
            diffuse,
            transmitted,
            transmission_probability,
            specular_probability,
            coat,
            sheen,
            sheen_probability,
            clearcoat,
            coat_normal,
            carries_light: false,
            through: under,
            clearcoat_probability,
        }
    }

    /// Albedo of the base under its coat, for the direction that the path came from: what irradiance with the factor
    /// [`Coat::entering`] is multiplied by, times π, for the radiance that leaves.
    #[inline]
    #[must_use]
    pub fn diffuse(&self) -> Vec3 {
        self.diffuse
    }

    /// As [`Self::diffuse`], for irradiance on the other side; 0 without diffuse transmission.
    #[inline]
    #[must_use]
    pub fn transmitted(&self) -> Vec3 {
        self.transmitted
    }

    /// Probability of choosing transmission rather than reflection by the base, where one of them is chosen.
    #[inline]
    #[must_use]
    pub fn transmission_probability(&self) -> f32 {
        self.transmission_probability
    }

    /// Probability of following the reflection rather than the base, where one of them is chosen.
    #[inline]
    #[must_use]
    pub fn specular_probability(&self) -> f32 {
        self.specular_probability
    }

    /// Probability that [`Self::sample`] samples multiple scattering.
    #[inline]
    #[must_use]
    pub fn multiple_probability(&self) -> f32 {
        self.multiple_probability
    }

    /// Probability that [`Self::sample`] samples the reflection of the clearcoat.
    #[inline]
    #[must_use]
    pub fn clearcoat_probability(&self) -> f32 {
        self.clearcoat_probability
    }

    /// What the clearcoat lets through from the direction of the path; 1 without one.
    #[inline]
    #[must_use]
    pub fn clearcoat_through(&self) -> f32 {
        self.through
    }

    /// Probability that [`Self::sample`] samples the sheen, if not the clearcoat.
    #[inline]
    #[must_use]
    pub fn sheen_probability(&self) -> f32 {
        self.sheen_probability
    }

    /// What the sheen lets through from the direction of the path; 1 without one.
    #[inline]
    #[must_use]
    pub fn sheen_through(&self) -> f32 {
        self.sheen.as_ref().map_or(1.0, Sheen::through)
    }

    /// The coats over the base.
    #[inline]
    #[must_use]
    pub fn coat(&self) -> Coat {
        self.coat
    }

    /// The reflection of light from `wi` towards `wo`; both point away from the surface, and `normal` is the shading
    /// normal on the side of `wo`. 0 below it.
    #[inline]
    #[must_use]
    pub fn evaluate(&self, wo: Vec3, wi: Vec3, normal: Vec3) -> Reflected {
        let (tangent, bitangent) = self.frame(normal);
        let local = |w: Vec3| Vec3::new(w.dot(tangent), w.dot(bitangent), w.dot(normal));
        let (o, i) = (local(wo), local(wi));
        let half = o + i;
        let length = half.length();
        if !(o.z > 0.0 && i.z > 0.0 && length > 0.0) {
            return Reflected::default();
        }
        let h = half / length;
        let across = (1.0 - o.dot(h)).clamp(0.0, 1.0);
        let grazing = across * across;
        let grazing = grazing * grazing * across;
        let fresnel = self.f0 * (1.0 - grazing) + Vec3::splat(self.f90 * grazing);
        let (single, mut pdf) = match &self.anisotropic {
            None => {
                (ggx::distribution(self.alpha, h) * ggx::visibility(self.alpha, o.z, i.z), ggx::pdf(self.alpha, o, h))
            }
            Some(anisotropic) => anisotropic.single(o, i, h),
        };
        let mut value = fresnel * (single * i.z);
        if self.multiple_probability > 0.0 {
            let albedo = AlbedoTable::get().directional(i.z.min(1.0), self.roughness);
            let cosine = i.z * std::f32::consts::FRAC_1_PI;
            value += self.multiple * ((1.0 - (albedo.x + albedo.y)).max(0.0) * cosine);
            pdf = pdf * (1.0 - self.multiple_probability) + cosine * self.multiple_probability;
        }
        if let Some(sheen) = &self.sheen {
            let all = sheen.over(Reflected { value, pdf }, self.sheen_probability, o, i, h);
            (value, pdf) = (all.value, all.pdf);
        }
        if self.clearcoat.weight > 0.0 {
            let p = self.clearcoat_probability;
            let (above, leaving) = match self.coat_normal == Vec3::ZERO {
                true => (self.clearcoat.evaluate(o, i, h), i.z),
                false => self.above(wo, wi, [o.z, i.z]),
            };
            value = value * self.through.min(self.clearcoat.through(leaving)) + above.value;
            pdf = pdf * (1.0 - p) + above.pdf * p;
        }
        Reflected { value, pdf }
    }

    /// The reflection of a clearcoat with a normal of its own, and the cosine of `wi` to it. `cosines` are those to the
    /// shading normal, by which the value is multiplied later on.
    #[inline]
    fn above(&self, wo: Vec3, wi: Vec3, cosines: [f32; 2]) -> (Reflected, f32) {
        let (tangent, bitangent) = sampling::basis(self.coat_normal);
        let local = |w: Vec3| Vec3::new(w.dot(tangent), w.dot(bitangent), w.dot(self.coat_normal));
        let (o, i) = (local(wo), local(wi));
        if !(o.z > 0.0 && i.z > 0.0) {
            return (Reflected::default(), i.z);
        }
        let mut above = self.clearcoat.evaluate(o, i, (o + i).normalize_or(Vec3::Z));
        // The cosine is that of the light, and factors for photons are relative to the shading normal.
        let limit = |own: f32, other: f32| own.min(shading_normal::MAX_RATIO * other);
        let counted = match self.carries_light {
            false => limit(i.z, cosines[1]),
            true => limit(o.z, cosines[0]) * cosines[1] / cosines[0],
        };
        above.value *= counted / i.z;
        (above, i.z)
    }

    /// The normal of the clearcoat, or `normal`, that of the surface below.
    #[inline]
    #[must_use]
    pub fn coat_normal(&self, normal: Vec3) -> Vec3 {
        if self.coat_normal == Vec3::ZERO { normal } else { self.coat_normal }
    }

    /// Two vectors perpendicular to the shading normal, along and across the anisotropy.
    #[inline]
    fn frame(&self, normal: Vec3) -> (Vec3, Vec3) {
        self.anisotropic.as_ref().map_or_else(|| sampling::basis(normal), |anisotropic| anisotropic.frame(normal))
    }

    /// Samples a direction of the reflection, and its value and density: the weight of the path is their ratio. `u` and
    /// `v` are uniform in `[0, 1)`.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: Vec3, normal: Vec3, u: f32, v: f32) -> (Vec3, Reflected) {
        let (p, top) = (self.multiple_probability, self.clearcoat_probability);
        let is_below = u >= top;
        let mut u = if top > 0.0 { rest_of(u, top) } else { u };
        let is_sheen = is_below && u < self.sheen_probability;
        if is_below && self.sheen_probability > 0.0 {
            u = rest_of(u, self.sheen_probability);
        }
        let wi = if is_sheen {
            sheen::sample(normal, u, v)
        } else if is_below && u < p {
            sampling::cosine_hemisphere(normal, u / p, v)
        } else {
            let has_own = !is_below && self.coat_normal != Vec3::ZERO;
            let axis = if has_own { self.coat_normal } else { normal };
            let (tangent, bitangent) = if has_own { sampling::basis(axis) } else { self.frame(normal) };
            let o = Vec3::new(wo.dot(tangent), wo.dot(bitangent), wo.dot(axis));
            let rest = if is_below { ((u - p) / (1.0 - p)).min(1.0 - f32::EPSILON) } else { u };
            let i = match &self.anisotropic {
                Some(anisotropic) if is_below => anisotropy::sample(anisotropic.widths, o, rest, v),
                _ => ggx::sample(if is_below { self.alpha } else { self.clearcoat.alpha() }, o, rest, v),
            };
            tangent * i.x + bitangent * i.y + axis * i.z
        };
        (wi, self.evaluate(wo, wi, normal))
    }
}

impl Reflected {
    /// The weight of a path that was sampled: value over density, times `factor`, for [`limited`] on camera paths or
    /// [`shading_normal::photon_factor`]. 0 if the factor is 0, or the direction is below the surface.
    #[inline]
    #[must_use]
    pub fn weight(&self, factor: f32) -> Vec3 {
        if self.pdf > 0.0 && factor > 0.0 { self.value * (factor / self.pdf) } else { Vec3::ZERO }
    }
}

/// [`shading_normal::cosine`] over the cosine to the shading normal, in `[0, 1]`: the factor on [`Reflected::value`] by
/// which all techniques count light from `direction` alike; 0 below the triangle's plane.
#[inline]
#[must_use]
pub fn limited(direction: Vec3, geometric: Vec3, shading: Vec3) -> f32 {
    let (below, above) = (direction.dot(geometric), direction.dot(shading));
    if below > 0.0 && above > 0.0 { (shading_normal::MAX_RATIO * below / above).min(1.0) } else { 0.0 }
}

/// The uniform number that is left of `choice` after it has decided between two lobes, the first with probability `first`.
#[inline]
#[must_use]
pub fn rest_of(choice: f32, first: f32) -> f32 {
    let rest = if choice < first { choice / first } else { (choice - first) / (1.0 - first) };
    rest.min(1.0 - f32::EPSILON)
}
