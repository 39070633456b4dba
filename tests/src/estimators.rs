//! A: density estimation in fields of known density.

use photon_core::{EstimateParams, IndexKind, Kernel, Photon, Search, radius_squared_factor};
use std::f64::consts::PI;

use crate::harness::{TestBackend, Uniform, estimate, estimates, estimates_on, photon_at, query_at};
use crate::stats::{SIGMAS, assert_agrees, moments};

const INDICES: [IndexKind; 3] = [IndexKind::Median, IndexKind::Vvh, IndexKind::Morton];

/// A Poisson process of `density` on the unit square around the origin: arrivals along x, uniform in y.
#[must_use]
pub fn poisson(density: f64, seed: u64) -> Vec<Photon> {
    let mut uniform = Uniform::new(seed);
    let mut photons = Vec::new();
    let mut x = 0.0;
    loop {
        x -= (1.0 - uniform.draw()).ln() / density;
        if x >= 1.0 {
            return photons;
        }
        let y = uniform.draw();
        photons.push(photon_at([(x - 0.5) as f32, (y - 0.5) as f32, 0.0]));
    }
}

fn gather(search: Search, kernel: Kernel) -> EstimateParams {
    EstimateParams { kernel, min_normal_cosine: 0.7, ..EstimateParams::new(search) }
}

/// Estimates divided by the truth at 256 positions, far enough apart to be independent, in `fields` fields, for each of several
/// sets of parameters.
fn relative<T: TestBackend>(
    kind: IndexKind,
    density: f64,
    radius: f32,
    fields: u64,
    gathers: &[EstimateParams],
) -> Vec<Vec<f64>> {
    let queries: Vec<_> = (0..256)
        .map(|i| query_at([(i % 16) as f32 * 0.05 - 0.375, (i / 16) as f32 * 0.05 - 0.375, 0.0], radius))
        .collect();
    let mut values = vec![Vec::new(); gathers.len()];
    for field in 0..fields {
        let photons = poisson(density, 1000 + field);
        for (values, found) in values.iter_mut().zip(estimates::<T>(kind, &photons, &queries, gathers)) {
            values.extend(found.iter().map(|e| e.irradiance(1)[0] / density));
        }
    }
    values
}

const DENSITY: f64 = 40_000.0;

/// Checks mean and variance. The standard error of the mean is `√(variance/n)`; that of the variance is about
/// `variance·√(3/n)` for distributions with somewhat heavier tails than the normal one.
fn check(what: &str, values: &[f64], mean: f64, variance: f64) {
    let n = values.len() as f64;
    let (m, v) = moments(values);
    assert_agrees(what, m, mean, (variance / n).sqrt(), 0.0);
    assert_agrees(&format!("{what}, variance"), v, variance, variance * (3.0 / n).sqrt(), 0.0);
}

/// A1: the naive k/(π r²), which the paper uses, is too bright by a factor of k/(k−1).
pub fn a1_naive_knn_is_too_bright<T: TestBackend>() {
    let counts = [5_u32, 10, 50];
    let naive = |max| gather(Search::Paper { max, threshold: 0, factor: 1.0 }, Kernel::Constant);
    let found = relative::<T>(IndexKind::Median, DENSITY, 0.5, 12, &counts.map(naive));
    for (k, values) in counts.into_iter().zip(found) {
        let k = f64::from(k);
        let variance = (k / (k - 1.0)).powi(2) / (k - 2.0);
        let error = (variance / values.len() as f64).sqrt();
        assert_agrees("naive", moments(&values).0, k / (k - 1.0), error, 0.0);
    }
}

/// A2: (k−1)/(π r²) is unbiased, with relative variance 1/(k−2), in every index.
pub fn a2_corrected_knn_is_unbiased<T: TestBackend>() {
    let counts = [10_u32, 50, 100];
    for kind in INDICES {
        let gathers = counts.map(|k| gather(Search::KNearest { k }, Kernel::Constant));
        for (k, values) in counts.into_iter().zip(relative::<T>(kind, DENSITY, 0.5, 8, &gathers)) {
            check(&format!("{kind:?} k={k}"), &values, 1.0, 1.0 / (f64::from(k) - 2.0));
        }
    }
}

