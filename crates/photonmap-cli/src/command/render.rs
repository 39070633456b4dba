//! A scene in, a picture out.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "results go to stdout, progress to stderr")]

use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use photon_core::{
    Budget, Event, Film, Forecast, LightShare, Outcome, Pipeline, Render, Settings, TransportBackend, View, render,
};
use photon_examples::args::Args;
use photon_examples::backend::{self, Chosen};
use photon_examples::fault::{self, Fault};
use photon_examples::report::{self, Told};
use photon_examples::{exr_file, png_file};
use photon_examples::{memory, whole};
use photon_scene::{LoadReport, Overrides, Scene};

fn main() -> ExitCode {
    fault::run(|| work(&Args::parse()))
}

fn work(args: &Args) -> Result<(), Fault> {
    if args.list {
        for (name, description) in photon_scene::builtin_names() {
            println!("{name:<20} {description}");
        }
        return Ok(());
    }
    if args.devices {
        for line in backend::list()? {
            println!("{line}");
        }
        return Ok(());
    }
    let settings = args.settings()?;
    let outputs = outputs(args)?;
    if !args.explain {
        let json = args.json.iter().filter(|path| path.as_os_str() != "-");
        outputs.iter().chain(json).try_for_each(|path| whole::check(path))?;
    }
    let begun = Instant::now();
    let (scene, load) = load(args)?;
    let seconds_load = begun.elapsed().as_secs_f64();
    for warning in scene.warnings() {
        eprintln!("warning: {warning}");
    }
    for line in &load.lines {
        eprintln!("{line}");
    }
    if args.strict && !load.is_exact() {
        return Err(Fault::input("--strict: the lines above say what is approximated or left out"));
    }
    let (width, height) = args.size;
    let view = View { camera: scene.camera(args.camera.as_deref(), width, height)?, width, height };
    if args.explain {
        return explain(args, &scene, &settings);
    }
    let mut renderer = start(args, &scene, view, &settings)?;
    let mut warnings = scene.warnings().to_vec();
    let starving = starving(&scene, &*renderer);
    starving.iter().for_each(|warning| eprintln!("warning: {warning}"));
    warnings.extend(starving);

    let stop = Arc::new(AtomicBool::new(false));
    let heard = Arc::clone(&stop);
    let handler = ctrlc::set_handler(move || {
        // The first asks for what is there; the second does not wait for it.
        if heard.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    });
    handler.map_err(Fault::failure)?;
    let outcome = passes(args, settings.photons, &mut *renderer, begun, &stop)?;
    let film = renderer.film()?;
    let seconds_total = begun.elapsed().as_secs_f64();

    let told = Told {
        scene: &args.scene,
        size: args.size,
        settings: &settings,
        outcome: &outcome,
        load: &load,
        warnings: &warnings,
        lights: &photon_core::light_shares(&scene.view()),
        seconds_load,
        seconds_total,
    };
    for output in &outputs {
        save(args, output, &film, &*renderer, &told)?;
        println!("{}", output.display());
    }
    if let Some(path) = &args.json {
        let text = format!("{:#}\n", report::json(&*renderer, &told));
        if path.as_os_str() == "-" {
            std::io::stdout().write_all(text.as_bytes()).map_err(|why| Fault::writing(path, why))?;
        } else {
            whole::write_bytes(path, text.as_bytes())?;
        }
    }
    let stopped = if outcome.cancelled { ", stopped early" } else { "" };
    let paths = renderer.facts().photons;
    eprintln!("{} passes of {paths} paths in {seconds_total:.1} s{stopped}", outcome.passes);
    if let (Some(cap), Some(peak)) = (args.memory, memory::peak()) {
        eprintln!("{:.0} MiB at the peak, of {:.0} allowed", peak as f64 / 1_048_576.0, cap as f64 / 1_048_576.0);
    }
    Ok(())
}

/// Checked before anything is rendered.
fn outputs(args: &Args) -> Result<Vec<PathBuf>, Fault> {
    if args.output.is_empty() {
        let stem = Path::new(&args.scene).file_stem().unwrap_or_default();
        return Ok(vec![Path::new(stem).with_extension("png")]);
    }
    for path in &args.output {
        let known = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr") || e.eq_ignore_ascii_case("png"));
        if !known {
            return Err(Fault::input(format!("{}: pictures end in .exr or .png", path.display())));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(Fault::input(format!("{}: there is no folder {}", path.display(), folder.display())));
        }
        if path.is_dir() {
            return Err(Fault::input(format!("{}: is a folder", path.display())));
        }
    }
    Ok(args.output.clone())
}

