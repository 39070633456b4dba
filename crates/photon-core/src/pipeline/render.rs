//! The interface that hides the backend, and the loop over passes.

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use crate::backend::observer::{Event, Observer, PassReport, Stopping};
use crate::backend::stop::StopCondition;
use crate::backend::tally::Tally;
use crate::backend::{Stage, StageTimings};
use crate::error::{Error, Result};
use crate::film::Film;
use crate::film::display::{Display, DisplayImage};
use crate::film::forecast::{ErrorModel, Forecast};
use crate::pipeline::error_target::ErrorTarget;
use crate::requirements::Requirements;
use crate::settings::budget::{Budget, Plan};

/// A renderer whose backend was chosen at run time. One virtual call per pass.
pub trait Render: Send {
    /// Renders pass `index` into the film. A pass depends only on its index, so any set of passes may be
    /// rendered on any machine, and the films merged.
    ///
    /// # Errors
    /// [`Error::PassTwice`] if the film contains the pass; errors of the backend. The film is unchanged then.
    fn pass(&mut self, index: u32, observer: &mut dyn Observer) -> Result<PassEnd>;

    /// Returns the film so far.
    ///
    /// # Errors
    /// Errors of the backend.
    fn film(&mut self) -> Result<Film>;

    /// Returns the picture so far as it is shown: four bytes per pixel, which devices compute themselves instead of copying
    /// their sums. By default made of [`Render::film`].
    ///
    /// # Errors
    /// Those of [`Display::validate`]; errors of the backend.
    fn display(&mut self, display: &Display) -> Result<DisplayImage> {
        display.validate()?;
        Ok(self.film()?.display(display))
    }

    /// Returns the film and starts an empty one: the sums of the passes since the last call. Sums of such films on the
    /// host, in order, do not depend on how the passes are distributed over calls, renderers and machines: see
    /// [`crate::render_blocks`].
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] with [`crate::Bandwidth::PerPixel`], since passes then depend on the film; errors of the
    /// backend.
    fn take(&mut self) -> Result<Film>;

    /// Radii of the first pass, normalised space, one for each map. Those of a film must be the same in all passes; they
    /// may have been derived from a pilot pass.
    fn radii(&self) -> Vec<f32> {
        Vec::new()
    }

    /// Replaces the radii, so that a film can be continued with those it was begun with.
    ///
    /// # Errors
    /// [`Error::InvalidInput`] for another number of radii, or one that is not above 0.
    fn set_radii(&mut self, radii: &[f32]) -> Result<()> {
        if radii.is_empty() {
            return Ok(());
        }
        Err(Error::InvalidInput { what: "radius", index: 0, why: "this renderer has no radii to replace".into() })
    }

    /// The error model of the film, which forecasts the error that a fraction `share` of the pixels does not exceed;
    /// `None` if error statistics are disabled, or no pixel has an error estimate.
    ///
    /// # Errors
    /// Errors of the backend.
    fn model(&mut self, _share: f64) -> Result<Option<ErrorModel>> {
        Ok(None)
    }

    /// Multiplies squared radii by `factor`, > 0, from the next pass on. Returns whether it did, which is
    /// the case only for derived radii.
    fn rescale(&mut self, _factor: f64) -> bool {
        false
    }

    /// Whether [`Render::rescale`] changes radii.
    fn rescales(&self) -> bool {
        false
    }

    /// Lowers the numbers of paths, shadow rays and final-gather rays of a pass, if a small pass tells that a whole one would take
    /// more than half of `time`, and returns a sentence on it. The film must be empty; otherwise, and by default, nothing
    /// is lowered. The pass may take longer than `time` even so if the picture is very large.
    ///
    /// # Errors
    /// Errors of the backend.
    fn lower(&mut self, _time: Duration) -> Result<Option<String>> {
        Ok(None)
    }

    /// Describes the renderer and what it was built for.
    fn facts(&self) -> Facts;
}

/// How a pass ended.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PassEnd {
    /// The pass is in the film.
    Done(PassReport),
    /// The pass is in the film, and the observer asked to stop.
    Last(PassReport),
    /// The observer or its condition stopped the pass; the film is unchanged.
    Cancelled,
}

