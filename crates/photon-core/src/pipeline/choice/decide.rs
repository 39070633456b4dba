//! Which of the compared settings is chosen.

use super::Candidate;
use crate::settings::{Area, Bandwidth};

/// Discs are chosen if their least error, and another number of paths if its error, is less than this part of that with areas of
/// surfaces or with the present number: times are not exact, and what discs lack at edges is more visible than noise.
const CLEARLY_LESS: f64 = 0.85;

/// Radii per pixel are chosen if the error is less than this part of that with shared radii; [`CLEARLY_LESS`] if that means discs
/// in place of areas of surfaces.
const LESS: f64 = 0.95;

/// In place of [`LESS`] if more than [`SEVERAL_PASSES`] are expected: with shared radii the bias then decides, of which trials show
/// little, so that large radii may seem better than they are.
const NOT_MORE: f64 = 1.05;
const SEVERAL_PASSES: f64 = 130.0;

/// More paths are chosen, one number after the other, if a pass takes at most this many times as long as with the number before, and
/// the error is at most this many times that of the best: two passes hardly show rare bright photons, of which more are
/// found, or the bias of narrow features.
const HARDLY_LONGER: f64 = 1.25;
const HARDLY_MORE: f64 = 1.05;

/// With as many passes radii are those of each pixel, whatever the forecast: bias that remains then is below the noise of trials.
const MANY_PASSES: f64 = 700.0;

/// The best of the candidates, which are by increasing error, for this time; `now` is the present number of paths. `None` without
/// a candidate that has this number. Areas are compared by the least error with any number of paths, the kinds of radii after more
/// paths were taken for each, which may raise an error by [`HARDLY_MORE`].
pub(super) fn decide(candidates: &[Candidate], now: u32, seconds: f64) -> Option<Candidate> {
    let shared = best_with(candidates, Bandwidth::Shared, now);
    let per_pixel = best_with(candidates, Bandwidth::PerPixel, now);
    match (shared, per_pixel) {
        (Some(shared), Some(per_pixel)) => {
            let loses_edges = (per_pixel.best.area, shared.best.area) == (Area::Disc, Area::Surface);
            let passes = seconds / per_pixel.best.seconds;
            let less = if passes > SEVERAL_PASSES { NOT_MORE } else { LESS };
            // Another number of paths may have less error with shared radii too, though not clearly.
            let is_better = per_pixel.best.error < if loses_edges { CLEARLY_LESS } else { less } * shared.least.error;
            Some(if is_better || passes > MANY_PASSES { per_pixel.best } else { shared.best })
        }
        (shared, per_pixel) => per_pixel.or(shared).map(|found| found.best),
    }
}

/// Of candidates with the same kinds of radii and areas: the one with the best number of paths, and the one with the least error.
#[derive(Clone, Copy)]
struct Found {
    best: Candidate,
    least: Candidate,
}

/// The best with this kind of radii; discs only if their least error is clearly less than that of areas of surfaces.
fn best_with(candidates: &[Candidate], bandwidth: Bandwidth, now: u32) -> Option<Found> {
    let surface = best_of(candidates, (bandwidth, Area::Surface), now);
    let disc = best_of(candidates, (bandwidth, Area::Disc), now);
    match (surface, disc) {
        (Some(surface), Some(disc)) => {
            let is_clearly_less = |disc: &Candidate| disc.error < CLEARLY_LESS * surface.least.error;
            Some(match (is_clearly_less(&disc.best), is_clearly_less(&disc.least)) {
                (true, _) => disc,
                // With the best number of paths the difference is not as clear.
                (false, true) => Found { best: disc.least, ..disc },
                (false, false) => surface,
            })
        }
        (surface, disc) => surface.or(disc),
    }
}