fn load(args: &Args) -> Result<(Scene, LoadReport), Fault> {
    let overrides = args.overrides.as_deref().map(Overrides::read).transpose()?;
    match photon_scene::builtin(&args.scene) {
        Some(mut builder) => {
            let mut report = LoadReport::default();
            if let Some(overrides) = &overrides {
                overrides.apply(&mut builder, &mut report)?;
            }
            Ok((builder.build()?, report))
        }
        None if Path::new(&args.scene).extension().is_none() => {
            let names: Vec<&str> = photon_scene::builtin_names().iter().map(|(name, _)| *name).collect();
            Err(Fault::input(format!(
                "{}: no built-in scene has that name (there are {}), and it has no ending that tells a file's format",
                args.scene,
                names.join(", ")
            )))
        }
        None => Ok(photon_scene::load(Path::new(&args.scene), overrides.as_ref())?),
    }
}

/// What the scene needs, and what is left out.
fn explain(args: &Args, scene: &Scene, settings: &Settings) -> Result<(), Fault> {
    println!("{}: {} triangles", args.scene, scene.view().triangles.len());
    let needs = photon_core::explain(&scene.view(), settings);
    for (heading, needed) in [("needed", true), ("left out", false)] {
        println!("\n{heading}:");
        for need in needs.iter().filter(|need| need.needed == needed) {
            println!("  {:<24} {}", need.what, need.why);
        }
    }
    println!("\nphotons by light, of {} paths a pass:", settings.photons);
    for share in photon_core::light_shares(&scene.view()) {
        let few = if share.starves(settings.photons) { ", too few to show what it does" } else { "" };
        let (paths, power) = (share.paths(settings.photons), 100.0 * share.power);
        println!("  {:<24} {paths:.0} paths for {power:.3} % of the power{few}", share.what);
    }
    Ok(())
}

/// Lights that get hardly any photons, if photons are sent out.
fn starving(scene: &Scene, renderer: &dyn Render) -> Vec<String> {
    let facts = renderer.facts();
    let required = &facts.required;
    if !(required.direct_map || required.caustic_map || required.global_map) {
        return Vec::new();
    }
    let shares = photon_core::light_shares(&scene.view());
    let few = shares.iter().filter(|share| share.starves(facts.photons));
    let told = |share: &LightShare| {
        let (paths, power) = (share.paths(facts.photons), share.power);
        format!(
            "{} has {power:.1e} of the power and gets about {paths:.0} of {} paths a pass, too few to show what it does; ask for more photons",
            share.what, facts.photons
        )
    };
    few.map(told).collect()
}

fn start(args: &Args, scene: &Scene, view: View, settings: &Settings) -> Result<Box<dyn Render>, Fault> {
    let chosen = backend::open(args.backend, args.threads)?;
    // A driver may keep much to itself by now.
    let memory = args.memory.map(|cap| memory::for_the_library(cap, args.size));
    let settings = &Settings { memory, ..settings.clone() };
    match chosen {
        Chosen::Cpu(on) => pipeline(on, scene, view, settings),
        Chosen::Vulkan(on) => pipeline(*on, scene, view, settings),
    }
}

fn pipeline<B: TransportBackend>(
    on: B,
    scene: &Scene,
    view: View,
    settings: &Settings,
) -> Result<Box<dyn Render>, Fault> {
    Ok(Box::new(Pipeline::new(on, &scene.view(), view, settings.clone())?))
}

fn passes(
    args: &Args,
    photons: u32,
    renderer: &mut dyn Render,
    started: Instant,
    stop: &AtomicBool,
) -> Result<Outcome, Fault> {
    // The time asked for is that of the whole program.
    let time = args.time.map(|time| Duration::from_secs_f64(time).saturating_sub(started.elapsed() + writing(args)));
    let mut plan = args.plan(time);
    // As many photons in all, if memory makes passes smaller.
    let each = renderer.facts().photons;
    if each < photons {
        eprintln!("{each} paths a pass, for the memory allowed");
        let more = |passes: u32| passes.saturating_mul(photons.div_ceil(each)).min(u32::MAX - 1);
        if let Budget::Passes(passes) = &mut plan.until {
            *passes = more(*passes);
        }
        plan.most_passes = plan.most_passes.map(more);
    }
    let terminal = std::io::stderr().is_terminal();
    // With only a time to go by, the bar shows that.
    let by_time = args.passes.is_none() && args.time.is_some();
    let count = plan.passes();
    let length = if by_time { time.unwrap_or_default().as_secs() } else { u64::from(count) };
    let bar = if terminal { indicatif::ProgressBar::new(length) } else { indicatif::ProgressBar::hidden() };
    let style = "{wide_bar} {msg} {elapsed} / {duration}";
    if let Ok(style) = indicatif::ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    let begun = Instant::now();
    let mut foretold = false;
    let mut observer = |event: &Event<'_>| {
        match event {
            Event::PassDone(pass) => {
                bar.set_position(if by_time { begun.elapsed().as_secs() } else { u64::from(pass.index) + 1 });
                bar.set_message(format!("pass {}", pass.index + 1));
                let next = pass.index + 1;
                if !terminal && (next.is_power_of_two() || next == count) {
                    eprintln!("pass {next}, {:.1} s", begun.elapsed().as_secs_f64());
                }
            }
            Event::Forecast(forecast) if !std::mem::replace(&mut foretold, true) => {
                bar.suspend(|| eprintln!("{}", foretell(forecast, photons)));
            }
            _ => {}
        }
        if stop.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = render(renderer, plan, &mut observer);
    bar.finish_and_clear();
    let outcome = outcome?;
    if let Some(reached) = &outcome.reached {
        eprintln!("{}", claimed("reached", reached));
    }
    Ok(outcome)
}

