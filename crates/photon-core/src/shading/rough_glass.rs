//! Rough glass: GGX reflection and transmission at the boundary of a solid or at a thin sheet; `rough_glass.glsl` is the
//! twin.
//!
//! Three parts add up, whose sum is 1 over all directions if the tint is 1:
//! - reflection at microfacets, `F D G2 / (4 cos_o cos_i)`;
//! - transmission through them (Walter et al. 2007, equation 21), or through a sheet that of the reflection mirrored in
//!   the surface;
//! - what single scattering loses, `n_b² (1 − E_a)(1 − E_b) / (π Σ_c n_c² (1 − Ē_c))` from side a to side b, where the
//!   sum is over both sides and E is the share that single scattering reflects and transmits: the form of Kulla and Conty
//!   (2017), made to fit both sides. [`crate::RoughGlassTable`] has E.
//!
//! F is Fresnel's equations at the microfacet. All parts are reciprocal but for the squared index, `f(a→b)/n_b² =
//! f(b→a)/n_a²`, so that weights are the same for photons and for camera paths, whose throughput is of radiance over n².

use glam::Vec3;

use crate::scene::material::{Material, MaterialKind};
use crate::scene::media::Interface;
use crate::shading::bsdf::Lobe;
use crate::shading::fresnel::{fresnel, sheet_reflectance};
use crate::shading::glossy::{MIN_SHARE, Reflected, rest_of};
use crate::shading::rough_glass_table::{Losses, RoughGlassTable};
use crate::shading::{ggx, sampling};

/// Refractive indices that differ by less than this share count as equal: no boundary, rough or smooth.
pub const MIN_CONTRAST: f32 = 1e-4;

/// A rough boundary as a path meets it.
#[derive(Clone, Copy, Debug)]
pub struct RoughGlass {
    alpha: f32,
    roughness: f32,
    eta: f32,
    is_thin: bool,
    tint: Vec3,
    losses: Losses,
    /// `1 − E` for the direction that the path came from: the probability of the third part.
    lost: f32,
    /// `n²/Σ` of the third part, on the side of the path and on the other one.
    spread: [f32; 2],
    /// Share of the third part that stays on the side of the path.
    staying: f32,
    /// Probability with which lights on the side of the path are sampled.
    light_side: f32,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct RoughSample {
    /// Unit vector away from the surface.
    pub direction: Vec3,
    /// [`Lobe::SpecularReflection`] or [`Lobe::SpecularTransmission`]: the side of the direction.
    pub lobe: Lobe,
    /// BSDF times cosine, and density; 0 if the microfacet sends light to the wrong side, where it is lost.
    pub found: Reflected,
    /// The uniform number that is left of the one that chose the lobe.
    pub rest: f32,
}

impl RoughGlass {
    /// The boundary of `material`, evaluated at the point, for a path that arrives with `cosine` > 0 to the shading normal.
    /// `None` where it is smooth, not glass, or between equal media.
    #[inline]
    #[must_use]
    pub fn new(table: &RoughGlassTable, material: &Material, cosine: f32, interface: &Interface) -> Option<Self> {
        let (roughness, eta) = (material.roughness, interface.eta);
        let is_thin = material.kind() == MaterialKind::Thin;
        let alpha = roughness * roughness;
        if !(material.kind().transmits() && alpha >= ggx::MIN_ALPHA && interface.is_active)
            || (eta - 1.0).abs() < MIN_CONTRAST
        {
            return None;
        }
        let losses = if is_thin { Losses::SHEET } else { table.losses(eta) };
        let cosine = cosine.min(1.0);
        let lost = table.lost(losses, 0, cosine, roughness);
        let squared = [1.0, if is_thin { 1.0 } else { eta * eta }];
        let means = [0, 1].map(|side| table.mean_lost(losses, side, roughness));
        let sum = squared[0] * means[0] + squared[1] * means[1];
        let has_loss = sum > MIN_SHARE;
        let spread = squared.map(|square| if has_loss { square / sum } else { 0.0 });
        let reflectance = reflectance(cosine, eta, is_thin);
        Some(Self {
            alpha,
            roughness,
            eta,
            is_thin,
            tint: material.albedo.into(),
            losses,
            lost: if has_loss { lost } else { 0.0 },
            spread,
            staying: spread[0] * means[0],
            light_side: reflectance.clamp(0.125, 0.875),
        })
    }

    /// Probability with which a light on the side of the path should be sampled, rather than one beyond the boundary.
    #[inline]
    #[must_use]
    pub fn light_side(&self) -> f32 {
        self.light_side
    }

    /// Numbers that the twin computes too: what is lost from the direction of the path and, on the other side, from one
    /// with `cosine`; the share of the third part that stays; [`Self::light_side`]; `n²/Σ` of both sides.
    #[must_use]
    pub fn parts(&self, table: &RoughGlassTable, cosine: f32) -> [f32; 6] {
        let beyond = table.lost(self.losses, 1, cosine, self.roughness);
        [self.lost, beyond, self.staying, self.light_side, self.spread[0], self.spread[1]]
    }

