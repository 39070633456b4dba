//! The table of media: the space around all solids, and their insides.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::shading::phase::{Mie, Phase};
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
    /// [`Self::ior`] at all wavelengths; with [`Medium::MATCHED`] that of the solid around it.
    pub dispersion: u32,
    /// Its coefficients, for wavelengths in micrometres: A, B; or B1, B2, B3, C1, C2, C3.
    pub terms: [f32; 6],
    /// Scattering coefficient, per normalised length, ≥ 0, linear RGB.
    pub scattering: [f32; 3],
    /// Mean cosine g of the Henyey–Greenstein phase function, in (−1, 1); of [`crate::phase::Mie::forward`] with [`Self::MIE`].
    pub anisotropy: f32,
    /// Kind of phase function: 0 for Henyey–Greenstein, [`Self::RAYLEIGH`] or [`Self::MIE`].
    pub phase: u32,
    /// The other parameters with [`Self::MIE`]: `draine`, `alpha` and `share` of [`crate::phase::Mie`].
    pub draine: [f32; 3],
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
        phase: 0,
        draine: [0.0; 3],
    };
    /// [`Self::dispersion`]: n = A + B/λ².
    pub const CAUCHY: u32 = 1;
    /// [`Self::dispersion`]: n² = 1 + Σ Bλ²/(λ² − C).
    pub const SELLMEIER: u32 = 2;
    /// [`Self::dispersion`]: light does not notice the boundary. Its [`Self::ior`] is 1, and means nothing.
    pub const MATCHED: u32 = 3;
    /// [`Self::phase`]: particles much smaller than the wavelength.
    pub const RAYLEIGH: u32 = 1;
    /// [`Self::phase`]: droplets of water.
    pub const MIE: u32 = 2;

    /// The medium with this phase function.
    #[must_use]
    pub fn with_phase(self, phase: Phase) -> Self {
        let (kind, anisotropy, draine) = match phase {
            Phase::HenyeyGreenstein(mean_cosine) => (0, mean_cosine, [0.0; 3]),
            Phase::Rayleigh => (Self::RAYLEIGH, 0.0, [0.0; 3]),
            Phase::Mie(Mie { forward, draine, alpha, share }) => (Self::MIE, forward, [draine, alpha, share]),
        };
        Self { phase: kind, anisotropy, draine, ..self }
    }

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

    /// Whether it scatters light too densely to be traced: paths would step over boundaries, since their mean free path is below
    /// 16 offsets of rays from surfaces.
    #[must_use]
    pub fn is_too_dense(&self) -> bool {
        self.scatters() && self.extinction().max_element() > 65_536.0
    }

    /// Diffuse albedo of a thick body of it under even light: van de Hulst's approximation (1980) for isotropic scattering,
    /// with the similarity relation for others.
    #[must_use]
    pub fn diffuse_albedo(&self) -> [f32; 3] {
        let mean_cosine = Phase::of(self).mean_cosine();
        std::array::from_fn(|c| {
            let (scattering, absorption) = (self.scattering[c], self.absorption[c]);
            let reduced = scattering * (1.0 - mean_cosine) + absorption;
            let s = if reduced > 0.0 { (absorption / reduced).sqrt() } else { 1.0 };
            (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
        })
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
        self.dispersion == Self::CAUCHY || self.dispersion == Self::SELLMEIER
    }

    /// Whether it is that of one of [`crate::Boundaries`].
    #[inline]
    #[must_use]
    pub const fn is_matched(&self) -> bool {
        self.dispersion == Self::MATCHED
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
