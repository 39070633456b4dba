//! Alpha coverage: whether a surface is there at a point where a ray meets it (glTF 2.0, section 3.9.4).
//!
//! Everything is a pure function of the point and of one random word of the ray, so that the surface that a ray hits does
//! not depend on the order in which a ray tracer visits triangles. The expectation over the word is exact: a ray passes n
//! surfaces of coverage a with probability (1 − a)ⁿ.

use crate::random::unit_f32;

/// Spreads the indices of triangles over the words: 2³² divided by the golden ratio.
const SPREAD: u32 = 0x9E37_79B9;

/// Number of steps of a coverage.
const STEPS: f32 = 16_777_216.0;

/// The probability with which a surface of this alpha is there. With a cutoff above 0 it is 1 for `alpha >= cutoff`,
/// otherwise 0; without one it is `alpha`, rounded up to a multiple of 2⁻²⁴, at most 1.
#[inline]
#[must_use]
pub fn coverage(alpha: f32, cutoff: f32) -> f32 {
    if cutoff > 0.0 {
        if alpha >= cutoff { 1.0 } else { 0.0 }
    } else {
        (alpha * STEPS).ceil().min(STEPS) * (1.0 / STEPS)
    }
}

/// Whether triangle `primitive` is there for a ray with the random word `word`, where its coverage is `coverage`: always
/// for 1, never for 0.
#[inline]
#[must_use]
pub fn keep(coverage: f32, primitive: u32, word: u32) -> bool {
    coverage > unit_f32(mix(word ^ primitive.wrapping_mul(SPREAD)))
}

/// The finalizer of `MurmurHash3`: a permutation in which every bit of the result depends on all bits of `word`.
#[inline]
#[must_use]
pub fn mix(word: u32) -> u32 {
    let word = (word ^ word >> 16).wrapping_mul(0x85EB_CA6B);
    let word = (word ^ word >> 13).wrapping_mul(0xC2B2_AE35);
    word ^ word >> 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Domain, Sampler};
    use crate::settings::RandomKind;

    const COUNT: u32 = 1 << 16;

    /// How many of [`COUNT`] words keep none of the triangles 0 to `sheets`.
    fn passed(coverage: f32, sheets: u32) -> f64 {
        let word = |path| Sampler::new(RandomKind::Counter, 5, 0, Domain::Photon, path).words(2)[3];
        let passes = |path: &u32| (0..sheets).all(|primitive| !keep(coverage, primitive, word(*path)));
        (0..COUNT).filter(passes).count() as f64
    }

    /// G12: (1 − a)ⁿ; the standard error of a count of probability p is √(N p (1 − p)).
    #[test]
    fn layers_transmit_independently() {
        for (alpha, sheets) in [(0.3, 1), (0.3, 5), (0.5, 2), (1.0 / 255.0, 40), (254.0 / 255.0, 1), (0.9, 3)] {
            let probability = (1.0 - f64::from(alpha)).powi(sheets as i32);
            let expected = f64::from(COUNT) * probability;
            let deviation = (expected * (1.0 - probability)).sqrt();
            let z = (passed(coverage(alpha, 0.0), sheets) - expected) / deviation;
            assert!(z.abs() <= 4.5, "{sheets} sheets of {alpha}: z = {z}");
            // One sheet more or less is detected.
            let z = (passed(coverage(alpha, 0.0), sheets + 20) - expected) / deviation;
            assert!(z.abs() > 4.5, "{sheets} sheets of {alpha}: z = {z}");
        }
    }

    #[test]
    fn coverage_is_all_nothing_or_alpha() {
        assert_eq!([0.499_999_97, 0.5, 1.0].map(|alpha| coverage(alpha, 0.5)), [0.0, 1.0, 1.0]);
        assert_eq!([0.0, 0.25, 1.0, 1.5].map(|alpha| coverage(alpha, 0.0)), [0.0, 0.25, 1.0, 1.0]);
        assert_eq!(coverage(1e-30, 0.0), 1.0 / STEPS);
        assert_eq!(coverage(1.0, 2.0), 0.0);
        for word in (0..4096).map(|i| i * 1_048_583) {
            assert!(keep(1.0, 7, word) && !keep(0.0, 7, word));
        }
    }

    /// Known values of the finalizer: 0 is a fixed point, and it is a permutation.
    #[test]
    fn words_are_mixed() {
        assert_eq!([0, 1].map(mix), [0, 0x514E_28B7]);
        let mut mixed: Vec<u32> = (0..4096).map(mix).collect();
        mixed.sort_unstable();
        mixed.dedup();
        assert_eq!(mixed.len(), 4096);
    }
}
