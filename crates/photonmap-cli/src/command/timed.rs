//! Settings for `--time`: those that are not given are chosen by trials in this scene.

use std::time::Instant;

use photon_core::{
    Bandwidth, Candidate, Choice, Estimator, Indirect, Open, Pipeline, Render as _, Settings, TransportBackend, View,
};
use photon_scene::Scene;

use crate::args::SettingsArgs;
use crate::command::gathering;
use crate::fault::Fault;

/// Half of the paths, from which trials begin: mostly, more passes are better than more photons in a given time.
pub(super) fn fewer_paths(args: &SettingsArgs, settings: Settings) -> Settings {
    let is_derived =
        matches!(settings.estimator, Estimator::Radius { radius: None }) && settings.irradiance_every.is_none();
    let from_maps = settings.indirect == Indirect::Map;
    if args.photon.photons.is_some() || !is_derived || !from_maps || !is_chosen(args) {
        return settings;
    }
    Settings { photons: (settings.photons / 2).max(Choice::MIN_PHOTONS.min(settings.photons)), ..settings }
}

/// Whether settings are chosen by trials: with `--time` and nothing else that determines its use. Error
/// estimates are wanted with the settings that are best for them.
pub(super) fn is_chosen(args: &SettingsArgs) -> bool {
    args.is_timed() && !args.budget.errors
}

/// Chooses areas, radii, the number of paths, whether each pixel has a radius of its own, and whether there is final
/// gathering, for the time that remains since `begun`. The renderer has them afterwards; it is returned with its settings.
///
/// # Errors
/// Those of rendering.
pub(super) fn choose<B: TransportBackend>(
    mut renderer: Pipeline<B>,
    (args, begun): (&SettingsArgs, Instant),
    (scene, view): (&Scene, View),
    settings: Settings,
) -> Result<(Pipeline<B>, Settings, Option<Choice>), Fault> {
    let Some(time) = args.budget.time.filter(|_| is_chosen(args)) else { return Ok((renderer, settings, None)) };
    let given = &args.estimate;
    let open = Open {
        photons: args.photon.photons.is_none(),
        area: given.area.is_none(),
        radius_factor: given.radius_factor.is_none(),
        bandwidth: given.bandwidth.is_none(),
        gather_rays: false,
    };
    let seconds = (time - begun.elapsed().as_secs_f64()).max(0.0);
    let Some(choice) = renderer.choose(&scene.view(), seconds, open)? else { return Ok((renderer, settings, None)) };
    let trials = seconds - (time - begun.elapsed().as_secs_f64());
    if gathering::is_worth_trying(args, &settings, (&choice, seconds), (&renderer.facts().setup, trials)) {
        return gathering::choose(renderer, (args, begun), (scene, view), settings, choice);
    }
    let (wanted, is_new) = with_choice(args, settings, &choice, (renderer.facts().photons, view, seconds));
    if is_new {
        renderer = Pipeline::new(renderer.into_backend()?, &scene.view(), view, wanted.clone())?;
    }
    Ok((renderer, wanted, Some(choice)))
}

/// The settings with what was chosen for this many seconds by a renderer with so many `photons`, and whether another one is
/// needed.
pub(super) fn with_choice(
    args: &SettingsArgs,
    settings: Settings,
    choice: &Choice,
    (photons, view, seconds): (u32, View, f64),
) -> (Settings, bool) {
    let errors = settings.errors || choice.bandwidth == Bandwidth::PerPixel;
    let radius_factor = settings.radius_factor * choice.radius_factor;
    let mut settings = Settings { area: choice.area, radius_factor, bandwidth: choice.bandwidth, errors, ..settings };
    let mut is_new = false;
    if args.photon.photons.is_none() {
        let pixels = view.width.saturating_mul(view.height);
        let more = more_paths(choice, photons, pixels, seconds);
        let chosen = more.map_or(choice.photons, |more| more.max(choice.photons));
        is_new = chosen != photons;
        if is_new {
            settings.photons = chosen;
        }
    }
    (settings, is_new)
}

/// Paths are not increased to where fewer passes than this fit.
const MANY_PASSES: f64 = 200.0;

/// The number of paths per pass if more are better: where radii are those of each pixel, the squared error by photons falls about
/// as (total paths)^(−2/3), and other noise is small after many passes. On a GPU a pass takes hardly longer with several times
/// as many. At most two per pixel; `None` if that is less than 1.5 times those of now.
fn more_paths(choice: &Choice, photons: u32, pixels: u32, seconds: f64) -> Option<u32> {
    let of_area = |each: &&Candidate| each.area == choice.area && each.photons == photons;
    let best = choice.candidates.iter().find(of_area)?;
    let parts = [choice.photon_seconds, best.seconds - choice.photon_seconds];
    if choice.bandwidth == Bandwidth::PerPixel { increased(photons, pixels, parts, seconds) } else { None }
}

fn increased(photons: u32, pixels: u32, parts: [f64; 2], seconds: f64) -> Option<u32> {
    let paths = affordable(photons, parts, seconds).min(2.0 * f64::from(pixels)) as u32;
    (f64::from(paths) >= 1.5 * f64::from(photons)).then_some(paths)
}

/// The paths with which [`MANY_PASSES`] fit if those of now take the first of these seconds of a pass, and in proportion; what
/// else a pass does takes the second.
fn affordable(photons: u32, [for_photons, rest]: [f64; 2], seconds: f64) -> f64 {
    f64::from(photons) * (seconds / MANY_PASSES - rest.max(0.0)).max(0.0) / for_photons.max(1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_as_many_as_leave_many_passes() {
        // 200 passes in 10 s are 50 ms each; 5 for what is not photons leave nine times the 5 that those of now take.
        let paths = affordable(100_000, [0.005, 0.005], 10.0);
        assert!((paths - 900_000.0).abs() < 1.0, "{paths}");
        // What is not photons takes all of a pass.
        assert_eq!(affordable(100_000, [0.005, 0.02], 2.0), 0.0);
        assert_eq!(affordable(100_000, [0.005, 0.005], 0.0), 0.0);
        assert!(affordable(100_000, [0.0, 0.0], 1.0).is_finite());
    }

    #[test]
    fn paths_are_at_most_two_per_pixel_and_increase_clearly_or_not_at_all() {
        let parts = [0.005, 0.005];
        assert_eq!(increased(100_000, 250_000, parts, 10.0), Some(500_000));
        assert!(increased(100_000, 10_000_000, parts, 10.0).is_some_and(|paths| paths.abs_diff(900_000) <= 1));
        assert_eq!(increased(100_000, 70_000, parts, 10.0), None);
        assert_eq!(increased(100_000, 10_000_000, parts, 2.0), None);
    }
}
