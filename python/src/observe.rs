//! Progress to Python, and Ctrl-C.

use std::ops::ControlFlow;

use photonmap::Event;
use pyo3::prelude::*;
use pyo3::types::PyBool;

/// What the observer of Python wants, remembered until the render has ended.
#[derive(Default)]
pub(crate) struct Latch {
    pub(crate) error: Option<PyErr>,
    stop: bool,
}

/// Calls the observer of Python with a kind of event, two numbers, a fraction and a text, and checks for signals such as
/// Ctrl-C. What is raised is kept in `latch`, and the render is stopped, as it is if the observer returns `False`.
pub(crate) fn observe<'a>(
    observer: Option<&'a Py<PyAny>>,
    latch: &'a mut Latch,
) -> impl FnMut(&Event<'_>) -> ControlFlow<()> + 'a {
    move |event| {
        let (kind, pass, count, number, text) = match event {
            Event::Photons { pass, traced, total } => {
                ("photons", *pass, u64::from(*traced), f64::from(*traced) / f64::from((*total).max(1)), "")
            }
            Event::PassDone(report) => ("pass", report.index, report.paths, 1.0, ""),
            Event::Forecast(forecast) => ("error", forecast.passes, 0, forecast.error, ""),
            Event::Warning(text) => ("warning", 0, 0, 0.0, *text),
            _ => return ControlFlow::Continue(()),
        };
        let answered = Python::attach(|py| {
            py.check_signals()?;
            let Some(observer) = observer else { return Ok(true) };
            let answer = observer.call1(py, (kind, pass, count, number, text))?;
            Ok::<bool, PyErr>(!answer.bind(py).is(PyBool::new(py, false)))
        });
        match answered {
            Ok(go_on) => latch.stop |= !go_on,
            Err(error) if latch.error.is_none() => latch.error = Some(error),
            Err(_) => {}
        }
        if latch.stop || latch.error.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
