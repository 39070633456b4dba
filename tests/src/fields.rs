//! Analytic light fields whose truth is known, and films of them.
//!
//! Each pixel is one query in a Poisson field of its own, far enough from its neighbours to be independent of them,
//! so that pixels are independent trials. Lengths are in radii of the first pass, in which 20 photons are expected
//! where the field is 1; radii shrink with α = 2/3 or stay constant.

use std::f64::consts::PI;

use photon_core::{
    ConfidenceInterval, ErrorMoments, Estimate, EstimateParams, Film, IndexKind, Kernel, Layer, MapKind, MapStages,
    Photon, Query, Result, Search, TransportBackend, Units, radius_squared_factor,
};
use photon_scene::{MaterialDesc, SceneBuilder};

use crate::harness::{Uniform, photon_at, query_at};
use crate::stats::moments;

/// An irradiance field around the origin, where the truth is evaluated; both coordinates within ±1.5.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Name for messages.
    pub name: &'static str,
    /// The field's value at (x, y).
    pub at: fn(f64, f64) -> f64,
    /// An upper bound on its values.
    pub most: f64,
}

fn bump(x: f64, y: f64, sigma: f64) -> f64 {
    (-(x * x + y * y) / (2.0 * sigma * sigma)).exp()
}

fn lit(yes: bool) -> f64 {
    f64::from(u8::from(yes))
}

/// `x^(−1/2)` beyond a fold at distance `d`, normalised to 1 at the origin; clamped to 12.
fn fold(x: f64, d: f64) -> f64 {
    if x <= -d { 0.0 } else { (d / (x + d)).sqrt().min(12.0) }
}

/// Fields where intervals must be claimed and must hold.
pub const SMOOTH: [Field; 5] = [
    Field { name: "uniform", at: |_, _| 1.0, most: 1.0 },
    Field { name: "slope", at: |x, _| (1.0 + 0.5 * x).max(0.0), most: 1.75 },
    Field { name: "bump of 1.5", at: |x, y| bump(x, y, 1.5), most: 1.0 },
    Field { name: "bump of 0.7", at: |x, y| bump(x, y, 0.7), most: 1.0 },
    Field { name: "side of a bump", at: |x, y| bump(x + 1.5, y, 1.5) / bump(1.5, 0.0, 1.5), most: 1.65 },
];

/// Fields with an edge within the radius, where wider intervals are claimed and must hold.
pub const EDGES: [Field; 5] = [
    Field { name: "edge at 0", at: |x, _| lit(x > 0.0), most: 1.0 },
    Field { name: "edge at 0.05", at: |x, _| lit(x > -0.05), most: 1.0 },
    Field { name: "edge at 0.15", at: |x, _| lit(x > -0.15), most: 1.0 },
    Field { name: "edge at 0.3", at: |x, _| lit(x > -0.3), most: 1.0 },
    Field { name: "dark, edge at 0.05", at: |x, _| lit(x > 0.05), most: 1.0 },
];

/// Fields where no intervals may be claimed.
pub const BROKEN: [Field; 4] = [
    Field { name: "dark, edge at 0.3", at: |x, _| lit(x > 0.3), most: 1.0 },
    Field { name: "fold at 0.2", at: |x, _| fold(x, 0.2), most: 12.0 },
    Field { name: "fold at 0.5", at: |x, _| fold(x, 0.5), most: 12.0 },
    Field { name: "corner of light", at: |x, y| lit(x > -0.2 && y > -0.2), most: 1.0 },
];

/// Expected number of photons within the first radius where the field is 1.
pub const EXPECTED: f64 = 20.0;

/// Parameters of one film of a field.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Number of passes, ≥ 1.
    pub passes: u32,
    /// Parameter α of the radius reduction.
    pub alpha: f64,
    /// Pixels along a side.
    pub side: u32,
    /// Seed of the photons.
    pub seed: u64,
}

impl Trial {
    /// Distance between pixels; all of them are within half a unit of the origin.
    fn step(&self) -> f64 {
        0.96 / f64::from(self.side)
    }

    /// Radius of the first pass: pixels are more than 2√2 times this apart.
    fn radius(&self) -> f64 {
        0.3 * self.step()
    }

    fn place(&self, pixel: u32) -> [f64; 2] {
        [pixel % self.side, pixel / self.side].map(|i| (f64::from(i) - 0.5 * f64::from(self.side - 1)) * self.step())
    }

    /// Photons of one pass: around each pixel, a Poisson process of the field's density, as far as √2 times the
    /// radius, which is `shrink` times the first. No query reads photons farther away.
    fn photons(&self, field: &Field, shrink: f64, uniform: &mut Uniform) -> Vec<Photon> {
        let (half, radius) = (1.42 * shrink, self.radius());
        let mean = EXPECTED / PI * 4.0 * half * half * field.most;
        let mut photons = Vec::new();
        for pixel in 0..self.side * self.side {
            let [cx, cy] = self.place(pixel);
            // Poisson arrivals at unit rate until `mean`.
            let mut time = -(1.0 - uniform.draw()).ln();
            while time < mean {
                let (x, y) = (half * (2.0 * uniform.draw() - 1.0), half * (2.0 * uniform.draw() - 1.0));
                if uniform.draw() * field.most < (field.at)(x, y) {
                    photons.push(photon_at([(cx + x * radius) as f32, (cy + y * radius) as f32, 0.0]));
                }
                time -= (1.0 - uniform.draw()).ln();
            }
        }
        photons
    }
}

