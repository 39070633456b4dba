//! Claims and rates in fields whose truth is known exactly, those of the test suite.

use std::fmt::Write as _;

use backend_cpu::Cpu;
use backend_vulkan::Vulkan;
use photon_core::{Film, inverse_radius_squared_sum, radius_squared_sum};
use photon_examples::args::BackendName;
use photon_examples::backend::{self, Chosen};
use photon_examples::fault::Fault;
use photon_tests::accuracy::{BROKEN, Field, SMOOTH, field_film, judge};
use photon_tests::harness::TestBackend;

use crate::measure::slope;

struct OnCpu;

impl TestBackend for OnCpu {
    type On = Cpu;
    fn make(threads: usize) -> Cpu {
        Cpu::with_threads(threads).expect("threads start")
    }
}

struct OnVulkan;

impl TestBackend for OnVulkan {
    type On = Vulkan;
    fn make(_threads: usize) -> Vulkan {
        Vulkan::new().expect("it was there a moment ago")
    }
}

/// Both tables; nothing for no films.
pub(crate) fn tables(backend: BackendName, films: u32) -> Result<String, Fault> {
    if films == 0 {
        return Ok(String::new());
    }
    Ok(match backend::open(backend, None)? {
        Chosen::Cpu(_) => claims::<OnCpu>(films) + &rates::<OnCpu>(films),
        Chosen::Vulkan(_) => claims::<OnVulkan>(films) + &rates::<OnVulkan>(films),
    })
}

const THIRDS: f64 = 2.0 / 3.0;

/// What is claimed in each field, and whether it holds.
fn claims<T: TestBackend>(films: u32) -> String {
    let mut text = format!(
        "\n### Claims in fields of known truth\n\n{} independent pixels a row, 20 photons expected in the first radius. Distances are in first\nradii. *By noise* is the share that the noise alone would cover, of all pixels.\n\n| field | passes | α | claimed | covered | by noise | claim / error |\n|---|---:|---:|---:|---:|---:|---:|\n",
        256 * films
    );
    for (passes, alpha) in [(16, THIRDS), (64, THIRDS), (64, 1.0)] {
        for (number, field) in SMOOTH.iter().chain(&BROKEN).enumerate() {
            let seed = |film: u32| u64::from(film) * 1000 + number as u64 + u64::from(passes) * 100_000;
            let films: Vec<Film> = (0..films).map(|film| field_film::<T>(field, passes, alpha, seed(film))).collect();
            let verdict = judge(field, &films);
            let covered =
                if verdict.claimed > 0.0 { format!("{:.1} %", 100.0 * verdict.covered) } else { "–".into() };
            let sharp = if verdict.claimed > 0.0 { format!("{:.2}", verdict.sharpness) } else { "–".into() };
            let _ = writeln!(
                text,
                "| {} | {passes} | {alpha:.2} | {:.1} % | {covered} | {:.1} % | {sharp} |",
                field.name,
                100.0 * verdict.claimed,
                100.0 * verdict.covered_by_noise
            );
        }
    }
    text
}

/// Mean squared bias and variance over a film's pixels.
fn parts(field: &Field, films: &[Film]) -> (f64, f64) {
    let truth = (field.at)(0.0, 0.0);
    let values: Vec<f64> =
        films.iter().flat_map(|film| film.claims().unwrap_or_default()).map(|claim| claim.value - truth).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean * mean - variance / n, variance)
}

/// How errors fall with passes, fitted and by theory for the same passes.
fn rates<T: TestBackend>(films: u32) -> String {
    const PASSES: [u32; 4] = [16, 64, 256, 1024];
    let mut text = String::from(
        "\n### Rates in fields of known truth\n\nSlopes over 16 to 1024 passes in logarithms, fitted and by theory; theory is exact for the variance of a uniform\nfield, and for bias while it grows as the squared radius.\n\n| field | α | of | slope | theory |\n|---|---:|---|---:|---:|\n",
    );
    for (field, alpha) in [(&SMOOTH[0], THIRDS), (&SMOOTH[0], 1.0), (&SMOOTH[3], THIRDS)] {
        let mut bias = Vec::new();
        let mut variance = Vec::new();
        let mut both = Vec::new();
        for passes in PASSES {
            let films: Vec<Film> = (0..films)
                .map(|film| field_film::<T>(field, passes, alpha, 7_000_000 + u64::from(film + passes)))
                .collect();
            let (b, v) = parts(field, &films);
            let n = f64::from(passes);
            bias.push((n, b));
            variance.push((n, v));
            both.push((n, b + v));
        }
        let theory = |of: &dyn Fn(u32, f64) -> f64| {
            slope(&PASSES.map(|passes| (f64::from(passes), of(passes, f64::from(passes))))).0
        };
        let var = theory(&|passes, n| inverse_radius_squared_sum(passes, alpha) / (n * n));
        let mut row = |of: &str, points: &[(f64, f64)], theory: f64| {
            let (slope, error) = slope(points);
            let _ = writeln!(text, "| {} | {alpha:.2} | {of} | {slope:.3} ± {error:.3} | {theory:.3} |", field.name);
        };
        row("variance", &variance, var);
        if field.name != SMOOTH[0].name {
            row("bias²", &bias, theory(&|passes, n| (radius_squared_sum(passes, alpha) / n).powi(2)));
            row("both", &both, -THIRDS);
        }
    }
    text
}
