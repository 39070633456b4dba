//! Dispersion of glass.

use serde::{Deserialize, Serialize};

use super::exact::Exact;
use crate::describe::Dispersion;

/// The formula of the refractive index, as in override files.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum DispersionExtras {
    Abbe(Exact),
    Cauchy([Exact; 2]),
    Sellmeier([Exact; 6]),
}

impl DispersionExtras {
    pub(super) fn new(dispersion: Dispersion) -> Self {
        match dispersion {
            Dispersion::Abbe(abbe) => Self::Abbe(Exact(abbe)),
            Dispersion::Cauchy(terms) => Self::Cauchy(terms.map(Exact)),
            Dispersion::Sellmeier(terms) => Self::Sellmeier(terms.map(Exact)),
        }
    }

    pub(super) fn plain(self) -> Dispersion {
        match self {
            Self::Abbe(abbe) => Dispersion::Abbe(abbe.0),
            Self::Cauchy(terms) => Dispersion::Cauchy(terms.map(|term| term.0)),
            Self::Sellmeier(terms) => Dispersion::Sellmeier(terms.map(|term| term.0)),
        }
    }
}
