//! The errors of the paper's formulas, predicted and measured, compared with those of the defaults.

use photon_core::glam::Vec3;
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{
    Backend, Estimate, EstimateParams, IndexKind, Photon, Query, RandomKind, Result, Search, octahedral, sampling,
};

/// One error.
#[derive(Debug)]
pub(crate) struct Bias {
    pub(crate) what: &'static str,
    /// Ratio to the true value, or a correlation.
    pub(crate) predicted: f64,
    /// Result of the paper's formula, and its standard error.
    pub(crate) paper: (f64, f64),
    /// Result of the default, and its standard error.
    pub(crate) ours: (f64, f64),
    /// Expected result of the default.
    pub(crate) truth: f64,
}

impl Bias {
    /// Whether both agree with the expected values within 4.5 standard errors.
    pub(crate) fn is_as_predicted(&self) -> bool {
        let near = |(seen, error): (f64, f64), wanted: f64| (seen - wanted).abs() <= 4.5 * error;
        near(self.paper, self.predicted) && near(self.ours, self.truth)
    }
}

/// Number of photons on the square.
const PHOTONS: u32 = 100_000;
/// Queries along a side, and their distance from the edges; the square's side is 1.
const SIDE: u32 = 16;
const MARGIN: f32 = 0.1;
/// Number of independent sets of photons.
const FIELDS: u32 = 4;

/// Measures all of them, on one backend.
pub(crate) fn all<B: Backend>(on: &mut B) -> Result<Vec<Bias>> {
    let paper = |max, threshold| Search::Paper { max, threshold, factor: 1.0 };
    // Radius of a disc that contains that many photons on average.
    let radius = |mean: f64| (mean / (f64::from(PHOTONS) * std::f64::consts::PI)).sqrt() as f32;
    let mut found = Vec::new();
    let mut compare = |what, predicted, slanted, searches: [Search; 2], radius| -> Result<()> {
        let [paper, ours] = searches.map(|search| ratio(on, search, slanted, radius));
        found.push(Bias { what, predicted, paper: paper?, ours: ours?, truth: 1.0 });
        Ok(())
    };
    let wide = radius(100.0);
    compare("extra cosine under uniform light: 2/3", 2.0 / 3.0, true, [paper(100_000, 0), Search::Radius], wide)?;
    let ten = [paper(10, 0), Search::KNearest { k: 10 }];
    compare("k/(π r²) with r to the k-th, k = 10: k/(k−1)", 10.0 / 9.0, false, ten, radius(100.0))?;
    let two_hundred = [paper(200, 0), Search::KNearest { k: 200 }];
    compare("the same, k = 200", 200.0 / 199.0, false, two_hundred, radius(800.0))?;
    compare("fewer than 8 give 0, mean 8", too_few(8, 8.0), false, [paper(100_000, 8), Search::Radius], radius(8.0))?;
    let correlations = [RandomKind::Lcg, RandomKind::Counter].map(correlation);
    let [paper, ours] = correlations;
    found.push(Bias {
        what: "correlation of the first numbers of neighbouring threads (LCG)",
        predicted: {
            // Neighbouring paths are one step apart, a/2³¹ of the period; the correlation
            // of a uniform number with itself shifted by this fraction c is 1 − 6c(1 − c).
            let apart = 1_103_515_245.0 / f64::from(1_u32 << 31);
            1.0 - 6.0 * apart * (1.0 - apart)
        },
        paper,
        ours,
        truth: 0.0,
    });
    Ok(found)
}

/// Fraction of the mean that remains if a Poisson number below `threshold` counts as 0:
/// `E[X; X ≥ t] / E[X] = P(X ≥ t − 1)`.
fn too_few(threshold: u32, mean: f64) -> f64 {
    let mut term = (-mean).exp();
    let mut below = 0.0;
    for n in 0..threshold - 1 {
        below += term;
        term *= mean / f64::from(n + 1);
    }
    1.0 - below
}

