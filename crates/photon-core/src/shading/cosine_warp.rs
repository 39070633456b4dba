//! Directions to a triangle in proportion to the cosine to a surface normal, approximately: numbers that are sampled from the
//! bilinear interpolation of the cosines at the corners, as Hart, Pandey, Neuberger, Wang and Ramamoorthi 2020 ("Practical
//! product sampling by fitting and composing warps") and pbrt-v4 do.

/// This part of the sum of the cosines is added to each, so that no density is too small: the cosine within a triangle may be
/// greater than at its corners.
pub const EVEN_SHARE: f32 = 0.1;

/// Below that, numbers remain uniform.
pub const MIN_EVEN: f32 = 1e-12;

/// The greatest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Numbers in `[0, 1)²` for [`crate::solid_angle::sample`] from such that are uniform, and the reciprocal of their density.
///
/// `cosines` to the normal are those of the corners where the second number is 1 and the first is 0, where the second number is
/// 0, and where both are 1. Uniform numbers remain as they are if no cosine is above 0.
#[inline]
#[must_use]
pub fn warp(cosines: [f32; 3], u: f32, v: f32) -> (f32, f32, f32) {
    let [start, pole, finish] = cosines.map(|cosine| cosine.max(0.0));
    let even = EVEN_SHARE * (start + pole + finish);
    // Squares of smaller numbers are 0.
    if !(even > MIN_EVEN) {
        return (u, v, 1.0);
    }
    let [start, pole, finish] = [start + even, pole + even, finish + even];
    let (v, rest, _) = linear(v, 2.0 * pole, start + finish);
    let (u, _, value) = linear(u, pole * rest + start * v, pole * rest + finish * v);
    (u, v, 0.25 * (2.0 * pole + start + finish) / value)
}

/// A number in `[0, 1)` whose density is proportional to the linear interpolation from `a` to `b`, both above 0; what is missing
/// from it to 1; and the interpolated value there.
///
/// Without differences of what was rounded, so that no error of a division or a root, of which devices allow several in the last
/// place, is multiplied by the ratio of `a` and `b`.
#[inline]
fn linear(x: f32, a: f32, b: f32) -> (f32, f32, f32) {
    let left = 1.0 - x;
    let value = (a * a * left + b * b * x).sqrt();
    let sum = a + b;
    ((x * sum / (a + value)).min(BELOW_ONE), left * sum / (b + value), value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{philox4x32, unit_f32};

    fn numbers(i: u32) -> (f32, f32) {
        let [u, v, ..] = philox4x32([i, 0, 0, 0], [21, 0]);
        (unit_f32(u), unit_f32(v))
    }

    /// The moments of the numbers are those of the bilinear density, and the mean of the reciprocal densities is 1, the area of
    /// the square. Standard errors are those of the samples.
    #[test]
    fn density_is_bilinear() {
        for cosines in [[0.5, 0.5, 0.5], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.3, 0.2, 0.9], [0.0, 0.4, 0.7]] {
            let n = 100_000;
            let positive: [f64; 3] = cosines.map(|cosine: f32| f64::from(cosine.max(0.0)));
            let even = f64::from(EVEN_SHARE) * positive.iter().sum::<f64>();
            let [start, pole, finish] = positive.map(|cosine| cosine + even);
            let mean = 0.25 * (2.0 * pole + start + finish);
            // Of 1/density, u, v and u v.
            let expected = [
                1.0,
                (pole / 2.0 + start / 6.0 + finish / 3.0) / 2.0 / mean,
                ((2.0 * pole) / 6.0 + (start + finish) / 3.0) / 2.0 / mean,
                (pole / 12.0 + start / 18.0 + finish / 9.0) / mean,
            ];
            let mut sums = [[0.0; 2]; 4];
            for (u, v) in (0..n).map(numbers) {
                let (u, v, reciprocal) = warp(cosines, u, v);
                assert!((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v));
                let [u, v, reciprocal] = [u, v, reciprocal].map(f64::from);
                for (sum, value) in sums.iter_mut().zip([reciprocal, u, v, u * v]) {
                    *sum = [sum[0] + value, sum[1] + value * value];
                }
            }
            for ([sum, squares], expected) in sums.into_iter().zip(expected) {
                let mean = sum / f64::from(n);
                let error = ((squares / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt();
                assert!((mean - expected).abs() <= 4.5 * error + 1e-6, "{cosines:?}: {mean} {expected} ± {error}");
            }
        }
    }

    #[test]
    fn extremes() {
        for cosines in [[-1.0, 0.0, -0.2], [1e-30, 0.0, 0.0]] {
            assert_eq!(warp(cosines, 0.3, 0.6), (0.3, 0.6, 1.0), "all below the horizon");
        }
        for cosines in [[1e-10, 0.0, 0.0], [1.0, 1e-30, 0.0], [0.0, 0.0, 1.0], [1.0; 3]] {
            for (u, v) in [(0.0, 0.0), (BELOW_ONE, BELOW_ONE), (0.0, BELOW_ONE), (BELOW_ONE, 0.0), (0.5, 0.5)] {
                let (u, v, reciprocal) = warp(cosines, u, v);
                assert!((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v), "{cosines:?}: {u} {v}");
                assert!(reciprocal > 0.25 && reciprocal < 6.5, "{cosines:?}: {reciprocal}");
            }
        }
    }
}
