//! Benefit and cost of each method of bias reduction: `docs/studies/data/debiasing.txt`.
//!
//! `debias SCENE [--backend cpu|vulkan] [--size N] [--seeds N] [--passes N] [--photons N] [--reference N]
//! [--part area|gather|bandwidth|plane]`: Markdown rows of error, with and without. Errors are squared over the
//! square of the reference plus that of a tenth of its mean; the reference is two runs of `--reference` passes
//! of eight times the photons on the CPU, with the area on the surface: the disc would make it too dark. Each is
//! distributed over four films. Products of the differences from two films contain none of their noise, and the
//! remaining random error of their mean is estimated from the spread between seeds, and between films.
#![expect(clippy::print_stdout, clippy::unwrap_used, reason = "a program for measuring")]

use std::time::Instant;

use backend_cpu::Cpu;
use backend_vulkan::{Options, Vulkan};
use photon_core::{
    Area, Bandwidth, Film, Indirect, PassEnd, Pipeline, Render, Settings, Stage, TransportBackend, View,
};
use photon_scene::{Scene, builtin};

/// Number of films over which a run of the reference is distributed.
const PARTS: u32 = 4;

/// The command line options.
struct Job {
    scene: String,
    backend: String,
    size: u32,
    seeds: u64,
    passes: u32,
    photons: u32,
    reference: u32,
    part: String,
}

fn job() -> Job {
    let mut words = std::env::args().skip(1);
    let mut job = Job {
        scene: words.next().unwrap_or_else(|| "cornell".to_owned()),
        backend: "cpu".to_owned(),
        size: 64,
        seeds: 8,
        passes: 16,
        photons: 50_000,
        reference: 64,
        part: "area".to_owned(),
    };
    while let Some(word) = words.next() {
        let value = words.next().unwrap_or_default();
        match word.as_str() {
            "--backend" => job.backend = value,
            "--size" => job.size = value.parse().unwrap(),
            "--seeds" => job.seeds = value.parse().unwrap(),
            "--passes" => job.passes = value.parse().unwrap(),
            "--photons" => job.photons = value.parse().unwrap(),
            "--reference" => job.reference = value.parse().unwrap(),
            _ => job.part = value,
        }
    }
    job
}

fn main() {
    let job = job();
    let scene = builtin(&job.scene).unwrap().build().unwrap();
    let base = Settings { photons: job.photons, ..Settings::default() };
    let truths: Pictures = (0..2 * PARTS)
        .map(|film| {
            let seed = (1 << 40) + u64::from(film / PARTS);
            let long = Settings { photons: 8 * job.photons, seed, area: Area::Surface, ..base.clone() };
            // Every fourth pass, so that the radii of all films shrink equally.
            let passes = (film % PARTS..job.reference).step_by(PARTS as usize);
            grey(&run(Cpu::new().unwrap(), &scene, &long, passes, job.size).0)
        })
        .collect();
    println!("| {} | passes | ms a pass | relMSE | bias² | ± | variance | bias | darkest bias |", job.scene);
    println!("|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    for (name, settings) in settings(&job, &base) {
        let films: Vec<(Film, f64)> = (0..job.seeds)
            .map(|seed| {
                let settings = Settings { seed, ..settings.clone() };
                match job.backend.as_str() {
                    "vulkan" => {
                        let on = Vulkan::with_options(&Options::default()).unwrap();
                        run(on, &scene, &settings, 0..job.passes, job.size)
                    }
                    _ => run(Cpu::new().unwrap(), &scene, &settings, 0..job.passes, job.size),
                }
            })
            .collect();
        row(&name, &films, &truths, &job);
    }
}

/// The settings to measure, by name.
fn settings(job: &Job, base: &Settings) -> Vec<(String, Settings)> {
    let gather = Settings { indirect: Indirect::Gather, gather_rays: 16, ..base.clone() };
    let details = Settings { errors: true, ..base.clone() };
    match job.part.as_str() {
        "bandwidth" => [("shared", Bandwidth::Shared), ("per pixel", Bandwidth::PerPixel)]
            .map(|(name, bandwidth)| (name.to_owned(), Settings { bandwidth, ..details.clone() }))
            .to_vec(),
        "plane" => [1.0, 0.5, 0.25, 0.1]
            .into_iter()
            .flat_map(|share| [("disc", Area::Disc), ("surface", Area::Surface)].map(|area| (share, area)))
            .map(|(share, (name, area))| {
                (
                    format!("{share} of the radius, {name}"),
                    Settings { max_plane_distance: Some(share), area, ..base.clone() },
                )
            })
            .collect(),
        "gather" => [None, Some(1), Some(4), Some(16)]
            .map(|irradiance_every| match irradiance_every {
                None => ("each ray asks the maps".to_owned(), gather.clone()),
                Some(every) => (format!("every {every}"), Settings { irradiance_every, ..gather.clone() }),
            })
            .to_vec(),
        _ => [("disc", Area::Disc), ("surface", Area::Surface)]
            .map(|(name, area)| (name.to_owned(), Settings { area, ..base.clone() }))
            .to_vec(),
    }
}

