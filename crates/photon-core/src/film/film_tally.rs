//! Fates of the photons and camera paths of a film, so that continued and merged renders report all of their passes.

use crate::backend::observer::PassReport;
use crate::backend::tally::Tally;
use crate::requirements::map_kind::PerMap;

/// Counts and flux of the photons of a film's passes, and truncated camera paths. They are sums of integers: exact, in any order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct FilmTally {
    /// Number of passes that were counted: fewer than [`crate::Film::passes`] if parts of the film are from files without
    /// counts, or were filled by hand.
    pub passes: u32,
    /// Paths that were not aimed.
    pub photons: Tally,
    /// Aimed paths.
    pub aimed: Tally,
    /// Camera paths and final-gather rays that were truncated ([`crate::EyeTracer::truncated`]).
    pub truncated_camera_paths: u64,
}

impl FilmTally {
    /// The photons that were stored in each map, of both kinds of paths.
    #[must_use]
    pub fn stored(&self) -> PerMap<u64> {
        PerMap::from_fn(|kind| self.photons.stored[kind].saturating_add(self.aimed.stored[kind]))
    }

    /// Adds a pass.
    pub(crate) fn add(&mut self, report: &PassReport) {
        self.merge(&Self {
            passes: 1,
            photons: report.tally,
            aimed: report.aimed,
            truncated_camera_paths: report.truncated_camera_paths,
        });
    }

    /// Adds the counts of other passes.
    pub fn merge(&mut self, other: &Self) {
        self.passes = self.passes.saturating_add(other.passes);
        self.photons.merge(&other.photons);
        self.aimed.merge(&other.aimed);
        self.truncated_camera_paths = self.truncated_camera_paths.saturating_add(other.truncated_camera_paths);
    }
}
