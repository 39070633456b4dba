//! When a render ends.

use std::time::Duration;

use crate::error::{Error, Result};
use crate::shown::number;

/// How long a render runs: a limit on its cost, or an error to reach.
///
/// With [`Budget::Time`] or [`Budget::Error`], and if errors are estimated, radii that the renderer derived
/// itself are adapted after the first 8 passes, so that noise and bias are balanced at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Budget {
    /// This many passes, ≥ 1.
    Passes(u32),
    /// As many passes as are needed to emit this many paths, ≥ 1.
    Photons(u64),
    /// All passes that end within this duration; the first one always runs, with fewer paths and rays if it would take too long
    /// ([`crate::Render::lower`]).
    Time(Duration),
    /// As many passes as are needed until the estimated error ([`crate::ConfidenceInterval`]) is small
    /// enough. [`crate::Settings::errors`] must be set.
    Error {
        /// The largest relative error, > 0: a fraction of the pixel, or of a tenth of the picture's mean
        /// where the pixel is darker than that.
        target: f64,
        /// The share of pixels that have to reach it, among the pixels whose error estimate needs no
        /// bounds ([`crate::ConfidenceInterval::reasons`] is empty); above 0
        /// and at most 1.
        share_of_pixels: f64,
    },
}

impl Budget {
    /// This many passes, however long they take.
    #[must_use]
    pub fn passes(passes: u32) -> Self {
        Self::Passes(passes)
    }
}

/// A budget, the first pass, and further limits.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: written as a literal with `..Plan::from(budget)`.
pub struct Plan {
    /// Index of the first pass.
    pub first: u32,
    /// How long to render.
    pub until: Budget,
    /// Maximum number of passes, ≥ 1.
    pub most_passes: Option<u32>,
    /// Maximum duration: no pass begins that is expected to end later. The first pass always runs, likewise, but as asked for
    /// with [`Budget::Passes`].
    pub most_time: Option<Duration>,
}

impl From<Budget> for Plan {
    fn from(until: Budget) -> Self {
        Self { first: 0, until, most_passes: None, most_time: None }
    }
}

impl Plan {
    /// The duration after which it ends, if it is limited.
    #[must_use]
    pub fn time(&self) -> Option<Duration> {
        let asked = match self.until {
            Budget::Time(time) => Some(time),
            _ => None,
        };
        asked.into_iter().chain(self.most_time).min()
    }

    /// The number of passes after which it ends, unless another limit ends it before.
    #[must_use]
    pub fn passes(&self) -> u32 {
        let asked = match self.until {
            Budget::Passes(passes) => Some(passes),
            _ => None,
        };
        let fewest = asked.into_iter().chain(self.most_passes).min().unwrap_or(u32::MAX - 1);
        // The last pass index is reserved for the pilot.
        fewest.min((u32::MAX - 1).saturating_sub(self.first))
    }

    /// Checks that all limits are valid.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] for zero passes, zero photons, or a target error that is not between 0
    /// and 1.
    pub fn validate(&self) -> Result<()> {
        let ensure = |good: bool, name, value: String, hint| {
            if good { Ok(()) } else { Err(Error::InvalidSetting { name, value, hint }) }
        };
        ensure(self.passes() > 0, "passes", self.passes().to_string(), "at least 1 is needed")?;
        match self.until {
            Budget::Photons(photons) => ensure(photons > 0, "photons", photons.to_string(), "at least 1 is needed"),
            Budget::Error { target, share_of_pixels: share } => {
                let good = target > 0.0 && target < 1.0;
                ensure(good, "target-error", number(target), "must be above 0 and below 1: 0.05 is 5 %")?;
                ensure(share > 0.0 && share <= 1.0, "share", number(share), "must be above 0 and at most 1")
            }
            Budget::Passes(_) | Budget::Time(_) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_limit_counts() {
        let time = Budget::Time(Duration::from_secs(5));
        assert_eq!(Plan::from(time).time(), Some(Duration::from_secs(5)));
        let plan = Plan { most_time: Some(Duration::from_secs(3)), most_passes: Some(9), ..Plan::from(time) };
        assert_eq!((plan.time(), plan.passes()), (Some(Duration::from_secs(3)), 9));
        assert_eq!(Plan { most_passes: Some(9), ..Plan::from(Budget::Passes(4)) }.passes(), 4);
        assert_eq!(Plan::from(Budget::Photons(4)).time(), None);
    }

    #[test]
    fn budgets_of_nothing_are_refused() {
        let error = |target, share_of_pixels| Budget::Error { target, share_of_pixels };
        let bad = [
            Budget::Passes(0),
            Budget::Photons(0),
            error(0.0, 0.5),
            error(f64::NAN, 0.5),
            error(f64::INFINITY, 0.5),
            error(2.0, 0.5),
            error(0.1, 0.0),
            error(0.1, 1.1),
            error(0.1, f64::NAN),
        ];
        for budget in bad {
            assert!(Plan::from(budget).validate().is_err(), "{budget:?}");
        }
        assert!(Plan::from(error(0.1, 1.0)).validate().is_ok());
    }
}
