//! Final gathering for `--time`, where trials show that it has a much smaller error than reading the map.

use std::time::Instant;

use photon_core::{
    Bandwidth, Choice, Indirect, Open, Pipeline, Render as _, Settings, Stage, StageTimings, TransportBackend, View,
};
use photon_scene::Scene;

use crate::args::SettingsArgs;
use crate::command::timed;
use crate::fault::Fault;

/// Below this, trials of gather rays and compiling their kernels would take too much of the time.
const MIN_SECONDS: f64 = 8.0;

/// They need two more pipelines, whose preparation must take at most this part of the time.
const MAX_PREPARATION: f64 = 0.05;

/// Reading the map has to make up this part of its forecast error: gather rays do not change the rest.
const MIN_MAP_SHARE: f64 = 0.5;

/// Final gathering is chosen if its error is less than this part of the other: forecasts of both are not exact.
const CLEARLY_LESS: f64 = 0.5;

/// The same where each pixel would have a radius of its own: forecasts of the error are with shared radii, which were up to four times
/// too large for it.
const CLEARLY_LESS_PER_PIXEL: f64 = 0.25;

/// Whether final gathering could be better than what was chosen for these seconds, and whether trying it takes a small part of
/// them.
pub(super) fn is_worth_trying(
    args: &SettingsArgs,
    settings: &Settings,
    setup: &StageTimings,
    (choice, seconds): (&Choice, f64),
) -> bool {
    let is_open = args.light.indirect.is_none() && args.light.gather_rays.is_none();
    let is_possible = settings.indirect == Indirect::Map && settings.memory.is_none();
    let preparation = 2.0 * (setup.total() - setup.get(Stage::Compile));
    is_open
        && is_possible
        && seconds >= MIN_SECONDS
        && preparation <= MAX_PREPARATION * seconds
        && choice.candidates.first().is_some_and(|best| best.error - best.direct_error > MIN_MAP_SHARE * best.error)
}

/// Tries final gathering, and takes it or what was chosen with maps. The renderer is made anew.
///
/// # Errors
/// Those of rendering.
pub(super) fn choose<B: TransportBackend>(
    renderer: Pipeline<B>,
    (args, begun): (&SettingsArgs, Instant),
    (scene, view): (&Scene, View),
    settings: Settings,
    choice: Choice,
) -> Result<(Pipeline<B>, Settings, Option<Choice>), Fault> {
    let time = args.budget.time.unwrap_or_default();
    let left = || (time - begun.elapsed().as_secs_f64()).max(0.0);
    let photons = renderer.facts().photons;
    let gathers = Settings { indirect: Indirect::Gather, ..settings.clone() };
    let mut renderer = Pipeline::new(renderer.into_backend()?, &scene.view(), view, gathers.clone())?;
    let open = Open { photons: false, area: false, radius_factor: false, bandwidth: false, gather_rays: true };
    let other = renderer.choose(&scene.view(), left(), open)?;
    let error = |choice: &Choice| choice.candidates.first().map(|best| best.error);
    let limit = if choice.bandwidth == Bandwidth::PerPixel { CLEARLY_LESS_PER_PIXEL } else { CLEARLY_LESS };
    let Some(mut other) = other.filter(|other| error(other) < error(&choice).map(|error| limit * error)) else {
        let (chosen, _) = timed::with_choice(args, settings, &choice, (photons, view, left()));
        let renderer = Pipeline::new(renderer.into_backend()?, &scene.view(), view, chosen.clone())?;
        return Ok((renderer, chosen, Some(choice)));
    };
    let chosen = Settings { gather_rays: other.gather_rays.unwrap_or(gathers.gather_rays), ..gathers };
    // What maps were expected to give is of interest too.
    other.candidates.extend(choice.candidates);
    other.candidates.sort_by(|a, b| a.error.total_cmp(&b.error));
    Ok((renderer, chosen, Some(other)))
}
