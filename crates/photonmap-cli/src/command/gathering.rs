//! Final gathering for a time, where trials show that it has a much smaller error than reading the map.

use photon_core::{
    Bandwidth, Candidate, Choice, Goal, Indirect, Open, Pipeline, Render as _, Settings, Stage, StageTimings,
    TransportBackend, View,
};
use photon_scene::Scene;

use crate::args::SettingsArgs;
use crate::command::timed::{self, Deadline};
use crate::fault::Fault;

/// With less time left, passes would be too few for their noise.
const MIN_SECONDS: f64 = 1.2;

/// Changing the settings of the pipeline twice, and trials, must take at most this part of the time.
const MAX_COST: f64 = 0.1;

/// Trials of final gathering, with 1 and 16 rays for each of few pixels, over those of maps: 0.6 to 2.7 times the time.
const COST_OF_RAYS: f64 = 1.5;

/// A larger part is affordable if it is short and many passes fit, as on a GPU: these seconds, up to this part of the time. In
/// fewer passes the noise of gather rays outweighs what they gain.
const SHORT: f64 = 0.45;
const MAX_SHORT_COST: f64 = 0.27;
const PASSES_FOR_SHORT: f64 = 50.0;

/// Estimates from maps have to make up this part of the forecast error: gather rays, or more paths, do not change the rest.
const MIN_MAP_SHARE: f64 = 0.5;

/// Final gathering is chosen if its error is less than this part of the other: forecasts of both are not exact. Its forecast was
/// half of the other in `two-rooms`, where it was as good or better, and at least 1.4 times the other in five scenes where it was
/// worse.
const CLEARLY_LESS: f64 = 0.8;

/// The same where a preset has radii per pixel: their forecasts are those of shared radii, up to four times the error that was
/// measured.
const MUCH_LESS_PRESET: f64 = 0.25;

/// Whether final gathering could be better than what was chosen, and whether finding out takes a small part of the time:
/// `setup` is that of the pipeline, and `trials` are the seconds that the present choice took.
pub(super) fn is_worth_trying(
    args: &SettingsArgs,
    settings: &Settings,
    choice: &Choice,
    (setup, trials): (&StageTimings, f64),
) -> bool {
    let is_open = args.light.indirect.is_none() && args.light.gather_rays.is_none();
    // What final gathering cannot have may have been asked for.
    let budget = &args.budget;
    let is_possible = settings.indirect == Indirect::Map
        && settings.memory.is_none()
        && args.estimate.bandwidth != Some(Bandwidth::PerPixel)
        && !budget.errors
        && budget.target_error.is_none();
    let cost = cost(setup, trials);
    let Some(chosen) = choice.chosen() else { return false };
    let is_affordable = is_affordable(cost, choice.seconds, choice.seconds / chosen.seconds);
    is_open && is_possible && is_affordable && is_by_maps(chosen.error, chosen.direct_error)
}

/// Seconds until it is known which is better. Kernels of final gathering are not compiled yet: they take about as long as those of
/// the present pipeline.
fn cost(setup: &StageTimings, trials: f64) -> f64 {
    2.0 * setup.without_scene() + setup.get(Stage::Compile) + COST_OF_RAYS * trials
}

fn is_affordable(cost: f64, seconds: f64, passes: f64) -> bool {
    let short = if passes >= PASSES_FOR_SHORT { SHORT.min(MAX_SHORT_COST * seconds) } else { 0.0 };
    seconds >= MIN_SECONDS && cost <= (MAX_COST * seconds).max(short)
}

/// Whether enough of an error is by estimates from maps.
pub(super) fn is_by_maps(error: f64, direct_error: f64) -> bool {
    error - direct_error > MIN_MAP_SHARE * error
}

/// Tries final gathering, and takes it or what was chosen with maps. The renderer gets other settings.
///
/// # Errors
/// Those of rendering.
pub(super) fn choose<B: TransportBackend>(
    renderer: Pipeline<B>,
    (args, deadline): (&SettingsArgs, Deadline),
    (scene, view): (&Scene, View),
    settings: Settings,
    mut choice: Choice,
) -> Result<(Pipeline<B>, Settings, Option<Choice>), Fault> {
    let photons = renderer.facts().photons;
    let gathers =
        Settings { indirect: Indirect::Gather, bandwidth: Bandwidth::Shared, errors: false, ..settings.clone() };
    let mut renderer = renderer.with_settings(&scene.view(), gathers.clone())?;
    let open = Open { photons: false, area: false, radius_factor: false, bandwidth: false, gather_rays: true };
    let other = renderer.choose(&scene.view(), Goal::Time(deadline.left()), open)?;
    let error = |choice: &Choice| choice.chosen().map(|chosen| chosen.error);
    let errors = other.as_ref().and_then(error).zip(error(&choice));
    let is_better = errors.is_some_and(|(gathered, by_map)| is_clearly_less(gathered, by_map, settings.bandwidth));
    match other {
        Some(mut other) if is_better => {
            let chosen = Settings { gather_rays: other.gather_rays.unwrap_or(gathers.gather_rays), ..gathers };
            add(&mut other.candidates, choice.candidates);
            Ok((renderer, chosen, Some(other)))
        }
        other => {
            let (chosen, _) = timed::with_choice(args, settings, &choice, (photons, view, deadline.left()));
            let renderer = renderer.with_settings(&scene.view(), chosen.clone())?;
            add(&mut choice.candidates, other.map_or_else(Vec::new, |other| other.candidates));
            Ok((renderer, chosen, Some(choice)))
        }
    }
}