/// The film of those passes, and the minimum time of a pass, seconds.
fn run<B: TransportBackend>(
    on: B,
    scene: &Scene,
    settings: &Settings,
    passes: impl Iterator<Item = u32>,
    size: u32,
) -> (Film, f64) {
    let view = View { camera: scene.camera(None, size, size).unwrap(), width: size, height: size };
    let mut renderer = Pipeline::new(on, &scene.view(), view, settings.clone()).unwrap();
    let (mut least, mut last) = (f64::INFINITY, None);
    for pass in passes {
        let start = Instant::now();
        last = Some(renderer.pass(pass, &mut ()).unwrap());
        least = least.min(start.elapsed().as_secs_f64());
    }
    if let Some(PassEnd::Done(report)) = last {
        let part = |stage: Stage| format!("{} {:.1}", stage.name(), 1e3 * report.seconds.get(stage));
        eprintln!("last pass, ms: {}", Stage::ALL.map(part).join(", "));
    }
    (renderer.film().unwrap(), least)
}

/// The mean of RGB of each pixel of each film.
type Pictures = Vec<Vec<f64>>;

fn grey(film: &Film) -> Vec<f64> {
    film.beauty().iter().map(|pixel| pixel.iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0).collect()
}

/// For one pixel, over all pictures but one: the mean, and its variance.
fn moments(pictures: &[Vec<f64>], pixel: usize, without: Option<usize>) -> (f64, f64) {
    let values = || pictures.iter().enumerate().filter(|(index, _)| Some(*index) != without).map(|(_, all)| all[pixel]);
    let count = values().count() as f64;
    let mean = values().sum::<f64>() / count;
    (mean, values().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0) / count)
}

/// The mean over pixels of their squared bias over their scale: the squared difference of two means, minus
/// the contribution of their noise. That is the mean of products over all pairs of pictures and all pairs of truths.
fn bias_squared(pictures: &[Vec<f64>], truths: &[Vec<f64>], scales: &[f64], without: [Option<usize>; 2]) -> f64 {
    let of = |(pixel, scale): (usize, &f64)| {
        let (found, noise) = moments(pictures, pixel, without[0]);
        let (truth, its_noise) = moments(truths, pixel, without[1]);
        ((found - truth).powi(2) - noise - its_noise) / scale
    };
    scales.iter().enumerate().map(of).sum::<f64>() / scales.len() as f64
}

/// The standard error of that by the jackknife, leaving out one film at a time (Quenouille 1956, Tukey 1958), of the
/// pictures and of the truths, which are independent.
fn chance(pictures: &[Vec<f64>], truths: &[Vec<f64>], scales: &[f64]) -> f64 {
    let variance = |count: usize, leave: &dyn Fn(usize) -> [Option<usize>; 2]| {
        let found: Vec<f64> = (0..count).map(|film| bias_squared(pictures, truths, scales, leave(film))).collect();
        let mean = found.iter().sum::<f64>() / count as f64;
        found.iter().map(|value| (value - mean).powi(2)).sum::<f64>() * (count as f64 - 1.0) / count as f64
    };
    let by_seed = variance(pictures.len(), &|film| [Some(film), None]);
    (by_seed + variance(truths.len(), &|film| [None, Some(film)])).sqrt()
}

/// Mean squares over pixels of the bias and of the noise of films with different seeds.
fn row(name: &str, films: &[(Film, f64)], truths: &[Vec<f64>], job: &Job) {
    let pictures: Pictures = films.iter().map(|(film, _)| grey(film)).collect();
    let pixels = pictures[0].len();
    let truth: Vec<f64> = (0..pixels).map(|pixel| moments(truths, pixel, None).0).collect();
    let mean_truth = truth.iter().sum::<f64>() / pixels as f64;
    let scales: Vec<f64> = truth.iter().map(|truth| truth * truth + 0.01 * mean_truth * mean_truth).collect();
    let (mut variance, mut bias) = (0.0, Vec::new());
    for (pixel, (truth, scale)) in truth.iter().zip(&scales).enumerate() {
        let (mean, noise) = moments(&pictures, pixel, None);
        variance += noise * pictures.len() as f64 / scale / pixels as f64;
        bias.push((mean - truth) / scale.sqrt());
    }
    let squared = bias_squared(&pictures, truths, &scales, [None; 2]);
    let chance = chance(&pictures, truths, &scales);
    let all = bias.iter().sum::<f64>() / pixels as f64;
    bias.sort_by(f64::total_cmp);
    let least = films.iter().map(|(_, seconds)| *seconds).fold(f64::INFINITY, f64::min);
    println!(
        "| {name} | {} | {:.1} | {:.2e} | {squared:.2e} | {chance:.1e} | {variance:.2e} | {:.2} % | {:.0} % |",
        job.passes,
        1e3 * least,
        squared + variance,
        1e2 * all,
        1e2 * bias[bias.len() / 100],
    );
}