/// Description of a renderer and what it was built for.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Facts {
    /// Short name of the backend.
    pub backend: &'static str,
    /// Description of the device.
    pub device: String,
    /// The requirements derived from scene and settings.
    pub required: Requirements,
    /// Seconds spent before the first pass: for uploading the scene to the device, and for the pilot pass
    /// from which radii are derived. After a restart, or with other settings for the same scene, the seconds for the scene are those
    /// of the first time.
    pub setup: StageTimings,
    /// Paths per pass: fewer than the settings ask for if [`crate::Settings::memory`] or [`Render::lower`] allow no more.
    pub photons: u32,
    /// Aimed paths per pass, for caustics; `None`: the other paths fill that map too.
    pub aimed: Option<u32>,
    /// Camera samples of a pixel in a pass, which [`Render::lower`] may have lowered.
    pub camera_samples: u32,
    /// Shadow rays of a query, likewise.
    pub shadow_rays: u32,
    /// Final-gather rays of a query, likewise.
    pub gather_rays: u32,
    /// Allocations: label and bytes.
    pub memory: Vec<(String, u64)>,
}

/// Results of all passes.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Outcome {
    /// Number of passes rendered.
    pub passes: u32,
    /// Number of paths emitted.
    pub paths: u64,
    /// Counts and flux of these paths.
    pub tally: Tally,
    /// Counts and flux of aimed paths, which `tally` does not include.
    pub aimed: Tally,
    /// Camera paths and final-gather rays that were truncated ([`crate::EyeTracer::truncated`]): unless 0, light is missing
    /// from the picture.
    pub truncated_camera_paths: u64,
    /// Seconds per stage.
    pub seconds: StageTimings,
    /// The last pass in the film.
    pub last: Option<PassReport>,
    /// Whether the observer stopped it before its budget was spent.
    pub cancelled: bool,
    /// A sentence on paths and rays that were lowered for the time: [`Render::lower`].
    pub lowered: Option<String>,
    /// The first forecast, if errors are estimated and there were at least 8 passes. With a limit on time, and unless radii or
    /// the end depend on it, it is made after the first pass that ends after a second; if there is none, this is
    /// [`Outcome::reached`].
    pub predicted: Option<Forecast>,
    /// The forecast at the end, likewise.
    pub reached: Option<Forecast>,
}

impl Outcome {
    /// Adds a pass.
    pub(super) fn add(&mut self, report: PassReport) {
        self.passes += 1;
        self.paths += report.paths;
        self.tally.merge(&report.tally);
        self.aimed.merge(&report.aimed);
        self.truncated_camera_paths += report.truncated_camera_paths;
        self.seconds.merge(&report.seconds);
        self.last = Some(report);
    }

    /// Adds the passes of another outcome, which come after these.
    pub(super) fn add_all(&mut self, other: Self) {
        self.passes += other.passes;
        self.paths += other.paths;
        self.tally.merge(&other.tally);
        self.aimed.merge(&other.aimed);
        self.truncated_camera_paths += other.truncated_camera_paths;
        self.seconds.merge(&other.seconds);
        self.last = other.last.or(self.last.take());
    }
}

/// The share of pixels for a forecast if the budget has none.
const SHARE: f64 = 0.95;

/// Number of passes before the first forecast.
const FORECAST_PASSES: u32 = 8;

/// With a limit on time, a forecast that nothing depends on is made only after this time: it reads the whole film, which may
/// take as long as many passes take on a GPU.
const FORECAST_TIME: Duration = Duration::from_secs(1);

