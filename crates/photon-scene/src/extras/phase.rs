//! Phase functions in extras.

use serde::{Deserialize, Serialize};

use super::Exact;
use crate::describe::PhaseDesc;

/// A phase function other than the usual one.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PhaseExtras {
    HenyeyGreenstein { anisotropy: Exact },
    Rayleigh,
    Mie { droplet_micrometres: Exact },
}

impl PhaseExtras {
    pub(super) fn new(phase: PhaseDesc) -> Option<Self> {
        (phase != PhaseDesc::default()).then_some(match phase {
            PhaseDesc::HenyeyGreenstein { anisotropy } => Self::HenyeyGreenstein { anisotropy: Exact(anisotropy) },
            PhaseDesc::Rayleigh => Self::Rayleigh,
            PhaseDesc::Mie { droplet_micrometres } => Self::Mie { droplet_micrometres: Exact(droplet_micrometres) },
        })
    }

    pub(super) fn plain(self) -> PhaseDesc {
        match self {
            Self::HenyeyGreenstein { anisotropy } => PhaseDesc::HenyeyGreenstein { anisotropy: anisotropy.0 },
            Self::Rayleigh => PhaseDesc::Rayleigh,
            Self::Mie { droplet_micrometres } => PhaseDesc::Mie { droplet_micrometres: droplet_micrometres.0 },
        }
    }
}
