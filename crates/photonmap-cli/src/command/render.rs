//! `photonmap render`

use std::path::Path;
use std::time::Instant;

use photon_core::{LightShare, Pipeline, Render, Settings, TransportBackend, View};
use photon_scene::{CompressedTree, LoadReport, Scene};

use crate::args::{MachineArgs, RenderArgs};
use crate::backend::{self, Opened};
use crate::command::decided::{self, Decided};
use crate::command::picture::{self, Look, Pictures, Shown};
use crate::command::{lost, render_blocks, render_film, render_passes};
use crate::fault::Fault;
use crate::outputs::Outputs;
use crate::report::{self, Details};
use crate::watch::Watch;
use crate::{load, memory, signals, summary};

/// Renders the scene and writes the files.
///
/// # Errors
/// [`Fault::Input`] for invalid options, scenes and paths, before anything is rendered;
/// [`Fault::Failure`] if rendering or writing fails.
pub fn run(args: &RenderArgs) -> Result<(), Fault> {
    let pictures = Pictures::of(args)?;
    let mut settings = Settings { transparent_background: args.files.transparent, ..args.settings.settings()? };
    render_blocks::check(args, &settings)?;
    render_film::check(args)?;
    args.files.json.iter().try_for_each(|path| Outputs::check_report(path))?;
    let begun = Instant::now();
    signals::end_while_loading()?;
    let ((scene, loaded), seconds_load, opened) = load_and_open(args)?;
    let look = pictures.look;
    let mut watch = Watch::start(&args.watch, look, &args.scene.scene)?;
    let view = args.settings.picture.view(&scene)?;
    let (mut renderers, seconds_device, decided) = start((args, begun), opened, &scene, view, &settings)?;
    if let Some(decided) = &decided {
        say!("{}", decided.lines());
        settings = Settings { memory: settings.memory, ..decided.settings().clone() };
    }
    let ready = Instant::now();
    let mut warnings = scene.warnings().to_vec();
    let starving = starving(&scene, &*renderers[0]);
    summary::say("warning: ", &starving);
    warnings.extend(starving);

    let stop = signals::stop();
    let (outcome, film, filed) = match &args.film.film {
        Some(path) => {
            let film = render_film::run(path, args, (&scene, &view, &settings), &mut renderers, (&mut watch, stop))?;
            (film.outcome, film.film, Some((path, film.filed)))
        }
        None if render_blocks::in_blocks(args) => {
            let (outcome, film) = render_blocks::run(args, &settings, &mut renderers, &mut watch, stop)?;
            (outcome, film, None)
        }
        None => {
            let renderer = &mut *renderers[0];
            (render_passes::run(args, settings.photons, renderer, begun, (&mut watch, stop))?, renderer.film()?, None)
        }
    };
    let seconds_passes = ready.elapsed().as_secs_f64();
    let renderer = &*renderers[0];
    let device = photon_film::device_names(&renderers);
    let grain = if render_blocks::in_blocks(args) {
        Some(render_blocks::blocks(args, &settings, settings.photons, renderers.len())?.grain())
    } else {
        None
    };
    let seconds_total = begun.elapsed().as_secs_f64();
    let pixels = u64::from(view.width) * u64::from(view.height);
    for warning in lost::too_deep(&outcome).into_iter().chain(lost::truncated(&outcome, &settings, pixels)) {
        say!("warning: {warning}");
        warnings.push(warning);
    }
    // Said before the first pass.
    warnings.extend(outcome.lowered.clone());
    let facts = renderer.facts();
    settings = Settings {
        photons: facts.photons,
        camera_samples: facts.camera_samples,
        shadow_rays: facts.shadow_rays,
        gather_rays: facts.gather_rays,
        ..settings
    };

    let details = Details {
        scene: &args.scene.scene,
        environment: scene.environment_text(),
        size: args.settings.picture.size,
        device: &device,
        grain,
        film: args.film.film.as_ref().map(|_| &film),
        settings: &settings,
        outcome: &outcome,
        load: &loaded,
        warnings: &warnings,
        lights: &photon_core::light_shares(&scene.view()),
        seconds_load,
        seconds_start: (ready - begun).as_secs_f64() - seconds_load,
        seconds_device,
        decided: decided.as_ref(),
        seconds_passes,
        seconds_total,
    };
    // Every output is tried, whatever becomes of the others, and before those who watch are waited for.
    let mut written = Outputs::default();
    match filed {
        Some((_, Ok(false))) | None => {}
        Some((path, filed)) => {
            written.named(format!("{} ({} passes)", path.display(), film.passes), filed.map(|_| ()));
        }
    }
    let (shown, denoised) = picture::shown(&film, pictures.denoiser.as_ref());
    written.keep(denoised);
    for output in &pictures.paths {
        written.file(output, save(args, output, (&shown, film.passes, look), renderer, &details));
    }
    if let Some(path) = &args.files.json {
        written.report(path, &report::json(renderer, &details));
    }
    watch.finish(&film);
    if let (Some(cap), Some(peak)) = (args.machine.memory, memory::peak()) {
        say!("memory: {:.0} MiB at the peak, of {:.0} allowed", peak as f64 / 1_048_576.0, cap as f64 / 1_048_576.0);
    }
    let (passes, paths) = (outcome.passes, renderer.facts().photons);
    let each = match (passes, film.cut) {
        (_, true) => "a part of a pass".to_owned(),
        (1, false) => "1 pass".to_owned(),
        (_, false) => format!("{passes} passes"),
    };
    let line = format!("wrote {written}: {each} of {paths} paths in {seconds_total:.1} s");
    if outcome.cancelled {
        written.keep(Err(Fault::Interrupted(format!("{line}, interrupted"))));
    } else {
        say!("{line}");
    }
    written.result()
}

