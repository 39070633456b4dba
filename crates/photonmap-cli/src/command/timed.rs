//! Settings for `--time`, `--preset` or `--target-error`: those that are not given are chosen by trials in this scene.

use std::time::Instant;

use photon_core::{
    Area, Bandwidth, Candidate, Choice, Estimator, Goal, Indirect, Open, Pipeline, Preset, Render as _, Settings,
    TransportBackend, View,
};
use photon_scene::Scene;

use crate::args::{Purpose, SettingsArgs};
use crate::command::choice_error::ChoiceError;
use crate::command::gathering;

/// The time for passes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deadline {
    /// Since when trials take time from it; `None` if they come on top.
    pub(super) since: Option<Instant>,
    pub(super) seconds: f64,
}

impl Deadline {
    pub(super) fn left(&self) -> f64 {
        let taken = self.since.map_or(0.0, |since| since.elapsed().as_secs_f64());
        (self.seconds - taken).max(0.0)
    }
}

/// With a target, the most paths for each pixel from which trials begin. Fewer take less time, but leave more pixels without an
/// error estimate.
const PATHS_PER_PIXEL: u32 = 4;

/// The settings from which trials begin.
pub(super) fn beginning(args: &SettingsArgs, settings: Settings, purpose: Option<Purpose>) -> Settings {
    match purpose {
        None => settings,
        Some(Purpose::Time(_)) => fewer_paths(args, settings),
        // Radii per pixel and error estimates are what it is for.
        Some(Purpose::Preset(Preset::Final)) => settings,
        Some(Purpose::Preset(_)) => Settings { area: args.estimate.area.unwrap_or(Area::Surface), ..settings },
        Some(Purpose::Target(_)) => {
            let (width, height) = args.picture.size;
            let few = PATHS_PER_PIXEL.saturating_mul(width).saturating_mul(height).max(Choice::MIN_PHOTONS);
            let photons = args.photon.photons.unwrap_or(settings.photons.min(few));
            Settings { photons, area: args.estimate.area.unwrap_or(Area::Surface), ..settings }
        }
    }
}

/// Half of the paths: mostly, more passes are better than more photons in a given time.
fn fewer_paths(args: &SettingsArgs, settings: Settings) -> Settings {
    let is_derived =
        matches!(settings.estimator, Estimator::Radius { radius: None }) && settings.irradiance_every.is_none();
    if args.photon.photons.is_some() || !is_derived || settings.indirect != Indirect::Map {
        return settings;
    }
    Settings { photons: (settings.photons / 2).max(Choice::MIN_PHOTONS.min(settings.photons)), ..settings }
}

/// The root mean square of errors, of which nearly all are claimed to be within 1: two to three standard errors.
const TYPICAL: f64 = 1.0 / 3.0;

/// What a pipeline chooses settings for; `time` is what is left of `--time`, which may be the limit of a target.
fn goal(purpose: Purpose, time: f64) -> Goal {
    match purpose {
        Purpose::Time(_) => Goal::Time(time),
        Purpose::Preset(preset) => Goal::Passes(preset.passes()),
        Purpose::Target(target) => Goal::Error { error: TYPICAL * target, most_seconds: time },
    }
}

/// Trials take about this many times as long as the pilot: 2 to 10 in nine scenes (3 s, two cores).
const TRIALS_OVER_PILOT: f64 = 4.0;

/// Whether trials for `--time` would take longer than the time that is left. Nothing would be left for passes then.
fn is_too_short(is_time: bool, left: f64, pilot: f64) -> bool {
    is_time && left < TRIALS_OVER_PILOT * pilot
}

