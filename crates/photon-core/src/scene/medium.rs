//! The table of media: the space around all solids, and their insides.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::shading::spectrum::Wavelength;

/// Medium inside a solid. Entry 0 of a scene's table is the space outside of all solids: a vacuum, or an ambient medium
/// without bounds.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Medium {
    /// Absorption coefficient (Beer–Lambert), per normalised length, ≥ 0, linear RGB.
    pub absorption: [f32; 3],
    /// Refractive index relative to vacuum, > 0.
    pub ior: f32,
    /// Where solids overlap, the medium with the highest priority applies; with equal priorities, the one
    /// entered last.
    pub priority: u32,
    /// Formula of the refractive index by wavelength: 0, [`Medium::CAUCHY`] or [`Medium::SELLMEIER`]. With 0 it is
    /// [`Self::ior`] at all wavelengths.
    pub dispersion: u32,
    /// Its coefficients, for wavelengths in micrometres: A, B; or B1, B2, B3, C1, C2, C3.
    pub terms: [f32; 6],
    /// Scattering coefficient, per normalised length, ≥ 0, linear RGB.
    pub scattering: [f32; 3],
    /// Mean cosine g of the Henyey–Greenstein phase function, in (−1, 1).
    pub anisotropy: f32,
}

impl Medium {
    /// Space without a medium.
    pub const VACUUM: Self = Self {
        absorption: [0.0; 3],
        ior: 1.0,
        priority: 0,
        dispersion: 0,
        terms: [0.0; 6],
        scattering: [0.0; 3],
        anisotropy: 0.0,
    };
    /// [`Self::dispersion`]: n = A + B/λ².
    pub const CAUCHY: u32 = 1;
    /// [`Self::dispersion`]: n² = 1 + Σ Bλ²/(λ² − C).
    pub const SELLMEIER: u32 = 2;

    /// Extinction coefficient: absorption and scattering.
    #[inline]
    #[must_use]
    pub fn extinction(&self) -> Vec3 {
        Vec3::from(self.absorption) + Vec3::from(self.scattering)
    }

    /// Whether light is scattered in it.
    #[inline]
    #[must_use]
    pub fn scatters(&self) -> bool {
        self.scattering != [0.0; 3]
    }

    /// Whether light is absorbed or scattered in it.
    #[inline]
    #[must_use]
    pub fn attenuates(&self) -> bool {
        self.scatters() || self.absorption != [0.0; 3]
    }

    /// Whether the refractive index depends on the wavelength.
    #[inline]
    #[must_use]
    pub const fn is_dispersive(&self) -> bool {
        self.dispersion != 0
    }

    /// Refractive index at a wavelength, at least 1 if it depends on it; [`Self::ior`] without a wavelength.
    #[inline]
    #[must_use]
    pub fn index(&self, wavelength: Wavelength) -> f32 {
        if !self.is_dispersive() || !wavelength.is_drawn() {
            return self.ior;
        }
        let length = wavelength.micrometres();
        let squared = length * length;
        let [b1, b2, b3, c1, c2, c3] = self.terms;
        if self.dispersion == Self::CAUCHY {
            return (b1 + b2 / squared).max(1.0);
        }
        let sum = b1 * squared / (squared - c1) + b2 * squared / (squared - c2) + b3 * squared / (squared - c3);
        (1.0 + sum).max(1.0).sqrt()
    }
}

impl Default for Medium {
    fn default() -> Self {
        Self::VACUUM
    }
}
