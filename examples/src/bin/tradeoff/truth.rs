//! What pictures are measured against.

use std::f64::consts::FRAC_1_PI;

use photon_core::Film;
use photon_scene::IntegratingSphere;

/// Radiance of each pixel, mean of RGB.
#[derive(Clone, Debug)]
pub(crate) enum Truth {
    /// A closed form: the same everywhere.
    Constant(f64),
    /// A long run of our own.
    Reference {
        pixels: Vec<f64>,
        /// What it claims of its own relMSE; of flagged pixels, their noise alone.
        error: f64,
        passes: u32,
        /// Paths that it was made of.
        photons: u64,
    },
}

impl Truth {
    pub(crate) fn at(&self, pixel: usize) -> f64 {
        match self {
            Self::Constant(radiance) => *radiance,
            Self::Reference { pixels, .. } => pixels.get(pixel).copied().unwrap_or(0.0),
        }
    }

    /// Whether claims of a run of so many paths can be held against it.
    pub(crate) fn judges(&self, photons: u64) -> bool {
        match self {
            Self::Constant(_) => true,
            Self::Reference { photons: own, .. } => *own >= 4 * photons,
        }
    }

    /// One hundredth of its mean, squared: what keeps errors of dark pixels in bounds.
    pub(crate) fn floor(&self, count: usize) -> f64 {
        let mean = (0..count).map(|pixel| self.at(pixel)).sum::<f64>() / count.max(1) as f64;
        0.01 * mean * mean
    }
}

/// The radiance of scenes whose answer is known.
pub(crate) fn closed_form(scene: &str) -> Option<f64> {
    match scene {
        // Albedo over π times the irradiance by light that was scattered before.
        "integrating-sphere" => {
            let sphere = IntegratingSphere::default();
            Some(sphere.albedo * FRAC_1_PI * sphere.indirect_irradiance())
        }
        // Radiosity 2.
        "furnace" => Some(2.0 * FRAC_1_PI),
        _ => None,
    }
}

/// What a long run tells.
pub(crate) fn reference(film: &Film, photons: u64) -> Truth {
    let claims = film.claims().unwrap_or_default();
    let pixels: Vec<f64> = claims.iter().map(|claim| claim.value).collect();
    let truth = Truth::Reference { pixels, error: 0.0, passes: film.passes, photons };
    let floor = truth.floor(claims.len());
    let squares = claims.iter().map(|claim| {
        let bias = (claim.bias * claim.bias - claim.bias_error * claim.bias_error).max(0.0);
        (claim.standard_error * claim.standard_error + bias) / (claim.value * claim.value + floor)
    });
    let error = squares.sum::<f64>() / claims.len().max(1) as f64;
    match truth {
        Truth::Reference { pixels, passes, photons, .. } => Truth::Reference { pixels, error, passes, photons },
        constant @ Truth::Constant(_) => constant,
    }
}
