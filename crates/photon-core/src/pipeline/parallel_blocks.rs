//! Blocks of passes on several devices of one host.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use crate::backend::observer::{Event, Observer, PassReport, Stopping, show};
use crate::backend::stop::StopCondition;
use crate::error::{Error, Result};
use crate::film::Film;
use crate::pipeline::blocks::{BlockOutcome, Blocks, End, add, block, forecast};
use crate::pipeline::error_target::Looks;
use crate::pipeline::render::{Outcome, Render};

/// Renders blocks with several renderers of the same scene, view and settings, each in a thread of its own: for example one
/// for each GPU. Each takes the next block when it is done with one.
///
/// Blocks are added in order. If all devices are of one kind, the film is that of [`crate::render_blocks`] with one of them,
/// bit by bit. All get the radii of the first. A block that is finished before its predecessors waits in host memory; at
/// most two for each renderer are rendered or wait.
///
/// The observer is called in this thread. Events of different passes are interleaved, and it may take some more events until
/// a request to stop is followed. The blocks before the first unfinished one are in the film then.
///
/// # Errors
/// [`Error::InvalidSetting`] without renderers, or if they differ in paths per pass or in the maps that they use; otherwise
/// as [`crate::render_blocks`]. If a renderer fails, so does the whole; the blocks before its own may be in the film.
pub fn render_blocks_in_parallel(
    renderers: &mut [Box<dyn Render>],
    blocks: &Blocks,
    film: &mut Option<Film>,
    observer: &mut dyn Observer,
    after_block: &mut dyn FnMut(&Film) -> Result<()>,
) -> Result<BlockOutcome> {
    agree(renderers)?;
    run(renderers, blocks, film, observer, after_block)
}

fn run(
    renderers: &mut [Box<dyn Render>],
    blocks: &Blocks,
    film: &mut Option<Film>,
    observer: &mut dyn Observer,
    after_block: &mut dyn FnMut(&Film) -> Result<()>,
) -> Result<BlockOutcome> {
    let mut results = BlockOutcome::default();
    let looks = blocks.looks(film.as_ref());
    if looks.found_reached(film.as_ref(), &mut results.outcome)? {
        return Ok(results);
    }
    let queue = Queue::new(blocks.clone(), renderers.len());
    let (sender, messages) = channel();
    let (condition, is_empty) = (observer.stop_condition(), film.is_none());
    thread::scope(|scope| {
        for renderer in renderers {
            let (queue, sender, condition) = (&queue, sender.clone(), condition.clone());
            scope.spawn(move || work(&mut **renderer, queue, &sender, (condition, is_empty)));
        }
        // The channel ends with the last of the workers.
        drop(sender);
        collect(&queue, &messages, (film, looks), observer, after_block)
    })
}

/// Checks that all renderers render the same passes, and gives all the same radii.
fn agree(renderers: &mut [Box<dyn Render>]) -> Result<()> {
    let invalid = |value: String, hint| Err(Error::InvalidSetting { name: "renderers", value, hint });
    let Some((first, others)) = renderers.split_first_mut() else {
        return invalid("empty".into(), "must be at least one");
    };
    let (facts, radii) = (first.facts(), first.radii());
    for other in others {
        let theirs = other.facts();
        if (theirs.photons, theirs.aimed) != (facts.photons, facts.aimed) {
            let value = format!(
                "of {} paths a pass on {}, {} on {}",
                facts.photons, facts.device, theirs.photons, theirs.device
            );
            return invalid(
                value,
                "must render the same passes: choose a number of paths that fits the memory of each",
            );
        }
        if other.radii().len() != radii.len() {
            return invalid("with different maps".into(), "must be of the same scene and settings");
        }
        other.set_radii(&radii)?;
    }
    Ok(())
}

/// The next block to render.
struct Queue {
    blocks: Blocks,
    /// Blocks that may be rendered or wait at a time.
    window: u32,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    /// Number of the next block, from 0.
    next: u32,
    /// Number of blocks in the film.
    added: u32,
    stopped: bool,
}

impl Queue {
    fn new(blocks: Blocks, renderers: usize) -> Self {
        let window = u32::try_from(2 * renderers).unwrap_or(u32::MAX);
        Self { blocks, window, state: Mutex::default(), changed: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Every change is a single assignment.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of the next block, once there is room for its film; `None` if there are no more.
    fn take(&self) -> Option<u32> {
        let waits = |state: &mut State| !state.stopped && state.next >= state.added.saturating_add(self.window);
        let mut state = self.changed.wait_while(self.lock(), waits).unwrap_or_else(PoisonError::into_inner);
        let passes = self.blocks.passes();
        let number = state.next;
        if state.stopped || number >= (passes.end - passes.start) / self.blocks.grain() {
            return None;
        }
        state.next += 1;
        Some(number)
    }

    fn added(&self) {
        self.lock().added += 1;
        self.changed.notify_all();
    }

    fn stop(&self) {
        self.lock().stopped = true;
        self.changed.notify_all();
    }

    fn flow(&self) -> ControlFlow<()> {
        if self.lock().stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// What a worker reports: an event, or the result of a block.
enum Message {
    Photons { pass: u32, traced: u32, total: u32 },
    Samples { pass: u32, taken: u32, total: u32 },
    PassDone(Box<PassReport>),
    Warning(String),
    Block(u32, Result<Box<(Film, Outcome)>>),
}

/// Stops the others if a renderer panics, which would wait for its block otherwise.
struct StopOnPanic<'a>(&'a Queue);

impl Drop for StopOnPanic<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.0.stop();
        }
    }
}