/// A3: without the k-th photon, whose weight is 0, Epanechnikov's kernel is unbiased.
pub fn a3_kernel_in_knn_is_unbiased<T: TestBackend>() {
    let gather = gather(Search::KNearest { k: 50 }, Kernel::Epanechnikov);
    let values = relative::<T>(IndexKind::Morton, DENSITY, 0.5, 8, &[gather]);
    check("k = 50", &values[0], 1.0, 4.0 / 3.0 / 48.0);
}

/// A6: within a fixed radius h, the mean is the density and the relative variance `R(K)/(λ h²)`.
pub fn a6_fixed_radius_mean_and_variance<T: TestBackend>() {
    let h = 0.02_f64;
    let kernels = [(Kernel::Constant, std::f64::consts::FRAC_1_PI), (Kernel::Epanechnikov, 0.424_413)];
    let gathers = kernels.map(|(kernel, _)| gather(Search::Radius, kernel));
    let found = relative::<T>(IndexKind::Morton, DENSITY, h as f32, 8, &gathers);
    for ((kernel, roughness), values) in kernels.into_iter().zip(found) {
        check(&format!("{kernel:?}"), &values, 1.0, roughness / (DENSITY * h * h));
    }
}

/// One photon in each cell of a fine grid, its power the field's value times the cell's area.
fn grid(cell: f64, half: f64, field: impl Fn(f64, f64) -> f64) -> Vec<Photon> {
    let count = (2.0 * half / cell).round() as i64;
    let at = |i: i64| (i as f64 + 0.5) * cell - half;
    (0..count * count)
        .map(|i| {
            let (x, y) = (at(i % count), at(i / count));
            let power = (field(x, y) * cell * cell) as f32;
            Photon { power: [power; 3], ..photon_at([x as f32, y as f32, 0.0]) }
        })
        .filter(|photon| photon.power[0] > 0.0)
        .collect()
}

/// A7: the bias in a field of constant curvature. The tolerance is that of the grid: 4 N^(−3/4) for N cells in the
/// disc, the uncertainty of the number of lattice points in a circle.
pub fn a7_bias_of_curvature<T: TestBackend>() {
    let (h, cell) = (0.2_f64, 0.000_8);
    let photons = grid(cell, 0.21, |x, y| 1.0 + 0.5 * (x * x + y * y));
    let bound = 4.0 * (PI * h * h / cell / cell).powf(-0.75);
    for (kernel, truth) in [(Kernel::Constant, 1.01), (Kernel::Epanechnikov, 1.006_666_7)] {
        let query = query_at([0.0; 3], h as f32);
        let found = estimate::<T>(IndexKind::Morton, &photons, &[query], &gather(Search::Radius, kernel));
        assert_agrees(&format!("{kernel:?}"), found[0].irradiance(1)[0], truth, 0.0, bound);
    }
}

/// A8 and S24: the light lost beyond an edge.
pub fn a8_loss_at_edges<T: TestBackend>() {
    let (h, cell) = (0.2_f64, 0.000_8);
    let half_plane = grid(cell, 0.42, |x, _| f64::from(u8::from(x > 0.0)));
    let quadrant = grid(cell, 0.24, |x, y| f64::from(u8::from(x > 0.0 && y > 0.0)));
    let bound = 4.0 * (PI * h * h / cell / cell).powf(-0.75);
    let check = |what: &str, photons: &[Photon], cases: &[(Kernel, &[(f64, f64)])]| {
        let at = |&(t, _): &(f64, f64)| query_at([(t * h) as f32, 0.0, 0.0], h as f32);
        let queries: Vec<_> = cases.iter().flat_map(|(_, cases)| cases.iter().map(at)).collect();
        let gathers: Vec<_> = cases.iter().map(|&(kernel, _)| gather(Search::Radius, kernel)).collect();
        let found = estimates::<T>(IndexKind::Median, photons, &queries, &gathers);
        let mut first = 0;
        for (found, (kernel, cases)) in found.iter().zip(cases) {
            assert_eq!(found.len(), queries.len());
            for (estimate, &(t, fraction)) in found[first..].iter().zip(*cases) {
                let what = format!("{what} {t}, {kernel:?}");
                assert_agrees(&what, estimate.irradiance(1)[0], fraction, 0.0, bound);
            }
            first += cases.len();
        }
    };
    let flat = [(0.0, 0.5), (0.1, 0.563_556), (0.25, 0.657_481), (0.5, 0.804_499), (0.9, 0.981_307)];
    let round = [(0.0, 0.5), (0.25, 0.705_638), (0.5, 0.873_415), (0.75, 0.973_909)];
    check("edge", &half_plane, &[(Kernel::Constant, &flat), (Kernel::Epanechnikov, &round)]);
    check("corner", &quadrant, &[(Kernel::Constant, &[(0.0, 0.25)])]);
}

