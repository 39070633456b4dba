//! The price list: what error is had for what time, by every setting that trades one for the other.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "the tables go to stdout, progress to stderr")]

mod asked;
mod document;
mod fields;
mod measure;
mod plot;
mod sweep;
mod truth;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use photon_core::{Budget, Film, Outcome, Pipeline, Plan, Render, Settings, TransportBackend, View};
use photon_examples::args::BackendName;
use photon_examples::backend::{self, Chosen};
use photon_examples::fault::{self, Fault};
use photon_scene::Scene;

use measure::{Run, Summary};
use sweep::Point;
use truth::Truth;

/// Renders scenes with many settings and seeds, and writes error and time of each.
#[derive(Debug, Parser)]
struct Args {
    /// Built-in scenes.
    #[arg(default_values_t = ["integrating-sphere", "furnace", "cornell", "cornell-glass", "ring"].map(str::to_owned))]
    scenes: Vec<String>,
    /// Where to render.
    #[arg(long, value_enum, default_value_t = BackendName::Auto)]
    backend: BackendName,
    /// Where the table and the plots go.
    #[arg(long, default_value = "out/tradeoff")]
    out: PathBuf,
    /// The document to write, tables included.
    #[arg(long)]
    document: Option<PathBuf>,
    /// Pixels across and down.
    #[arg(long, default_value_t = 48)]
    size: u32,
    /// Runs of each setting.
    #[arg(long, default_value_t = 10)]
    seeds: u32,
    /// Photon paths per pass of the middle setting.
    #[arg(long, default_value_t = 20_000)]
    photons: u32,
    /// Fields of known truth for claims, 256 pixels each, of each kind; 0 leaves them out.
    #[arg(long, default_value_t = 4)]
    fields: u32,
    /// How many times the photons of the longest run those of a reference are, where the truth is not known.
    #[arg(long, default_value_t = 8)]
    reference: u32,
}

/// All that is known of one scene.
struct Result {
    scene: String,
    truth: Truth,
    rows: Vec<(Point, Summary)>,
    /// Lines about what was asked for.
    asked: String,
}

fn main() -> ExitCode {
    fault::run(|| work(&Args::parse()))
}

fn work(args: &Args) -> std::result::Result<(), Fault> {
    if args.seeds < 2 {
        return Err(Fault::input("--seeds: at least 2 are needed to tell bias from variance"));
    }
    std::fs::create_dir_all(&args.out).map_err(|why| Fault::writing(&args.out, why))?;
    let mut results = Vec::new();
    let mut device = String::new();
    for name in &args.scenes {
        let builder = photon_scene::builtin(name);
        let builder = builder.ok_or_else(|| Fault::input(format!("{name}: no built-in scene has that name")))?;
        let scene = builder.build()?;
        let view = View { camera: scene.camera(None, args.size, args.size)?, width: args.size, height: args.size };
        let subject = Subject { args, name, scene: &scene, view };
        let result = subject.examine(&mut device)?;
        write(&args.out.join(format!("{name}.svg")), &plot::picture(&result))?;
        results.push(result);
    }
    write(&args.out.join("tradeoff.csv"), &document::csv(&results))?;
    let fields = fields::tables(args.backend, args.fields)?;
    let text = document::markdown(&results, &device, &fields, (args.size, args.seeds));
    write(args.document.as_deref().unwrap_or(&args.out.join("tradeoff.md")), &text)?;
    println!("{text}");
    Ok(())
}

fn write(path: &Path, text: &str) -> std::result::Result<(), Fault> {
    std::fs::write(path, text).map_err(|why| Fault::writing(path, why))
}

/// One scene, seen by its camera.
struct Subject<'a> {
    args: &'a Args,
    name: &'a str,
    scene: &'a Scene,
    view: View,
}

impl Subject<'_> {
    fn examine(&self, device: &mut String) -> std::result::Result<Result, Fault> {
        let base = sweep::base(self.name, self.args.photons);
        // The radii that the library derives are what the sweep of radii goes about.
        let (_, probe) = self.film(&base, Budget::Passes(1), 0)?;
        *device = probe.device;
        let points = sweep::points(&base, probe.radius);
        let longest = points.iter().map(|point| u64::from(point.passes) * u64::from(point.settings.photons)).max();
        let truth = match truth::closed_form(self.name) {
            Some(radiance) => Truth::Constant(radiance),
            None => self.reference(&base, longest.unwrap_or(1))?,
        };
        let mut rows = Vec::new();
        for point in points {
            let runs = (0..self.args.seeds)
                .map(|seed| {
                    let (film, told) = self.film(&point.settings, Budget::Passes(point.passes), u64::from(seed) + 1)?;
                    Ok(Run { film, seconds: told.seconds, photons: told.outcome.paths })
                })
                .collect::<std::result::Result<Vec<_>, Fault>>()?;
            let summary = measure::summarise(&runs, &truth);
            eprintln!(
                "{}: {} {}: {:.2} s, relMSE {:.2e}",
                self.name, point.knob, point.value, summary.seconds, summary.error
            );
            rows.push((point, summary));
        }
        let settings = Settings { errors: true, ..base };
        let answers = asked::plans()
            .into_iter()
            .map(|plan| {
                let (film, told) = self.film(&settings, plan, 77)?;
                Ok((plan, told.outcome, film, told.seconds))
            })
            .collect::<std::result::Result<Vec<_>, Fault>>()?;
        let asked = asked::rows(self.name, &answers, &truth);
        eprint!("{asked}");
        Ok(Result { scene: self.name.to_owned(), truth, rows, asked })
    }

    /// A long run with more photons to a pass; with a seed that no other run has.
    fn reference(&self, base: &Settings, longest: u64) -> std::result::Result<Truth, Fault> {
        let settings = Settings { photons: base.photons.saturating_mul(4), errors: true, ..base.clone() };
        let passes = (longest * u64::from(self.args.reference)).div_ceil(u64::from(settings.photons));
        eprintln!("{}: a reference of {passes} passes", self.name);
        let (film, told) = self.film(&settings, Budget::Passes(passes.min(100_000) as u32), u64::MAX)?;
        Ok(truth::reference(&film, told.outcome.paths))
    }

    fn film(&self, settings: &Settings, plan: impl Into<Plan>, seed: u64) -> std::result::Result<(Film, Told), Fault> {
        let settings = Settings { seed, ..settings.clone() };
        match backend::open(self.args.backend, None)? {
            Chosen::Cpu(on) => self.render(on, settings, plan.into()),
            Chosen::Vulkan(on) => self.render(*on, settings, plan.into()),
        }
    }

    fn render<B: TransportBackend>(
        &self,
        on: B,
        settings: Settings,
        plan: Plan,
    ) -> std::result::Result<(Film, Told), Fault> {
        let mut pipeline = Pipeline::new(on, &self.scene.view(), self.view, settings)?;
        let begun = std::time::Instant::now();
        let outcome = photon_core::render(&mut pipeline, plan, &mut ())?;
        let seconds = begun.elapsed().as_secs_f64();
        let film = pipeline.film()?;
        let facts = pipeline.facts();
        let last = outcome.last.as_ref();
        let radius = last.and_then(|last| last.radius_global.or(last.radius_caustic).or(last.radius_direct));
        let device = format!("{}: {}", facts.backend, facts.device);
        Ok((film, Told { seconds, outcome, radius: radius.unwrap_or(0.05), device }))
    }
}

/// What a run tells besides its picture.
struct Told {
    seconds: f64,
    outcome: Outcome,
    radius: f64,
    device: String,
}