/// Renders the film of a trial, in units of the field's density.
///
/// # Errors
/// Any error of the backend.
pub fn film_of<B: TransportBackend>(on: &mut B, field: &Field, trial: &Trial) -> Result<Film> {
    let mut last = None;
    films_of(on, field, trial, &[trial.passes], &mut |film| last = Some(film))?;
    Ok(last.unwrap())
}

/// As [`film_of`], but passes the film to `show` after each of the passes in `after`, which are in ascending order.
///
/// # Errors
/// Any error of the backend.
pub fn films_of<B: TransportBackend>(
    on: &mut B,
    field: &Field,
    trial: &Trial,
    after: &[u32],
    show: &mut dyn FnMut(Film),
) -> Result<()> {
    let mut builder = SceneBuilder::new();
    let white = builder.material(MaterialDesc::lambert("white", [1.0; 3]));
    builder.quad("floor", [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]], white);
    let scene = builder.build().unwrap();
    let (count, radius) = (trial.side * trial.side, trial.radius());
    let mut there = on.film(scene.units(), trial.side, trial.side)?;
    on.keep_errors(&mut there)?;
    let queries: Vec<Query> = (0..count)
        .map(|pixel| {
            let [x, y] = trial.place(pixel);
            Query { pixel, ..query_at([x as f32, y as f32, 0.0], radius as f32) }
        })
        .collect();
    let queries = on.upload("queries", &queries)?;
    let mut estimates = on.alloc::<Estimate>("estimates", u64::from(count))?;
    let mut error_moments = on.alloc::<ErrorMoments>("spreads", u64::from(count))?;
    let MapStages { mut builder, mut estimator } = on.map_stages(IndexKind::Morton)?;
    let mut uniform = Uniform::new(trial.seed);
    for pass in 0..trial.passes {
        let shrink = radius_squared_factor(pass, trial.alpha).sqrt();
        let gather = EstimateParams {
            kernel: Kernel::Epanechnikov,
            radius_scale: shrink as f32,
            min_normal_cosine: 0.7,
            ..EstimateParams::new(Search::Radius)
        };
        let photons = on.upload("photons", &trial.photons(field, shrink, &mut uniform))?;
        let map = builder.build(on, photons)?;
        estimator.estimate_with_moments(on, &map, &queries, &gather, &mut estimates, &mut error_moments)?;
        on.accumulate(&mut there, Layer::Indirect, &queries, &estimates, 1)?;
        on.accumulate_errors(&mut there, MapKind::Global, &queries, &estimates, &error_moments, 1)?;
        on.end_pass(&mut there)?;
        if after.contains(&(pass + 1)) {
            let mut film = on.read_film(&there)?;
            film.units = Units { power: PI * radius * radius / EXPECTED, ..Units::default() };
            show(film);
        }
    }
    Ok(())
}

/// How the confidence intervals of one field compare with the truth.
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// Fraction of the pixels for which an interval is claimed.
    pub claimed: f64,
    /// Fraction of these whose truth is within the interval.
    pub covered: f64,
    /// Fraction of all pixels whose truth is within the interval that noise alone would give.
    pub covered_by_noise: f64,
    /// Median half-width over the root mean squared error.
    pub sharpness: f64,
}

/// Evaluates films of the same field.
#[must_use]
pub fn judge(field: &Field, films: &[Film]) -> Verdict {
    let truth = (field.at)(0.0, 0.0);
    let all: Vec<ConfidenceInterval> = films.iter().flat_map(|film| film.confidence_intervals().unwrap()).collect();
    let quantile = photon_core::student_975(f64::from(films[0].passes) - 1.0);
    let error = |interval: &ConfidenceInterval| (interval.value - truth).abs();
    let claimed: Vec<&ConfidenceInterval> = all.iter().filter(|interval| interval.flags.is_empty()).collect();
    let squares: Vec<f64> = claimed.iter().map(|interval| error(interval).powi(2)).collect();
    let mut widths: Vec<f64> = claimed.iter().map(|interval| interval.half_width).collect();
    widths.sort_by(f64::total_cmp);
    let share = |count: usize, of: usize| count as f64 / of.max(1) as f64;
    Verdict {
        claimed: share(claimed.len(), all.len()),
        covered: share(claimed.iter().filter(|interval| error(interval) <= interval.half_width).count(), claimed.len()),
        covered_by_noise: share(
            all.iter().filter(|interval| error(interval) <= quantile * interval.standard_error).count(),
            all.len(),
        ),
        sharpness: widths.get(widths.len() / 2).map_or(f64::NAN, |&width| width / moments(&squares).0.sqrt()),
    }
}
