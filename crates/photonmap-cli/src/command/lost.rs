//! Warnings about light that is missing from the picture.

use photon_core::flight::MAX_COLLISIONS;
use photon_core::{Indirect, MediumStack, Outcome, Settings, Tally};

/// Share of the light that may be missing without a warning: a quarter of the step between two shades of a PNG.
const NEGLIGIBLE: f64 = 1e-3;

/// A warning about paths that were inside more solids at once than a path can keep track of.
pub(super) fn too_deep(outcome: &Outcome) -> Option<String> {
    let paths = outcome.tally.too_deep + outcome.aimed.too_deep;
    (paths > 0).then(|| {
        format!(
            "{paths} photon paths entered more than {} overlapping solids at once; further ones were ignored there: merge \
             solids, or close meshes that are open",
            MediumStack::DEPTH
        )
    })
}

/// A warning about paths that met as many surfaces as they may, if their light is not negligible; the report and the film
/// count all of them.
pub(super) fn truncated(outcome: &Outcome, settings: &Settings, pixels: u64) -> Option<String> {
    let gathered = if settings.indirect == Indirect::Gather { settings.gather_rays } else { 0 };
    let seen = pixels * u64::from(outcome.passes) * (u64::from(settings.camera_samples) + u64::from(gathered));
    let seen = outcome.truncated_camera_paths as f64 / seen.max(1) as f64;
    // Paths are thinned out in fog without bounds alone. Most of their light goes away, so that its share says little.
    let is_endless = outcome.tally.terminated > 0;
    let walks = outcome.tally.truncated as f64 / outcome.tally.emitted.max(1) as f64;
    if is_endless && walks.max(seen) > NEGLIGIBLE {
        return Some(format!(
            "{:.2} % of the camera paths and {:.2} % of the photon paths ended after up to {} surfaces or {MAX_COLLISIONS} \
             collisions; in fog without bounds, the light that would come back from there is missing, some per cent where the \
             fog is dense: give [medium] a box, or absorption",
            100.0 * seen,
            100.0 * walks,
            settings.max_bounces
        ));
    }
    let photons = if is_endless { 0.0 } else { photons(outcome) };
    (seen.max(photons) > NEGLIGIBLE).then(|| {
        format!(
            "{:.2} % of the camera paths and {:.2} % of the light of photons ended in glass, media or between mirrors, after \
             up to {} surfaces or {MAX_COLLISIONS} collisions, and the light beyond is missing: raise --max-bounces, \
             close open solids, or give the glass an absorption",
            100.0 * seen,
            100.0 * photons,
            settings.max_bounces
        )
    })
}

/// Share of the flux of photons that was truncated, of the channel with the largest.
fn photons(outcome: &Outcome) -> f64 {
    let per_path = |sum: [f64; 3], paths: u64| sum.map(|flux| flux / paths.max(1) as f64);
    let lost = |tally: &Tally| per_path(tally.flux_truncated.value(), tally.emitted);
    let emitted = per_path(outcome.tally.flux_emitted.value(), outcome.tally.emitted);
    let (traced, aimed) = (lost(&outcome.tally), lost(&outcome.aimed));
    (0..3).map(|channel| (traced[channel] + aimed[channel]) / emitted[channel]).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use photon_core::FixedFlux;

    use super::*;

    fn outcome(camera_paths: u64, photons: u32) -> Outcome {
        let mut outcome = Outcome::default();
        (outcome.passes, outcome.truncated_camera_paths) = (10, camera_paths);
        outcome.tally.emitted = 10_000;
        let path = FixedFlux::new([1.0, 0.5, 0.0]);
        (0..10_000).for_each(|_| outcome.tally.flux_emitted.add(path));
        (0..photons).for_each(|_| outcome.tally.flux_truncated.add(path));
        outcome
    }

    /// Light far below the noise is no warning; the rest is in per cent, with a remedy.
    #[test]
    fn only_light_that_counts_is_a_warning() {
        let settings = Settings { max_bounces: 8, ..Settings::default() };
        let warning = |camera_paths, photons| truncated(&outcome(camera_paths, photons), &settings, 1000);
        assert_eq!([warning(0, 0), warning(10, 10)], [None, None]);
        let text = warning(0, 50).unwrap();
        assert!(text.starts_with("0.00 % of the camera paths and 0.50 % of the light of photons"), "{text}");
        let text = warning(300, 0).unwrap();
        assert!(text.starts_with("3.00 % of the camera paths and 0.00 %") && text.contains("8 surfaces"), "{text}");
        assert!(text.ends_with("raise --max-bounces, close open solids, or give the glass an absorption"), "{text}");
        // Final-gather rays are counted with camera paths.
        let gather = Settings { indirect: Indirect::Gather, gather_rays: 99, ..settings };
        assert_eq!(truncated(&outcome(300, 0), &gather, 1000), None);
        assert_eq!(truncated(&Outcome::default(), &gather, 0), None);
        let mut endless = outcome(0, 50);
        endless.tally.terminated = 1;
        // Few paths carry much light away.
        assert_eq!(truncated(&endless, &gather, 1000), None);
        endless.tally.truncated = 20;
        let text = truncated(&endless, &gather, 1000).unwrap();
        assert!(text.contains("0.20 % of the photon paths") && text.contains("give [medium] a box"), "{text}");
    }
}