/// A9: a ball cuts a cap of area π r² off a sphere, so the estimate is exact. Photons lie on a Fibonacci spiral;
/// their counts in caps of 3125 are within a few dozen.
pub fn a9_no_bias_on_a_sphere<T: TestBackend>() {
    let n = 200_000;
    let at = |i: f64, n: f64| {
        let z = 1.0 - (2.0 * i + 1.0) / n;
        let turns = PI * (1.0 + 5.0_f64.sqrt()) * i;
        let r = (1.0 - z * z).sqrt();
        [(0.5 * r * turns.cos()) as f32, (0.5 * r * turns.sin()) as f32, (0.5 * z) as f32]
    };
    let photons: Vec<_> = (0..n).map(|i| photon_at(at(f64::from(i), f64::from(n)))).collect();
    let queries: Vec<_> = (0..500).map(|i| query_at(at(f64::from(i), 500.0), 0.125)).collect();
    let all = EstimateParams { min_normal_cosine: -1.0, ..gather(Search::Radius, Kernel::Constant) };
    let values: Vec<f64> =
        estimate::<T>(IndexKind::Vvh, &photons, &queries, &all).iter().map(|e| e.irradiance(1)[0]).collect();
    let truth = f64::from(n) / (4.0 * PI * 0.25);
    let (mean, variance) = moments(&values);
    assert_agrees("sphere", mean / truth, 1.0, 0.0, 2e-3);
    assert!(variance.sqrt() / truth < 0.01, "{}", variance.sqrt() / truth);
}

/// A12: after 100 passes with shrinking radii, starting with 20 photons, the standard deviation is 0.0398283; its
/// own relative standard error over 256 queries is `1/√512`.
pub fn a12_progressive_variance<T: TestBackend>() {
    let (r1, photons) = (0.02_f64, 20.0);
    let density = photons / (PI * r1 * r1);
    let mut sums = vec![0.0; 256];
    let mut on = T::make(2);
    for pass in 0..100 {
        let factor = radius_squared_factor(pass, 2.0 / 3.0).sqrt();
        let how = EstimateParams { radius_scale: factor as f32, ..gather(Search::Radius, Kernel::Constant) };
        let field = 5000 + u64::from(pass);
        let queries: Vec<_> = (0..256)
            .map(|i| query_at([(i % 16) as f32 * 0.05 - 0.375, (i / 16) as f32 * 0.05 - 0.375, 0.0], r1 as f32))
            .collect();
        let found = estimates_on(&mut on, IndexKind::Morton, &poisson(density, field), &queries, &[how]).concat();
        for (sum, e) in sums.iter_mut().zip(found) {
            *sum += e.irradiance(1)[0] / density / 100.0;
        }
    }
    let (mean, variance) = moments(&sums);
    assert_agrees("mean", mean, 1.0, 0.039_828_3 / 16.0, 0.0);
    let off = variance.sqrt() / 0.039_828_3 - 1.0;
    assert!(off.abs() <= SIGMAS / 512.0_f64.sqrt(), "{off}");
}

/// A13: "too few photons give 0" darkens: the factor is the fraction of the mean contributed by Poisson counts of
/// at least the threshold. Error of the mean: `√(second moment/n)`, at most `√((m+1)/m/n)`.
pub fn a13_threshold_darkens<T: TestBackend>() {
    for (mean, threshold, share) in
        [(8.0, 8, 0.686_626), (4.0, 8, 0.110_674), (16.0, 8, 0.995_994), (2.0, 4, 0.323_324)]
    {
        let h = (mean / (PI * DENSITY)).sqrt();
        let search = Search::Paper { max: 10_000, threshold, factor: 1.0 };
        let values = relative::<T>(IndexKind::Median, DENSITY, h as f32, 8, &[gather(search, Kernel::Constant)]);
        let error = ((mean + 1.0) / mean / values[0].len() as f64).sqrt();
        assert_agrees("threshold", moments(&values[0]).0, share, error, 0.0);
    }
}
