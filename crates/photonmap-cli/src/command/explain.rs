//! `photonmap explain`

use std::fmt::Write as _;
use std::time::Instant;

use photon_core::{Settings, TransportBackend, View};
use photon_scene::Scene;

use crate::args::ExplainArgs;
use crate::backend::Chosen;
use crate::command::choice_error::{ChoiceError, with_or_without_gathering};
use crate::command::chosen::{Allowed, ChosenSettings};
use crate::command::render;
use crate::fault::Fault;
use crate::{load, memory, stdout};

/// Prints what the scene requires with these settings, what is left out, how photons are distributed over lights, and what is
/// chosen for a time, a preset or a target if it is given. Settings of renders in blocks and on several devices are fixed.
///
/// # Errors
/// As [`load::scene_within`], and invalid settings; if something is chosen also those of rendering.
pub fn run(args: &ExplainArgs, in_blocks: bool) -> Result<(), Fault> {
    let mut settings = args.settings.settings()?;
    let begun = Instant::now();
    let size = args.settings.picture.size;
    let limit = args.machine.memory.map(|cap| move || memory::for_loading(cap, size));
    let (scene, _) = load::scene_within(&args.scene, limit.as_ref().map(|limit| limit as &dyn Fn() -> u64))?;
    // A camera that does not exist is an error here too.
    let view = args.settings.picture.view(&scene)?;
    let mut choice = String::new();
    let is_open = args.settings.purpose().is_some() && !in_blocks && !args.machine.several();
    if args.settings.is_timed() || is_open {
        let chosen = trials((args, begun), &scene, view, settings)?;
        choice = chosen.table();
        settings = chosen.settings;
    }
    let mut text = format!("{}: {} triangles\n", args.scene.scene, scene.view().triangles.len());
    if let Some(environment) = scene.environment_text() {
        let _ = writeln!(text, "environment: {environment}");
    }
    if let Some(shares) = photon_core::portal_shares(&scene.view()) {
        let (light, photons) = (100.0 * shares.light, 100.0 * shares.photons);
        let count = scene.view().portals.len();
        let _ = writeln!(
            text,
            "portals: {count} triangles; {light:.3} % of the light from infinitely far away passes them, and {photons:.1} % \
             of its photons"
        );
    }
    let needs = photon_core::explain(&scene.view(), &settings);
    for (heading, needed) in [("needed", true), ("left out", false)] {
        let _ = writeln!(text, "\n{heading}:");
        for need in needs.iter().filter(|need| need.needed == needed) {
            let _ = writeln!(text, "  {:<24} {}", need.what, need.why);
        }
    }
    let _ = writeln!(text, "\nphotons by light, of {} paths a pass:", settings.photons);
    for share in photon_core::light_shares(&scene.view()) {
        let few = if share.starves(settings.photons) { ", too few to show what it does" } else { "" };
        let (paths, power) = (share.paths(settings.photons), 100.0 * share.power);
        let _ = writeln!(text, "  {:<24} {paths:.0} paths for {power:.3} % of the power{few}", share.what);
    }
    text.push_str(&choice);
    stdout::write(text.as_bytes())
}

/// What is chosen for the time, the preset or the target, by trials on the backend of the options.
fn trials(
    (args, begun): (&ExplainArgs, Instant),
    scene: &Scene,
    view: View,
    settings: Settings,
) -> Result<ChosenSettings, Fault> {
    if args.machine.several() {
        return Err(Fault::input("--device: settings for a time are chosen on a single device; give one"));
    }
    let size = args.settings.picture.size;
    let chosen = with_or_without_gathering(|may_gather| {
        let (opened, _) = render::open(&args.machine)?;
        let memory = args.machine.memory.map(|cap| memory::for_the_library(cap, size));
        let within = |memory| Settings { memory, ..settings.clone() };
        let on = if may_gather { opened.report() } else { opened.silent() };
        match on {
            Chosen::Cpu(on) => {
                // It shares the texels, which are resident, with the scene.
                let memory = memory.map(|bytes| bytes.saturating_add(memory::texels(scene)));
                choose(on, (args, begun, may_gather), (scene, view), within(memory))
            }
            Chosen::Vulkan(on) => choose(*on, (args, begun, may_gather), (scene, view), within(memory)),
        }
    });
    let chosen = chosen.map(|(chosen, _)| chosen);
    chosen.map_err(|fault| fault.within(args.machine.memory, memory::besides(size)))
}

fn choose<B: TransportBackend>(
    on: B,
    (args, begun, may_gather): (&ExplainArgs, Instant, bool),
    (scene, view): (&Scene, View),
    settings: Settings,
) -> Result<ChosenSettings, ChoiceError> {
    let allowed = Allowed { choices: true, gathering: may_gather };
    let made = ChosenSettings::pipeline(on, (&args.settings, begun), (scene, view), settings, allowed);
    made.map(|(_, chosen)| chosen)
}
