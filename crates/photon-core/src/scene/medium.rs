//! The table of media, the insides of solids.

use bytemuck::{Pod, Zeroable};

use crate::shading::spectrum::Wavelength;

/// Medium inside a solid. Entry 0 of a scene's table is the vacuum outside of all solids.
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
    /// Zero.
    pub reserved: [u32; 4],
}

impl Medium {
    /// Entry 0 of every table.
    pub const VACUUM: Self =
        Self { absorption: [0.0; 3], ior: 1.0, priority: 0, dispersion: 0, terms: [0.0; 6], reserved: [0; 4] };
    /// [`Self::dispersion`]: n = A + B/λ².
    pub const CAUCHY: u32 = 1;
    /// [`Self::dispersion`]: n² = 1 + Σ Bλ²/(λ² − C).
    pub const SELLMEIER: u32 = 2;

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
