//! A5: a custom kernel, summed over the neighbours that an index finds, as another renderer would do it: the
//! truncated Gaussian of Jensen 1996, `W(u) = α (1 − (1 − e^(−β u/2)) / (1 − e^(−β)))` with `u = d²/r²`, α = 0.918,
//! β = 1.953.
//!
//! It retains 0.531155 of the light, since that is `∫₀¹ W(u) du`; with α = 1.7283093 it retains all of it.

use backend_cpu::index::{IndexKind, Neighbours, PointIndex};
use photon_tests::estimators::poisson;
use photon_tests::stats::{agrees, assert_agrees, moments};

const DENSITY: f64 = 40_000.0;
const JENSEN: f64 = 0.918;
const NORMALISED: f64 = 1.728_309_3;

fn gaussian(alpha: f64, u: f64) -> f64 {
    const BETA: f64 = 1.953;
    alpha * (1.0 - (1.0 - (-0.5 * BETA * u).exp()) / (1.0 - (-BETA).exp()))
}

/// Mean of a power of the weight over the disc, by the midpoint rule; accurate to 1e-9.
fn integral(alpha: f64, power: i32) -> f64 {
    let steps = 10_000;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
    (0..steps).map(|i| gaussian(alpha, at(i)).powi(power)).sum::<f64>() / f64::from(steps)
}

/// Estimates divided by the density at 256 positions of 8 fields, far enough apart to be independent: the sum of
/// W/(π r²), with r the distance of the k-th photon, including that photon or not.
fn relative(kind: IndexKind, alpha: f64, k: usize, with_kth: bool) -> Vec<f64> {
    let mut values = Vec::new();
    let mut found = Neighbours::default();
    for field in 0..8 {
        let points: Vec<[f32; 3]> = poisson(DENSITY, 2000 + field).iter().map(|photon| photon.position).collect();
        let index = PointIndex::build(&points, kind).expect("finite points");
        for place in 0..=255_u8 {
            let at = [f32::from(place % 16) * 0.05 - 0.375, f32::from(place / 16) * 0.05 - 0.375, 0.0];
            index.nearest_of_all(at, k, 0.25, &mut found);
            let (last, others) = found.as_slice().split_last().expect("k of them");
            assert_eq!(others.len() + 1, k);
            let reach = f64::from(last.d2);
            let kept = if with_kth { found.as_slice() } else { others };
            let sum: f64 = kept.iter().map(|neighbour| gaussian(alpha, f64::from(neighbour.d2) / reach)).sum();
            values.push(sum / (std::f64::consts::PI * reach) / DENSITY);
        }
    }
    values
}

#[test]
fn a5_the_norm_by_quadrature() {
    assert_agrees("Jensen's", integral(JENSEN, 1), 0.531_155, 0.0, 1e-6);
    assert_agrees("normalised", integral(NORMALISED, 1), 1.0, 0.0, 1e-6);
}

/// Without the k-th photon the variance is `∫W²/(k−2)`, as with any kernel; its own relative standard error is
/// taken as `√(3/n)`, for tails somewhat heavier than the normal distribution's.
#[test]
fn a5_mean_and_variance_without_the_kth() {
    for (kind, k) in [(IndexKind::Median, 10), (IndexKind::Vvh, 50), (IndexKind::Morton, 50)] {
        for (alpha, mean) in [(JENSEN, 0.531_155), (NORMALISED, 1.0)] {
            let values = relative(kind, alpha, k, false);
            let (m, v) = moments(&values);
            let (n, variance) = (values.len() as f64, integral(alpha, 2) / (k as f64 - 2.0));
            assert_agrees("mean", m, mean, (variance / n).sqrt(), 0.0);
            assert_agrees("variance", v, variance, variance * (3.0 / n).sqrt(), 0.0);
        }
    }
}

/// With the k-th photon the mean gains `W(1)/(k−1)`.
#[test]
fn a5_with_the_kth() {
    for (k, mean) in [(10_usize, 0.559_06), (50, 0.536_28)] {
        let gained = integral(JENSEN, 1) + gaussian(JENSEN, 1.0) / (k as f64 - 1.0);
        assert_agrees("closed form", gained, mean, 0.0, 1e-4);
        let values = relative(IndexKind::Morton, JENSEN, k, true);
        let (m, v) = moments(&values);
        assert_agrees("mean", m, gained, (v / values.len() as f64).sqrt(), 0.0);
    }
}

/// Negative control: Jensen's constant is not mistaken for a normalised kernel.
#[test]
fn a5_loss_is_seen() {
    let values = relative(IndexKind::Morton, JENSEN, 50, false);
    let (m, v) = moments(&values);
    assert!(!agrees(m, 1.0, (v / values.len() as f64).sqrt(), 0.4), "{m}");
}
