//! Sheen: the retro-reflection of cloth at grazing angles; `sheen.glsl` is the twin.
//!
//! `KHR_materials_sheen` of glTF 2.0: with the colour C, the roughness r and `α = r²`, the layer reflects
//! `C D V` with the distribution `D = (2 + 1/α) sin^(1/α) θ_h / 2π` and the visibility
//! `V = 1 / ((1 + Λ_o + Λ_i) 4 cos_o cos_i)` of Estevez and Kulla 2017, equations 2 and 3 with the fit of table 1. Its
//! directional albedo E exceeds 1 at grazing angles for r < .25. There it is limited: C D V has the factor
//! `min(s_o, s_i)` with `s = 1 / max(E, 1)`, which is reciprocal, and the layer never reflects more than it receives.
//!
//! Of other light, it lets through `T = 1 − max(C) min(E, 1)`. A diffuse base has the factor `T_o T_i / T̄`, together with that of
//! the coats over it (`entering`), so that a white one loses nothing for r ≥ .25; a reflection below has `min(T_o, T_i)`.
//!
//! E is tabulated over the cube root of the cosine and the square root of the roughness; its error where it is below 1 is at
//! most 2.5e-3, for cosines from .001 on.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use crate::shading::albedo_table::AlbedoTable;
use crate::shading::clearcoat::Clearcoat;
use crate::shading::glossy::{MIN_SHARE, Reflected};
use crate::shading::layers::Layers;
use crate::shading::sampling;
use crate::shading::sheen_lobe::{Charlie, SheenTable};

pub use crate::shading::sheen_lobe::{MIN_COSINE, MIN_ROUGHNESS};

#[cfg(test)]
mod tests;

/// The sheen of a surface where a path meets it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheen {
    color: Vec3,
    lobe: Charlie,
}

impl Sheen {
    /// That of `layers`, if there is one, for a path that comes from a direction with this cosine.
    #[inline]
    pub(crate) fn of(layers: &Layers, cosine: f32) -> Option<Self> {
        let is_there = layers.sheen_color != Vec3::ZERO;
        is_there.then(|| Self { color: layers.sheen_color, lobe: Charlie::new(layers.sheen_roughness, cosine) })
    }

    /// The largest channel of its colour.
    #[inline]
    pub(crate) fn strength(&self) -> f32 {
        self.color.max_element()
    }

    /// What it lets through in the direction of the path.
    #[inline]
    pub(crate) fn through(&self) -> f32 {
        1.0 - self.strength() * self.lobe.albedo.min(1.0)
    }

    /// The reflection, and the reflection below it, `below`, with the factor of the layer; `probability` is that of sampling
    /// the layer's.
    #[inline]
    pub(crate) fn over(&self, below: Reflected, probability: f32, o: Vec3, i: Vec3, h: Vec3) -> Reflected {
        let factor = self.through().min(self.lobe.through_at(self.strength(), i.z));
        let value = below.value * factor + self.color * (self.lobe.evaluate(o, i, h) * i.z);
        Reflected { value, pdf: below.pdf * (1.0 - probability) + probability * PDF }
    }
}

/// A direction about `normal` with the density [`PDF`].
#[inline]
pub(crate) fn sample(normal: Vec3, u: f32, v: f32) -> Vec3 {
    sampling::about(normal, u, v)
}

/// Density per solid angle of the directions that [`sample`] returns: even over the hemisphere, since the lobe is strongest
/// at grazing angles.
pub(crate) const PDF: f32 = 0.5 * FRAC_1_PI;

/// Number of cosines at which the mean of a product is evaluated.
pub const NODES: u32 = 16;

/// Steps between 0 and 1 of the parts of a packed [`crate::Coat`] with a sheen: roughness of the coat, root of its F0, its F90,
/// strength and roughness of the sheen, weight and roughness of the clearcoat. First without a clearcoat, then with one.
pub const STEPS: [[u32; 7]; 2] = [[63, 63, 7, 63, 255, 0, 0], [31, 31, 7, 15, 15, 7, 15]];

/// The lowest bit of each part.
pub const SHIFTS: [[u32; 7]; 2] = [[0, 6, 12, 15, 22, 0, 0], [0, 5, 10, 13, 22, 17, 26]];

/// Masks and their marks: no [`crate::Coat`] without a sheen has these bits, since its F0 would be above its F90.
pub const MARKS: [[u32; 2]; 2] = [[1 << 21 | 3 << 30, 1 << 21 | 1 << 30], [3 << 20 | 3 << 30, 1 << 20]];

/// The bits of [`crate::Coat`] for a base under a coat of this roughness, F0 and F90, and `sheen` over both; over these, the
/// clearcoat, if its weight is above 0.
#[inline]
pub(crate) fn pack(roughness: f32, f0: f32, f90: f32, sheen: &Sheen, clearcoat: Clearcoat) -> u32 {
    let parts =
        [roughness, f0.sqrt(), f90, sheen.strength(), sheen.lobe.roughness, clearcoat.weight, clearcoat.roughness];
    let layout = usize::from(clearcoat.weight > 0.0);
    let mut bits = MARKS[layout][1];
    for (part, (steps, shift)) in parts.into_iter().zip(STEPS[layout].into_iter().zip(SHIFTS[layout])) {
        bits |= ((part.min(1.0) * steps as f32 + 0.5) as u32) << shift;
    }
    bits
}

/// Whether these bits are from [`pack`].
#[inline]
pub(crate) const fn is_packed(bits: u32) -> bool {
    bits & MARKS[0][0] == MARKS[0][1] || bits & MARKS[1][0] == MARKS[1][1]
}

/// The factor on light that arrives at the base with `cosine` to the normal, compared with a base without anything over it;
/// its mean over the hemisphere is 1.
#[inline]
pub(crate) fn entering(bits: u32, cosine: f32) -> f32 {
    let layout = usize::from(bits & MARKS[0][0] != MARKS[0][1]);
    let part = |index: usize| {
        let (steps, shift) = (STEPS[layout][index], SHIFTS[layout][index]);
        if steps == 0 { 0.0 } else { (bits >> shift & steps) as f32 / steps as f32 }
    };
    let [roughness, root, f90, strength, sheen_roughness] = [part(0), part(1), part(2), part(3), part(4)];
    let clearcoat = Clearcoat { weight: part(5), roughness: part(6) };
    let (f0, table, sheens) = (root * root, AlbedoTable::get(), SheenTable::get());
    let all = |cosine: f32| {
        let mut through = 1.0 - strength * sheens.directional(cosine, sheen_roughness).min(1.0);
        if f90 > 0.0 {
            let albedo = table.directional(cosine, roughness);
            through *= 1.0 - (f0 * albedo.x + f90 * albedo.y);
        }
        if clearcoat.weight > 0.0 { through * clearcoat.through(cosine) } else { through }
    };
    let (mut sum, mut weights) = (0.0, 0.0);
    for k in 0..NODES {
        // Uniform in the root of the cosine.
        let root = (k as f32 + 0.5) / NODES as f32;
        let weight = root * root * root;
        sum += weight * all(root * root);
        weights += weight;
    }
    let mean = sum / weights;
    if mean > MIN_SHARE { all(cosine.clamp(0.0, 1.0)) / mean } else { 0.0 }
}
