//! `photonmap info`

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use photon_core::{FilmTally, MapKind, MediumStack, Tally};
use photon_film::FilmInfo;

use crate::command::outlook::TargetArgs;
use crate::fault::Fault;
use crate::stdout;

/// Show what a film file contains: passes, scene, settings, photons, and who rendered it.
#[derive(Clone, Debug, Args)]
pub struct InfoArgs {
    /// The film file.
    #[arg(value_name = "FILE.film")]
    film: PathBuf,
    #[command(flatten)]
    target: TargetArgs,
}

/// Prints the description; the pixels are not read without a target.
///
/// # Errors
/// [`Fault::Input`] for a file that is no film, or a target that does not fit it; [`Fault::Failure`] if there is no forecast.
pub fn run(args: &InfoArgs) -> Result<(), Fault> {
    args.target.check(&args.film)?;
    stdout::write(text(&photon_film::read_info(&args.film)?).as_bytes())?;
    args.target.print(&args.film)
}

fn text(info: &FilmInfo) -> String {
    let key = &info.key;
    let (width, height) = key.size();
    let order =
        if info.in_order { "those of a single render" } else { "may differ from those of a single render by rounding" };
    let mut text = String::new();
    let mut line = |name: &str, value: &dyn std::fmt::Display| {
        // Writing to a string cannot fail. Names in a film are whatever its writer chose.
        let _ = writeln!(text, "{name:<12} {}", photon_film::shown(&value.to_string()));
    };
    line("scene", &format!("{}, digest {}", info.scene, key.scene_digest()));
    line("size", &format!("{width}x{height}"));
    line("passes", &format!("{} ({} in all)", info.contains, info.contains.count()));
    line("photons", &format!("{} paths per pass", key.photons()));
    line("grain", &key.grain());
    line("sums", &order);
    line("errors", &if info.errors { "estimated" } else { "not estimated" });
    for maker in &info.makers {
        line(
            "rendered by",
            &format!("{}, {} on {}, {:.1} s", maker.program, maker.backend, maker.device, maker.seconds),
        );
    }
    for (name, value) in counted(info) {
        line(name, &value);
    }
    for (name, value) in key.settings() {
        line("setting", &format!("{name} = {value}"));
    }
    text
}

/// What the photons did, in words.
fn counted(info: &FilmInfo) -> Vec<(&'static str, String)> {
    let FilmTally { passes, photons, aimed, .. } = &info.tally;
    let all = info.contains.count();
    if *passes == 0 {
        return vec![("paths", "not counted: the film was written by an older version".to_owned())];
    }
    let of = |tally: &Tally, how: &str| {
        let Tally { emitted, absorbed, escaped, terminated, truncated, dropped, .. } = tally;
        let terminated = if *terminated > 0 { format!("{terminated} {how}, ") } else { String::new() };
        let balance = if tally.balances() { "" } else { "; WRONG: they do not add up" };
        format!(
            "{emitted} emitted: {absorbed} absorbed, {escaped} escaped, {terminated}{truncated} truncated, {dropped} \
             dropped{balance}"
        )
    };
    let stored = info.tally.stored();
    let stored = MapKind::ALL.map(|kind| format!("{} in the {} map", stored[kind], kind.name()));
    let mut lines = vec![("paths", of(photons, "thinned out in fog"))];
    if aimed.emitted > 0 {
        lines.push(("aimed paths", of(aimed, "ended at diffuse surfaces")));
    }
    lines.push(("stored", stored.join(", ")));
    let too_deep = photons.too_deep.saturating_add(aimed.too_deep);
    if too_deep > 0 {
        let depth = MediumStack::DEPTH;
        lines.push(("warning", format!("{too_deep} paths entered more than {depth} overlapping solids at once")));
    }
    if info.tally.truncated_camera_paths > 0 {
        let text = format!("{} truncated; the light beyond is missing", info.tally.truncated_camera_paths);
        lines.push(("camera paths", text));
    }
    if u64::from(*passes) < all {
        lines.push(("counted", format!("{passes} of {all} passes; the others are from a file without counts")));
    }
    lines
}

#[cfg(test)]
mod tests {
    use photon_core::{FixedFlux, PassSet, Settings, View};
    use photon_film::FilmKey;

    use super::*;

    /// Counts of all passes, of some, of none, and counts that do not add up.
    #[test]
    fn counts_are_shown_as_far_as_they_are_known() {
        let scene = photon_scene::builtin("cornell").unwrap().build().unwrap();
        let view = View { camera: scene.camera(None, 2, 2).unwrap(), width: 2, height: 2 };
        let settings = Settings { photons: 100, ..Settings::default() };
        let on = backend_cpu::Cpu::with_threads(1).unwrap();
        let renderer = photon_core::Pipeline::new(on, &scene.view(), view, settings.clone()).unwrap();
        let key = FilmKey::new(&scene.view(), &view, &settings, &renderer, 1);
        let mut info = FilmInfo::new(key, "cornell");
        info.contains = PassSet::of(0, 0..4);
        assert!(text(&info).contains("not counted: the film was written by an older version"));

        let (one, photons) = (FixedFlux::new([1.0; 3]), &mut info.tally.photons);
        (photons.emitted, photons.absorbed, photons.too_deep) = (1, 1, 3);
        photons.flux_emitted.add(one);
        photons.flux_absorbed.add(one);
        (info.tally.passes, info.tally.truncated_camera_paths) = (3, 7);
        let shown = text(&info);
        for part in ["1 emitted: 1 absorbed", "3 of 4 passes", "3 paths entered more than", "7 truncated"] {
            assert!(shown.contains(part), "{part}: {shown}");
        }
        assert!(!shown.contains("WRONG") && !shown.contains("aimed"), "{shown}");

        info.tally.aimed.emitted = 5;
        info.tally.passes = 4;
        let shown = text(&info);
        assert!(shown.contains("aimed paths  5 emitted") && shown.contains("WRONG"), "{shown}");
        assert!(!shown.contains("counted "), "{shown}");
    }
}
