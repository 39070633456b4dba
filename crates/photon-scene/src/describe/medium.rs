//! Media that absorb and scatter light.

use photon_core::Medium;

use super::{MaterialDesc, Surface};
use crate::error::SceneError;

/// The medium around all solids, without bounds: fog, haze, water around a diver.
///
/// Light from infinitely far away does not arrive through it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct AmbientMedium {
    /// Scattering coefficient, per user length, finite and ≥ 0, linear RGB.
    pub scattering: [f64; 3],
    /// Absorption coefficient, per user length, finite and ≥ 0, linear RGB.
    pub absorption: [f64; 3],
    /// Mean cosine g of the Henyey–Greenstein phase function, in (−1, 1): 0 scatters evenly, 1 forwards. Beyond ±0.999 it is
    /// rendered as ±0.999.
    pub anisotropy: f64,
}

impl AmbientMedium {
    /// A medium that scatters evenly in all directions.
    #[must_use]
    pub fn new(scattering: [f64; 3], absorption: [f64; 3]) -> Self {
        Self { scattering, absorption, anisotropy: 0.0 }
    }

    /// The medium with this [`Self::anisotropy`].
    #[must_use]
    pub fn with_anisotropy(self, anisotropy: f64) -> Self {
        Self { anisotropy, ..self }
    }

    /// Whether it changes no light.
    #[must_use]
    pub fn is_vacuum(&self) -> bool {
        self.scattering == [0.0; 3] && self.absorption == [0.0; 3]
    }

    /// Its record, for a user length of `scale` per normalised one.
    pub(crate) fn record(&self, scale: f64) -> Medium {
        record(self.absorption, self.scattering, self.anisotropy, scale)
    }
}

/// Greatest magnitude of a mean cosine; beyond, f32 loses the shape of the lobe.
const MAX_ANISOTROPY: f64 = 0.999;

/// Coefficients per normalised length and the mean cosine, in a vacuum's record.
pub(crate) fn record(absorption: [f64; 3], scattering: [f64; 3], anisotropy: f64, scale: f64) -> Medium {
    // Opaque beyond a few units anyway; an infinity would give 0 · ∞ at zero distance.
    let normalised = |per_length: [f64; 3]| per_length.map(|part| (part * scale).min(1e30) as f32);
    let scattering = normalised(scattering);
    // Media that differ in what has no effect share an entry.
    let anisotropy = if scattering == [0.0; 3] { 0.0 } else { anisotropy.clamp(-MAX_ANISOTROPY, MAX_ANISOTROPY) };
    Medium { absorption: normalised(absorption), scattering, anisotropy: anisotropy as f32, ..Medium::VACUUM }
}

/// Greatest scattering coefficient per normalised length. Beyond, mean free paths are below 16 ray offsets, and photons would
/// step over boundaries.
const MAX_SCATTERING: f64 = 65_536.0;

/// Refuses media that scatter too densely to be traced.
pub(crate) fn check_density(
    materials: &[MaterialDesc],
    ambient: Option<&AmbientMedium>,
    scale: f64,
) -> Result<(), SceneError> {
    let is_dense = |scattering: [f64; 3]| scattering.iter().any(|part| part * scale > MAX_SCATTERING);
    if let Some(medium) = ambient.filter(|medium| is_dense(medium.scattering)) {
        let value = format!("{:?}, where light goes less than a 65536th of the scene's extent", medium.scattering);
        let hint = "nothing would be seen through it: use a thinner medium, or surfaces";
        return Err(SceneError::Medium { property: "scattering", value, hint });
    }
    for desc in materials.iter().filter(|desc| is_dense(desc.scattering)) {
        let Surface::Dielectric { absorption, .. } = desc.surface else { continue };
        let albedo: [f64; 3] = std::array::from_fn(|channel| {
            diffuse_albedo(desc.scattering[channel], absorption[channel], desc.scattering_anisotropy)
        });
        let value = format!(
            "{:?}, where light goes less than a 65536th of the scene's extent and the solid looks like a diffuse surface of \
             albedo {albedo:.4?}",
            desc.scattering
        );
        let hint = "such solids are not traced: use kind = \"lambert\" of that albedo, or less scattering";
        return Err(SceneError::Material { material: desc.name.clone(), property: "scattering", value, hint });
    }
    Ok(())
}

/// Share of diffuse light that a half space of a medium reflects, index-matched (van de Hulst 1980, by similarity).
fn diffuse_albedo(scattering: f64, absorption: f64, g: f64) -> f64 {
    // Scaled, so that extreme coefficients do not overflow.
    let albedo = 1.0 / (1.0 + absorption / scattering.max(f64::MIN_POSITIVE));
    let s = ((1.0 - albedo) / (1.0 - albedo * g)).sqrt();
    (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
}

/// Warns of phase functions that are clamped.
pub(crate) fn warn(materials: &[MaterialDesc], ambient: Option<&AmbientMedium>, warnings: &mut Vec<String>) {
    let solids = materials.iter().filter(|desc| desc.scattering != [0.0; 3]);
    let solids = solids.map(|desc| (format!("material '{}'", desc.name), desc.scattering_anisotropy));
    let around = ambient.map(|medium| ("the ambient medium".to_owned(), medium.anisotropy));
    for (what, g) in around.into_iter().chain(solids).filter(|(_, g)| g.abs() > MAX_ANISOTROPY) {
        warnings.push(format!("{what}: its anisotropy {g} is rendered as {}", MAX_ANISOTROPY.copysign(g)));
    }
}
