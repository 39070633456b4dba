//! Times whole passes by stage: median device milliseconds, and passes per second of wall-clock time.
//!
//! `pass_bench [SCENE] [--size WxH] [--photons N] [--passes N] [--gather RAYS] [--knn K] [--errors] [--small]`;
//! without arguments `cornell-glass` at 1920x1080 with 1 M photon paths a pass.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program's output")]

use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

use backend_vulkan::Vulkan;
use photon_core::{Display, Estimator, Indirect, PassEnd, PassReport, Pipeline, Render, Settings, Stage, View};

/// Readings back that are timed.
const READS: usize = 9;

struct Job {
    scene: String,
    width: u32,
    height: u32,
    passes: u32,
    settings: Settings,
}

fn main() -> ExitCode {
    match parse(std::env::args().skip(1)).and_then(|job| run(&job)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Job, Box<dyn Error>> {
    let mut job = Job {
        scene: "cornell-glass".to_owned(),
        width: 1920,
        height: 1080,
        passes: 20,
        settings: Settings { photons: 1_000_000, ..Settings::default() },
    };
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            "--size" => {
                let size = value()?;
                let (width, height) = size.split_once('x').ok_or("a size is WxH")?;
                (job.width, job.height) = (width.parse()?, height.parse()?);
            }
            "--photons" => job.settings.photons = value()?.parse()?,
            "--passes" => job.passes = value()?.parse::<u32>()?.max(1),
            "--errors" => job.settings.errors = true,
            "--no-caustics" => job.settings.caustics = false,
            "--index" => {
                job.settings.index = match value()?.as_str() {
                    "median" => photon_core::IndexKind::Median,
                    "vvh" => photon_core::IndexKind::Vvh,
                    _ => photon_core::IndexKind::Morton,
                }
            }
            "--gather" => {
                job.settings.indirect = Indirect::Gather;
                job.settings.gather_rays = value()?.parse()?;
            }
            "--knn" => job.settings.estimator = Estimator::Knn { k: value()?.parse()?, max_radius: None },
            "--small" => {
                (job.width, job.height, job.passes) = (160, 90, 3);
                job.settings.photons = 20_000;
            }
            name if !name.starts_with('-') => name.clone_into(&mut job.scene),
            other => return Err(format!("unknown option {other}").into()),
        }
    }
    Ok(job)
}

/// Times of reading back: the median, and the first, which touches new memory.
fn milliseconds(mut read: impl FnMut() -> photon_core::Result<()>) -> photon_core::Result<String> {
    let mut times = Vec::new();
    for _ in 0..READS {
        let start = Instant::now();
        read()?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    let first = times[0];
    times.sort_unstable_by(f64::total_cmp);
    Ok(format!("{:.1} ({first:.1}) ms", times[READS / 2]))
}

fn run(job: &Job) -> Result<(), Box<dyn Error>> {
    let scene =
        photon_scene::builtin(&job.scene).ok_or(format!("no built-in scene is named {}", job.scene))?.build()?;
    let camera = scene.camera(None, job.width, job.height)?;
    let view = View { camera, width: job.width, height: job.height };
    let mut pipeline = Pipeline::new(Vulkan::new()?, &scene.view(), view, job.settings.clone())?;
    println!("{}", pipeline.facts().device);
    println!("{} {}x{}, {} paths a pass", job.scene, job.width, job.height, job.settings.photons);
    // The first pass allocates buffers and compiles kernels.
    pipeline.pass(0, &mut ())?;
    let mut reports: Vec<PassReport> = Vec::new();
    let start = Instant::now();
    for index in 1..=job.passes {
        if let PassEnd::Done(report) | PassEnd::Last(report) = pipeline.pass(index, &mut ())? {
            reports.push(report);
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    let film = milliseconds(|| pipeline.film().map(|_| ()))?;
    // The first picture compiles a kernel.
    pipeline.display(&Display::default())?;
    let shown = milliseconds(|| pipeline.display(&Display::default()).map(|_| ()))?;
    let median = |of: &dyn Fn(&PassReport) -> f64| {
        let mut values: Vec<f64> = reports.iter().map(of).collect();
        values.sort_unstable_by(f64::total_cmp);
        values[values.len() / 2]
    };
    for stage in Stage::ALL {
        let ms = median(&|report| report.seconds.get(stage)) * 1e3;
        if ms > 0.0 {
            println!("{:<9} {ms:>9.3} ms", stage.name());
        }
    }
    let device = median(&|report| report.seconds.total());
    println!("{:<9} {:>9.3} ms, {:.1} passes/s", "device", device * 1e3, 1.0 / device);
    let wall = seconds / f64::from(job.passes);
    println!("{:<9} {:>9.3} ms, {:.1} passes/s", "wall", wall * 1e3, 1.0 / wall);
    println!("to the host, median (first) of {READS}: film {film}, picture of eight bits {shown}");
    println!("queries   {:>9.0}", median(&|report| report.queries as f64));
    for (label, bytes) in pipeline.facts().memory {
        println!("  {label:<20} {:>9.1} MiB", bytes as f64 / 1_048_576.0);
    }
    Ok(())
}
