//! `photonmap explain`

use std::fmt::Write as _;

use crate::args::ExplainArgs;
use crate::fault::Fault;
use crate::{load, memory, stdout};

/// Prints what the scene requires with these settings, what is left out, and how photons are distributed over lights.
///
/// # Errors
/// As [`load::scene_within`], and invalid settings.
pub fn run(args: &ExplainArgs) -> Result<(), Fault> {
    let settings = args.settings.settings()?;
    let size = args.settings.picture.size;
    let limit = args.machine.memory.map(|cap| move || memory::for_loading(cap, size));
    let (scene, _) = load::scene_within(&args.scene, limit.as_ref().map(|limit| limit as &dyn Fn() -> u64))?;
    // A camera that does not exist is an error here too.
    args.settings.picture.view(&scene)?;
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
    stdout::write(text.as_bytes())
}
