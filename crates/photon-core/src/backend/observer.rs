//! Progress and cancellation.

use std::ops::ControlFlow;

use crate::backend::StageTimings;
use crate::backend::tally::Tally;
use crate::film::forecast::Forecast;
use crate::requirements::map_kind::PerMap;

/// What a renderer tells while it works.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// Paths of the present pass that have been followed, of how many.
    Photons {
        /// Number of the pass, from 0.
        pass: u32,
        /// Followed so far.
        traced: u32,
        /// To follow.
        total: u32,
    },
    /// A pass is in the film.
    PassDone(&'a PassReport),
    /// What is claimed of the errors so far, and what more passes would bring.
    Forecast(&'a Forecast),
    /// Something that the user should know.
    Warning(&'a str),
}

/// Hears of progress, and may ask to stop.
pub trait Observer {
    /// [`ControlFlow::Break`] asks to stop as soon as the film is valid.
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()>;
}

/// Hears nothing, never stops.
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

/// What one pass did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PassReport {
    /// Number of the pass, from 0.
    pub index: u32,
    /// Paths emitted; fewer than asked for if the pass was cut short.
    pub paths: u64,
    /// What became of them.
    pub tally: Tally,
    /// What became of those that were aimed, apart from these.
    pub aimed: Tally,
    /// Radius within which each map was searched, user space; `None`: the map was not built.
    pub radius: PerMap<Option<f64>>,
    /// Points whose radiance was estimated.
    pub queries: u64,
    /// Seconds per stage.
    pub seconds: StageTimings,
}
