//! The front that knows no backend, and the loop over passes.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use crate::backend::StageTimings;
use crate::error::{Error, Result};
use crate::film::Film;
use crate::observer::{Observer, PassReport};
use crate::requirements::Requirements;
use crate::tally::Tally;

/// A renderer whose backend was chosen at run time. One virtual call per pass.
pub trait Render: Send {
    /// Renders pass `index` into the film. Passes depend on nothing but their index, so any set of
    /// them may be rendered, anywhere, and the films merged.
    ///
    /// # Errors
    /// What the backend raises. The film then holds what it held before.
    fn pass(&mut self, index: u32, observer: &mut dyn Observer) -> Result<PassEnd>;

    /// The picture so far.
    ///
    /// # Errors
    /// What the backend raises.
    fn film(&mut self) -> Result<Film>;

    /// What it is and what it was built for.
    fn facts(&self) -> Facts;
}

/// How a pass ended.
#[derive(Clone, Debug, PartialEq)]
pub enum PassEnd {
    /// It is in the film.
    Done(PassReport),
    /// It is in the film, and the observer asked for no more.
    Last(PassReport),
    /// The observer stopped it; the film is as it was before.
    Cancelled,
}

/// What a renderer is and what it was built for.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// Short name of the backend.
    pub backend: &'static str,
    /// Device, in words.
    pub device: String,
    /// What was derived from scene and settings.
    pub required: Requirements,
    /// Seconds spent before the first pass: bringing the scene to the device, and the photons that
    /// derived radii come from.
    pub setup: StageTimings,
    /// Paths per pass: fewer than the settings ask for if [`crate::Settings::memory`] allows no more.
    pub photons: u32,
    /// What is allocated: label and bytes.
    pub memory: Vec<(String, u64)>,
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Number of the first pass.
    pub first: u32,
    /// So many passes at most, ≥ 1.
    pub passes: u32,
    /// No new pass is begun that would end after this; the first one always runs.
    pub time: Option<Duration>,
}

impl Budget {
    /// So many passes, however long they take.
    #[must_use]
    pub fn passes(passes: u32) -> Self {
        Self { first: 0, passes, time: None }
    }
}

/// What all passes did together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Passes rendered.
    pub passes: u32,
    /// Paths emitted.
    pub paths: u64,
    /// What became of them.
    pub tally: Tally,
    /// Seconds per stage.
    pub seconds: StageTimings,
    /// The last pass in the film.
    pub last: Option<PassReport>,
    /// The observer stopped it before its budget was spent.
    pub cancelled: bool,
}

/// Renders passes until the budget is spent or the observer asks to stop.
///
/// # Errors
/// [`Error::InvalidSetting`] for no passes; [`Error::Cancelled`] if there is nothing to show;
/// what a pass raises. Even then [`Render::film`] has what earlier passes gave.
pub fn render(renderer: &mut dyn Render, budget: Budget, observer: &mut dyn Observer) -> Result<Outcome> {
    if budget.passes == 0 {
        return Err(Error::InvalidSetting { name: "passes", value: "0".into(), mend: "at least 1 is needed" });
    }
    let start = Instant::now();
    let mut outcome = Outcome::default();
    let mut longest = Duration::ZERO;
    for index in budget.first..budget.first.saturating_add(budget.passes) {
        let begun = start.elapsed();
        if budget.time.is_some_and(|time| outcome.passes > 0 && begun + longest > time) {
            break;
        }
        let (report, flow) = match renderer.pass(index, observer)? {
            PassEnd::Done(report) => (report, ControlFlow::Continue(())),
            PassEnd::Last(report) => (report, ControlFlow::Break(())),
            PassEnd::Cancelled => {
                outcome.cancelled = true;
                break;
            }
        };
        longest = longest.max(start.elapsed() - begun);
        outcome.passes += 1;
        outcome.paths += report.paths;
        outcome.tally.merge(&report.tally);
        outcome.seconds.merge(&report.seconds);
        outcome.last = Some(report);
        if flow.is_break() {
            outcome.cancelled = outcome.passes < budget.passes;
            break;
        }
    }
    if outcome.passes == 0 { Err(Error::Cancelled) } else { Ok(outcome) }
}