/// Renders passes until the budget is spent or the observer asks to stop. With a limit on time, and unless a number of passes is
/// asked for, a pass has fewer paths and rays if it would take more than half of that time ([`Render::lower`]), of which
/// the observer gets a warning. A pass that turns out to end more than a twentieth of the time too late is abandoned, unless
/// it is the first.
///
/// # Errors
/// [`Error::InvalidSetting`] for an empty budget, or a target error if the renderer does not estimate
/// errors; [`Error::Cancelled`] if no pass was finished; errors of a pass. Even then [`Render::film`]
/// returns the results of earlier passes.
pub fn render(renderer: &mut dyn Render, plan: impl Into<Plan>, observer: &mut dyn Observer) -> Result<Outcome> {
    let plan = plan.into();
    plan.validate()?;
    let mut clock = Clock::new();
    let mut outcome = Outcome::default();
    let mut next_look = FORECAST_PASSES;
    if let Some(time) = plan.time().filter(|_| !matches!(plan.until, Budget::Passes(_))) {
        outcome.lowered = renderer.lower(time)?;
    }
    if let Some(text) = &outcome.lowered
        && observer.on_event(&Event::Warning(text)).is_break()
    {
        return Err(Error::Cancelled);
    }
    let asked = observer.stop_condition();
    let late =
        plan.time().and_then(|time| clock.begun.checked_add(time.saturating_add(time / 20))).map(StopCondition::at);
    let condition = match (asked.clone(), late) {
        (Some(asked), Some(late)) => Some(asked.or(late)),
        (asked, late) => asked.or(late),
    };
    for index in plan.first..plan.first.saturating_add(plan.passes()) {
        if is_over(&plan, &outcome, &clock) {
            break;
        }
        clock.begin_pass();
        let condition = if outcome.passes > 0 { condition.clone() } else { None };
        let (report, flow) = match renderer.pass(index, &mut Stopping { inner: &mut *observer, condition })? {
            PassEnd::Done(report) => (report, ControlFlow::Continue(())),
            PassEnd::Last(report) => (report, ControlFlow::Break(())),
            PassEnd::Cancelled => {
                outcome.cancelled = asked.as_ref().is_some_and(StopCondition::is_met) || !clock.is_over(plan.time());
                break;
            }
        };
        clock.end_pass(report.seconds.get(Stage::Compile));
        outcome.add(report);
        if flow.is_break() {
            outcome.cancelled = outcome.passes < plan.passes();
            break;
        }
        if shown(renderer, outcome.passes, observer)?.is_break() {
            outcome.cancelled = outcome.passes < plan.passes();
            break;
        }
        if outcome.passes == next_look {
            if plan.time().is_some() && clock.elapsed() < FORECAST_TIME && !adapts(renderer, &plan) {
                next_look += 1;
                continue;
            }
            let forecast = look(renderer, &plan, &outcome, &clock)?;
            next_look = after(&plan, outcome.passes, forecast.as_ref());
            let Some(forecast) = forecast else {
                if matches!(plan.until, Budget::Error { .. }) {
                    patience(renderer, outcome.passes)?;
                }
                continue;
            };
            outcome.predicted.get_or_insert(forecast);
            let enough = matches!(plan.until, Budget::Error { .. }) && forecast.is_reached();
            if observer.on_event(&Event::Forecast(&forecast)).is_break() {
                outcome.cancelled = !enough;
                break;
            }
            if enough {
                break;
            }
        }
    }
    if outcome.passes == 0 {
        return Err(Error::Cancelled);
    }
    if outcome.passes >= FORECAST_PASSES {
        outcome.reached = look(renderer, &plan, &outcome, &clock)?;
        outcome.predicted = outcome.predicted.or(outcome.reached);
    }
    Ok(outcome)
}

/// Whether anything depends on the first forecast: radii that are adapted to it, or the end.
fn adapts(renderer: &dyn Render, plan: &Plan) -> bool {
    matches!(plan.until, Budget::Error { .. }) || matches!(plan.until, Budget::Time(_)) && renderer.rescales()
}

/// Shows the observer what it wants to see.
fn shown(renderer: &mut dyn Render, passes: u32, observer: &mut dyn Observer) -> Result<ControlFlow<()>> {
    if let Some(display) = observer.wants_display(passes)
        && observer.on_event(&Event::Display(&renderer.display(&display)?)).is_break()
    {
        return Ok(ControlFlow::Break(()));
    }
    if observer.wants_film(passes) {
        return Ok(observer.on_event(&Event::Film(&renderer.film()?)));
    }
    Ok(ControlFlow::Continue(()))
}

/// Whether to continue although no pixel has an error estimate.
fn patience(renderer: &mut dyn Render, passes: u32) -> Result<()> {
    let refuse = |value: &str, hint| Err(Error::InvalidSetting { name: "target-error", value: value.into(), hint });
    if passes == FORECAST_PASSES && renderer.film()?.errors.is_none() {
        return refuse("set", "it needs error estimates: enable Settings::errors");
    }
    if passes >= ErrorTarget::GIVE_UP {
        return refuse("set", "no pixel has an error estimate after hundreds of passes: more photons are needed");
    }
    Ok(())
}