    /// What reaches `wo` of light from `wi`; both point away from the surface, and `normal` is the shading normal on the
    /// side of `wo`.
    #[inline]
    #[must_use]
    pub fn evaluate(&self, table: &RoughGlassTable, wo: Vec3, wi: Vec3, normal: Vec3) -> Reflected {
        let (tangent, bitangent) = sampling::basis(normal);
        let local = |w: Vec3| Vec3::new(w.dot(tangent), w.dot(bitangent), w.dot(normal));
        let (o, i) = (local(wo), local(wi));
        let across = if i.z >= 0.0 {
            o + i
        } else if self.is_thin {
            Vec3::new(o.x + i.x, o.y + i.y, o.z - i.z)
        } else {
            o + i * self.eta
        };
        let length = across.length();
        let sign = if across.z < 0.0 { -1.0 } else { 1.0 };
        let h = if length > 0.0 { across * (sign / length) } else { Vec3::Z };
        self.at(table, o, i, h)
    }

    /// Samples a direction. `choice`, `u` and `v` are uniform in `[0, 1)`.
    #[inline]
    #[must_use]
    pub fn sample(&self, table: &RoughGlassTable, wo: Vec3, normal: Vec3, [choice, u, v]: [f32; 3]) -> RoughSample {
        let rest = rest_of(choice, self.lost);
        if choice < self.lost {
            let stays = rest < self.staying;
            let direction = sampling::cosine_hemisphere(if stays { normal } else { -normal }, u, v);
            let found = self.evaluate(table, wo, direction, normal);
            return RoughSample { direction, lobe: lobe(stays), found, rest: rest_of(rest, self.staying) };
        }
        let (tangent, bitangent) = sampling::basis(normal);
        let o = Vec3::new(wo.dot(tangent), wo.dot(bitangent), wo.dot(normal));
        let h = ggx::visible_normal(self.alpha, o, u, v);
        let across = o.dot(h);
        let split = fresnel(across, self.eta);
        let share = if self.is_thin { sheet_reflectance(split.reflectance) } else { split.reflectance };
        let stays = rest < share;
        let mirrored = h * (2.0 * across) - o;
        let i = if stays {
            mirrored
        } else if self.is_thin {
            Vec3::new(mirrored.x, mirrored.y, -mirrored.z)
        } else {
            h * (across / self.eta - split.cos_transmitted) - o / self.eta
        };
        let direction = (tangent * i.x + bitangent * i.y + normal * i.z).normalize_or_zero();
        let lands = if stays { i.z > 0.0 } else { i.z < 0.0 };
        let found = if lands { self.at(table, o, i, h) } else { Reflected::default() };
        RoughSample { direction, lobe: lobe(stays), found, rest: rest_of(rest, share) }
    }

    /// BSDF times cosine and density, with the microfacet normal `h` between `o` and `i`, all in the frame of the normal.
    #[inline]
    fn at(&self, table: &RoughGlassTable, o: Vec3, i: Vec3, h: Vec3) -> Reflected {
        let (across, beyond, height) = (o.dot(h), i.dot(h), i.z.abs());
        if !(o.z > 0.0 && height > 0.0) {
            return Reflected::default();
        }
        let stays = i.z > 0.0;
        let reflectance = reflectance(across, self.eta, self.is_thin);
        let share = if stays { reflectance } else { 1.0 - reflectance };
        // Factor from the density of microfacet normals, times o·h, to that of directions.
        let per_normal = if stays || self.is_thin {
            0.25
        } else if across > 0.0 && beyond < 0.0 {
            let both = across / self.eta + beyond;
            across * -beyond / (both * both)
        } else {
            0.0
        };
        let density = if across > 0.0 { ggx::distribution(self.alpha, h) * share * per_normal } else { 0.0 };
        let side = usize::from(!stays);
        let lost = self.lost * self.spread[side] * (height * std::f32::consts::FRAC_1_PI);
        let again = lost * table.lost(self.losses, side, height.min(1.0), self.roughness);
        let value = density * 4.0 * height * ggx::visibility(self.alpha, o.z, height) + again;
        let spread = if stays { self.staying } else { 1.0 - self.staying };
        let pdf = density * (1.0 - self.lost) * (2.0 / (o.z + ggx::spread(self.alpha, o.z)))
            + self.lost * spread * (height * std::f32::consts::FRAC_1_PI);
        Reflected { value: if stays { Vec3::splat(value) } else { self.tint * value }, pdf }
    }
}

#[inline]
fn lobe(stays: bool) -> Lobe {
    if stays { Lobe::SpecularReflection } else { Lobe::SpecularTransmission }
}

/// The reflected share at a microfacet.
#[inline]
pub(crate) fn reflectance(cosine: f32, eta: f32, is_thin: bool) -> f32 {
    let single = fresnel(cosine, eta).reflectance;
    if is_thin { sheet_reflectance(single) } else { single }
}

#[cfg(test)]
#[path = "rough_glass/tests.rs"]
pub(in crate::shading) mod tests;
