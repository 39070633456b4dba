//! Progress and cancellation.

use std::ops::ControlFlow;

use crate::backend::StageTimings;
use crate::backend::stop::StopCondition;
use crate::backend::tally::Tally;
use crate::film::Film;
use crate::film::display::{Display, DisplayImage};
use crate::film::forecast::Forecast;
use crate::requirements::map_kind::PerMap;

/// What a renderer reports while it works.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// Progress of the current pass, in traced paths.
    Photons {
        /// Index of the pass, from 0.
        pass: u32,
        /// Paths traced so far.
        traced: u32,
        /// Paths of the pass.
        total: u32,
    },
    /// Progress of the camera samples of the current pass, if it has several.
    Samples {
        /// Index of the pass, from 0.
        pass: u32,
        /// Samples taken so far.
        taken: u32,
        /// Samples of the pass.
        total: u32,
    },
    /// A pass was added to the film.
    PassDone(&'a PassReport),
    /// The current error estimate, and a forecast for more passes.
    Forecast(&'a Forecast),
    /// The film so far, after a pass for which [`Observer::wants_film`] returned true.
    Film(&'a Film),
    /// The picture so far, after a pass for which [`Observer::wants_display`] returned how to show it.
    Display(&'a DisplayImage),
    /// A warning for the user.
    Warning(&'a str),
}

/// Receives progress reports, and may ask to stop.
pub trait Observer {
    /// [`ControlFlow::Break`] asks to stop as soon as the film is valid.
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()>;

    /// The condition under which a pass is abandoned in the middle of a stage. [`crate::render`] and [`crate::render_blocks`]
    /// apply it to all passes but the first, which has fewer paths and camera samples instead; [`crate::Render::pass`] applies
    /// it to any. By default `None`: a pass is stopped after an event only.
    fn stop_condition(&self) -> Option<StopCondition> {
        None
    }

    /// Whether to report the film as [`Event::Film`] now that it has this number of passes. Without blocks, it is copied
    /// from the device, which takes time, and memory for another film. By default false.
    fn wants_film(&mut self, _passes: u32) -> bool {
        false
    }

    /// How to show the picture as [`Event::Display`] now that it has this number of passes, or `None`. Asked before
    /// [`Observer::wants_film`]. Devices copy four bytes per pixel for it instead of their sums. By default `None`.
    fn wants_display(&mut self, _passes: u32) -> Option<Display> {
        None
    }
}

/// Asks the observer whether to continue, and shows it the picture or the film if it wants one.
pub(crate) fn show(film: &Film, observer: &mut dyn Observer) -> ControlFlow<()> {
    if let Some(display) = observer.wants_display(film.passes) {
        observer.on_event(&Event::Display(&film.display(&display)))?;
    }
    if observer.wants_film(film.passes) { observer.on_event(&Event::Film(film)) } else { ControlFlow::Continue(()) }
}

/// An observer whose passes are abandoned under a condition of its own.
pub(crate) struct Stopping<'a> {
    pub(crate) inner: &'a mut dyn Observer,
    pub(crate) condition: Option<StopCondition>,
}

impl Observer for Stopping<'_> {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        self.inner.on_event(event)
    }

    fn stop_condition(&self) -> Option<StopCondition> {
        self.condition.clone()
    }

    fn wants_film(&mut self, passes: u32) -> bool {
        self.inner.wants_film(passes)
    }

    fn wants_display(&mut self, passes: u32) -> Option<Display> {
        self.inner.wants_display(passes)
    }
}

/// Ignores all events, and never stops.
impl Observer for () {
    fn on_event(&mut self, _event: &Event<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(&Event<'_>) -> ControlFlow<()>> Observer for F {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        self(event)
    }
}

/// Results of one pass.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct PassReport {
    /// Index of the pass, from 0.
    pub index: u32,
    /// Paths emitted; fewer than asked for if the pass was cut short.
    pub paths: u64,
    /// Counts and flux of its paths.
    pub tally: Tally,
    /// Counts and flux of its aimed paths, which `tally` does not include.
    pub aimed: Tally,
    /// Camera paths and final-gather rays that were truncated ([`crate::EyeTracer::truncated`]).
    pub truncated_camera_paths: u64,
    /// Search radius of each map, user space; `None`: the map was not built.
    pub radius: PerMap<Option<f64>>,
    /// Number of points at which radiance was estimated.
    pub queries: u64,
    /// Seconds per stage.
    pub seconds: StageTimings,
}
