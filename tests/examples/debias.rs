//! What each tool against bias gains and costs: the tables of `docs/debiasing.md`.
//!
//! `debias SCENE [--backend cpu|vulkan] [--size N] [--seeds N] [--passes N] [--photons N] [--reference N]
//! [--part area|gather|bandwidth|plane]`: Markdown rows of error, with and without. Errors are squared over the
//! square of the reference plus that of a tenth of its mean; the reference is two runs of `--reference` passes
//! of eight times the photons on the CPU, divided by the surface: by the disc it would be too dark itself. Two,
//! since the product of the differences from each has none of their noise.
#![expect(clippy::print_stdout, clippy::unwrap_used, reason = "a program for measuring")]

use std::time::Instant;

use backend_cpu::Cpu;
use backend_vulkan::{Options, Vulkan};
use photon_core::{
    Area, Bandwidth, Film, Indirect, PassEnd, Pipeline, Render, Settings, Stage, TransportBackend, View,
};
use photon_scene::{Scene, builtin};

/// What the command line says.
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
    let truths = [1 << 40, 1 << 41].map(|seed| {
        let long = Settings { photons: 8 * job.photons, seed, area: Area::Surface, ..base.clone() };
        run(Cpu::new().unwrap(), &scene, &long, job.reference, job.size).0.beauty()
    });
    println!("| {} | passes | ms a pass | relMSE | bias² | ± | variance | bias | darkest bias |", job.scene);
    println!("|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    for (name, settings) in settings(&job, &base) {
        let films: Vec<(Film, f64)> = (0..job.seeds)
            .map(|seed| {
                let settings = Settings { seed, ..settings.clone() };
                match job.backend.as_str() {
                    "vulkan" => {
                        let on = Vulkan::with_options(&Options::default()).unwrap();
                        run(on, &scene, &settings, job.passes, job.size)
                    }
                    _ => run(Cpu::new().unwrap(), &scene, &settings, job.passes, job.size),
                }
            })
            .collect();
        row(&name, &films, &truths, &job);
    }
}

/// What is measured, by name.
fn settings(job: &Job, base: &Settings) -> Vec<(String, Settings)> {
    let gather = Settings { indirect: Indirect::Gather, gather_rays: 16, ..base.clone() };
    let told = Settings { errors: true, ..base.clone() };
    match job.part.as_str() {
        "bandwidth" => [("shared", Bandwidth::Shared), ("per pixel", Bandwidth::PerPixel)]
            .map(|(name, bandwidth)| (name.to_owned(), Settings { bandwidth, ..told.clone() }))
            .to_vec(),
        "plane" => [1.0, 0.5, 0.25, 0.1]
            .into_iter()
            .flat_map(|share| [("disc", Area::Disc), ("surface", Area::Surface)].map(|area| (share, area)))
            .map(|(share, (name, area))| {
                (format!("{share} of the radius, {name}"), Settings { max_plane_distance: share, area, ..base.clone() })
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

/// The film of so many passes, and the least seconds of one.
fn run<B: TransportBackend>(on: B, scene: &Scene, settings: &Settings, passes: u32, size: u32) -> (Film, f64) {
    let view = View { camera: scene.camera(None, size, size).unwrap(), width: size, height: size };
    let mut renderer = Pipeline::new(on, &scene.view(), view, settings.clone()).unwrap();
    let mut least = f64::INFINITY;
    for pass in 0..passes {
        let start = Instant::now();
        let end = renderer.pass(pass, &mut ()).unwrap();
        least = least.min(start.elapsed().as_secs_f64());
        if let (true, PassEnd::Done(report)) = (pass + 1 == passes, end) {
            let part = |stage: Stage| format!("{} {:.1}", stage.name(), 1e3 * report.seconds.get(stage));
            eprintln!("last pass, ms: {}", Stage::ALL.map(part).join(", "));
        }
    }
    (renderer.film().unwrap(), least)
}

/// Mean squares over pixels of the bias and of the noise of films that differ in their seed.
fn row(name: &str, films: &[(Film, f64)], truths: &[Vec<[f32; 3]>; 2], job: &Job) {
    let grey = |pixel: &[f32; 3]| pixel.iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0;
    let truth: Vec<[f64; 2]> = truths[0].iter().zip(&truths[1]).map(|(a, b)| [grey(a), grey(b)]).collect();
    let mean_truth = truth.iter().flatten().sum::<f64>() / (2 * truth.len()) as f64;
    let pictures: Vec<Vec<f64>> = films.iter().map(|(film, _)| film.beauty().iter().map(grey).collect()).collect();
    let count = pictures.len() as f64;
    let (mut squares, mut variance, mut bias) = (Vec::new(), 0.0, Vec::new());
    for (i, &[first, second]) in truth.iter().enumerate() {
        let truth = 0.5 * (first + second);
        let scale = truth * truth + 0.01 * mean_truth * mean_truth;
        let mean = pictures.iter().map(|picture| picture[i]).sum::<f64>() / count;
        let own = pictures.iter().map(|picture| (picture[i] - mean).powi(2)).sum::<f64>() / (count - 1.0);
        variance += own / scale;
        // The square of a mean of noise is no bias.
        squares.push(((mean - first) * (mean - second) - own / count) / scale);
        bias.push((mean - truth) / scale.sqrt());
    }
    let pixels = truth.len() as f64;
    let (squared, variance) = (squares.iter().sum::<f64>() / pixels, variance / pixels);
    // Pixels are nearly independent of each other in what is left of chance here.
    let chance = (squares.iter().map(|s| (s - squared).powi(2)).sum::<f64>() / pixels / pixels).sqrt();
    let all = bias.iter().sum::<f64>() / pixels;
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
