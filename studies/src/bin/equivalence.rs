//! The same scenes on the CPU and on Vulkan, with the same seeds: a table, and pictures of the
//! differences.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "the table goes to stdout, progress to stderr")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use backend_cpu::Cpu;
use backend_vulkan::Vulkan;
use clap::Parser;
use photon_core::{Budget, Film, Indirect, Pipeline, Settings, TransportBackend, View, render};
use photon_scene::{Overrides, Scene};
use photonmap_cli::difference::{self, Difference};
use photonmap_cli::fault::{self, Fault};
use photonmap_cli::png_file;
use photonmap_cli::tonemap::{self, ToneMap};

/// Renders scenes on both backends and compares the pictures.
#[derive(Debug, Parser)]
struct Args {
    /// Built-in names or files; a file may be followed by `:` and its override file. Default: all
    /// built-in scenes.
    scenes: Vec<String>,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/compare")]
    out: PathBuf,
    /// Width and height of the pictures, pixels.
    #[arg(long, default_value_t = 256)]
    size: u32,
    /// Number of passes.
    #[arg(long, default_value_t = 8)]
    passes: u32,
    /// Photon paths per pass.
    #[arg(long, default_value_t = 100_000)]
    photons: u32,
    /// Use final gathering instead of the global map.
    #[arg(long)]
    gather: bool,
    /// Gain of the differences in the pictures.
    #[arg(long, default_value_t = 10.0)]
    gain: f32,
}

fn main() -> ExitCode {
    fault::run(|| work(&Args::parse()))
}

fn work(args: &Args) -> Result<(), Fault> {
    std::fs::create_dir_all(&args.out).map_err(|why| Fault::writing(&args.out, why))?;
    let all: Vec<String> = photon_scene::builtin_names().iter().map(|(name, _)| (*name).to_owned()).collect();
    let names = if args.scenes.is_empty() { &all } else { &args.scenes };
    let mut settings = Settings { photons: args.photons, ..Settings::default() };
    if args.gather {
        settings.indirect = Indirect::Gather;
    }
    let mut table = String::from(
        "| scene | mean | RMS | noise | RMS/noise | apart | greatest |\n|---|---:|---:|---:|---:|---:|---:|\n",
    );
    for name in names {
        let scene = load(name)?;
        let view = View { camera: scene.camera(None, args.size, args.size)?, width: args.size, height: args.size };
        eprintln!("{name}: cpu");
        let cpu = film(Cpu::new()?, &scene, view, &settings, args.passes)?;
        eprintln!("{name}: vulkan");
        let vulkan = film(Vulkan::new()?, &scene, view, &settings, args.passes)?;
        let Difference { mean, rms, noise, apart, greatest } = difference::between(&cpu, &vulkan);
        let stem = Path::new(name.split(':').next().unwrap_or(name)).file_stem().unwrap_or_default().to_string_lossy();
        let ratio = rms / noise;
        let _ = writeln!(
            table,
            "| {stem} | {mean:+.1e} | {rms:.1e} | {noise:.1e} | {ratio:.3} | {:.2} % | {greatest:.1e} |",
            100.0 * apart
        );
        save(args, &stem, &cpu, &vulkan)?;
    }
    let path = args.out.join("table.md");
    photonmap_cli::atomic_write::write_bytes(&path, table.as_bytes())?;
    print!("{table}");
    Ok(())
}

fn load(name: &str) -> Result<Scene, Fault> {
    if let Some(builder) = photon_scene::builtin(name) {
        return Ok(builder.build()?);
    }
    let (path, overrides) = match name.split_once(':') {
        Some((path, overrides)) => (path, Some(Overrides::read(Path::new(overrides))?)),
        None => (name, None),
    };
    Ok(photon_scene::load(Path::new(path), overrides.as_ref())?.0)
}

fn film<B: TransportBackend>(
    on: B,
    scene: &Scene,
    view: View,
    settings: &Settings,
    passes: u32,
) -> Result<Film, Fault> {
    let mut pipeline = Pipeline::new(on, &scene.view(), view, settings.clone())?;
    render(&mut pipeline, Budget::passes(passes), &mut ())?;
    Ok(photon_core::Render::film(&mut pipeline)?)
}

/// Side by side: the CPU's picture, Vulkan's, the difference.
fn save(args: &Args, stem: &str, cpu: &Film, vulkan: &Film) -> Result<(), Fault> {
    let shade = |film: &Film| -> Vec<u8> {
        film.beauty().into_iter().flat_map(|c| tonemap::map(ToneMap::Aces, 0.0, c).map(tonemap::encode)).collect()
    };
    let parts = [shade(cpu), shade(vulkan), difference::picture(cpu, vulkan, args.gain)];
    let row = 3 * cpu.width as usize;
    let bytes: Vec<u8> = (0..cpu.height as usize)
        .flat_map(|y| parts.iter().flat_map(move |part| part[y * row..(y + 1) * row].iter().copied()))
        .collect();
    png_file::write_bytes(&args.out.join(format!("{stem}.png")), 3 * cpu.width, cpu.height, &bytes)
}
