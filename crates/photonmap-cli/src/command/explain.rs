//! `photonmap explain`

use std::fmt::Write as _;
use std::time::Instant;

use crate::args::ExplainArgs;
use crate::command::{decided, render};
use crate::fault::Fault;
use crate::{load, memory, signals, stdout};

/// Prints what the scene requires with these settings, what is left out, how photons are distributed over lights, and which
/// settings are decided if `may_decide` and the options leave any open.
///
/// # Errors
/// As [`load::scene_within`], and invalid settings; if something is decided also those of a pass.
pub fn run(args: &ExplainArgs, may_decide: bool) -> Result<(), Fault> {
    let begun = Instant::now();
    signals::end_while_loading()?;
    let mut settings = args.settings.settings()?;
    let size = args.settings.picture.size;
    let limit = args.machine.memory.map(|cap| move || memory::for_loading(cap, size));
    let (scene, _) = load::scene_within(&args.scene, limit.as_ref().map(|limit| limit as &dyn Fn() -> u64))?;
    // A camera that does not exist is an error here too.
    let view = args.settings.picture.view(&scene)?;
    let mut decided = None;
    if may_decide && args.settings.open().is_some() {
        let (opened, _) = render::open(&args.machine)?;
        let memory = args.machine.memory.map(|cap| memory::for_the_library(cap, size));
        let open = (&args.settings, begun, true);
        let made = decided::open(opened.report(), open, (&scene, view), (&settings, memory));
        decided = made.map_err(|fault| fault.within(args.machine.memory, memory::besides(size)))?.1;
    }
    if let Some(decided) = &decided {
        settings = decided.settings().clone();
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
    if let Some(decided) = &decided {
        let _ = writeln!(text, "\n{}", decided.lines());
    }
    stdout::write(text.as_bytes())
}