/// Renders blocks until there are no more; under the condition passes are abandoned. `is_empty`: the film has no blocks yet.
fn work(
    renderer: &mut dyn Render,
    queue: &Queue,
    sender: &Sender<Message>,
    (condition, is_empty): (Option<StopCondition>, bool),
) {
    let _guard = StopOnPanic(queue);
    let mut observer = |event: &Event<'_>| {
        let message = match *event {
            Event::Photons { pass, traced, total } => Some(Message::Photons { pass, traced, total }),
            Event::Samples { pass, taken, total } => Some(Message::Samples { pass, taken, total }),
            Event::PassDone(report) => Some(Message::PassDone(Box::new(report.clone()))),
            Event::Warning(text) => Some(Message::Warning(text.to_owned())),
            // There are none within blocks.
            Event::Forecast(_) | Event::Film(_) | Event::Display(_) => None,
        };
        // The receiver is dropped last.
        if let Some(message) = message {
            let _ = sender.send(message);
        }
        queue.flow()
    };
    while let Some(number) = queue.take() {
        let (start, grain) = (queue.blocks.passes().start, queue.blocks.grain());
        let start = start + number * grain;
        let mut outcome = Outcome::default();
        let mut stopping = Stopping { inner: &mut observer, condition: condition.clone() };
        let is_first = is_empty && number == 0;
        let result = block(renderer, start..start + grain, is_first, &mut stopping, &mut outcome);
        let failed = result.is_err();
        let _ = sender.send(Message::Block(number, result.map(|(film, _)| Box::new((film, outcome)))));
        if failed {
            queue.stop();
        }
    }
}

/// Adds the blocks in order until all workers have ended.
fn collect(
    queue: &Queue,
    messages: &Receiver<Message>,
    (film, looks): (&mut Option<Film>, Looks),
    observer: &mut dyn Observer,
    after_block: &mut dyn FnMut(&Film) -> Result<()>,
) -> Result<BlockOutcome> {
    let mut results = BlockOutcome::default();
    let mut waiting = BTreeMap::new();
    let (mut failure, mut is_reached) = (None, false);
    // Number of the next block to add; `None` after one that is not whole.
    let mut next = Some(0);
    for message in messages {
        let flow = match message {
            Message::Photons { pass, traced, total } => observer.on_event(&Event::Photons { pass, traced, total }),
            Message::Samples { pass, taken, total } => observer.on_event(&Event::Samples { pass, taken, total }),
            Message::PassDone(report) => observer.on_event(&Event::PassDone(&report)),
            Message::Warning(text) => observer.on_event(&Event::Warning(&text)),
            Message::Block(number, Ok(block)) => {
                waiting.insert(number, block);
                ControlFlow::Continue(())
            }
            Message::Block(_, Err(error)) => {
                failure.get_or_insert(error);
                ControlFlow::Continue(())
            }
        };
        if flow.is_break() {
            queue.stop();
        }
        while let Some((number, block)) = next.and_then(|number| waiting.remove_entry(&number)) {
            let (block, outcome) = *block;
            results.outcome.add_all(outcome);
            let added = add(film, block, queue.blocks.grain(), &mut results);
            let whole = match added {
                Ok(Some(film)) => {
                    is_reached = false;
                    after_block(film).and_then(|()| forecast(film, &looks, &mut *observer, &mut results.outcome)).map(
                        |end| {
                            is_reached = end == Some(End::Reached);
                            Some(if end.is_some() { ControlFlow::Break(()) } else { show(film, &mut *observer) })
                        },
                    )
                }
                Ok(None) => Ok(None),
                Err(error) => Err(error),
            };
            next = match whole {
                // The blocks that are finished already are discarded.
                Ok(Some(_)) if is_reached => None,
                Ok(Some(flow)) => {
                    if flow.is_break() {
                        queue.stop();
                    }
                    Some(number + 1)
                }
                Ok(None) => None,
                Err(error) => {
                    failure.get_or_insert(error);
                    None
                }
            };
            if next.is_none() {
                queue.stop();
            }
            queue.added();
        }
    }
    // What happened to blocks that are not needed does not matter.
    if let Some(error) = failure.filter(|_| !is_reached) {
        return Err(error);
    }
    if film.is_none() && results.unfinished.is_none() {
        return Err(Error::Cancelled);
    }
    let passes = queue.blocks.passes();
    let all = (passes.end - passes.start) / queue.blocks.grain();
    results.outcome.cancelled = next != Some(all) && !is_reached;
    looks.end(film.as_ref(), &mut results.outcome);
    Ok(results)
}

#[cfg(test)]
mod tests;
