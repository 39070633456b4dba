//! How much of an estimate's disc lies on the surface: where probes of it stand.
//!
//! An estimate divides flux by the area of a disc, and loses light where the disc hangs over the end of
//! its surface: half of it along a straight edge, three quarters in a corner. Photons cannot tell the
//! end of a surface from the edge of a shadow, so that the scene is asked, by a few short rays.
//!
//! Probes stand on [`SPOKES`] rays about the query, [`RINGS`] on each, in strata of equal weight; the
//! whole figure is turned, and shifted outwards, by two random numbers. The share of the disc that is
//! on the surface is the share of the probes' weights, 1 to the bit where all are on it. A ray is asked from its outermost
//! probe on: if that one is found and nothing stands in the way, those within are taken to be found. One over an
//! estimate is too large on average by its relative variance: at edges and corners by less than 0.4 % with
//! Epanechnikov's kernel, by less than 1 % with any.
//!
//! Where errors are told, estimates within the second radii lose light in the same places, and other shares of it.
//! The same probes tell them, each counted as these radii weigh photons, and one more on each spoke, farther out.

use crate::settings::kernel::Kernel;

/// Directions in which probes stand.
pub const SPOKES: u32 = 8;

/// Probes in each.
pub const RINGS: u32 = 3;

/// The height from which surfaces are looked for, above and below the plane of the query, in radii: a
/// sphere may fall away by so much. An obstacle that is lower does not end a surface.
pub const HEIGHT: f32 = 0.5;

/// The least share that is believed in, so that no probe brightens a pixel beyond measure.
pub const MIN_SHARE: f32 = 1.0 / 16.0;

/// Below this radius, normalised length, probes would be as short as the rounding of points.
pub const MIN_RADIUS: f32 = 1.0 / 262_144.0;

/// Sheets and boundaries of glass that a probe passes.
pub const SHEETS: u32 = 4;

/// Where one probe stands, and what it counts for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// From the query, in radii, in `[0, 1]`.
    pub distance: f32,
    /// Relative to the others, ≥ 0.
    pub weight: f32,
}

/// The direction of a spoke in turns, for a random number in `[0, 1)`.
#[inline]
#[must_use]
pub fn spoke_turns(spoke: u32, random: f32) -> f32 {
    (spoke as f32 + random) * (1.0 / SPOKES as f32)
}

/// A probe of a spoke, for another random number. Where the kernel falls to zero at the rim, probes are
/// as dense as Epanechnikov's; otherwise evenly dense, and weighted.
#[inline]
#[must_use]
pub fn probe(kernel: Kernel, spoke: u32, ring: u32, random: f32) -> Probe {
    // Neighbouring spokes are shifted by the golden ratio, so that all of them together are even.
    let shift = (random + spoke as f32 * 0.618_034).fract();
    let share = ((ring as f32 + shift) * (1.0 / RINGS as f32)).min(1.0 - f32::EPSILON);
    match kernel {
        Kernel::Epanechnikov => Probe { distance: (1.0 - (1.0 - share).sqrt()).sqrt(), weight: 1.0 },
        Kernel::Biweight => {
            let rest = (1.0 - share).sqrt();
            Probe { distance: (1.0 - rest).sqrt(), weight: rest }
        }
        Kernel::Constant | Kernel::Cone { .. } => Probe { distance: share.sqrt(), weight: kernel.weight(share) },
    }
}

/// What share of the disc is believed to lie on the surface, if `found` of the weight of `all` probes is.
#[inline]
#[must_use]
pub fn share(found: f32, all: f32) -> f32 {
    // Nothing at all: what the query stands on is too thin or too small to be probed.
    if found > 0.0 && found < all { (found / all).max(MIN_SHARE) } else { 1.0 }
}

/// The squared distance from which on the outer probes stand, in squared radii; they end at 2, and are evenly dense.
const OUTER: f32 = 0.75;

/// The probe of a spoke that is for the second radius alone: how far out, in radii, up to √2.
#[inline]
#[must_use]
pub fn outer_distance(spoke: u32, random: f32) -> f32 {
    let shift = (random + spoke as f32 * 0.618_034).fract();
    (OUTER + (2.0 - OUTER) * shift).sqrt()
}

