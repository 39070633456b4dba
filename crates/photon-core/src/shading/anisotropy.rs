//! Anisotropic GGX reflection, which is wider along a tangent than across it; `anisotropy.glsl` is the twin.
//!
//! `KHR_materials_anisotropy` of glTF 2.0: with roughness r and strength s, the widths are `α_b = r²` and
//! `α_t = α_b + (1 − α_b) s²`, the latter along the direction of anisotropy. `widths` below has α_t and α_b, and unit vectors
//! are in the frame of tangent, bitangent and normal. The functions are those of [`crate::ggx`] for two widths (Heitz 2014,
//! section 5.4).
//!
//! Albedos are tabulated for one width: those of anisotropic reflection are taken as those of [`equivalent_roughness`].

use glam::{Vec2, Vec3};

use crate::shading::layers::Layers;
use crate::shading::math::{sin_cos_turns, turns_of};
use crate::shading::{ggx, sampling};

#[cfg(test)]
mod tests;

/// The widths along and across the direction of anisotropy, of a roughness and a strength in `[0, 1]`.
#[inline]
#[must_use]
pub fn widths(roughness: f32, strength: f32) -> Vec2 {
    let across = roughness * roughness;
    let along = across + (1.0 - across) * (strength * strength);
    Vec2::new(along, across).max(Vec2::splat(ggx::MIN_ALPHA))
}

/// The roughness of the isotropic reflection whose albedos stand for those of these widths: the width is the root mean
/// square of both. Its mean albedo over the hemisphere is right within 0.025; docs/studies/surfaces.md has single directions.
#[inline]
#[must_use]
pub fn equivalent_roughness(widths: Vec2) -> f32 {
    (0.5 * (widths.x * widths.x + widths.y * widths.y)).sqrt().sqrt()
}

/// Density of microfacet normals at `h`, per solid angle and projected area, as [`ggx::distribution`].
#[inline]
#[must_use]
pub fn distribution(widths: Vec2, h: Vec3) -> f32 {
    let (x, y) = (h.x / widths.x, h.y / widths.y);
    let root = x * x + y * y + h.z * h.z;
    1.0 / (std::f32::consts::PI * (widths.x * widths.y) * (root * root))
}

/// The length of `w`, stretched by the widths: [`ggx::spread`] for two widths.
#[inline]
#[must_use]
pub fn spread(widths: Vec2, w: Vec3) -> f32 {
    let (x, y) = (widths.x * w.x, widths.y * w.y);
    (x * x + y * y + w.z * w.z).sqrt()
}

/// `G2 / (4 cos_o cos_i)`, as [`ggx::visibility`]; both z above 0.
#[inline]
#[must_use]
pub fn visibility(widths: Vec2, o: Vec3, i: Vec3) -> f32 {
    0.5 / (o.z * spread(widths, i) + i.z * spread(widths, o))
}

/// The factor k of a bounded spherical cap (Eto and Tokuyoshi 2023, equation 5), of the lesser width.
#[inline]
fn bound(widths: Vec2, o: Vec3) -> f32 {
    let least = widths.x.min(widths.y);
    let squared = least * least;
    let s = 1.0 + (o.x * o.x + o.y * o.y).sqrt();
    let s = s * s;
    (1.0 - squared) * s / (s + squared * (o.z * o.z))
}

/// The reflection of `o` at a visible normal, as [`ggx::sample`]; it may lie below the surface. `u` and `v` are uniform in
/// `[0, 1)`; `o.z` > 0.
#[inline]
#[must_use]
pub fn sample(widths: Vec2, o: Vec3, u: f32, v: f32) -> Vec3 {
    let (x, y) = (widths.x * o.x, widths.y * o.y);
    let inverse = 1.0 / (x * x + y * y + o.z * o.z).sqrt();
    let top = o.z * inverse;
    let b = bound(widths, o) * top;
    // As in `ggx`: from z, the sine would consist of rounding errors near the pole.
    let versine = u * (1.0 + b);
    let sine = (versine * (2.0 - versine)).max(0.0).sqrt();
    let z = 1.0 - versine;
    let (sin, cos) = sin_cos_turns(v);
    let h = Vec3::new(widths.x * (sine * cos + x * inverse), widths.y * (sine * sin + y * inverse), z + top);
    let h = h.normalize_or(Vec3::Z);
    h * (2.0 * o.dot(h)) - o
}