/// Irradiance relative to the truth, mean and standard error, in sets of uniform density; with light from all
/// directions equally if `slanted`, else perpendicular.
fn ratio<B: Backend>(on: &mut B, search: Search, slanted: bool, radius: f32) -> Result<(f64, f64)> {
    let query = |i: u32| {
        let at = |n: u32| MARGIN + (1.0 - 2.0 * MARGIN) * (n as f32 + 0.5) / SIDE as f32;
        let position = [at(i % SIDE), at(i / SIDE), 0.0];
        Query { position, radius, normal: [0.0, 0.0, 1.0], throughput: [1.0; 3], ..Query::default() }
    };
    let queries: Vec<Query> = (0..SIDE * SIDE).map(query).collect();
    let gather = EstimateParams { min_normal_cosine: 0.7, ..EstimateParams::new(search) };
    let mut stages = on.map_stages(IndexKind::Median)?;
    let queries = on.upload("queries", &queries)?;
    let mut estimates = on.alloc::<Estimate>("estimates", u64::from(SIDE * SIDE))?;
    let mut values = Vec::new();
    for field in 0..FIELDS {
        let photons = on.upload("photons", &photons(field, slanted))?;
        let map = stages.builder.build(on, photons)?;
        stages.estimator.estimate(on, &map, &queries, &gather, &mut estimates)?;
        let mut found = Vec::new();
        on.download(&estimates, &mut found)?;
        values.extend(found.iter().map(|e| e.irradiance(u64::from(PHOTONS))[0]));
    }
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    Ok((mean, (variance / n).sqrt()))
}

/// Photons of unit total power, uniformly random on the unit square.
fn photons(field: u32, slanted: bool) -> Vec<Photon> {
    let up = octahedral::pack(Vec3::Z);
    (0..PHOTONS)
        .map(|i| {
            let mut sampler = Sampler::new(RandomKind::Counter, 2010, field, Domain::Photon, i);
            let [x, y, u, v] = sampler.words(0).map(unit_f32);
            // Lambert: the number of photons per direction is proportional to its cosine.
            let towards = if slanted { sampling::cosine_hemisphere(Vec3::Z, u, v) } else { Vec3::Z };
            Photon { position: [x, y, 0.0], direction: octahedral::pack(towards), power: [1.0; 3], normal: up }
        })
        .collect()
}

/// Correlation between the first random numbers of neighbouring paths, and the standard error that it would
/// have if they were independent.
fn correlation(kind: RandomKind) -> (f64, f64) {
    const PATHS: u32 = 1 << 20;
    let first = |path| f64::from(unit_f32(Sampler::new(kind, 0, 0, Domain::Photon, path).words(0)[0]));
    // The mean and variance of uniform numbers between 0 and 1 are known.
    let sum: f64 = (0..PATHS).map(|path| (first(path) - 0.5) * (first(path + 1) - 0.5)).sum();
    let n = f64::from(PATHS);
    (sum / n * 12.0, 1.0 / n.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_formulas_err_as_predicted_and_the_defaults_do_not() {
        check(&mut backend_cpu::Cpu::new().unwrap());
        if let Some(mut on) = backend_vulkan::low_level::for_tests() {
            check(&mut on);
        }
    }

    fn check<B: Backend>(on: &mut B) {
        for bias in all(on).unwrap() {
            assert!(bias.is_as_predicted(), "{bias:?}");
            // A comparison that cannot distinguish the two proves nothing.
            let mistaken = Bias { predicted: bias.truth, truth: bias.predicted, ..bias };
            let weak = mistaken.what.contains("200");
            assert!(weak || !mistaken.is_as_predicted(), "{mistaken:?}");
        }
    }

    #[test]
    fn the_threshold_takes_what_the_paper_says() {
        assert!((too_few(8, 8.0) - 0.687).abs() < 1e-3);
        assert_eq!(too_few(1, 3.0), 1.0);
    }
}