/// Chooses areas, radii, the number of paths, whether each pixel has a radius of its own, and whether there is final
/// gathering. The renderer has them afterwards; it is returned with its settings. Nothing is chosen for a time that trials would
/// take alone.
///
/// # Errors
/// Those of rendering.
pub(super) fn choose<B: TransportBackend>(
    mut renderer: Pipeline<B>,
    (args, purpose, begun): (&SettingsArgs, Purpose, Instant),
    (scene, view): (&Scene, View),
    settings: Settings,
    may_gather: bool,
) -> Result<(Pipeline<B>, Settings, Option<Choice>), ChoiceError> {
    let given = &args.estimate;
    let (is_time, is_target) = (matches!(purpose, Purpose::Time(_)), matches!(purpose, Purpose::Target(_)));
    let open = Open {
        // With a target, fewer paths would leave more pixels without an error estimate.
        photons: args.photon.photons.is_none() && !is_target,
        area: given.area.is_none(),
        radius_factor: given.radius_factor.is_none(),
        // Radii that pixels share are adapted to a target after the first passes, and a preset has its own kind of radii.
        bandwidth: given.bandwidth.is_none() && is_time,
        gather_rays: false,
    };
    let since = Instant::now();
    let time = args.budget.time.map_or(f64::INFINITY, |time| (time - begun.elapsed().as_secs_f64()).max(0.0));
    if is_too_short(is_time, time, renderer.facts().setup.without_scene()) {
        return Ok((renderer, settings, None));
    }
    let goal = goal(purpose, time);
    let Some(choice) = renderer.choose(&scene.view(), goal, open)? else { return Ok((renderer, settings, None)) };
    let trials = since.elapsed().as_secs_f64();
    let deadline = Deadline { since: is_time.then_some(since), seconds: choice.seconds };
    if may_gather && gathering::is_worth_trying(args, &settings, &choice, (&renderer.facts().setup, trials)) {
        let tried = gathering::choose(renderer, (args, deadline), (scene, view), settings, choice);
        return tried.map_err(ChoiceError::FinalGathering);
    }
    let (wanted, is_new) = with_choice(args, settings, &choice, (renderer.facts().photons, view, choice.seconds));
    if is_new {
        renderer = renderer.with_settings(&scene.view(), wanted.clone())?;
    }
    Ok((renderer, wanted, Some(choice)))
}

/// The settings with what was chosen by a renderer with so many `photons`, and whether another one is needed; `seconds` are left
/// for passes.
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
        let more = if args.is_timed() { more_paths(choice, photons, pixels, seconds) } else { None };
        let chosen = more.unwrap_or(choice.photons);
        is_new = chosen != photons;
        if is_new {
            settings.photons = chosen;
        }
    }
    (settings, is_new)
}

/// Paths of a pass are increased if at least this many times as many in all fit into the time.
const CLEARLY_MORE: f64 = 1.5;

/// Paths are not increased to where fewer passes than this fit.
const MANY_PASSES: f64 = 200.0;

/// The number of paths per pass if more are better: where radii are those of each pixel, the squared error by photons falls about
/// as (total paths)^(−2/3). On a GPU a pass takes hardly longer with several times as many; but where most of the error has other
/// causes, fewer passes add to it. At most two per pixel; `None` if that is not clearly more than those of now, or those that were
/// chosen.
fn more_paths(choice: &Choice, photons: u32, pixels: u32, seconds: f64) -> Option<u32> {
    let is_like =
        |each: &&Candidate| (each.area, each.bandwidth, each.photons) == (choice.area, choice.bandwidth, photons);
    let best = choice.candidates.iter().find(is_like)?;
    let parts = [choice.photon_seconds, best.seconds - choice.photon_seconds];
    let may_help = gathering::is_by_maps(best.error, best.direct_error);
    let paths = affordable(photons, parts, seconds).min(2.0 * f64::from(pixels)) as u32;
    let is_more = is_clearly_more(paths, photons.max(choice.photons), photons, parts);
    (choice.bandwidth == Bandwidth::PerPixel && may_help && is_more).then_some(paths)
}

/// Whether so many `paths` per pass are more than `others`, and at least [`CLEARLY_MORE`] as many in the same time. The first of
/// these seconds of a pass are for `photons` paths, and in proportion to their number; the others do not depend on it.
fn is_clearly_more(paths: u32, others: u32, photons: u32, [for_photons, rest]: [f64; 2]) -> bool {
    let rate = |paths: u32| {
        let seconds = for_photons * f64::from(paths) / f64::from(photons) + rest.max(0.0);
        f64::from(paths) / seconds.max(1e-6)
    };
    paths > others && rate(paths) >= CLEARLY_MORE * rate(others)
}

/// The paths with which [`MANY_PASSES`] fit if those of now take the first of these seconds of a pass, and in proportion; what
/// else a pass does takes the second.
fn affordable(photons: u32, [for_photons, rest]: [f64; 2], seconds: f64) -> f64 {
    f64::from(photons) * (seconds / MANY_PASSES - rest.max(0.0)).max(0.0) / for_photons.max(1e-6)
}