/// The scene, the seconds that loading it took, and the backend, which is opened meanwhile: that takes a GPU's driver half a
/// second. If the scene is loaded first, its tree is built until the device is there. `None` for several devices, and under a limit on memory, which drivers take too: then it is opened afterwards.
#[expect(clippy::type_complexity, reason = "three things that are made at the same time")]
fn load_and_open(args: &RenderArgs) -> Result<((Scene, LoadReport), f64, Option<(Opened, f64)>), Fault> {
    let begun = Instant::now();
    let load = |limit| load::scene_within(&args.scene, limit).map(|loaded| (loaded, begun.elapsed().as_secs_f64()));
    if let Some(cap) = args.machine.memory {
        let (loaded, seconds) = load(Some(&|| memory::for_loading(cap, args.settings.picture.size)))?;
        return Ok((loaded, seconds, None));
    }
    if args.machine.several() {
        let (loaded, seconds) = load(None)?;
        return Ok((loaded, seconds, None));
    }
    std::thread::scope(|threads| {
        let opening = threads.spawn(|| open(&args.machine));
        let loaded = load(None);
        // It takes that long for GPUs only: the cores are free meanwhile. What is wrong with the scene is found later.
        let tree = match &loaded {
            Ok(((scene, _), _)) if !opening.is_finished() => {
                let (begun, view) = (Instant::now(), scene.view());
                let tree = CompressedTree::build(view.positions, view.triangles).ok();
                tree.map(|tree| (tree, begun.elapsed().as_secs_f64()))
            }
            _ => None,
        };
        let opened = opening.join().map_err(|_| Fault::failure("opening the device failed"));
        let (loaded, seconds) = loaded?;
        let (opened, device) = opened??;
        let opened = match tree {
            Some((tree, seconds)) => opened.with_tree(tree, seconds),
            None => opened,
        };
        Ok((loaded, seconds, Some((opened, device))))
    })
}

/// The backend, and the seconds that opening it took.
pub(super) fn open(machine: &MachineArgs) -> Result<(Opened, f64), Fault> {
    let begun = Instant::now();
    let opened = match machine.device.as_slice() {
        [device] => backend::open_device_quietly(device),
        _ => backend::open_quietly(machine.backend, machine.threads),
    };
    Ok((opened?, begun.elapsed().as_secs_f64()))
}

