//! Renders every model of a folder: a picture of each, a contact sheet and a table of loader reports and times.
//!
//! `gallery FOLDER --environment studio.exr` looks for `.gltf`, `.glb`, `.obj` and `.ply` files in the folder and one level
//! below, and writes `out/gallery/*.png`, `sheet.png` and `README.md`. With `--overrides FOLDER`, the override file
//! `FOLDER/NAME.toml` is applied to the model NAME. A model without a camera is seen obliquely from above. A model that
//! cannot be rendered gets a row with its error, and the exit code is 1.
#![expect(clippy::print_stderr, reason = "progress goes to standard error")]

mod document;
mod oblique;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use photon_core::{Budget, Film, Pipeline, Render, Settings, TransportBackend, View, render};
use photon_scene::{EnvironmentDesc, LoadReport, Overrides, Scene};
use photonmap_cli::args::EnvironmentArgs;
use photonmap_cli::backend::{self, BackendName, Chosen};
use photonmap_cli::exposure::{self, Exposure};
use photonmap_cli::fault::{self, Fault};
use photonmap_cli::png_file::{self, Picture};
use photonmap_cli::tonemap::{self, ToneMap};

use document::Row;

/// Renders every model of a folder.
#[derive(Debug, Parser)]
struct Args {
    /// Folder with .gltf, .glb, .obj or .ply files, or with folders of them.
    folder: PathBuf,
    /// Light from infinitely far away; needed by models without lights.
    #[command(flatten)]
    environment: EnvironmentArgs,
    /// Folder with an override file NAME.toml for some of the models, such as NAME.glb.
    #[arg(long)]
    overrides: Option<PathBuf>,
    /// Folder for the pictures and the table.
    #[arg(long, default_value = "out/gallery")]
    out: PathBuf,
    /// Width and height of the pictures, pixels.
    #[arg(long, default_value_t = 256)]
    size: u32,
    /// Number of passes.
    #[arg(long, default_value_t = 32)]
    passes: u32,
    /// Photon paths per pass.
    #[arg(long, default_value_t = 100_000)]
    photons: u32,
    /// Backend.
    #[arg(long, value_enum, default_value_t = BackendName::Auto)]
    backend: BackendName,
}

fn main() -> ExitCode {
    fault::run(|| work(&Args::parse()))
}

fn work(args: &Args) -> Result<(), Fault> {
    let models = models(&args.folder)?;
    if models.is_empty() {
        return Err(Fault::input(format!(
            "{}: it has no .gltf, .glb, .obj or .ply file, and no folder with one",
            args.folder.display()
        )));
    }
    std::fs::create_dir_all(&args.out).map_err(|why| Fault::writing(&args.out, why))?;
    let mut of_environment = LoadReport::default();
    let environment = args.environment.desc(&mut of_environment)?;
    of_environment.lines.iter().for_each(|line| eprintln!("{line}"));
    let mut rows = Vec::new();
    for path in &models {
        eprintln!("{}", path.display());
        let name = path.strip_prefix(&args.folder).unwrap_or(path).display().to_string();
        let mut row = Row { name, ..Row::default() };
        match model(args, path, environment.as_ref(), &mut row) {
            Ok(bytes) => {
                let stem: String = row.name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
                row.picture = format!("{stem}.png");
                png_file::write_bytes(&args.out.join(&row.picture), args.size, args.size, &bytes)?;
                row.bytes = bytes;
            }
            Err(fault) => row.error = Some(fault.to_string()),
        }
        rows.push(row);
    }
    document::write(&args.out, args.size, environment.as_ref(), &rows)?;
    match rows.iter().filter(|row| row.error.is_some()).count() {
        0 => Ok(()),
        failed => Err(Fault::failure(format!("{failed} of {} models failed: see README.md", rows.len()))),
    }
}

/// The models in a folder and in the folders within, by name.
fn models(folder: &Path) -> Result<Vec<PathBuf>, Fault> {
    let list = |folder: &Path| -> Result<Vec<PathBuf>, Fault> {
        let unreadable = |why: std::io::Error| Fault::input(format!("{}: {why}", folder.display()));
        let entries = std::fs::read_dir(folder).map_err(unreadable)?;
        let mut paths =
            entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
        paths.sort();
        Ok(paths)
    };
    let known = |path: &PathBuf| {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        extension.is_some_and(|e| ["gltf", "glb", "obj", "ply"].contains(&e.as_str()))
    };
    let mut found = Vec::new();
    for path in list(folder)? {
        let within = if path.is_dir() { list(&path)? } else { vec![path] };
        found.extend(within.into_iter().filter(|path| known(path) && path.is_file()));
    }
    Ok(found)
}

/// Loads and renders a model; the tone-mapped bytes of its picture.
fn model(args: &Args, path: &Path, environment: Option<&EnvironmentDesc>, row: &mut Row) -> Result<Vec<u8>, Fault> {
    let begun = Instant::now();
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    // These add no camera, unlike `load_builder`.
    let (mut builder, mut report) = match extension.as_deref() {
        Some("obj") => photon_scene::load_obj(path)?,
        Some("ply") => photon_scene::load_ply(path)?,
        _ => photon_scene::load_gltf(path)?,
    };
    let overrides = args.overrides.as_deref().zip(path.file_name());
    let overrides = overrides.map(|(folder, name)| folder.join(name).with_extension("toml"));
    if let Some(path) = overrides.filter(|path| path.is_file()) {
        Overrides::read(&path)?.apply(&mut builder, &mut report)?;
    }
    row.report = report.lines.iter().map(ToString::to_string).collect();
    if let Some(environment) = environment {
        builder.environment_from(environment)?;
    }
    if !builder.has_camera() {
        builder.camera("oblique", oblique::camera(&builder.clone().build()?.view()));
    }
    let scene = builder.build()?;
    row.report.extend(scene.warnings().iter().map(|warning| format!("warning: {warning}")));
    row.triangles = scene.view().triangles.len();
    row.seconds_load = begun.elapsed().as_secs_f64();
    let begun = Instant::now();
    let view = View { camera: scene.camera(None, args.size, args.size)?, width: args.size, height: args.size };
    let film = match backend::open(args.backend, None)? {
        Chosen::Cpu(on) => film(on, &scene, view, args)?,
        Chosen::Vulkan(on) => film(*on, &scene, view, args)?,
    };
    row.seconds_render = begun.elapsed().as_secs_f64();
    let picture = Picture::new(&film, false);
    let stops = Exposure::Auto.stops(&exposure::measured(&picture.colours, &film.alpha()));
    let shade = |&color: &[f32; 3]| tonemap::map(ToneMap::Neutral, stops, color).map(tonemap::encode);
    Ok(picture.colours.iter().flat_map(shade).collect())
}

fn film<B: TransportBackend>(on: B, scene: &Scene, view: View, args: &Args) -> Result<Film, Fault> {
    let settings = Settings { photons: args.photons, ..Settings::default() };
    let mut pipeline = Pipeline::new(on, &scene.view(), view, settings)?;
    render(&mut pipeline, Budget::passes(args.passes), &mut ())?;
    Ok(pipeline.film()?)
}
