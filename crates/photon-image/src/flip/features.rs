//! Edges and points, which are noticeable when pictures alternate (section 4.2).

use super::filter::{Plane, weights};

/// Width of the feature detectors, degrees.
const WIDTH: f64 = 0.082;

/// Strength of edges and of points at each pixel; `luminance` is in `[0, 1]`.
pub(super) fn detect(luminance: &Plane, pixels_per_degree: f64) -> (Vec<f64>, Vec<f64>) {
    let sigma = 0.5 * WIDTH * pixels_per_degree;
    let radius = (3.0 * sigma).ceil() as usize;
    let gaussian = |x: f64| (-0.5 * (x / sigma).powi(2)).exp();
    let plain = weights(radius, gaussian);
    let sum: f64 = plain.iter().sum();
    let plain: Vec<f64> = plain.iter().map(|weight| weight / sum).collect();
    // First and second derivative of a Gaussian.
    let edge = balanced(weights(radius, |x| -x * gaussian(x)));
    let point = balanced(weights(radius, |x| ((x / sigma).powi(2) - 1.0) * gaussian(x)));
    let strength = |weights: &[f64]| -> Vec<f64> {
        let (x, y) = (luminance.filtered(weights, &plain), luminance.filtered(&plain, weights));
        x.values.iter().zip(&y.values).map(|(x, y)| x.hypot(*y)).collect()
    };
    (strength(&edge), strength(&point))
}

/// Normalises positive weights to sum 1, negative ones to −1.
fn balanced(weights: Vec<f64>) -> Vec<f64> {
    let positive: f64 = weights.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|weight| **weight < 0.0).sum::<f64>();
    weights.into_iter().map(|weight| if weight > 0.0 { weight / positive } else { weight / negative }).collect()
}
