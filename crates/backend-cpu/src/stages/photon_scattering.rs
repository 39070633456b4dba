//! How photons leave a surface: directions and weights, and Russian roulette.

use photon_core::glam::Vec3;
use photon_core::{Bsdf, Glossy, Lobe, RoughSample, glossy, sampling, shading_normal};

/// The direction in which a photon leaves a surface with a shading normal, and the factor on its power.
#[inline]
pub(crate) fn scattered(
    bsdf: &Bsdf,
    lobe: Lobe,
    incoming: Vec3,
    geometric: Vec3,
    shading: Vec3,
    (u, v): (f32, f32),
) -> (Vec3, f32) {
    let outgoing = match lobe {
        Lobe::Diffuse => bsdf.direction(lobe, incoming, geometric, u, v),
        Lobe::SpecularReflection | Lobe::SpecularTransmission => {
            shading_normal::on_side_of(lobe, bsdf.direction(lobe, incoming, shading, u, v), geometric)
        }
    };
    (outgoing, shading_normal::photon_factor(lobe, incoming, outgoing, geometric, shading))
}

/// How a photon leaves a glossy surface.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum GlossyLobe {
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
    pub(crate) fn choose(glossy: &Glossy, choice: f32) -> (Self, f32) {
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
    pub(crate) fn side(self) -> Lobe {
        if self == Self::Transmission { Lobe::SpecularTransmission } else { Lobe::SpecularReflection }
    }
}

/// The direction in which a photon leaves a glossy surface by `lobe`, and the weight, over the probability of that lobe.
#[inline]
pub(crate) fn glossy_scattered(
    glossy: &Glossy,
    lobe: GlossyLobe,
    incoming: Vec3,
    geometric: Vec3,
    shading: Vec3,
    (u, v): (f32, f32),
) -> (Vec3, Vec3) {
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

/// The weight of a photon that rough glass scatters; 0 where shading normals send it to the wrong side.
#[inline]
pub(crate) fn rough_weight(sampled: &RoughSample, incoming: Vec3, geometric: Vec3, shading: Vec3) -> Vec3 {
    let stays = sampled.lobe == Lobe::SpecularReflection;
    let lands = (sampled.direction.dot(geometric) > 0.0) == stays && incoming.dot(geometric) < 0.0;
    let factor = shading_normal::photon_factor(sampled.lobe, incoming, sampled.direction, geometric, shading);
    sampled.found.weight(if lands { factor } else { 0.0 })
}

/// Russian roulette (Arvo and Kirk 1990). A surviving photon keeps the power of its brightest channel, or, with
/// `grows`, a larger one if a weight is above 1; `None` if the photon is absorbed.
#[inline]
pub(crate) fn russian_roulette(power: Vec3, weight: Vec3, choice: f32, grows: bool) -> Option<Vec3> {
    let next = power * weight;
    let mut chance = next.max_element() / power.max_element();
    // Not `min`, which would turn 0/0 into 1.
    if grows && chance > 1.0 {
        chance = 1.0;
    }
    // Also false for 0/0.
    if choice < chance { Some(next / chance) } else { None }
}
