//! Errors of several runs of one setting.

use photon_core::Film;

use crate::truth::Truth;

/// One run.
pub(crate) struct Run {
    pub(crate) film: Film,
    pub(crate) seconds: f64,
    pub(crate) photons: u64,
}

/// What runs with different seeds have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Summary {
    /// Median seconds of the passes.
    pub(crate) seconds: f64,
    /// Paths emitted by each run.
    pub(crate) photons: u64,
    /// Mean over pixels and runs of `(x − y)²/(y² + ȳ²/100)`.
    pub(crate) error: f64,
    /// Its standard error over runs.
    pub(crate) error_error: f64,
    /// The part of it that the mean of all runs has too; what is left of the variance is taken off.
    pub(crate) bias: f64,
    /// The part that runs differ by.
    pub(crate) variance: f64,
    /// Claims, if errors were told.
    pub(crate) claims: Option<Claims>,
}

/// How claims did.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Claims {
    /// Share of the pixels of which something is claimed.
    pub(crate) claimed: f64,
    /// Share of these whose truth is within the claim.
    pub(crate) covered: f64,
    /// Lowest share of one run.
    pub(crate) worst: f64,
    /// Median of claim over the root mean square of the pixel's errors.
    pub(crate) sharpness: f64,
}

/// Errors of runs that differ by their seeds.
pub(crate) fn summarise(runs: &[Run], truth: &Truth) -> Summary {
    let pictures: Vec<Vec<f64>> = runs.iter().map(|run| grey(&run.film)).collect();
    let count = pictures.first().map_or(0, Vec::len);
    let (n, floor) = (runs.len() as f64, truth.floor(count));
    let weight = |pixel: usize| 1.0 / ((truth.at(pixel).powi(2) + floor) * count as f64);
    let errors: Vec<f64> = pictures
        .iter()
        .map(|x| x.iter().enumerate().map(|(pixel, x)| weight(pixel) * (x - truth.at(pixel)).powi(2)).sum())
        .collect();
    let (mut bias, mut variance) = (0.0, 0.0);
    for pixel in 0..count {
        let mean = pictures.iter().map(|x| x[pixel]).sum::<f64>() / n;
        let spread = pictures.iter().map(|x| (x[pixel] - mean).powi(2)).sum::<f64>() / (n - 1.0);
        variance += weight(pixel) * spread;
        bias += weight(pixel) * ((mean - truth.at(pixel)).powi(2) - spread / n);
    }
    let error = errors.iter().sum::<f64>() / n;
    let mut seconds: Vec<f64> = runs.iter().map(|run| run.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    let spread = errors.iter().map(|e| (e - error).powi(2)).sum::<f64>() / (n - 1.0);
    Summary {
        seconds: seconds[seconds.len() / 2],
        photons: runs.first().map_or(0, |run| run.photons),
        error,
        error_error: (spread / n).sqrt(),
        bias,
        variance,
        claims: claims(runs, truth),
    }
}

fn grey(film: &Film) -> Vec<f64> {
    film.beauty().iter().map(|c| c.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0).collect()
}

fn claims(runs: &[Run], truth: &Truth) -> Option<Claims> {
    let all: Vec<_> = runs.iter().filter_map(|run| run.film.claims()).collect();
    let count = all.first()?.len();
    let (mut claimed, mut covered, mut worst) = (0, 0, 1.0_f64);
    for claims in &all {
        let standing = || claims.iter().enumerate().filter(|(_, claim)| claim.flags.is_empty());
        let hits =
            standing().filter(|(pixel, claim)| (claim.value - truth.at(*pixel)).abs() <= claim.half_width).count();
        let here = standing().count();
        claimed += here;
        covered += hits;
        worst = worst.min(hits as f64 / here.max(1) as f64);
    }
    let mut ratios: Vec<f64> = (0..count)
        .filter_map(|pixel| {
            let mean_square = all.iter().map(|claims| (claims[pixel].value - truth.at(pixel)).powi(2)).sum::<f64>();
            let root = (mean_square / all.len() as f64).sqrt();
            let widths: Vec<f64> =
                all.iter().map(|claims| claims[pixel].half_width).filter(|width| width.is_finite()).collect();
            let mean = widths.iter().sum::<f64>() / widths.len() as f64;
            (!widths.is_empty() && root > 0.0).then_some(mean / root)
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    Some(Claims {
        claimed: claimed as f64 / (count * all.len()) as f64,
        covered: covered as f64 / claimed.max(1) as f64,
        worst,
        sharpness: ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN),
    })
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

/// Which of the points no other beats in both time and error, from the fastest on.
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
        let film = |value: f64| {
            let mut film = Film::new(1, 1, photon_core::Units::default()).unwrap();
            film.pixels[0].layers[0] = [value; 3];
            film.passes = 1;
            Run { film, seconds: 1.0, photons: 10 }
        };
        let summary = summarise(&[film(1.0), film(1.2), film(1.4)], &Truth::Constant(1.0));
        // Variance 0.04; the mean is 0.2 off, of which a third of 0.04 is chance.
        let unit = 1.01;
        assert!((summary.variance * unit - 0.04).abs() < 1e-6, "{summary:?}");
        assert!((summary.bias * unit - (0.04 - 0.04 / 3.0)).abs() < 1e-6, "{summary:?}");
        assert!((summary.error * unit - (0.04 + 0.16) / 3.0).abs() < 1e-6 && summary.claims.is_none());
    }
}