#[cfg(test)]
mod tests {
    use backend_cpu::Cpu;

    use super::*;

    #[test]
    fn without_time_for_trials_nothing_is_chosen() {
        assert!(is_too_short(true, 0.39, 0.1) && !is_too_short(true, 0.41, 0.1) && !is_too_short(false, 0.0, 0.1));
        assert!(is_too_short(true, 0.0, 0.1) && !is_too_short(true, f64::INFINITY, 0.1));
    }

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

    /// Radii per pixel for 100 000 paths in 10 ms, half of them for photons, with an error of which 0.1 is not by photons.
    fn choice() -> Choice {
        let scene = photon_scene::builtin("furnace").unwrap().build().unwrap();
        let view = View { camera: scene.camera(None, 4, 4).unwrap(), width: 4, height: 4 };
        let settings = Settings { photons: 100, ..Settings::default() };
        let mut renderer = Pipeline::new(Cpu::with_threads(1).unwrap(), &scene.view(), view, settings).unwrap();
        let open = Open { photons: false, area: true, radius_factor: false, bandwidth: true, gather_rays: false };
        let mut choice = renderer.choose(&scene.view(), Goal::Time(1.0), open).unwrap().unwrap();
        (choice.bandwidth, choice.photon_seconds) = (Bandwidth::PerPixel, 0.005);
        choice.candidates.truncate(1);
        let only = &mut choice.candidates[0];
        (only.photons, only.area, only.bandwidth) = (100_000, choice.area, choice.bandwidth);
        (only.seconds, only.error, only.direct_error) = (0.01, 1.0, 0.1);
        choice
    }

    #[test]
    fn paths_are_at_most_two_per_pixel_and_increase_clearly_or_not_at_all() {
        let mut choice = choice();
        let mut increased = |chosen, pixels, seconds| {
            choice.photons = chosen;
            more_paths(&choice, 100_000, pixels, seconds)
        };
        assert_eq!(increased(100_000, 250_000, 10.0), Some(500_000));
        assert!(increased(100_000, 10_000_000, 10.0).is_some_and(|paths| paths.abs_diff(900_000) <= 1));
        assert_eq!(increased(100_000, 70_000, 10.0), None);
        assert_eq!(increased(100_000, 10_000_000, 2.0), None);
        // As many were chosen already.
        assert_eq!(increased(400_000, 250_000, 10.0), None);
        // 500 000 take 0.03 s and 200 000 half of that: 1.25 times as many in the same time.
        assert_eq!(increased(200_000, 250_000, 10.0), None);
        // Fewer were chosen: neither those of now nor somewhat more are taken instead.
        assert_eq!(increased(25_000, 70_000, 10.0), None);
        assert_eq!(increased(25_000, 250_000, 10.0), Some(500_000));
        // Where photons take a tenth of a pass, 500 000 take 1.3 times as long as 200 000.
        choice.photons = 200_000;
        choice.photon_seconds = 0.001;
        assert_eq!(more_paths(&choice, 100_000, 250_000, 10.0), Some(500_000));
    }

    #[test]
    fn more_paths_are_clearly_more_in_the_same_time() {
        // 400 000 take 25 ms, 16 million in a second; 114 000 and 115 000 take 10.7 ms, 10.65 and 10.70 million in a second.
        let is_more = |others| is_clearly_more(400_000, others, 100_000, [0.005, 0.005]);
        assert!(is_more(100_000) && is_more(114_000) && !is_more(115_000) && !is_more(400_000));
        // All of the time is for photons, or measured so.
        assert!(!is_clearly_more(400_000, 100_000, 100_000, [0.005, -0.001]));
    }

    #[test]
    fn only_errors_by_maps_with_radii_per_pixel_need_more_paths() {
        let mut choice = choice();
        let mut of = |bandwidth, direct_error| {
            choice.bandwidth = bandwidth;
            (choice.candidates[0].bandwidth, choice.candidates[0].direct_error) = (bandwidth, direct_error);
            more_paths(&choice, 100_000, 250_000, 10.0)
        };
        assert_eq!(of(Bandwidth::PerPixel, 0.4), Some(500_000));
        assert_eq!(of(Bandwidth::PerPixel, 0.6), None);
        assert_eq!(of(Bandwidth::Shared, 0.4), None);
    }
}