/// What writing the pictures will take, about: a tenth of a microsecond a pixel for a PNG, and the
/// compression of all layers for an EXR.
fn writing(args: &Args) -> Duration {
    let pixels = f64::from(args.size.0) * f64::from(args.size.1);
    let exr = args.output.iter().any(|path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")));
    Duration::from_secs_f64(pixels * if exr { 1.5e-6 } else { 1e-7 })
}

fn claimed(what: &str, forecast: &Forecast) -> String {
    let Forecast { passes, claimed, error, share, .. } = forecast;
    let within = forecast.target.map_or(String::new(), |target| {
        format!(", {:.1} % of them within {:.2} %", 100.0 * forecast.within, 100.0 * target)
    });
    format!(
        "{what} after {passes} passes: an error of {:.2} % in {:.0} % of the pixels of which anything is claimed, which are {:.1} % of all{within}",
        100.0 * error,
        100.0 * share,
        100.0 * claimed
    )
}

fn foretell(forecast: &Forecast, photons: u32) -> String {
    // From the least on, if that rounds to another number.
    let from = |least: String, most: String| if least == most { most } else { format!("{least} to {most}") };
    let cost = |least: u32, most: u32| {
        let [least, most] = [least, most].map(|passes| {
            let (passes, photons) = (f64::from(passes), f64::from(photons) / 1e6);
            [
                format!("{passes}"),
                format!("{:.1}", passes * photons),
                format!("{:.0}", passes * forecast.seconds_per_pass),
            ]
        });
        let [passes, photons, seconds]: [String; 3] = std::array::from_fn(|i| from(least[i].clone(), most[i].clone()));
        format!("{passes} passes, {photons} million photons, {seconds} s")
    };
    let limit = || {
        let [least, most] =
            [forecast.error_possible_least, forecast.error_possible].map(|error| format!("{:.2}", 100.0 * error));
        format!("an error of {} % with {}", from(least, most), cost(forecast.passes_possible, forecast.passes_possible))
    };
    let line = match (forecast.target, forecast.passes_least, forecast.passes_needed) {
        (None, ..) => format!("predicted: {}", limit()),
        (Some(_), Some(least), Some(most)) if forecast.is_reachable() => {
            format!("predicted: reached with {}", cost(least, most))
        }
        (Some(_), Some(least), most) => {
            let often = most.map_or_else(|| format!("{} or more", cost(least, least)), |most| cost(least, most));
            let perhaps = if forecast.may_be_reached() { "perhaps " } else { "" };
            format!("{perhaps}out of reach: it takes {often}; predicted: {}", limit())
        }
        (Some(_), None, _) => format!("out of reach with any number of passes; predicted: {}", limit()),
    };
    let radii = match forecast.radius_factor {
        factor if (factor - 1.0).abs() < 1e-9 => String::new(),
        factor => format!(", with radii times {factor:.2} from here on"),
    };
    format!("{}\n{line}{radii}", claimed("pilot", forecast))
}

fn save(args: &Args, path: &Path, film: &Film, renderer: &dyn Render, told: &Told<'_>) -> Result<(), Fault> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return png_file::write(path, film, args.tonemap, args.exposure);
    }
    let facts = renderer.facts();
    let seconds: Vec<String> = photon_core::Stage::ALL
        .into_iter()
        .map(|stage| format!("{} {:.3}", stage.name(), told.outcome.seconds.get(stage)))
        .collect();
    let attributes = [
        ("photon:scene", args.scene.clone()),
        ("photon:seed", args.seed.to_string()),
        ("photon:passes", film.passes.to_string()),
        ("photon:photons_per_pass", facts.photons.to_string()),
        ("photon:settings", format!("{:?}", told.settings)),
        ("photon:backend", facts.backend.to_owned()),
        ("photon:device", facts.device),
        ("photon:seconds", format!("total {:.3}, {}", told.seconds_total, seconds.join(", "))),
        ("photon:command", std::env::args().collect::<Vec<_>>().join(" ")),
    ];
    exr_file::write(path, film, &attributes.map(|(name, value)| (name.to_owned(), value)))
}