/// Warnings about lights that get hardly any photons, if photons are traced.
fn starving(scene: &Scene, renderer: &dyn Render) -> Vec<String> {
    let facts = renderer.facts();
    let required = &facts.required;
    if !required.maps.any() {
        return Vec::new();
    }
    let shares = photon_core::light_shares(&scene.view());
    let few = shares.iter().filter(|share| share.starves(facts.photons));
    let warning = |share: &LightShare| {
        let (paths, power) = (share.paths(facts.photons), share.power);
        format!(
            "{} has {power:.1e} of the power and gets about {paths:.0} of {} paths a pass, too few to show what it does; use more photons",
            share.what, facts.photons
        )
    };
    few.map(warning).collect()
}

/// A renderer for each device, at least one; the seconds of opening it, 0 for several; and settings that were decided.
#[expect(clippy::type_complexity, reason = "three results, of which only the caller makes use")]
fn start(
    (args, begun): (&RenderArgs, Instant),
    opened: Option<(Opened, f64)>,
    scene: &Scene,
    view: View,
    settings: &Settings,
) -> Result<(Vec<Box<dyn Render>>, f64, Option<Decided>), Fault> {
    if args.machine.several() {
        let devices = backend::open_devices(&args.machine.device)?;
        // The devices of one host compile their kernels at the same time.
        return std::thread::scope(|threads| {
            let start = |on| threads.spawn(move || pipeline(on, scene, view, settings));
            let starting: Vec<_> = devices.into_iter().map(start).collect();
            let renderers = starting
                .into_iter()
                .map(|renderer| renderer.join().map_err(|_| Fault::failure("a device failed"))?)
                .collect::<Result<_, _>>()?;
            Ok((renderers, 0.0, None))
        });
    }
    let (opened, device) = opened.map_or_else(|| open(&args.machine), Ok)?;
    let on = opened.report();
    // Measured now, since a Vulkan driver allocates memory of its own when it is opened.
    let memory = args.machine.memory.map(|cap| memory::for_the_library(cap, args.settings.picture.size));
    let open = (&args.settings, begun, !render_blocks::in_blocks(args));
    let made = decided::open(on, open, (scene, view), (settings, memory));
    let besides = memory::besides(args.settings.picture.size);
    let (renderer, decided) = made.map_err(|fault| fault.within(args.machine.memory, besides))?;
    Ok((vec![renderer], device, decided))
}

fn pipeline<B: TransportBackend>(
    on: B,
    scene: &Scene,
    view: View,
    settings: &Settings,
) -> Result<Box<dyn Render>, Fault> {
    Ok(Box::new(Pipeline::new(on, &scene.view(), view, settings.clone())?))
}

fn save(
    args: &RenderArgs,
    path: &Path,
    (shown, passes, look): (&Shown<'_>, u32, Look),
    renderer: &dyn Render,
    details: &Details<'_>,
) -> Result<(), Fault> {
    if !picture::is_exr(path) {
        return picture::write(path, shown, look, &[]);
    }
    let facts = renderer.facts();
    let seconds: Vec<String> = photon_core::Stage::ALL
        .into_iter()
        .map(|stage| format!("{} {:.3}", stage.name(), details.outcome.seconds.get(stage)))
        .collect();
    let mut attributes = vec![
        ("photon:scene", picture::without_folder(&args.scene.scene).to_owned()),
        ("photon:seed", args.settings.photon.seed.to_string()),
        ("photon:passes", passes.to_string()),
        ("photon:photons_per_pass", facts.photons.to_string()),
        ("photon:settings", format!("{:?}", details.settings)),
        ("photon:backend", facts.backend.to_owned()),
        ("photon:device", details.device.to_owned()),
        ("photon:seconds", format!("total {:.3}, {}", details.seconds_total, seconds.join(", "))),
        ("photon:command", picture::command(std::env::args())),
    ];
    attributes.extend(
        details.decided.and_then(|decided| decided.options(details.outcome)).map(|text| ("photon:decided", text)),
    );
    let environment = details.environment.map(picture::without_folder);
    attributes.extend(environment.map(|text| ("photon:environment", text.to_owned())));
    let attributes: Vec<(String, String)> =
        attributes.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    picture::write(path, shown, look, &attributes)
}
