//! Phase functions: the directions in which media scatter light.

use photon_core::phase::{Mie, Phase};

use crate::error::SceneError;

/// Greatest magnitude of a mean cosine; beyond, f32 loses the shape of the lobe.
const MAX_ANISOTROPY: f64 = 0.999;
/// Diameters of droplets in micrometres, for which the approximation was made.
const DROPLETS: std::ops::RangeInclusive<f64> = 5.0..=50.0;

/// Phase function of a medium: the distribution of the directions of scattered light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PhaseDesc {
    /// That of Henyey and Greenstein.
    HenyeyGreenstein {
        /// Mean cosine g, in (−1, 1): 0 scatters evenly, 1 forwards. Beyond ±0.999 it is rendered as ±0.999.
        anisotropy: f64,
    },
    /// That of particles much smaller than the wavelength: air.
    Rayleigh,
    /// That of droplets of water, fog and cloud, by the approximation of Jendersie and d'Eon (2023); the same for all colours.
    Mie {
        /// Diameter of the droplets in micrometres, from 5 to 50.
        droplet_micrometres: f64,
    },
}

impl Default for PhaseDesc {
    /// Even scattering.
    fn default() -> Self {
        Self::from(0.0)
    }
}

impl From<f64> for PhaseDesc {
    /// [`Self::HenyeyGreenstein`] with this mean cosine.
    fn from(anisotropy: f64) -> Self {
        Self::HenyeyGreenstein { anisotropy }
    }
}

/// The keys of a phase function in override files, and the arguments of these names in other languages.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::exhaustive_structs, reason = "made by callers, of exactly these keys")]
pub struct PhaseKeys<'a> {
    /// `"hg"`, `"rayleigh"` or `"mie"`.
    pub phase: Option<&'a str>,
    /// Mean cosine of `"hg"`.
    pub anisotropy: Option<f64>,
    /// Diameter of the droplets of `"mie"`.
    pub droplet_micrometres: Option<f64>,
}

impl PhaseDesc {
    /// The phase function with the keys that are given; the rest stays.
    ///
    /// # Errors
    /// [`SceneError::Phase`] for unknown phases, and for keys that do not belong to the phase.
    pub fn with_keys(self, keys: PhaseKeys<'_>) -> Result<Self, SceneError> {
        let PhaseKeys { phase, anisotropy, droplet_micrometres } = keys;
        let refused = |what: String, hint| Err(SceneError::Phase { what, hint });
        match phase.unwrap_or(self.name()) {
            name @ ("rayleigh" | "mie") if anisotropy.is_some() => {
                refused(format!("phase \"{name}\" with anisotropy"), "leave anisotropy out, or use phase = \"hg\"")
            }
            name @ ("hg" | "rayleigh") if droplet_micrometres.is_some() => refused(
                format!("phase \"{name}\" with droplet_micrometres"),
                "leave droplet_micrometres out, or use phase = \"mie\"",
            ),
            "hg" => Ok(match (anisotropy, self) {
                (None, Self::HenyeyGreenstein { .. }) => self,
                (given, _) => Self::from(given.unwrap_or_default()),
            }),
            "rayleigh" => Ok(Self::Rayleigh),
            "mie" => match (droplet_micrometres, self) {
                (Some(droplet_micrometres), _) => Ok(Self::Mie { droplet_micrometres }),
                (None, Self::Mie { .. }) => Ok(self),
                (None, Self::HenyeyGreenstein { .. } | Self::Rayleigh) => refused(
                    "phase \"mie\" without droplet_micrometres".to_owned(),
                    "give the diameter of the droplets, from 5 to 50",
                ),
            },
            other => refused(format!("the unknown phase \"{other}\""), "use \"hg\", \"rayleigh\" or \"mie\""),
        }
    }

    /// Its value of the key `phase`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::HenyeyGreenstein { .. } => "hg",
            Self::Rayleigh => "rayleigh",
            Self::Mie { .. } => "mie",
        }
    }

    /// Property, value and valid range of a number that is out of range.
    pub(crate) fn fault(self) -> Option<(&'static str, String, &'static str)> {
        match self {
            Self::HenyeyGreenstein { anisotropy: g } => {
                let hint = "the mean cosine of scattering must lie between -1 and 1, both excluded";
                // NaN is out of range too.
                (!(g.abs() < 1.0)).then(|| ("anisotropy", g.to_string(), hint))
            }
            Self::Rayleigh => None,
            Self::Mie { droplet_micrometres: diameter } => {
                let hint = "the diameter of droplets must lie between 5 and 50 micrometres";
                (!DROPLETS.contains(&diameter)).then(|| ("droplet_micrometres", diameter.to_string(), hint))
            }
        }
    }

    /// The phase function that is rendered.
    pub(crate) fn phase(self) -> Phase {
        match self {
            Self::HenyeyGreenstein { anisotropy } => {
                Phase::HenyeyGreenstein(anisotropy.clamp(-MAX_ANISOTROPY, MAX_ANISOTROPY) as f32)
            }
            Self::Rayleigh => Phase::Rayleigh,
            Self::Mie { droplet_micrometres } => Phase::Mie(Mie::droplets(droplet_micrometres)),
        }
    }

    /// Warning of a mean cosine that is clamped.
    pub(super) fn warning(self) -> Option<String> {
        match self {
            Self::HenyeyGreenstein { anisotropy: g } if g.abs() > MAX_ANISOTROPY => {
                Some(format!("its anisotropy {g} is rendered as {}", MAX_ANISOTROPY.copysign(g)))
            }
            Self::HenyeyGreenstein { .. } | Self::Rayleigh | Self::Mie { .. } => None,
        }
    }
}
