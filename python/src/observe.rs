//! Rendering on a thread of its own, while the thread of Python calls the observer and looks for Ctrl-C.

use std::ffi::CString;
use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use photonmap::{Error, Event, Observer, StopCondition};
use pyo3::exceptions::PyRuntimeWarning;
use pyo3::prelude::*;
use pyo3::types::PyBool;

/// Time between two checks for signals.
const INTERVAL: Duration = Duration::from_millis(50);

/// What the observer of Python wants, remembered until the render has ended.
#[derive(Default)]
pub(crate) struct Latch {
    pub(crate) error: Option<PyErr>,
    stop: bool,
}

/// An event, as the observer of Python gets it: a kind, two numbers, a fraction and a text.
type Message = (&'static str, u32, u64, f64, String);

/// Kind of the events that are warnings at the line that called `render`.
const WARNING: &str = "checkpoint";

/// Does the work, such as a render, on a thread of its own, and calls the observer of Python on this one, which also checks for
/// signals such as Ctrl-C. What is raised is kept in `latch`, and the render is stopped, in the middle of a pass if there is
/// another, as it is if the observer returns `False`.
pub(crate) fn observed<T: Send>(
    observer: Option<&Py<PyAny>>,
    latch: &mut Latch,
    work: impl FnOnce(&mut Remote) -> T + Send,
) -> T {
    let (events, inbox) = channel();
    let stop = Arc::new(AtomicBool::new(false));
    let mut remote = Remote { events, stop: Arc::clone(&stop) };
    thread::scope(|scope| {
        let worker = scope.spawn(move || work(&mut remote));
        loop {
            let message = inbox.recv_timeout(INTERVAL);
            match &message {
                // The worker has ended.
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => latch.ask(observer, None),
                Ok((message, _)) => latch.ask(observer, Some(message)),
            }
            stop.store(latch.stop || latch.error.is_some(), Ordering::SeqCst);
            if let Ok((_, answer)) = message {
                let _ = answer.send(());
            }
        }
        worker.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

impl Latch {
    /// Checks for signals, and calls the observer if there is an event.
    fn ask(&mut self, observer: Option<&Py<PyAny>>, message: Option<&Message>) {
        let answered = Python::attach(|py| {
            py.check_signals()?;
            let Some((kind, pass, count, number, text)) = message else { return Ok(true) };
            if *kind == WARNING {
                return warn(py, text).map(|()| true);
            }
            let Some(observer) = observer else { return Ok(true) };
            let answer = observer.call1(py, (*kind, *pass, *count, *number, text))?;
            Ok::<bool, PyErr>(!answer.bind(py).is(PyBool::new(py, false)))
        });
        match answered {
            Ok(go_on) => self.stop |= !go_on,
            Err(error) if self.error.is_none() => self.error = Some(error),
            Err(_) => {}
        }
    }
}

/// The observer on the thread of the render, which waits for that of Python.
#[derive(Clone)]
pub(crate) struct Remote {
    events: Sender<(Message, Sender<()>)>,
    stop: Arc<AtomicBool>,
}

impl Remote {
    /// Sends a message to Python, and waits for the answer.
    fn send(&self, message: Message) {
        let (sender, answer) = channel();
        if self.events.send((message, sender)).is_ok() {
            let _ = answer.recv();
        }
    }

    /// Warns at the line that called `render`.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if Python makes an exception of it.
    pub(crate) fn warn(&self, text: &str) -> photonmap::Result<()> {
        self.send((WARNING, 0, 0, 0.0, text.to_owned()));
        if self.stop.load(Ordering::SeqCst) { Err(Error::Cancelled) } else { Ok(()) }
    }
}

/// Warns at the line that called `render`, on the thread of Python.
pub(crate) fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let text = CString::new(text.replace('\0', " ")).unwrap_or_default();
    PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), &text, 4)
}

impl Observer for Remote {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        let message = match event {
            Event::Photons { pass, traced, total } => {
                Some(("photons", *pass, u64::from(*traced), f64::from(*traced) / f64::from((*total).max(1)), ""))
            }
            Event::PassDone(report) => Some(("pass", report.index, report.paths, 1.0, "")),
            Event::Forecast(forecast) => Some(("error", forecast.passes, 0, forecast.error, "")),
            Event::Warning(text) => Some(("warning", 0, 0, 0.0, *text)),
            _ => None,
        };
        if let Some((kind, pass, count, number, text)) = message {
            self.send((kind, pass, count, number, text.to_owned()));
        }
        if self.stop.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn stop_condition(&self) -> Option<StopCondition> {
        let stop = Arc::clone(&self.stop);
        Some(StopCondition::new(move || stop.load(Ordering::SeqCst)))
    }
}