fn best_of(candidates: &[Candidate], (bandwidth, area): (Bandwidth, Area), now: u32) -> Option<Found> {
    let mut such = candidates.iter().filter(|each| (each.bandwidth, each.area) == (bandwidth, area)).copied();
    let best = such.clone().find(|each| each.photons == now)?;
    let least = such.next()?;
    let best = if least.error < CLEARLY_LESS * best.error { least } else { best };
    let is_like =
        |each: &&Candidate| (each.area, each.bandwidth, each.gather_rays) == (area, bandwidth, best.gather_rays);
    // One step after the other, since each may take hardly longer than the one before.
    let next = |from: &Candidate| {
        // Radii of more paths are smaller even with the same factor.
        let more = candidates.iter().filter(|each| each.photons > from.photons && is_like(each));
        more.filter(|each| each.radius_factor >= from.radius_factor)
            .filter(|each| each.seconds <= HARDLY_LONGER * from.seconds && each.error <= HARDLY_MORE * best.error)
            .min_by(|a, b| a.photons.cmp(&b.photons).then(a.error.total_cmp(&b.error)))
            .copied()
    };
    std::iter::successors(Some(best), next).last().map(|best| Found { best, least })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(photons: u32, area: Area, error: f64) -> Candidate {
        Candidate {
            photons,
            area,
            radius_factor: 0.7,
            bandwidth: Bandwidth::Shared,
            gather_rays: None,
            // Photons take half of a pass of 1000 paths.
            seconds: 0.005 + 0.005 * f64::from(photons) / 1000.0,
            error,
            direct_error: 0.1 * error,
        }
    }

    fn decided(candidates: &[Candidate]) -> Candidate {
        let mut sorted = candidates.to_vec();
        sorted.sort_by(|a, b| a.error.total_cmp(&b.error));
        decide(&sorted, 1000, 1.0).unwrap()
    }

    #[test]
    fn discs_and_other_numbers_of_paths_have_to_be_clearly_better() {
        let surface = candidate(1000, Area::Surface, 1.0);
        for (other, is_chosen) in [
            (candidate(1000, Area::Disc, 0.86), false),
            (candidate(1000, Area::Disc, 0.84), true),
            (candidate(4000, Area::Surface, 0.86), false),
            (candidate(4000, Area::Surface, 0.84), true),
        ] {
            let expected = if is_chosen { other } else { surface };
            assert_eq!(decided(&[surface, other]), expected, "{other:?}");
        }
        assert_eq!(decide(&[candidate(500, Area::Disc, 1.0)], 1000, 1.0), None);
    }

    /// Of several such numbers the largest, with the best radius; one after the other.
    #[test]
    fn more_paths_are_taken_if_they_take_hardly_longer() {
        let best = candidate(1000, Area::Surface, 1.0);
        let more = |seconds: f64, error: f64| Candidate { seconds, ..candidate(4000, Area::Surface, error) };
        for (other, is_chosen) in [
            (more(0.0124, 1.04), true),
            (more(0.0126, 1.04), false),
            (more(0.0114, 1.06), false),
            (Candidate { area: Area::Disc, ..more(0.0114, 1.04) }, false),
            (Candidate { radius_factor: 0.5, ..more(0.0114, 1.04) }, false),
            (Candidate { photons: 500, ..more(0.0114, 1.04) }, false),
            (Candidate { bandwidth: Bandwidth::PerPixel, ..more(0.0114, 1.04) }, false),
        ] {
            let expected = if is_chosen { other } else { best };
            assert_eq!(decided(&[best, other]), expected, "{other:?}");
        }
        let fewer = Candidate { photons: 2000, ..more(0.0114, 1.0) };
        let wide = Candidate { radius_factor: 1.4, ..more(0.0139, 1.03) };
        assert_eq!(decided(&[best, fewer, more(0.0139, 1.04), wide]), wide, "each step is a small one");
        assert_eq!(decided(&[best, fewer, more(0.0144, 1.0)]), fewer);
        assert_eq!(decided(&[best, fewer, more(0.0139, 1.06)]), fewer);
    }

    #[test]
    fn pixels_have_their_own_radii_where_that_is_better() {
        let best = candidate(1000, Area::Surface, 1.0);
        let own =
            |photons, area, error| Candidate { bandwidth: Bandwidth::PerPixel, ..candidate(photons, area, error) };
        for (other, is_chosen) in [
            (own(1000, Area::Surface, 0.96), false),
            (own(1000, Area::Surface, 0.94), true),
            (own(1000, Area::Disc, 0.86), false),
            (own(1000, Area::Disc, 0.84), true),
        ] {
            assert_eq!(decided(&[best, other]), if is_chosen { other } else { best }, "{other:?}");
        }
        // Four times the paths would have 0.9 of the error with shared radii.
        let more = candidate(4000, Area::Surface, 0.9);
        assert_eq!(decided(&[best, more, own(1000, Area::Surface, 0.88)]), best);
        assert_eq!(decided(&[best, more, own(1000, Area::Surface, 0.85)]), own(1000, Area::Surface, 0.85));
        // Areas and the number of paths are chosen for each kind of radii.
        let [surface, disc] = [own(1000, Area::Surface, 0.8), own(1000, Area::Disc, 0.7)];
        assert_eq!(decided(&[best, surface, disc]), surface);
        let more = own(4000, Area::Surface, 0.6);
        assert_eq!(decided(&[best, surface, disc, more]), more);
        assert_eq!(decided(&[surface, disc]), surface);
        // Discs are compared with areas of surfaces of any number of paths.
        let [few, more] = [own(1000, Area::Surface, 1.0), own(4000, Area::Surface, 0.8)];
        assert_eq!(decided(&[few, more, own(1000, Area::Disc, 0.7)]), more);
        assert_eq!(decided(&[few, more, own(1000, Area::Disc, 0.67)]), own(1000, Area::Disc, 0.67));
        // Of discs, only another number of paths is clearly better, and only with it they are.
        let [present, other] = [own(1000, Area::Disc, 0.75), own(2000, Area::Disc, 0.67)];
        assert_eq!(decided(&[few, more, present, other]), other);
        // 0.01 s for a pass: 130 in 1.3 s.
        let alike = own(1000, Area::Surface, 1.04);
        assert_eq!(decide(&[best, alike], 1000, 1.29), Some(best));
        assert_eq!(decide(&[best, alike], 1000, 1.31), Some(alike));
        assert_eq!(decide(&[best, own(1000, Area::Surface, 1.06)], 1000, 1.31), Some(best));
        // 0.01 s for a pass: 700 in 7 s.
        let worse = own(1000, Area::Surface, 2.0);
        assert_eq!(decide(&[best, worse], 1000, 6.99), Some(best));
        assert_eq!(decide(&[best, worse], 1000, 7.01), Some(worse));
    }
}