/// Density per solid angle of the directions of [`sample`]; `h` is the half vector of `o` and the direction.
#[inline]
#[must_use]
pub fn pdf(widths: Vec2, o: Vec3, h: Vec3) -> f32 {
    distribution(widths, h) / (2.0 * (bound(widths, o) * o.z + spread(widths, o)))
}

/// Tangent and bitangent of `normal`: `tangent`, made perpendicular to it, or any if that is parallel to the normal or 0.
#[inline]
#[must_use]
pub fn frame(tangent: Vec3, normal: Vec3) -> (Vec3, Vec3) {
    let once = (tangent - normal * normal.dot(tangent)).normalize_or(Vec3::ZERO);
    // Of a tangent that is nearly parallel, the first difference consists of rounding errors.
    let rest = once - normal * normal.dot(once);
    if !(rest.length_squared() > 0.25) {
        return sampling::basis(normal);
    }
    let across = rest.normalize_or(Vec3::X);
    (across, normal.cross(across))
}

/// Mark of packed words.
const MARK: u32 = 1 << 31;
/// Steps of packed words: of the strength between 0 and 1, and of the direction in half a turn.
pub const STEPS: [f32; 2] = [32_767.0, 65_536.0];

/// The anisotropy of `layers` in a word of a query whose shading normal is `normal`; 0 without any.
#[inline]
#[must_use]
pub fn pack(layers: &Layers, normal: Vec3) -> u32 {
    if !(layers.anisotropy > 0.0) {
        return 0;
    }
    let (x, y) = sampling::basis(normal);
    let (across, along) = (layers.tangent.dot(y), layers.tangent.dot(x));
    // Opposite directions are the same.
    let turns = turns_of(across.abs(), if across < 0.0 { -along } else { along });
    let direction = (turns * (2.0 * STEPS[1]) + 0.5) as u32 & 0xFFFF;
    let strength = (layers.anisotropy.min(1.0) * STEPS[0] + 0.5) as u32;
    MARK | strength << 16 | direction
}

/// [`crate::Query::path`] of a query for a reflection whose anisotropy is `packed`, in a scene that has any: that, or `path`
/// without its highest bit, which no picture of less than 2²⁹ pixels has.
#[inline]
#[must_use]
pub const fn path_word(path: u32, packed: u32) -> u32 {
    if is_packed(packed) { packed } else { path & !MARK }
}

/// Strength and tangent of a word of [`pack`]; `None` of other words.
#[inline]
#[must_use]
pub fn unpack(word: u32, normal: Vec3) -> Option<(f32, Vec3)> {
    if !is_packed(word) {
        return None;
    }
    let (sin, cos) = sin_cos_turns((word & 0xFFFF) as f32 / (2.0 * STEPS[1]));
    let (x, y) = sampling::basis(normal);
    Some(((word >> 16 & 0x7FFF) as f32 / STEPS[0], x * cos + y * sin))
}

/// Whether a word is from [`pack`].
#[inline]
#[must_use]
pub const fn is_packed(word: u32) -> bool {
    word & MARK != 0
}

/// An anisotropic reflection at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anisotropic {
    pub(crate) widths: Vec2,
    tangent: Vec3,
}

impl Anisotropic {
    #[inline]
    pub(crate) fn new(roughness: f32, strength: f32, tangent: Vec3) -> Option<Self> {
        (strength > 0.0).then(|| Self { widths: widths(roughness, strength), tangent })
    }

    /// Of a surface of this roughness.
    #[inline]
    pub(crate) fn of(layers: &Layers, roughness: f32) -> Option<Self> {
        Self::new(roughness, layers.anisotropy, layers.tangent)
    }

    #[inline]
    pub(crate) fn frame(&self, normal: Vec3) -> (Vec3, Vec3) {
        frame(self.tangent, normal)
    }

    /// Single scattering of a perfect reflector from `i` towards `o` without the cosine, and the density of [`sample`].
    #[inline]
    pub(crate) fn single(&self, o: Vec3, i: Vec3, h: Vec3) -> (f32, f32) {
        (distribution(self.widths, h) * visibility(self.widths, o, i), pdf(self.widths, o, h))
    }
}