/// What a probe at that distance, in radii, counts for within √2 of the radius, and within 1/√2 of it: the kernel
/// there over the density of all probes that may stand there, which are those of [`probe`] and, for the former,
/// of [`outer_distance`] (the balance heuristic of Veach and Guibas 1995).
#[inline]
#[must_use]
pub fn second_weights(kernel: Kernel, distance: f32) -> [f32; 2] {
    let square = distance * distance;
    let falls = matches!(kernel, Kernel::Epanechnikov | Kernel::Biweight);
    let inner = match square < 1.0 {
        true if falls => RINGS as f32 * 2.0 * (1.0 - square),
        true => RINGS as f32,
        false => 0.0,
    };
    let outer = if square >= OUTER { 1.0 / (2.0 - OUTER) } else { 0.0 };
    let wide = kernel.weight((0.5 * square).min(1.0)) / (inner + outer);
    [wide, if square < 0.5 { kernel.weight(2.0 * square) / inner } else { 0.0 }]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A8: of a disc, the part this side of a line so many radii from its middle, as each kernel weighs it.
    const EDGES: [(Kernel, f64, f64); 6] = [
        (Kernel::Constant, 0.25, 0.657_481),
        (Kernel::Constant, 0.5, 0.804_499),
        (Kernel::Epanechnikov, 0.0, 0.5),
        (Kernel::Epanechnikov, 0.25, 0.705_638),
        (Kernel::Epanechnikov, 0.5, 0.873_415),
        (Kernel::Epanechnikov, 0.75, 0.973_909),
    ];

    /// Mean over random numbers of the share itself, and of its reciprocal.
    fn means(kernel: Kernel, inside: impl Fn(f64, f64) -> bool) -> (f64, f64) {
        const STEPS: u32 = 61;
        let (mut mean, mut reciprocal) = (0.0, 0.0);
        for step in 0..STEPS * STEPS {
            let number = |step: u32| (step as f32 + 0.5) / STEPS as f32;
            let (turn, shift) = (number(step % STEPS), number(step / STEPS));
            let (mut found, mut all) = (0.0, 0.0);
            for spoke in 0..SPOKES {
                let angle = f64::from(spoke_turns(spoke, turn)) * std::f64::consts::TAU;
                for ring in 0..RINGS {
                    let Probe { distance, weight } = probe(kernel, spoke, ring, shift);
                    let (x, y) = (f64::from(distance) * angle.cos(), f64::from(distance) * angle.sin());
                    all += weight;
                    found += if inside(x, y) { weight } else { 0.0 };
                }
            }
            mean += f64::from(found / all);
            reciprocal += 1.0 / f64::from(share(found, all));
        }
        let steps = f64::from(STEPS * STEPS);
        (mean / steps, reciprocal / steps)
    }

    /// The fractions of A8, for each kernel; and the mean of one over them, by which estimates are
    /// multiplied, within 0.5 % for edges and 1 % for a corner.
    #[test]
    fn shares_at_edges_and_corners_are_the_closed_forms() {
        for (kernel, at, truth) in EDGES {
            let (mean, reciprocal) = means(kernel, |x, _| x < at);
            assert!((mean - truth).abs() < 2e-3, "{kernel:?}, {at}: {mean} instead of {truth}");
            assert!((reciprocal * truth - 1.0).abs() < 5e-3, "{kernel:?}, {at}: {reciprocal}");
        }
        for kernel in [Kernel::Constant, Kernel::Epanechnikov, Kernel::Biweight, Kernel::Cone { slope: 1.1 }] {
            assert_eq!(means(kernel, |_, _| true), (1.0, 1.0));
            assert_eq!(means(kernel, |_, _| false).1, 1.0);
            let (mean, reciprocal) = means(kernel, |x, y| x < 0.0 && y < 0.0);
            assert!((mean - 0.25).abs() < 2e-3 && (reciprocal - 4.0).abs() < 0.04, "{kernel:?}: {mean} {reciprocal}");
        }
    }

    /// Means over random numbers of the shares of the second radii, and of one over each.
    fn second_means(kernel: Kernel, inside: impl Fn(f64, f64) -> bool) -> [[f64; 2]; 2] {
        const STEPS: u32 = 61;
        let mut means = [[0.0; 2]; 2];
        for step in 0..STEPS * STEPS {
            let number = |step: u32| (step as f32 + 0.5) / STEPS as f32;
            let (turn, shift) = (number(step % STEPS), number(step / STEPS));
            let (mut found, mut all) = ([0.0_f32; 2], [0.0_f32; 2]);
            for spoke in 0..SPOKES {
                let angle = f64::from(spoke_turns(spoke, turn)) * std::f64::consts::TAU;
                let rings = (0..RINGS).map(|ring| probe(kernel, spoke, ring, shift).distance);
                for distance in rings.chain([outer_distance(spoke, shift)]) {
                    let (x, y) = (f64::from(distance) * angle.cos(), f64::from(distance) * angle.sin());
                    for (i, weight) in second_weights(kernel, distance).into_iter().enumerate() {
                        // The narrow disc is asked by inner probes alone.
                        all[i] += weight;
                        found[i] += if inside(x, y) { weight } else { 0.0 };
                    }
                }
            }
            for i in 0..2 {
                means[i][0] += f64::from(found[i] / all[i]);
                means[i][1] += 1.0 / f64::from(share(found[i], all[i]));
            }
        }
        means.map(|pair| pair.map(|sum| sum / f64::from(STEPS * STEPS)))
    }

    /// The same fractions within √2 and 1/√2 of the radius: within 0.5 % at edges, and 1.5 % for one over them.
    #[test]
    fn shares_of_second_radii_are_the_closed_forms() {
        for (kernel, at, truth) in EDGES {
            for (i, radius) in [2.0_f64.sqrt(), 0.5_f64.sqrt()].into_iter().enumerate() {
                let [mean, reciprocal] = second_means(kernel, |x, _| x < at * radius)[i];
                assert!((mean - truth).abs() < 5e-3, "{kernel:?}, {at}, {radius}: {mean} instead of {truth}");
                assert!((reciprocal * truth - 1.0).abs() < 1.5e-2, "{kernel:?}, {at}, {radius}: {reciprocal}");
                // By the first radius another share lies within.
                let first = means(kernel, |x, _| x < at * radius).0;
                assert!(at == 0.0 || (first - truth).abs() > 0.015, "{kernel:?}, {at}: nothing was to be seen");
            }
        }
        for kernel in [Kernel::Constant, Kernel::Epanechnikov, Kernel::Biweight, Kernel::Cone { slope: 1.1 }] {
            assert_eq!(second_means(kernel, |_, _| true), [[1.0; 2]; 2]);
            for [mean, _] in second_means(kernel, |x, y| x < 0.0 && y < 0.0) {
                assert!((mean - 0.25).abs() < 5e-3, "{kernel:?}: {mean}");
            }
        }
    }

    #[test]
    fn no_share_is_below_the_least() {
        assert_eq!(share(1.0, 24.0), MIN_SHARE);
        assert_eq!(share(12.0, 24.0), 0.5);
    }
}