/// Whether to stop before the next pass: the budget is spent, or the next pass is expected to end too late.
fn is_over(plan: &Plan, outcome: &Outcome, clock: &Clock) -> bool {
    if outcome.passes == 0 {
        return false;
    }
    let (elapsed, pass) = (clock.elapsed(), clock.pass());
    let spent = matches!(plan.until, Budget::Photons(photons) if outcome.paths >= photons);
    spent || plan.time().is_some_and(|time| elapsed + pass > time)
}

/// Times the passes, without the time that they waited for kernels. The first one also allocates memory, some backends read the film to choose radii, and forecasts and previews
/// come between: the duration of a pass is the median of the latest others.
struct Clock {
    begun: Instant,
    /// When the present pass began.
    pass_begun: Instant,
    passes: u32,
    /// Durations of the latest passes; of the first one only until there is a second.
    latest: VecDeque<Duration>,
}

impl Clock {
    /// Number of passes whose median is taken.
    const LATEST: usize = 63;

    fn new() -> Self {
        let begun = Instant::now();
        Self { begun, pass_begun: begun, passes: 0, latest: VecDeque::new() }
    }

    fn elapsed(&self) -> Duration {
        self.begun.elapsed()
    }

    fn is_over(&self, time: Option<Duration>) -> bool {
        time.is_some_and(|time| self.elapsed() > time)
    }

    fn begin_pass(&mut self) {
        self.pass_begun = Instant::now();
    }

    /// Ends a pass that waited this many seconds for kernels, as later ones will not.
    fn end_pass(&mut self, compiling: f64) {
        let compiling = Duration::try_from_secs_f64(compiling).unwrap_or_default();
        self.add(self.pass_begun.elapsed().saturating_sub(compiling));
    }

    fn add(&mut self, pass: Duration) {
        if self.passes == 1 || self.latest.len() == Self::LATEST {
            self.latest.pop_front();
        }
        self.passes = self.passes.saturating_add(1);
        self.latest.push_back(pass);
    }

    fn pass(&self) -> Duration {
        let mut latest: Vec<Duration> = self.latest.iter().copied().collect();
        latest.sort_unstable();
        latest.get(latest.len() / 2).copied().unwrap_or_default()
    }
}

/// The present error estimate and a forecast for more passes, with radii adapted to the remaining budget.
fn look(renderer: &mut dyn Render, plan: &Plan, outcome: &Outcome, clock: &Clock) -> Result<Option<Forecast>> {
    let (target, share) = match plan.until {
        Budget::Error { target, share_of_pixels } => (Some(target), share_of_pixels),
        _ => (None, SHARE),
    };
    let Some(mut model) = renderer.model(share)? else { return Ok(None) };
    let pass = clock.pass().as_secs_f64().max(f64::MIN_POSITIVE);
    let left = |time: Duration| time.saturating_sub(clock.elapsed()).as_secs_f64();
    let in_time = plan.time().map_or(f64::INFINITY, |time| f64::from(outcome.passes) + left(time) / pass);
    // Limited by u32 and by the plan.
    let possible = in_time.min(f64::from(plan.passes())).max(f64::from(outcome.passes)) as u32;
    // Radii are adapted to the remaining passes once, and not with a budget of passes or photons, which
    // promise bitwise equal results everywhere.
    let mut radius_factor = 1.0;
    if outcome.predicted.is_none() && matches!(plan.until, Budget::Time(_) | Budget::Error { .. }) {
        let needed = target
            .and_then(|target| model.passes_until(target, ErrorModel::least_error_after))
            .unwrap_or(possible)
            .min(possible);
        let scale = model.best_scale(needed);
        if needed > 2 * outcome.passes && renderer.rescale(scale) {
            model = model.scaled(scale);
            radius_factor = scale.sqrt();
        }
    }
    Ok(Some(Forecast { radius_factor, ..model.forecast(target, pass, possible) }))
}

/// The pass after which to evaluate the error again: the earliest one at which the target may be reached,
/// but before the number of passes has doubled, since forecasts improve.
fn after(plan: &Plan, passes: u32, forecast: Option<&Forecast>) -> u32 {
    if !matches!(plan.until, Budget::Error { .. }) {
        return u32::MAX;
    }
    let needed = forecast.and_then(|forecast| forecast.passes_least).unwrap_or(u32::MAX);
    needed.min(passes.saturating_mul(2)).max(passes + passes.div_ceil(16))
}

#[cfg(test)]
mod tests;
