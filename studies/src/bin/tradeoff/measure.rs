//! Errors over several runs of one setting.

use photon_core::{ConfidenceInterval, Film, student_975};

use crate::records::{Claims, Summary};
use crate::truth::Truth;

/// The part of one run that is kept: a film is a hundred times as large.
pub(crate) struct Run {
    pub(crate) grey: Vec<f64>,
    pub(crate) claims: Option<Vec<ConfidenceInterval>>,
    pub(crate) passes: u32,
    pub(crate) seconds: f64,
    pub(crate) photons: u64,
}

impl Run {
    pub(crate) fn new(film: &Film, seconds: f64, photons: u64) -> Self {
        let grey = film.beauty().iter().map(|c| c.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0).collect();
        Self { grey, claims: film.confidence_intervals(), passes: film.passes, seconds, photons }
    }
}

/// relMSE of one run: the mean over pixels of `(x − y)²/(y² + ȳ²/100)`.
pub(crate) fn error(run: &Run, truth: &Truth) -> f64 {
    run.grey.iter().zip(weights(run.grey.len(), truth)).map(|(x, (y, weight))| weight * (x - y).powi(2)).sum()
}

/// The reference of each pixel, and the weight of its squared error.
fn weights(count: usize, truth: &Truth) -> impl Iterator<Item = (f64, f64)> {
    let floor = truth.floor(count);
    (0..count).map(move |pixel| (truth.at(pixel), 1.0 / ((truth.at(pixel).powi(2) + floor) * count as f64)))
}

/// Errors of runs with different seeds.
pub(crate) fn summarise(runs: &[Run], truth: &Truth) -> Summary {
    let count = runs.first().map_or(0, |run| run.grey.len());
    let n = runs.len() as f64;
    let errors: Vec<f64> = runs.iter().map(|run| error(run, truth)).collect();
    let (mut bias, mut variance) = (0.0, 0.0);
    for (pixel, (y, weight)) in weights(count, truth).enumerate() {
        let mean = runs.iter().map(|run| run.grey[pixel]).sum::<f64>() / n;
        let spread = runs.iter().map(|run| (run.grey[pixel] - mean).powi(2)).sum::<f64>() / (n - 1.0);
        variance += weight * spread;
        bias += weight * ((mean - y).powi(2) - spread / n);
    }
    let error = errors.iter().sum::<f64>() / n;
    let mut seconds: Vec<f64> = runs.iter().map(|run| run.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    let spread = errors.iter().map(|e| (e - error).powi(2)).sum::<f64>() / (n - 1.0);
    Summary {
        seconds: seconds[seconds.len() / 2],
        fastest: seconds[0],
        photons: runs.first().map_or(0, |run| run.photons),
        error,
        error_error: (spread / n).sqrt(),
        bias,
        variance,
        claims: runs.iter().all(|run| run.claims.is_some()).then(|| claims(runs, &|pixel| truth.at(pixel))),
    }
}

/// Coverage of the confidence intervals of runs.
pub(crate) fn claims(runs: &[Run], truth: &dyn Fn(usize) -> f64) -> Claims {
    let all: Vec<(&[ConfidenceInterval], f64)> = runs
        .iter()
        .filter_map(|run| Some((run.claims.as_deref()?, student_975(f64::from(run.passes) - 1.0))))
        .collect();
    let count = all.first().map_or(0, |(claims, _)| claims.len());
    let (mut claimed, mut covered, mut by_noise, mut worst) = (0, 0, 0, 1.0_f64);
    for (claims, quantile) in &all {
        let (mut here, mut hits) = (0, 0);
        for (pixel, claim) in claims.iter().enumerate() {
            let error = (claim.value - truth(pixel)).abs();
            by_noise += u64::from(error <= quantile * claim.standard_error);
            here += u64::from(claim.flags.is_empty());
            hits += u64::from(claim.flags.is_empty() && error <= claim.half_width);
        }
        claimed += here;
        covered += hits;
        if here > 0 {
            worst = worst.min(hits as f64 / here as f64);
        }
    }
    let mut ratios: Vec<f64> = (0..count)
        .filter_map(|pixel| {
            let mean_square = all.iter().map(|(claims, _)| (claims[pixel].value - truth(pixel)).powi(2)).sum::<f64>();
            let root = (mean_square / all.len() as f64).sqrt();
            let widths: Vec<f64> =
                all.iter().map(|(claims, _)| claims[pixel].half_width).filter(|width| width.is_finite()).collect();
            let mean = widths.iter().sum::<f64>() / widths.len() as f64;
            (!widths.is_empty() && root > 0.0).then_some(mean / root)
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    let pixels = (count * all.len()).max(1) as f64;
    Claims {
        claimed: claimed as f64 / pixels,
        covered: covered as f64 / claimed.max(1) as f64,
        worst,
        by_noise: by_noise as f64 / pixels,
        sharpness: ratios.get(ratios.len() / 2).copied().unwrap_or(0.0),
    }
}

/// The slope of `y` over `x` in logarithms, by least squares, and its standard error.
pub(crate) fn slope(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let sxx: f64 = logs.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let slope = logs.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>() / sxx;
    let rest: f64 = logs.iter().map(|p| (p.1 - my - slope * (p.0 - mx)).powi(2)).sum();
    (slope, (rest / (n - 2.0).max(1.0) / sxx).sqrt())
}

/// The Pareto front of time and error, from the fastest point on.
pub(crate) fn pareto(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0).then(points[a].1.total_cmp(&points[b].1)));
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i].1 < least;
        least = least.min(points[i].1);
        better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_found_and_the_front_is_what_nothing_beats() {
        let (slope, error) = slope(&[(1.0, 2.0), (8.0, 0.5), (64.0, 0.125)]);
        assert!((slope + 2.0 / 3.0).abs() < 1e-12 && error < 1e-9);
        assert_eq!(pareto(&[(2.0, 1.0), (1.0, 3.0), (3.0, 2.0), (2.0, 4.0), (4.0, 0.5)]), [1, 0, 4]);
    }

    #[test]
    fn bias_and_variance_come_apart() {
        let run = |value: f64| Run { grey: vec![value], claims: None, passes: 1, seconds: 1.0, photons: 10 };
        let summary = summarise(&[run(1.0), run(1.2), run(1.4)], &Truth::constant(1.0));
        // Variance 0.04; the mean is 0.2 off, of which a third of 0.04 is noise.
        let unit = 1.01;
        assert!((summary.variance * unit - 0.04).abs() < 1e-12, "{summary:?}");
        assert!((summary.bias * unit - (0.04 - 0.04 / 3.0)).abs() < 1e-12, "{summary:?}");
        assert!((summary.error * unit - (0.04 + 0.16) / 3.0).abs() < 1e-12 && summary.claims.is_none());
    }

    #[test]
    fn a_claim_that_is_wrong_is_not_covered() {
        let claim = |value: f64, half_width: f64| ConfidenceInterval {
            photons: 1000.0,
            bounded: 0.0,
            value,
            standard_error: 0.01,
            bias: 0.0,
            bias_error: 0.0,
            half_width,
            flags: photon_core::Flags::default(),
            allowed: photon_core::Flags::default(),
        };
        let run = |claim| Run { grey: vec![1.0], claims: Some(vec![claim]), passes: 9, seconds: 1.0, photons: 1 };
        let details = claims(&[run(claim(1.1, 0.2)), run(claim(0.9, 0.05))], &|_| 1.0);
        assert_eq!((details.claimed, details.covered, details.worst, details.by_noise), (1.0, 0.5, 0.0, 0.0));
        assert!((details.sharpness - 1.25).abs() < 1e-9);
    }
}
