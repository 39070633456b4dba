//! Phase functions in extras.

use serde::{Deserialize, Serialize};

use super::Exact;
use crate::describe::PhaseDesc;

/// A phase function other than Henyey and Greenstein's, whose mean cosine is a member of its own.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PhaseExtras {
    Rayleigh,
    Mie { droplet_micrometres: Exact },
}

impl PhaseExtras {
    /// The mean cosine, and the phase function if it is another.
    pub(super) fn new(phase: PhaseDesc) -> (Exact, Option<Self>) {
        match phase {
            PhaseDesc::HenyeyGreenstein { anisotropy } => (Exact(anisotropy), None),
            PhaseDesc::Rayleigh => (Exact(0.0), Some(Self::Rayleigh)),
            PhaseDesc::Mie { droplet_micrometres } => {
                (Exact(0.0), Some(Self::Mie { droplet_micrometres: Exact(droplet_micrometres) }))
            }
        }
    }

    pub(super) fn plain(anisotropy: Exact, other: Option<Self>) -> PhaseDesc {
        match other {
            None => PhaseDesc::from(anisotropy.0),
            Some(Self::Rayleigh) => PhaseDesc::Rayleigh,
            Some(Self::Mie { droplet_micrometres }) => PhaseDesc::Mie { droplet_micrometres: droplet_micrometres.0 },
        }
    }
}
