//! Confidence intervals and convergence rates in fields with an exactly known result, those of the test suite.

use photon_core::{Film, TransportBackend, inverse_radius_squared_sum, radius_squared_sum};
use photon_tests::fields::{BROKEN, EDGES, Field, SMOOTH, Trial, film_of, films_of, judge};
use photonmap_cli::fault::Fault;

use crate::engine::Work;
use crate::measure::slope;
use crate::records::{Claims, FieldRow, RateRow};

const THIRDS: f64 = 2.0 / 3.0;

/// The intervals of each field, and whether they hold.
pub(crate) struct FieldClaims {
    /// Number of films of each field, with different seeds.
    pub(crate) films: u32,
    /// Pixels along a side of each film.
    pub(crate) side: u32,
}

impl Work for FieldClaims {
    type Output = Vec<FieldRow>;

    fn on<B: TransportBackend>(self, on: &mut B) -> Result<Vec<FieldRow>, Fault> {
        let mut rows = Vec::new();
        let fields =
            || SMOOTH.iter().chain(&EDGES).map(|field| (field, false)).chain(BROKEN.iter().map(|field| (field, true)));
        for (passes, alpha) in [(16, THIRDS), (64, THIRDS), (64, 1.0)] {
            for (number, (field, broken)) in fields().enumerate() {
                let films = (0..self.films)
                    .map(|film| {
                        let seed = u64::from(film) * 1000 + number as u64 + u64::from(passes) * 100_000_000;
                        film_of(on, field, &Trial { passes, alpha, side: self.side, seed })
                    })
                    .collect::<photon_core::Result<Vec<Film>>>()?;
                let verdict = judge(field, &films);
                rows.push(FieldRow {
                    field: field.name.to_owned(),
                    broken,
                    passes,
                    alpha,
                    films: self.films,
                    pixels: self.side * self.side,
                    claims: Claims {
                        claimed: verdict.claimed,
                        covered: verdict.covered,
                        worst: verdict.covered,
                        by_noise: verdict.covered_by_noise,
                        sharpness: if verdict.claimed > 0.0 { verdict.sharpness } else { 0.0 },
                    },
                });
            }
            crate::progress(&format!("fields after {passes} passes, α = {alpha:.2}"));
        }
        Ok(rows)
    }
}

/// How errors fall with passes: fitted, and in theory for the same passes.
pub(crate) struct Rates {
    /// Pixels along a side.
    pub(crate) side: u32,
    /// Largest number of passes; where radii shrink, the smallest is a 32nd of it.
    pub(crate) most: u32,
}

impl Work for Rates {
    type Output = Vec<RateRow>;

    fn on<B: TransportBackend>(self, on: &mut B) -> Result<Vec<RateRow>, Fault> {
        let mut rows = Vec::new();
        // Constant radii follow their law from the first pass on, and cost more.
        let cases = [
            (&SMOOTH[0], THIRDS, self.most),
            (&SMOOTH[0], 1.0, self.most / 16),
            (&SMOOTH[3], THIRDS, self.most),
            (&SMOOTH[3], 1.0, self.most / 16),
        ];
        for (field, alpha, most) in cases {
            let mut after: Vec<u32> = (0..6).rev().map(|half| (most >> half).max(1)).collect();
            after.dedup();
            let mut values: Vec<Vec<f64>> = Vec::new();
            let trial = Trial { passes: most, alpha, side: self.side, seed: 7_000_000 };
            films_of(on, field, &trial, &after, &mut |film| {
                let truth = (field.at)(0.0, 0.0);
                values.push(
                    film.confidence_intervals().unwrap_or_default().iter().map(|claim| claim.value - truth).collect(),
                );
            })?;
            crate::progress(&format!("rates: {}, α = {alpha:.2}", field.name));
            rows.extend(of_field(field, alpha, &after, &values));
        }
        Ok(rows)
    }
}

/// Mean squared bias and variance of errors that are due to noise.
fn parts(errors: &[f64]) -> (f64, f64) {
    let n = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let variance = errors.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean * mean - variance / n, variance)
}

fn of_field(field: &Field, alpha: f64, after: &[u32], values: &[Vec<f64>]) -> Vec<RateRow> {
    let of_n = |of: &dyn Fn(u32, f64) -> f64| -> Vec<(f64, f64)> {
        after.iter().map(|&passes| (f64::from(passes), of(passes, f64::from(passes)))).collect()
    };
    // The rate of such a field, if noise and bias follow the theory from the smallest number of passes on.
    let variance = of_n(&|passes, n| inverse_radius_squared_sum(passes, alpha) / (n * n));
    let bias = of_n(&|passes, n| (radius_squared_sum(passes, alpha) / n).powi(2));
    let (b, v) = parts(&values[0]);
    let both: Vec<(f64, f64)> =
        variance.iter().zip(&bias).map(|(w, c)| (w.0, v * w.1 / variance[0].1 + b * c.1 / bias[0].1)).collect();
    let mut rows = Vec::new();
    let mut row = |of: &str, part: &dyn Fn(&[f64]) -> f64, theory: &[(f64, f64)]| {
        let points: Vec<(f64, f64)> =
            after.iter().zip(values).map(|(&passes, errors)| (f64::from(passes), part(errors))).collect();
        rows.push(RateRow {
            field: field.name.to_owned(),
            alpha,
            of: of.to_owned(),
            from: after[0],
            to: after[after.len() - 1],
            slope: slope(&points).0,
            error: jackknife(after, values, part),
            theory: slope(theory).0,
            points,
        });
    };
    row("variance", &|errors| parts(errors).1, &variance);
    if field.name != SMOOTH[0].name {
        row("bias²", &|errors| parts(errors).0.max(f64::MIN_POSITIVE), &bias);
        row(
            "both",
            &|errors| {
                let (bias, variance) = parts(errors);
                bias + variance
            },
            &both,
        );
    }
    rows
}

/// The standard error of a slope, by a jackknife over sixteenths of the pixels (Tukey 1958): results after
/// more passes contain the photons of those after fewer, so that residuals underestimate the error.
fn jackknife(after: &[u32], values: &[Vec<f64>], part: &dyn Fn(&[f64]) -> f64) -> f64 {
    const BLOCKS: usize = 16;
    let slopes: Vec<f64> = (0..BLOCKS)
        .map(|block| {
            let points: Vec<(f64, f64)> = after
                .iter()
                .zip(values)
                .map(|(&passes, errors)| {
                    let rest: Vec<f64> =
                        errors.iter().enumerate().filter(|(i, _)| i % BLOCKS != block).map(|(_, &e)| e).collect();
                    (f64::from(passes), part(&rest))
                })
                .collect();
            slope(&points).0
        })
        .collect();
    let mean = slopes.iter().sum::<f64>() / BLOCKS as f64;
    let squares: f64 = slopes.iter().map(|slope| (slope - mean).powi(2)).sum();
    (squares * (BLOCKS - 1) as f64 / BLOCKS as f64).sqrt()
}