/// Whether the error of final gathering is clearly less than that of maps, with this kind of radii before the choice.
fn is_clearly_less(gathered: f64, by_map: f64, radii: Bandwidth) -> bool {
    let part = if radii == Bandwidth::PerPixel { MUCH_LESS_PRESET } else { CLEARLY_LESS };
    gathered < by_map * part
}

/// All that were compared, by increasing error.
fn add(to: &mut Vec<Candidate>, others: Vec<Candidate>) {
    to.extend(others);
    to.sort_by(|a, b| a.error.total_cmp(&b.error));
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use backend_cpu::Cpu;
    use clap::Parser as _;

    use super::*;
    use crate::args::RenderArgs;

    /// Final gathering is taken if it is better, otherwise what was chosen with maps; the candidates of both are told.
    #[test]
    fn the_better_one_is_rendered() {
        let args = RenderArgs::try_parse_from(["render", "--time", "5"]).unwrap().settings;
        let scene = photon_scene::builtin("cornell").unwrap().build().unwrap();
        let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
        let settings = Settings { photons: 2000, ..Settings::default() };
        for (error_of_maps, indirect) in [(0.0, Indirect::Map), (1e9, Indirect::Gather)] {
            let mut renderer =
                Pipeline::new(Cpu::with_threads(1).unwrap(), &scene.view(), view, settings.clone()).unwrap();
            let open = Open { photons: false, area: true, radius_factor: true, bandwidth: false, gather_rays: false };
            let mut choice = renderer.choose(&scene.view(), Goal::Time(5.0), open).unwrap().unwrap();
            choice.candidates.iter_mut().for_each(|candidate| candidate.error = error_of_maps);
            let deadline = Deadline { since: Some(Instant::now()), seconds: 5.0 };
            let (by_map, area) = (choice.candidates.len(), choice.area);
            let (mut renderer, chosen, compared) =
                choose(renderer, (&args, deadline), (&scene, view), settings.clone(), choice).unwrap();
            assert_eq!(chosen.indirect, indirect);
            assert!(indirect == Indirect::Gather || chosen.area == area);
            assert_eq!(renderer.facts().required.final_gather, indirect == Indirect::Gather);
            let compared = compared.unwrap();
            let gathered = compared.candidates.iter().filter(|each| each.gather_rays.is_some()).count();
            assert!(gathered == 3 && compared.candidates.len() == by_map + 3, "{gathered}");
            assert!(compared.candidates.is_sorted_by(|a, b| a.error <= b.error));
            assert_eq!(compared.chosen().unwrap().gather_rays.is_some(), indirect == Indirect::Gather);
            renderer.pass(0, &mut ()).unwrap();
        }
    }

    /// The scene is kept.
    #[test]
    fn settings_change_twice_and_kernels_are_compiled() {
        let mut setup = StageTimings::default();
        let stages = [(Stage::Bvh, 8.0), (Stage::Prepare, 4.0), (Stage::Project, 2.0), (Stage::Compile, 1.0)];
        for (stage, seconds) in stages.into_iter().chain([(Stage::Trace, 0.25), (Stage::Estimate, 0.125)]) {
            setup.add(stage, seconds);
        }
        assert!((cost(&setup, 0.0) - 1.75).abs() < 1e-12 && (cost(&setup, 2.0) - 4.75).abs() < 1e-12);
    }

    #[test]
    fn trials_take_little_of_the_time_and_may_help() {
        let few = |cost, seconds| is_affordable(cost, seconds, 49.0);
        assert!(few(1.0, 10.0) && !few(1.01, 10.0) && !few(0.0, 1.1) && few(0.2, 2.0) && !few(0.21, 2.0));
        // Short trials may take more of a short time in which many passes fit.
        let many = |cost, seconds| is_affordable(cost, seconds, 50.0);
        assert!(many(0.45, 2.0) && !many(0.46, 2.0) && many(0.32, 1.2) && !many(0.33, 1.2) && many(1.0, 10.0));
        assert!(!is_affordable(0.3, 2.0, f64::NAN));
        assert!(is_by_maps(1.0, 0.49) && !is_by_maps(1.0, 0.51) && !is_by_maps(f64::NAN, 0.0));
    }

    #[test]
    fn final_gathering_has_to_be_clearly_better() {
        for (radii, part) in [(Bandwidth::Shared, 0.8), (Bandwidth::PerPixel, 0.25)] {
            assert!(is_clearly_less(0.99 * part * 3.0, 3.0, radii) && !is_clearly_less(1.01 * part * 3.0, 3.0, radii));
            // Forecasts that are not numbers decide nothing.
            assert!(!is_clearly_less(f64::NAN, 3.0, radii) && !is_clearly_less(1.0, f64::NAN, radii));
        }
    }
}
