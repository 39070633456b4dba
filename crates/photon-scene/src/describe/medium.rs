//! Media that absorb and scatter light.

use photon_core::Medium;

use super::{MaterialDesc, PhaseDesc, Surface};
use crate::error::SceneError;

/// The medium around all solids: fog, haze, water around a diver.
///
/// Light from infinitely far away does not arrive through one without bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct AmbientMedium {
    /// Scattering coefficient, per user length, finite and ≥ 0, linear RGB.
    pub scattering: [f64; 3],
    /// Absorption coefficient, per user length, finite and ≥ 0, linear RGB.
    pub absorption: [f64; 3],
    /// Directions of scattered light.
    pub phase: PhaseDesc,
    /// Lower and upper corner of the box that it fills, in user space; `None` without bounds.
    pub bounds: Option<[[f64; 3]; 2]>,
}

impl AmbientMedium {
    /// A medium without bounds that scatters evenly in all directions.
    #[must_use]
    pub fn new(scattering: [f64; 3], absorption: [f64; 3]) -> Self {
        Self { scattering, absorption, phase: PhaseDesc::default(), bounds: None }
    }

    /// The medium with this [`Self::phase`], or with the mean cosine of Henyey and Greenstein's.
    #[must_use]
    pub fn with_phase(self, phase: impl Into<PhaseDesc>) -> Self {
        Self { phase: phase.into(), ..self }
    }

    /// The medium within a box from `low` to `high`.
    #[must_use]
    pub fn with_bounds(self, low: [f64; 3], high: [f64; 3]) -> Self {
        Self { bounds: Some([low, high]), ..self }
    }

    /// Whether it changes no light.
    #[must_use]
    pub fn is_vacuum(&self) -> bool {
        self.scattering == [0.0; 3] && self.absorption == [0.0; 3]
    }

    /// Its record, for a user length of `scale` per normalised one.
    pub(crate) fn record(&self, scale: f64) -> Medium {
        record(self.absorption, self.scattering, self.phase, scale)
    }
}

/// Coefficients per normalised length and the phase function, in a vacuum's record.
pub(crate) fn record(absorption: [f64; 3], scattering: [f64; 3], phase: PhaseDesc, scale: f64) -> Medium {
    // Opaque beyond a few units anyway; an infinity would give 0 · ∞ at zero distance.
    let normalised = |per_length: [f64; 3]| per_length.map(|part| (part * scale).min(1e30) as f32);
    let medium = Medium { absorption: normalised(absorption), scattering: normalised(scattering), ..Medium::VACUUM };
    // Media that differ in what has no effect share an entry.
    if medium.scatters() { medium.with_phase(phase.phase()) } else { medium }
}

/// Refuses media that scatter too densely to be traced.
pub(crate) fn check_density(
    materials: &[MaterialDesc],
    ambient: Option<&AmbientMedium>,
    scale: f64,
) -> Result<(), SceneError> {
    if let Some(medium) = ambient.filter(|medium| medium.record(scale).is_too_dense()) {
        let value = format!("{:?}, where light goes less than a 65536th of the scene's extent", medium.scattering);
        let hint = "nothing would be seen through it: use a thinner medium, or surfaces";
        return Err(SceneError::Medium { property: "scattering", value, hint });
    }
    for desc in materials {
        let (Surface::Dielectric { absorption, .. } | Surface::Boundary { absorption }) = desc.surface else {
            continue;
        };
        let medium = record(absorption, desc.scattering, desc.phase, scale * desc.density());
        if medium.is_too_dense() {
            let value = format!(
                "{:?}, where light goes less than a 65536th of the scene's extent and the solid looks like a diffuse surface \
                 of albedo {:.4?}",
                desc.scattering,
                medium.diffuse_albedo()
            );
            let hint = "such solids are not traced: use kind = \"lambert\" of that albedo, or less scattering";
            return Err(SceneError::Material { material: desc.name.clone(), property: "scattering", value, hint });
        }
    }
    Ok(())
}

/// Warns of phase functions that are clamped.
pub(crate) fn warn(materials: &[MaterialDesc], ambient: Option<&AmbientMedium>, warnings: &mut Vec<String>) {
    let solids = materials.iter().filter(|desc| desc.scattering != [0.0; 3]);
    let solids = solids.map(|desc| (format!("material '{}'", desc.name), desc.phase));
    let around = ambient.map(|medium| ("the ambient medium".to_owned(), medium.phase));
    let clamped = around.into_iter().chain(solids).filter_map(|(what, phase)| phase.warning().map(|text| (what, text)));
    warnings.extend(clamped.map(|(what, text)| format!("{what}: {text}")));
}
