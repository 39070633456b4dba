//! A clearcoat over a glossy or diffuse surface; `clearcoat.glsl` is the twin.
//!
//! `KHR_materials_clearcoat` of glTF 2.0: a colourless dielectric of index 1.5 (F0 = .04, F90 = 1) with GGX reflection of its
//! own width, there for a share c. With its directional albedo E, let `T = 1 − c E` be what it lets through. The
//! clearcoat reflects `c F D G2 / (4 cos_o cos_i)`; what is below it changes as follows:
//! - a diffuse base has the factor `T_o T_i / T̄`, as under the coat of [`crate::Glossy`]. With both,
//!   `(1 − S_o) T_o (1 − S_i) T_i` is divided by the mean of the product over the hemisphere;
//! - a reflection has the factor `min(T_o, T_i)`, which is reciprocal and never gains light.
//!
//! So a white diffuse surface with a clearcoat loses nothing, and a white metal at most 5.3 %. Emission from
//! below is dimmed: [`crate::Shading::emission_through`].

use glam::Vec3;

use crate::scene::material::{Material, MaterialKind};
use crate::shading::albedo_table::AlbedoTable;
use crate::shading::ggx;
use crate::shading::glossy::{MIN_SHARE, Reflected};
use crate::shading::layers::Layers;

#[cfg(test)]
mod tests;

/// Reflectance at normal incidence: a refractive index of 1.5.
pub const F0: f32 = 0.04;

/// Number of cosines at which the mean of a product is evaluated.
pub const NODES: u32 = 8;

/// Steps between 0 and 1 of the parts of a packed [`crate::Coat`] with a clearcoat: roughness of the lower coat, root of
/// its F0, its F90, weight and roughness of the clearcoat.
pub const STEPS: [f32; 5] = [63.0, 127.0, 15.0, 63.0, 63.0];

/// Mark of packed words: no [`crate::Coat`] without a clearcoat has an F0 of at least ½ and an F90 below ¼.
const MARK: u32 = 1 << 21;
const MARK_BITS: u32 = 1 << 21 | 3 << 30;

/// A clearcoat at one point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Clearcoat {
    pub(crate) weight: f32,
    pub(crate) roughness: f32,
}

impl Clearcoat {
    #[inline]
    pub(crate) fn of(layers: &Layers) -> Self {
        Self { weight: layers.clearcoat, roughness: layers.clearcoat_roughness }
    }

    /// `1 − c E` for a direction with this cosine.
    #[inline]
    pub(crate) fn through(self, cosine: f32) -> f32 {
        let albedo = AlbedoTable::get().directional(cosine.clamp(0.0, 1.0), self.roughness);
        1.0 - self.weight * (F0 * albedo.x + albedo.y)
    }

    /// Its mean over the hemisphere, weighted by the cosine.
    #[inline]
    fn mean_through(self) -> f32 {
        let albedo = AlbedoTable::get().mean(self.roughness);
        1.0 - self.weight * (F0 * albedo.x + albedo.y)
    }

    #[inline]
    pub(crate) fn alpha(self) -> f32 {
        (self.roughness * self.roughness).max(ggx::MIN_ALPHA)
    }

    /// Its reflection of light from `i` towards `o`, with the half vector `h`, all in the frame of the normal.
    #[inline]
    pub(crate) fn evaluate(self, o: Vec3, i: Vec3, h: Vec3) -> Reflected {
        let across = (1.0 - o.dot(h)).clamp(0.0, 1.0);
        let square = across * across;
        let grazing = square * square * across;
        let fresnel = F0 * (1.0 - grazing) + grazing;
        let alpha = self.alpha();
        let single = ggx::distribution(alpha, h) * ggx::visibility(alpha, o.z, i.z) * i.z;
        Reflected { value: Vec3::splat(self.weight * fresnel * single), pdf: ggx::pdf(alpha, o, h) }
    }
}

/// The bits of [`crate::Coat`] for a base under a coat of this roughness, F0 and F90, and a clearcoat over both.
#[inline]
pub(crate) fn pack(roughness: f32, f0: f32, f90: f32, clearcoat: Clearcoat) -> u32 {
    let bits = |value: f32, most: f32| (value.min(1.0) * most + 0.5) as u32;
    let weight = bits(clearcoat.weight, STEPS[3]);
    let below = bits(roughness, STEPS[0]) | bits(f90, STEPS[2]) << 6 | bits(f0.sqrt(), STEPS[1]) << 10;
    let above = (weight & 15) << 17 | bits(clearcoat.roughness, STEPS[4]) << 22 | weight >> 4 << 28;
    below | above | MARK
}

/// Whether these bits are from [`pack`].
#[inline]
pub(crate) const fn is_packed(bits: u32) -> bool {
    bits & MARK_BITS == MARK
}

/// The factor on light that arrives at the base with `cosine` to the normal, compared with a base without coats; its mean
/// over the hemisphere is 1.
#[inline]
pub(crate) fn entering(bits: u32, cosine: f32) -> f32 {
    let part = |shift: u32, most: f32| (bits >> shift & most as u32) as f32 / most;
    let (roughness, root, f90) = (part(0, STEPS[0]), part(10, STEPS[1]), part(6, STEPS[2]));
    let weight = (bits >> 17 & 15 | (bits >> 28 & 3) << 4) as f32 / STEPS[3];
    let clearcoat = Clearcoat { weight, roughness: part(22, STEPS[4]) };
    let table = AlbedoTable::get();
    let f0 = root * root;
    let has_coat = f90 > 0.0;
    let both = |cosine: f32| {
        let albedo = table.directional(cosine, roughness);
        let below = if has_coat { 1.0 - (f0 * albedo.x + f90 * albedo.y) } else { 1.0 };
        below * clearcoat.through(cosine)
    };
    let mean = if has_coat {
        let (mut sum, mut weights) = (0.0, 0.0);
        for k in 0..NODES {
            // Uniform in the root of the cosine, as the table is.
            let root = (k as f32 + 0.5) / NODES as f32;
            let weight = root * root * root;
            sum += weight * both(root * root);
            weights += weight;
        }
        sum / weights
    } else {
        clearcoat.mean_through()
    };
    let through = both(cosine.clamp(0.0, 1.0));
    if mean > MIN_SHARE { through / mean } else { 0.0 }
}

/// The glossy material that reflects like the clearcoat alone.
#[inline]
pub(crate) fn reflector(layers: &Layers) -> Material {
    Material {
        kind: MaterialKind::Glossy as u32,
        roughness: layers.clearcoat_roughness,
        specular: layers.clearcoat,
        ior: 1.5,
        ..Material::default()
    }
}
