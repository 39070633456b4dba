//! The phase function of Henyey and Greenstein (1941): how light that collides in a medium is scattered.

use glam::Vec3;

use crate::shading::sampling;

/// Density per solid angle of scattering by an angle of this cosine between the directions of travel, for a mean cosine of
/// `anisotropy`. It integrates to 1 over the sphere, and is the same for both directions of travel exchanged.
#[inline]
#[must_use]
pub fn value(anisotropy: f32, cosine: f32) -> f32 {
    let (a, along) = (anisotropy.abs(), if anisotropy < 0.0 { -cosine } else { cosine });
    // 1 + a² − 2a·cos, without cancellation.
    let base = (1.0 - a) * (1.0 - a) + 2.0 * a * (1.0 - along).max(0.0);
    (0.25 * std::f32::consts::FRAC_1_PI) * (1.0 - a) * (1.0 + a) / (base * base.sqrt())
}

/// A direction of travel with the density [`value`] after travel along `direction`.
#[inline]
#[must_use]
pub fn sample(anisotropy: f32, direction: Vec3, [u, v]: [f32; 2]) -> Vec3 {
    let a = anisotropy.abs();
    let axis = if anisotropy < 0.0 { -direction } else { direction };
    // The inverse of the distribution function, solved for 1 − cos and with common factors taken out: exact digits for
    // narrow lobes, and for a of 0.
    let (narrow, below) = (1.0 - a, (1.0 - a) + 2.0 * a * u);
    let versine = 2.0 * (1.0 - u) * (1.0 + a * u) * (narrow * narrow / (below * below));
    sampling::about(axis, versine.min(2.0), v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{SplitMix64, unit_f32};

    /// ⟨cos⟩ = g and ⟨cos²⟩ = (1 + 2g²)/3, within 4.5 standard errors; and the density integrates to 1.
    #[test]
    fn moments_are_those_of_henyey_and_greenstein() {
        const N: u32 = 200_000;
        for g in [0.0, 1e-8, -1e-8, 0.3, -0.6, 0.9, 0.99, -0.999] {
            let mut numbers = SplitMix64(5);
            let mut sums = [0.0_f64; 4];
            for _ in 0..N {
                let direction = sample(g, Vec3::Y, [0; 2].map(|_: i32| unit_f32(numbers.word() as u32)));
                let cosine = f64::from(direction.dot(Vec3::Y));
                let square = cosine * cosine;
                [cosine, square, square, square * square].into_iter().zip(&mut sums).for_each(|(x, sum)| *sum += x);
            }
            let [first, second, square, fourth] = sums.map(|sum| sum / f64::from(N));
            let exact = f64::from(g);
            let error = |mean: f64, square: f64| ((square - mean * mean).max(0.0) / f64::from(N)).sqrt() + 1e-7;
            assert!((first - exact).abs() < 4.5 * error(first, square), "{g}: {first}");
            let expected = (1.0 + 2.0 * exact * exact) / 3.0;
            assert!((second - expected).abs() < 4.5 * error(second, fourth), "{g}: {second}");
            // By the midpoint rule over the angle, with steps that are fine at the poles.
            let steps = 200_000;
            let integral: f64 = (0..steps)
                .map(|step| {
                    let t = (f64::from(step) + 0.5) / f64::from(steps);
                    // cos = ±(1 − 2t⁴): versine 2t⁴ has the measure 8t³ dt.
                    let along = if g < 0.0 { -1.0 } else { 1.0 } * (1.0 - 2.0 * t.powi(4));
                    2.0 * std::f64::consts::PI * f64::from(value(g, along as f32)) * 8.0 * t.powi(3) / f64::from(steps)
                })
                .sum();
            assert!((integral - 1.0).abs() < if g.abs() < 0.99 { 1e-5 } else { 2e-3 }, "{g}: {integral}");
        }
    }
}
