//! Phase functions: how light that collides in a medium is scattered; `phase.glsl` is the twin.
//!
//! All are densities per solid angle that integrate to 1, depend on the angle between the directions of travel alone, and stay the
//! same if both are exchanged.

mod mie;

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;

use crate::scene::medium::Medium;
use crate::shading::math::cube_root;
use crate::shading::reflection_lobe::{Vectors, vector};
use crate::shading::sampling;
pub use mie::Mie;

/// Distribution of the directions of scattered light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// That of Henyey and Greenstein (1941) with this mean cosine, in (−1, 1).
    HenyeyGreenstein(f32),
    /// That of particles much smaller than the wavelength: air.
    Rayleigh,
    /// That of droplets of water: fog and cloud.
    Mie(Mie),
}

impl Phase {
    /// The phase function of a medium.
    #[inline]
    #[must_use]
    pub fn of(medium: &Medium) -> Self {
        match medium.phase {
            Medium::RAYLEIGH => Self::Rayleigh,
            Medium::MIE => Self::Mie(Mie::of(medium)),
            _ => Self::HenyeyGreenstein(medium.anisotropy),
        }
    }

    /// Mean cosine of the angle of scattering.
    #[must_use]
    pub fn mean_cosine(self) -> f32 {
        match self {
            Self::HenyeyGreenstein(mean_cosine) => mean_cosine,
            Self::Rayleigh => 0.0,
            Self::Mie(mie) => mie.mean_cosine(),
        }
    }

    /// Density of scattering from one direction of travel into another, both unit vectors.
    #[inline]
    #[must_use]
    pub fn value(self, from: Vec3, to: Vec3) -> f32 {
        match self {
            // Equal to the bit, and sooner.
            Self::HenyeyGreenstein(0.0) => 0.25 * FRAC_1_PI,
            Self::HenyeyGreenstein(g) => henyey_greenstein(g.abs(), sampling::versine(mirrored(g, from), to)),
            Self::Rayleigh => {
                let cosine = from.dot(to);
                (3.0 / (16.0 * PI)) * (1.0 + cosine * cosine)
            }
            Self::Mie(mie) => mie.value(sampling::versine(from, to)),
        }
    }

    /// [`Self::value`] from several directions; the loops become vector instructions.
    #[inline(always)]
    #[must_use]
    pub fn values<const N: usize>(self, from: &Vectors<N>, to: Vec3) -> [f32; N] {
        match self {
            Self::HenyeyGreenstein(0.0) => [self.value(to, to); N],
            // Each in a loop of its own.
            Self::HenyeyGreenstein(g) => each(from, |from| Self::HenyeyGreenstein(g).value(from, to)),
            Self::Rayleigh => each(from, |from| Self::Rayleigh.value(from, to)),
            Self::Mie(mie) => each(from, |from| Self::Mie(mie).value(from, to)),
        }
    }

    /// A direction of travel with the density [`Self::value`] after travel along `from`.
    #[inline]
    #[must_use]
    pub fn sample(self, from: Vec3, [u, v]: [f32; 2]) -> Vec3 {
        match self {
            Self::HenyeyGreenstein(g) => {
                sampling::about(mirrored(g, from), henyey_greenstein_versine(g.abs(), u).min(2.0), v)
            }
            Self::Rayleigh => sampling::about(from, rayleigh_versine(u), v),
            Self::Mie(mie) => sampling::about(from, mie.versine(u).min(2.0), v),
        }
    }
}

#[inline(always)]
fn each<const N: usize>(from: &Vectors<N>, value: impl Fn(Vec3) -> f32) -> [f32; N] {
    let mut values = [0.0; N];
    for lane in 0..N {
        values[lane] = value(vector(from, lane));
    }
    values
}

/// Axis of the lobe: backwards for a negative mean cosine.
#[inline]
fn mirrored(g: f32, from: Vec3) -> Vec3 {
    if g < 0.0 { -from } else { from }
}

/// Density of scattering by an angle of this versine, for a mean cosine `g` ≥ 0.
#[inline]
fn henyey_greenstein(g: f32, versine: f32) -> f32 {
    // 1 + g² − 2g·cos, without cancellation.
    let base = (1.0 - g) * (1.0 - g) + 2.0 * g * versine;
    (0.25 * FRAC_1_PI) * (1.0 - g) * (1.0 + g) / (base * base.sqrt())
}

/// Versine of an angle with the density [`henyey_greenstein`].
#[inline]
fn henyey_greenstein_versine(g: f32, u: f32) -> f32 {
    // The inverse of the distribution function, solved for 1 − cos and with common factors taken out: exact digits for
    // narrow lobes, and for g of 0.
    let (narrow, below) = (1.0 - g, (1.0 - g) + 2.0 * g * u);
    2.0 * (1.0 - u) * (1.0 + g * u) * (narrow * narrow / (below * below))
}

/// Versine of an angle whose cosine c has a density proportional to 1 + c²: the root of c³ + 3c = 8u − 4.
#[inline]
fn rayleigh_versine(u: f32) -> f32 {
    // Cardano's formula for the forward half; the other one is its mirror image.
    let q = (4.0 * u - 2.0).abs();
    let root = cube_root(q + (q * q + 1.0).sqrt());
    let cosine = (root - 1.0 / root).min(1.0);
    if u < 0.5 { 1.0 + cosine } else { 1.0 - cosine }
}

#[cfg(test)]
mod tests;
