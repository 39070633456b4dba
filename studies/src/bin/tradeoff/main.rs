//! Error over render time, for every setting that trades one for the other.
#![expect(clippy::print_stderr, reason = "progress goes to stderr")]

mod answers;
mod asked;
mod csv_tables;
mod details;
mod document;
mod engine;
mod fields;
mod indices;
mod measure;
mod plot;
mod presets;
mod records;
mod sweep;
mod tables;
mod truth;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use photon_core::{Budget, Settings};
use photonmap_cli::atomic_write;
use photonmap_cli::backend::BackendName;
use photonmap_cli::fault::{self, Fault};

use engine::{Engine, Subject};
use measure::Run;
use records::{Body, ClaimRow, Part};
use truth::{Effort, Truth};

/// Renders scenes with many settings and seeds, and measures error and time of each. Results are written to files
/// in the folder --out, to which further calls add, also on other machines; each call writes
/// document and plots from all results in the folder.
#[derive(Debug, Parser)]
struct Args {
    /// Built-in scenes.
    #[arg(default_values_t = ["integrating-sphere", "furnace", "cornell", "cornell-glass", "ring"].map(str::to_owned))]
    scenes: Vec<String>,
    /// Backend; may be given twice.
    #[arg(long, value_enum, default_values_t = [BackendName::Auto])]
    backend: Vec<BackendName>,
    /// What to measure; may be given several times [default: all].
    #[arg(long, value_enum)]
    part: Vec<PartName>,
    /// Folder for results and plots.
    #[arg(long, default_value = "out/tradeoff")]
    out: PathBuf,
    /// The document to write, including tables; all rows go to another one beside it, `NAME-rows.csv`.
    #[arg(long)]
    document: Option<PathBuf>,
    /// Measure nothing: only write document and plots from the results in this folder.
    #[arg(long, value_name = "DIR")]
    assemble: Option<PathBuf>,
    /// Width and height of the pictures, pixels.
    #[arg(long, default_value_t = 48)]
    size: u32,
    /// Runs (seeds) of each setting.
    #[arg(long, default_value_t = 10)]
    seeds: u32,
    /// Photon paths per pass of the baseline setting.
    #[arg(long, default_value_t = 20_000)]
    photons: u32,
    /// Runs for confidence intervals of scenes with a known result.
    #[arg(long, default_value_t = 200)]
    claim_seeds: u32,
    /// Films of each field with a known result.
    #[arg(long, default_value_t = 200)]
    fields: u32,
    /// Pixels along a side of these fields.
    #[arg(long, default_value_t = 8)]
    field_side: u32,
    /// Largest number of passes for convergence rates.
    #[arg(long, default_value_t = 16_384)]
    rate_passes: u32,
    /// Pixels along a side for convergence rates.
    #[arg(long, default_value_t = 32)]
    rate_side: u32,
    /// Photons of a reference as a multiple of those of the longest run, where no exact result is known.
    #[arg(long, default_value_t = 6000)]
    reference: u32,
}

/// What can be measured separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PartName {
    /// The long runs that serve as references for scenes without a closed form.
    Reference,
    /// Each setting varied by itself, and the presets.
    Sweep,
    /// Confidence intervals of scenes with a known result.
    Claims,
    /// The candidates for presets.
    Presets,
    /// Build and query time per index.
    Indices,
    /// Error targets and time budgets.
    Asked,
    /// Confidence intervals in fields with a known result.
    Fields,
    /// Convergence rates in these fields.
    Rates,
    /// Pictures with a few settings beside the reference, for `tests/mitsuba/pictures.py`.
    Pictures,
}

fn main() -> ExitCode {
    fault::run(|| work(&Args::parse()))
}

/// One line of progress.
fn progress(line: &str) {
    eprintln!("{line}");
}

