//! What textures, vertex normals, gloss, alpha, environments and many lights cost: times of passes with each of them over
//! those without, in one run; and how fast images are decoded. In Markdown.
//!
//! `surface_costs [--backend cpu|vulkan] [--threads N] [--size PIXELS] [--photons N] [--rounds N] [--only WORDS]
//! [IMAGE...]`
#![expect(clippy::print_stdout, clippy::expect_used, reason = "a program for measuring")]

mod scenes;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use photon_core::{Backend, PassEnd, Pipeline, Render, Stage, StageTimings, TransportBackend, View};
use photon_scene::{Image, Scene};
use photonmap_cli::backend::{self, BackendName, Chosen};
use photonmap_cli::fault::{self, Fault};

use scenes::{Pair, pairs};

#[derive(Parser)]
#[command(about = "Times of surfaces and lights, each over the same scene without it")]
struct Arguments {
    #[arg(long, value_enum, default_value = "cpu")]
    backend: BackendName,
    /// Threads of the CPU backend.
    #[arg(long)]
    threads: Option<usize>,
    /// Width and height of the pictures.
    #[arg(long, default_value_t = 192)]
    size: u32,
    /// Photon paths of a pass.
    #[arg(long, default_value_t = 100_000)]
    photons: u32,
    /// Passes of each scene, in turns; the least time of a stage counts.
    #[arg(long, default_value_t = 9)]
    rounds: u32,
    /// Only the rows whose name contains this.
    #[arg(long, default_value = "")]
    only: String,
    /// Images to decode.
    images: Vec<PathBuf>,
}

fn main() -> ExitCode {
    fault::run(|| run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Fault> {
    let device = match backend::open(arguments.backend, arguments.threads)? {
        Chosen::Cpu(on) => on.device(),
        Chosen::Vulkan(on) => on.device(),
    };
    println!(
        "{device}, {0}×{0} pixels, {1} paths, least of {2} passes\n",
        arguments.size, arguments.photons, arguments.rounds
    );
    println!("| what | ms with | ms without | ratio | goal |\n|---|--:|--:|--:|--:|");
    for pair in pairs(arguments.photons).into_iter().filter(|pair| pair.what.contains(&arguments.only)) {
        let [with, without] = measure(arguments, &pair)?;
        let ratio = with / without;
        println!("| {} | {:.3} | {:.3} | {ratio:.2} | {} |", pair.what, 1e3 * with, 1e3 * without, pair.goal);
    }
    if !arguments.images.is_empty() {
        println!("\n| image | size | MB/s of decoded texels |\n|---|---|--:|");
    }
    for path in &arguments.images {
        let bytes = std::fs::read(path).map_err(|error| Fault::input(format!("{}: {error}", path.display())))?;
        let begun = Instant::now();
        let image = Image::decode(&bytes).map_err(|error| Fault::input(format!("{}: {error}", path.display())))?;
        let seconds = begun.elapsed().as_secs_f64();
        let decoded = size_of_val(&*image.texels) as f64;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        println!("| {name} | {}×{} | {:.0} |", image.width, image.height, decoded / seconds / 1e6);
    }
    Ok(())
}

/// The least seconds of the pair's stages in a pass, with the feature and without; rendered in turns.
fn measure(arguments: &Arguments, pair: &Pair) -> Result<[f64; 2], Fault> {
    let built = pair.scenes.clone().map(|builder| builder.build());
    let [with, without] = built;
    let scenes = [with?, without?];
    let open = || backend::open(arguments.backend, arguments.threads);
    match (open()?, open()?) {
        (Chosen::Cpu(a), Chosen::Cpu(b)) => in_turns(arguments, pair, [(a, &scenes[0]), (b, &scenes[1])]),
        (Chosen::Vulkan(a), Chosen::Vulkan(b)) => in_turns(arguments, pair, [(*a, &scenes[0]), (*b, &scenes[1])]),
        _ => Err(Fault::failure("the second backend is another one than the first")),
    }
}

fn in_turns<B: TransportBackend>(
    arguments: &Arguments,
    pair: &Pair,
    sides: [(B, &Scene); 2],
) -> Result<[f64; 2], Fault> {
    let (width, height) = (arguments.size, arguments.size);
    let start = |(on, scene): (B, &Scene)| -> Result<Pipeline<B>, Fault> {
        let view = View { camera: scene.camera(None, width, height)?, width, height };
        Ok(Pipeline::new(on, &scene.view(), view, pair.settings.clone())?)
    };
    let [with, without] = sides;
    let mut renderers = [start(with)?, start(without)?];
    let mut least = [f64::INFINITY; 2];
    for round in 0..arguments.rounds.max(1) {
        for (renderer, least) in renderers.iter_mut().zip(&mut least) {
            if let PassEnd::Done(report) = renderer.pass(round, &mut ())? {
                *least = least.min(sum(&report.seconds, pair.stages));
            }
        }
    }
    Ok(least)
}

fn sum(seconds: &StageTimings, stages: &[Stage]) -> f64 {
    stages.iter().map(|&stage| seconds.get(stage)).sum()
}
