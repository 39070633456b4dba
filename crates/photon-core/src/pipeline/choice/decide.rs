//! Which of the compared settings is chosen.

use super::Candidate;
use crate::settings::{Area, Bandwidth};

/// Discs are chosen, or another number of paths, if the error is less than this part of that with areas of surfaces, or with the
/// present number: times are not exact, and what discs lack at edges is more visible than noise.
const CLEARLY_LESS: f64 = 0.85;

/// A radius for each pixel gains little where direct light makes up more than this part of the error.
const MAX_DIRECT: f64 = 0.5;

/// More paths are chosen if a pass takes at most this many times as long, and the error is at most this many times as large: two
/// passes hardly show rare bright photons, of which more are found.
const HARDLY_MORE: f64 = 1.15;

/// With that many times the passes of [`passes_per_pixel`], direct light is no reason against a radius for each pixel: its noise
/// falls faster than bias.
const MANY_TIMES: f64 = 2.0;

/// With as many passes, a radius for each pixel is worth the error estimates that it takes. These are estimates with a second
/// radius, which areas of surfaces make more expensive.
const fn passes_per_pixel(area: Area) -> f64 {
    match area {
        Area::Disc => 200.0,
        Area::Surface => 500.0,
    }
}

/// The best of the candidates, which are by increasing error, for this time; `now` is the present number of paths. With
/// radii per pixel, if these may be chosen, the factor on radii is 1. `None` without a candidate that has this number.
pub(super) fn decide(
    candidates: &[Candidate],
    now: u32,
    seconds: f64,
    (bandwidth, is_open): (Bandwidth, bool),
) -> Option<(Candidate, Bandwidth)> {
    let best = best_of(candidates, |candidate| candidate.photons == now)?;
    let other = best_of(candidates, |candidate| candidate.photons != now);
    let best = other.filter(|other| other.error < CLEARLY_LESS * best.error).unwrap_or(best);
    let best = candidates
        .iter()
        .filter(|each| each.photons >= best.photons && (each.area, each.gather_rays) == (best.area, best.gather_rays))
        .filter(|each| each.seconds <= HARDLY_MORE * best.seconds && each.error <= HARDLY_MORE * best.error)
        .max_by(|a, b| a.photons.cmp(&b.photons).then(b.error.total_cmp(&a.error)))
        .copied()
        .unwrap_or(best);
    let limits = seconds / (passes_per_pixel(best.area) * best.seconds);
    let is_per_pixel = is_open && limits > 1.0 && (limits > MANY_TIMES || best.direct_error < MAX_DIRECT * best.error);
    Some(if is_per_pixel { (Candidate { radius_factor: 1.0, ..best }, Bandwidth::PerPixel) } else { (best, bandwidth) })
}

/// The best of some candidates; discs only if they are clearly better.
fn best_of(candidates: &[Candidate], is_meant: impl Fn(&Candidate) -> bool) -> Option<Candidate> {
    let least = |area: Area| candidates.iter().find(|candidate| candidate.area == area && is_meant(candidate)).copied();
    match (least(Area::Surface), least(Area::Disc)) {
        (Some(surface), Some(disc)) if disc.error > CLEARLY_LESS * surface.error => Some(surface),
        (surface, disc) => disc.or(surface),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(photons: u32, area: Area, error: f64) -> Candidate {
        Candidate {
            photons,
            area,
            radius_factor: 0.7,
            gather_rays: None,
            // Photons take half of a pass of 1000 paths.
            seconds: 0.005 + 0.005 * f64::from(photons) / 1000.0,
            error,
            direct_error: 0.1 * error,
        }
    }

    fn decided(candidates: &[Candidate], seconds: f64) -> (Candidate, Bandwidth) {
        let mut sorted = candidates.to_vec();
        sorted.sort_by(|a, b| a.error.total_cmp(&b.error));
        decide(&sorted, 1000, seconds, (Bandwidth::Shared, true)).unwrap()
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
            assert_eq!(decided(&[surface, other], 1.0), (expected, Bandwidth::Shared), "{other:?}");
        }
        let none = decide(&[candidate(500, Area::Disc, 1.0)], 1000, 1.0, (Bandwidth::Shared, true));
        assert_eq!(none, None);
    }

    /// Of several such numbers the largest, with the best radius.
    #[test]
    fn more_paths_are_taken_if_they_take_hardly_longer() {
        let best = candidate(1000, Area::Surface, 1.0);
        let more = |seconds: f64, error: f64| Candidate { seconds, ..candidate(4000, Area::Surface, error) };
        for (other, is_chosen) in [
            (more(0.0114, 1.14), true),
            (more(0.0116, 1.14), false),
            (more(0.0114, 1.16), false),
            (Candidate { area: Area::Disc, ..more(0.0114, 1.14) }, false),
            (Candidate { photons: 500, ..more(0.0114, 1.14) }, false),
        ] {
            let expected = if is_chosen { other } else { best };
            assert_eq!(decided(&[best, other], 1.0).0, expected, "{other:?}");
        }
        let fewer = Candidate { photons: 2000, ..more(0.0101, 1.0) };
        let wide = Candidate { radius_factor: 1.4, ..more(0.0114, 1.13) };
        assert_eq!(decided(&[best, fewer, more(0.0114, 1.14), wide], 1.0).0, wide);
    }

    #[test]
    fn pixels_have_their_own_radii_with_many_passes_and_little_noise_of_direct_light() {
        for (area, many) in [(Area::Disc, 2.0), (Area::Surface, 5.0)] {
            let best = candidate(1000, area, 1.0);
            assert_eq!(decided(&[best], 0.99 * many), (best, Bandwidth::Shared));
            let own = Candidate { radius_factor: 1.0, ..best };
            assert_eq!(decided(&[best], 1.01 * many), (own, Bandwidth::PerPixel));
            let closed = decide(&[best], 1000, 1.01 * many, (Bandwidth::Shared, false));
            assert_eq!(closed, Some((best, Bandwidth::Shared)));
            let noisy = Candidate { direct_error: 0.6, ..best };
            assert_eq!(decided(&[noisy], 1.99 * many), (noisy, Bandwidth::Shared));
            let own = Candidate { radius_factor: 1.0, ..noisy };
            assert_eq!(decided(&[noisy], 2.01 * many), (own, Bandwidth::PerPixel));
        }
    }
}
