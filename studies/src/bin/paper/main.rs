//! Repeats the table and the pictures of Lin and Wang 2010 on the available backends.
#![forbid(unsafe_code)]
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "tables go to stdout, progress to stderr")]

mod biases;
mod calibrate;
mod experiment;
mod report;
mod studio;
mod table;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use backend_cpu::Cpu;
use calibrate::Calibration;
use clap::{Parser, ValueEnum};
use experiment::{Experiment, FIGURES, Reading};
use photon_core::{TransportBackend, View};
use photon_scene::Scene;
use photonmap_cli::backend;
use photonmap_cli::fault::{self, Fault};
use photonmap_cli::png_file;
use photonmap_cli::tonemap::ToneMap;
use report::{Report, Results};
use studio::Studio;

/// Renders the pictures of "Research and Implementation of Photon Mapping in CUDA" (Lin and Wang
/// 2010), measures the times of its grid and of a larger one, and the errors of its formulas.
#[derive(Debug, Parser)]
#[command(name = "paper", version, about)]
struct Args {
    /// Folder for pictures, tables and rows; created if it does not exist.
    #[arg(long, value_name = "DIR", default_value = "paper-results")]
    out: PathBuf,
    /// Backends, separated by commas [default: all that are available].
    #[arg(long, value_enum, value_delimiter = ',')]
    backend: Vec<Where>,
    /// Built-in scene.
    #[arg(long, value_name = "NAME", default_value = "cornell-glass")]
    scene: String,
    /// Width and height of the pictures, pixels.
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=8192))]
    size: u32,
    /// Runs of each cell, of which the median is taken.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: u32,
    /// Also our own grid: photons in the global map, separated by commas; without values: 1000000,10000000.
    #[arg(long, value_name = "N", num_args = 0..=1, value_delimiter = ',', default_missing_value = "1000000,10000000")]
    large: Vec<u32>,
    /// Seconds after which no new cell is started; Vulkan comes first, and gets at most half of them.
    #[arg(long, value_name = "SECONDS", default_value_t = 240.0)]
    time: f64,
    /// Number of CPU threads [default: all cores].
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Where {
    /// The CPU.
    Cpu,
    /// A Vulkan device.
    Vulkan,
}

fn main() -> ExitCode {
    fault::run(|| work(&Args::parse()))
}

fn work(args: &Args) -> Result<(), Fault> {
    if args.threads == Some(0) {
        return Err(Fault::input("--threads is 0, but at least 1 is needed"));
    }
    if !(args.time > 0.0 && args.time <= 1e6) {
        return Err(Fault::input(format!("--time is {}, but must be above 0 and at most a million", args.time)));
    }
    if let Some(bad) = args.large.iter().find(|&&n| !(1000..=50_000_000).contains(&n)) {
        return Err(Fault::input(format!("--large is {bad}, but must be 1000 to 50000000")));
    }
    let builder = photon_scene::builtin(&args.scene)
        .ok_or_else(|| Fault::input(format!("{}: no built-in scene has that name", args.scene)))?;
    let scene = builder.build()?;
    let view = View { camera: scene.camera(None, args.size, args.size)?, width: args.size, height: args.size };
    std::fs::create_dir_all(&args.out).map_err(|why| Fault::writing(&args.out, why))?;
    let cpu = || match args.threads {
        Some(threads) => Cpu::with_threads(threads),
        None => Cpu::new(),
    };
    let begun = Instant::now();
    let mut calibration = Calibration::new(Studio::new(cpu()?, &scene, view)?)?;
    let mut report = Report::default();
    let all = args.backend.is_empty();
    if all || args.backend.contains(&Where::Vulkan) {
        match backend::vulkan() {
            Ok(on) => {
                let last = begun + Duration::from_secs_f64(args.time / 2.0);
                report.add(measure(args, &scene, view, on, &mut calibration, last)?);
            }
            Err(why) if all => eprintln!("without Vulkan: {why}"),
            Err(why) => return Err(why),
        }
    }
    if all || args.backend.contains(&Where::Cpu) {
        let last = begun + Duration::from_secs_f64(args.time);
        report.add(measure(args, &scene, view, cpu()?, &mut calibration, last)?);
    }
    for (name, text) in [("paper.csv", report.csv()), ("paper.md", report.markdown())] {
        let path = args.out.join(name);
        photonmap_cli::atomic_write::write_bytes(&path, text.as_bytes())?;
    }
    // The paper's own table is printed last, where a terminal shows it.
    print!("{}", report.markdown());
    Ok(())
}

/// Runs everything on one backend; after `last` nothing new is started.
fn measure<B: TransportBackend>(
    args: &Args,
    scene: &Scene,
    view: View,
    on: B,
    calibration: &mut Calibration,
    last: Instant,
) -> Result<Results, Fault> {
    let mut studio = Studio::new(on, scene, view)?;
    let mut results = Results::new(studio.on.name(), studio.on.device());
    // The first use of a kernel compiles it; the CPU needs no significant warm-up.
    let warm_ups = usize::from(results.backend != "cpu");
    let readings = Reading::ALL.into_iter().flat_map(|reading| {
        FIGURES.iter().map(move |&(caustic, global, ..)| Experiment::cell(reading, caustic, global))
    });
    let large = args.large.iter().flat_map(|&photons| Experiment::large(photons));
    for experiment in Experiment::pictures().into_iter().chain(readings).chain(large) {
        if Instant::now() > last {
            results.left_out += 1;
            continue;
        }
        let sizes = calibration.sizes(&experiment)?;
        // A long cell is not repeated: variance matters less there than time.
        let repeats = if experiment.table == "large" && results.backend == "cpu" { 1 } else { args.repeats as usize };
        let (measured, mut film) = studio.run(&experiment, &sizes, warm_ups, repeats)?;
        eprintln!(
            "{}: {} {}: {}, {} caustic and {} global photons of {} paths",
            results.backend,
            experiment.table,
            experiment.name,
            table::seconds(measured.wall),
            measured.stored[0],
            measured.stored[1],
            measured.paths
        );
        if experiment.table == "pictures" {
            film.clamp = true;
            let path = args.out.join(format!("{}-{}.png", experiment.name, results.backend));
            png_file::write(&path, &png_file::Picture::new(&film, false), ToneMap::None, 0.0)?;
        }
        results.cells.push((experiment, measured));
    }
    results.biases = biases::all(&mut studio.on)?;
    Ok(results)
}
