//! How photons leave a surface: direction, weight, and Russian roulette.

use glam::Vec3;

use crate::shading::bsdf::{Bsdf, Lobe};
use crate::shading::glossy::{self, Glossy};
use crate::shading::rough_glass::RoughSample;
use crate::shading::{sampling, shading_normal};

/// A photon that leaves a surface.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct PhotonSample {
    /// Unit vector away from the surface.
    pub direction: Vec3,
    /// Its power, after Russian roulette.
    pub power: Vec3,
    /// [`Lobe::SpecularTransmission`] if it goes on beyond the surface.
    pub lobe: Lobe,
}

/// A photon that arrives at a surface.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::exhaustive_structs, reason = "callers make it")]
pub struct Arriving {
    /// Unit vector in which it moves.
    pub incoming: Vec3,
    /// Its power.
    pub power: Vec3,
    /// Geometric normal, on its side.
    pub geometric: Vec3,
    /// Shading normal, on its side.
    pub shading: Vec3,
    /// Uniform numbers in `[0, 1)` for the direction in which it leaves.
    pub uv: [f32; 2],
}

/// `None`: the photon is absorbed.
impl PhotonSample {
    /// From a surface without shading normals that scatters by `lobe`, which `choice` selected.
    #[inline(always)]
    #[must_use]
    pub fn flat(bsdf: &Bsdf, lobe: Lobe, choice: f32, at: &Arriving) -> Option<Self> {
        // A photon that is absorbed needs no direction.
        let power = survive(bsdf, choice, at.power, bsdf.weight(lobe), false)?;
        Some(Self { direction: bsdf.direction(lobe, at.incoming, at.geometric, at.uv[0], at.uv[1]), power, lobe })
    }

    /// The same from a surface with a shading normal, whose weights may be above 1 (Veach 1997, section 5.3).
    #[inline]
    #[must_use]
    pub fn shaded(bsdf: &Bsdf, lobe: Lobe, choice: f32, at: &Arriving) -> Option<Self> {
        let Arriving { incoming, power, geometric, shading, uv: [u, v] } = *at;
        let direction = match lobe {
            Lobe::Diffuse => bsdf.direction(lobe, incoming, geometric, u, v),
            Lobe::SpecularReflection | Lobe::SpecularTransmission => {
                shading_normal::on_side_of(lobe, bsdf.direction(lobe, incoming, shading, u, v), geometric)
            }
        };
        let weight = bsdf.weight(lobe) * shading_normal::photon_factor(lobe, incoming, direction, geometric, shading);
        let power = survive(bsdf, choice, power, weight, true)?;
        Some(Self { direction, power, lobe })
    }

    /// From a glossy surface; `chosen` is from [`GlossyLobe::choose`], and the lobe's probability is divided out.
    #[inline]
    #[must_use]
    pub fn glossy(glossy: &Glossy, chosen: (GlossyLobe, f32), at: &Arriving) -> Option<Self> {
        let (lobe, rest) = chosen;
        let (direction, weight) = glossy_scattered(glossy, lobe, at);
        let power = russian_roulette(at.power, weight, rest, true)?;
        Some(Self { direction, power, lobe: lobe.side() })
    }

    /// From rough glass. The weight is 0 where the shading normal sends the photon to the wrong side.
    #[inline]
    #[must_use]
    pub fn rough_glass(sampled: &RoughSample, at: &Arriving) -> Option<Self> {
        let Arriving { incoming, power, geometric, shading, .. } = *at;
        let RoughSample { direction, lobe, .. } = *sampled;
        let stays = lobe == Lobe::SpecularReflection;
        let lands = (direction.dot(geometric) > 0.0) == stays && incoming.dot(geometric) < 0.0;
        let factor = shading_normal::photon_factor(lobe, incoming, direction, geometric, shading);
        let weight = sampled.found.weight(if lands { factor } else { 0.0 });
        let power = russian_roulette(power, weight, sampled.rest, true)?;
        Some(Self { direction, power, lobe })
    }
}