fn work(args: &Args) -> Result<(), Fault> {
    let folder = args.assemble.as_deref().unwrap_or(&args.out);
    if args.assemble.is_none() {
        measure(args)?;
    }
    let parts = records::parts(folder)?;
    if parts.is_empty() && args.assemble.is_none() {
        // Pictures and references contribute no rows.
        return Ok(());
    }
    if parts.is_empty() {
        return Err(Fault::input(format!("{}: holds no results of this program", folder.display())));
    }
    for sweep in tables::sweeps(&parts) {
        let name = format!("{}-{}.svg", sweep.1.scene, sweep.0.backend);
        write(&folder.join(name), &plot::sweep(sweep.1))?;
    }
    if let Some(svg) = plot::rates(&parts) {
        write(&folder.join("rates.svg"), &svg)?;
    }
    write(&folder.join("tradeoff.csv"), &details::csv(&parts))?;
    if let Some(svg) = plot::indices(&parts) {
        write(&folder.join("indices.svg"), &svg)?;
        write(&folder.join("indices.csv"), &indices::csv(&parts))?;
    }
    let home = args.document.as_deref().and_then(Path::parent).unwrap_or(folder);
    for path in [Some(folder.join("tradeoff.md")), args.document.clone()].into_iter().flatten() {
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let claims = format!("{name}-claims");
        write(&path.with_file_name(format!("{name}-rows.csv")), &details::every_row(&parts))?;
        for (name, text) in [(&name, document::markdown(&parts, home, &name)), (&claims, document::claims(&parts))] {
            let document = csv_tables::separate(&text, name);
            write(&path.with_file_name(format!("{name}.md")), &document.text)?;
            for (file, csv) in document.files {
                write(&path.with_file_name(file), &csv)?;
            }
        }
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<(), Fault> {
    atomic_write::write_bytes(path, text.as_bytes())
}

fn measure(args: &Args) -> Result<(), Fault> {
    if args.seeds < 2 || args.claim_seeds < 2 {
        return Err(Fault::input("--seeds, --claim-seeds: at least 2 are needed to tell bias from variance"));
    }
    if args.photons < 4 || args.reference == 0 || args.rate_passes < 64 || args.fields == 0 {
        return Err(Fault::input(
            "--photons of at least 4, --rate-passes of 64, --fields and --reference of 1 are needed",
        ));
    }
    if args.field_side == 0 || args.rate_side < 4 {
        return Err(Fault::input("--field-side of at least 1 and --rate-side of 4 are needed"));
    }
    std::fs::create_dir_all(&args.out).map_err(|why| Fault::writing(&args.out, why))?;
    let wanted = |part| args.part.is_empty() || args.part.contains(&part);
    for &backend in &args.backend {
        // One backend for all: a driver may refuse a program that opens it repeatedly.
        let mut engine = Engine::open(backend)?;
        if wanted(PartName::Fields) {
            let work = fields::FieldClaims { films: args.fields, side: args.field_side };
            let rows = engine.with(work)?;
            save(args, &engine, "fields", Body::Fields(rows))?;
        }
        if wanted(PartName::Rates) {
            let rows = engine.with(fields::Rates { side: args.rate_side, most: args.rate_passes })?;
            save(args, &engine, "rates", Body::Rates(rows))?;
        }
        for name in &args.scenes {
            let subject = Subject::new(name, args.size)?;
            let base = sweep::base(name, args.photons);
            if wanted(PartName::Claims)
                && let Some(radiance) = truth::closed_form(name)
            {
                let rows = claims(args, &mut engine, &subject, &base, &Truth::constant(radiance))?;
                save(args, &engine, &format!("claims-{name}"), Body::Claims(rows))?;
            }
            if wanted(PartName::Indices) {
                let rows = indices::rows(&mut engine, name, &base)?;
                save(args, &engine, &format!("indices-{name}"), Body::Indices(rows))?;
            }
            let judged = [PartName::Reference, PartName::Sweep, PartName::Presets, PartName::Asked, PartName::Pictures];
            if !judged.into_iter().any(wanted) {
                continue;
            }
            let (passes, photons) = sweep::longest(&base);
            let effort = Effort { passes, photons, times: args.reference };
            let truth = Truth::of(&mut engine, &subject, (&base, effort), &args.out)?;
            if wanted(PartName::Sweep) {
                let rows = sweep::rows(&mut engine, &subject, (&base, args.seeds), &truth)?;
                let body = records::Sweep {
                    scene: name.clone(),
                    size: args.size,
                    seeds: args.seeds,
                    photons: args.photons,
                    truth: truth.note.clone(),
                    rows,
                };
                save(args, &engine, &format!("sweep-{name}"), Body::Sweep(body))?;
            }
            if wanted(PartName::Presets) {
                let rows = presets::rows(&mut engine, &subject, &base, &truth)?;
                save(args, &engine, &format!("presets-{name}"), Body::Presets(rows))?;
            }
            if wanted(PartName::Pictures) && !truth.colours.is_empty() {
                let (backend, size) = (engine.names().0.to_owned(), args.size);
                let path = args.out.join(format!("pictures-{name}-{backend}.json"));
                let shots = sweep::shots(&mut engine, &subject, &base)?;
                let pictures =
                    records::Pictures { scene: name.clone(), size, backend, truth: truth.colours.clone(), shots };
                records::write(&path, &pictures)?;
            }
            if wanted(PartName::Asked) {
                let rows = asked::rows(&mut engine, &subject, &base, &truth)?;
                save(args, &engine, &format!("asked-{name}"), Body::Asked(rows))?;
            }
        }
    }
    Ok(())
}

fn save(args: &Args, engine: &Engine, what: &str, body: Body) -> Result<(), Fault> {
    let (backend, device) = engine.names();
    let path = args.out.join(format!("part-{what}-{backend}.json"));
    records::write(&path, &Part { backend: backend.to_owned(), device, body })
}

/// Confidence intervals of a scene with a known result, with many seeds.
fn claims(
    args: &Args,
    engine: &mut Engine,
    subject: &Subject,
    base: &Settings,
    truth: &Truth,
) -> Result<Vec<ClaimRow>, Fault> {
    let mut rows = Vec::new();
    for passes in [sweep::PASSES, 4 * sweep::PASSES] {
        let runs = (0..args.claim_seeds)
            .map(|seed| {
                let settings = Settings { errors: true, seed: u64::from(seed) + 1000, ..base.clone() };
                let (film, details) = engine.film(subject, &settings, Budget::Passes(passes))?;
                Ok(Run::new(&film, details.seconds, details.outcome.paths))
            })
            .collect::<Result<Vec<_>, Fault>>()?;
        let claims = measure::claims(&runs, &|pixel| truth.at(pixel));
        progress(&format!("{}: claims after {passes} passes: {:.1} % covered", subject.name, 100.0 * claims.covered));
        rows.push(ClaimRow {
            scene: subject.name.clone(),
            passes,
            seeds: args.claim_seeds,
            pixels: args.size * args.size,
            claims,
        });
    }
    Ok(rows)
}