/// Roulette by `choice`, unless that has chosen the lobe already: at smooth glass nothing is absorbed.
#[inline(always)]
fn survive(bsdf: &Bsdf, choice: f32, power: Vec3, weight: Vec3, grows: bool) -> Option<Vec3> {
    if bsdf.split().is_some() { Some(power * weight) } else { russian_roulette(power, weight, choice, grows) }
}

/// How a photon leaves a glossy surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// Exhaustive: backends must follow each.
pub enum GlossyLobe {
    /// By its reflection.
    Reflection,
    /// By reflection at its base.
    Base,
    /// By diffuse transmission.
    Transmission,
}

impl GlossyLobe {
    /// The lobe that `choice`, uniform in `[0, 1)`, selects, and the uniform number that is left of it.
    #[inline]
    #[must_use]
    pub fn choose(glossy: &Glossy, choice: f32) -> (Self, f32) {
        let (first, second) = (glossy.specular_probability(), glossy.transmission_probability());
        let rest = glossy::rest_of(choice, first);
        if choice < first {
            (Self::Reflection, rest)
        } else if second > 0.0 {
            let lobe = if rest < second { Self::Transmission } else { Self::Base };
            (lobe, glossy::rest_of(rest, second))
        } else {
            (Self::Base, rest)
        }
    }

    /// Whether the photon stays on the side from which it came.
    #[must_use]
    pub fn side(self) -> Lobe {
        if self == Self::Transmission { Lobe::SpecularTransmission } else { Lobe::SpecularReflection }
    }
}

/// The direction in which a photon leaves a glossy surface by `lobe`, and the weight, over the probability of that lobe.
#[inline]
fn glossy_scattered(glossy: &Glossy, lobe: GlossyLobe, at: &Arriving) -> (Vec3, Vec3) {
    let Arriving { incoming, geometric, shading, uv: [u, v], .. } = *at;
    let first = glossy.specular_probability();
    if lobe == GlossyLobe::Reflection {
        let (onward, found) = glossy.sample(-incoming, shading, u, v);
        let above = onward.dot(geometric) > 0.0 && incoming.dot(geometric) < 0.0;
        let factor =
            shading_normal::photon_factor(Lobe::SpecularReflection, incoming, onward, geometric, shading) / first;
        return (onward, found.weight(if above { factor } else { 0.0 }));
    }
    let second = glossy.transmission_probability();
    if lobe == GlossyLobe::Transmission {
        let onward = sampling::cosine_hemisphere(-geometric, u, v);
        let factor = shading_normal::photon_factor(Lobe::Diffuse, incoming, onward, geometric, shading);
        let entering = glossy.coat().entering(-onward.dot(shading));
        return (onward, glossy.transmitted() * (entering * factor / ((1.0 - first) * second)));
    }
    let onward = sampling::cosine_hemisphere(geometric, u, v);
    let factor = shading_normal::photon_factor(Lobe::Diffuse, incoming, onward, geometric, shading);
    let weight = glossy.diffuse() * (glossy.coat().entering(onward.dot(shading)) * factor / (1.0 - first));
    (onward, if second > 0.0 { weight / (1.0 - second) } else { weight })
}

/// Russian roulette (Arvo and Kirk 1990). A surviving photon keeps the power of its brightest channel, or, with
/// `grows`, a larger one if a weight is above 1; `None` if the photon is absorbed.
#[inline]
fn russian_roulette(power: Vec3, weight: Vec3, choice: f32, grows: bool) -> Option<Vec3> {
    let next = power * weight;
    let mut chance = next.max_element() / power.max_element();
    // Not `min`, which would turn 0/0 into 1.
    if grows && chance > 1.0 {
        chance = 1.0;
    }
    // Also false for 0/0.
    if choice < chance { Some(next / chance) } else { None }
}
