//! Passes in blocks, whose sums are added on the host.

use std::ops::{ControlFlow, Range};

use crate::backend::observer::{Event, Observer, Stopping, show};
use crate::error::{Error, Result};
use crate::film::Film;
use crate::film::pass_set::PassSet;
use crate::pipeline::error_target::{ErrorTarget, Looks};
use crate::pipeline::render::{Outcome, PassEnd, Render};

/// A range of passes, in blocks of `grain` passes each.
///
/// Floating-point sums depend on their order, which is fixed by the blocks: passes are added in order within each block,
/// and blocks are added in order. The film is a function of scene, settings, passes and grain alone, and not of where and
/// when the blocks are rendered. With grain 1, the bits on the CPU are those of [`crate::render`].
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks {
    passes: Range<u32>,
    grain: u32,
    target: Option<ErrorTarget>,
}

impl Blocks {
    /// The passes of a range, in blocks of `grain`.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] for an empty range, a grain of 0, a range that does not begin and end at a multiple of
    /// the grain, or one that contains pass 2³² − 1, which is reserved.
    pub fn new(passes: Range<u32>, grain: u32) -> Result<Self> {
        let text = format!("{}..{}", passes.start, passes.end);
        let invalid = |name, value, hint| Err(Error::InvalidSetting { name, value, hint });
        if grain == 0 {
            return invalid("grain", "0".into(), "must be at least 1");
        }
        if passes.is_empty() {
            return invalid("passes", text, "must be at least one pass");
        }
        if !(passes.start.is_multiple_of(grain) && passes.end.is_multiple_of(grain)) {
            let value = format!("{text} with grain {grain}");
            return invalid("passes", value, "must begin and end at a multiple of the grain");
        }
        Ok(Self { passes, grain, target: None })
    }

    /// These blocks until the error of the film is small enough: then the later ones are not rendered, and films of blocks
    /// that are finished early are discarded.
    #[must_use]
    pub fn with_target(self, target: ErrorTarget) -> Self {
        Self { target: Some(target), ..self }
    }

    /// The error at which rendering ends, if there is one.
    #[must_use]
    pub fn target(&self) -> Option<ErrorTarget> {
        self.target
    }

    /// Examinations of a film to which these blocks are added.
    pub(super) fn looks(&self, film: Option<&Film>) -> Looks {
        let found = film.map_or(0, |film| film.passes);
        Looks::new(self.target, self.grain, found, self.passes.end - self.passes.start)
    }

    /// All passes.
    #[must_use]
    pub fn passes(&self) -> Range<u32> {
        self.passes.clone()
    }

    /// Passes in a block.
    #[must_use]
    pub fn grain(&self) -> u32 {
        self.grain
    }

    /// The blocks that remain after those of a film; `None` if it contains all. `seed` is that of the settings.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] if the film does not contain whole blocks from the first one on, and nothing else; or if
    /// it contains more than these blocks.
    pub fn remaining(&self, film: &PassSet, seed: u64) -> Result<Option<Self>> {
        let mut ranges = film.ranges();
        let Some((found, range)) = ranges.next() else { return Ok(Some(self.clone())) };
        let invalid = |hint| Err(Error::InvalidSetting { name: "film", value: format!("of passes {film}"), hint });
        if ranges.next().is_some() || found != seed || range.start != self.passes.start {
            return invalid(
                "it can be continued only if it has one seed, no gaps, and the first of the passes asked for; render the \
                 others to another film and merge the two",
            );
        }
        if range.end > self.passes.end {
            return invalid("it has more passes than are asked for; ask for at least as many");
        }
        if range.end % self.grain != 0 {
            return invalid("it ends within a block; render it again");
        }
        Ok((range.end < self.passes.end).then(|| Self { passes: range.end..self.passes.end, ..self.clone() }))
    }
}

/// Results of [`render_blocks`].
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BlockOutcome {
    /// Results of all passes that were rendered. Forecasts only if there is a target: the first one and the last.
    pub outcome: Outcome,
    /// The passes of the block in which the observer stopped it, which are not in the film; `None` if there are none.
    /// Its only pass may be cut short.
    pub unfinished: Option<Film>,
}

/// Renders blocks and adds each to `film`, in order; `None` is an empty film. After each block, `after_block` gets the
/// film, and may store it. With a target ([`Blocks::with_target`]), it ends when the error of the film is small enough,
/// which may be so at the beginning.
///
/// The film of the renderer has to be empty, and is empty afterwards.
///
/// # Errors
/// [`Error::InvalidSetting`] if the renderer has a film, or one that cannot be taken ([`Render::take`]); [`Error::PassTwice`]
/// if a pass is in the film already; [`Error::Cancelled`] if no pass was finished; errors of a pass and of `after_block`.
/// `film` has the whole blocks then.
pub fn render_blocks(
    renderer: &mut dyn Render,
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
    for start in blocks.passes().step_by(blocks.grain as usize) {
        let passes = start..start + blocks.grain;
        let (block, flow) = block(renderer, passes, film.is_none(), observer, &mut results.outcome)?;
        let Some(film) = add(film, block, blocks.grain, &mut results)? else { break };
        after_block(film)?;
        let end = forecast(film, &looks, observer, &mut results.outcome)?;
        if end == Some(End::Reached) {
            break;
        }
        if end.is_some() || flow.is_break() || show(film, observer).is_break() {
            results.outcome.cancelled = start + blocks.grain < blocks.passes.end;
            break;
        }
    }
    if film.is_none() && results.unfinished.is_none() {
        return Err(Error::Cancelled);
    }
    looks.end(film.as_ref(), &mut results.outcome);
    Ok(results)
}

/// Renders the passes of one block into a film of its own, for programs that distribute blocks; `None` if the observer stopped it.
/// Its condition ([`Observer::stop_condition`]) ends any pass, but not the first one of a block that `is_first`, so that a
/// film has a pass.
///
/// # Errors
/// Errors of a pass. The renderer must have no film, and has none afterwards.
pub fn render_block(
    renderer: &mut dyn Render,
    passes: Range<u32>,
    is_first: bool,
    observer: &mut dyn Observer,
) -> Result<Option<Film>> {
    let (film, _) = block(renderer, passes.clone(), is_first, observer, &mut Outcome::default())?;
    Ok((film.passes == passes.end - passes.start && !film.cut).then_some(film))
}

/// Why rendering ends before the last block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// The error is small enough.
    Reached,
    /// The observer asked to stop.
    Stopped,
}

/// Examines the film if it is due, and shows the forecast to the observer.
pub(super) fn forecast(
    film: &Film,
    looks: &Looks,
    observer: &mut dyn Observer,
    outcome: &mut Outcome,
) -> Result<Option<End>> {
    let Some(forecast) = looks.at(film, outcome)? else { return Ok(None) };
    let flow = observer.on_event(&Event::Forecast(&forecast));
    Ok(if forecast.is_reached() { Some(End::Reached) } else { flow.is_break().then_some(End::Stopped) })
}

/// Adds a block to the film and returns the film; `None` for a block that was stopped, which is kept in `results`.
pub(super) fn add<'a>(
    film: &'a mut Option<Film>,
    block: Film,
    grain: u32,
    results: &mut BlockOutcome,
) -> Result<Option<&'a Film>> {
    if block.cut || block.passes < grain {
        results.outcome.cancelled = true;
        results.unfinished = (block.passes > 0).then_some(block);
        return Ok(None);
    }
    if block.passes > grain {
        return Err(Error::InvalidSetting {
            name: "film of the renderer",
            value: format!("of {} passes", block.passes - grain),
            hint: "must be empty before blocks are rendered; take it first",
        });
    }
    match film {
        Some(film) => {
            film.merge(&block)?;
            Ok(Some(film))
        }
        None => Ok(Some(film.insert(block))),
    }
}

/// Renders the passes of a block until the observer asks to stop; under its condition, a pass is abandoned, but not the first
/// of all. If there is an error, the passes are discarded.
pub(super) fn block(
    renderer: &mut dyn Render,
    passes: Range<u32>,
    is_first: bool,
    observer: &mut dyn Observer,
    outcome: &mut Outcome,
) -> Result<(Film, ControlFlow<()>)> {
    let mut flow = ControlFlow::Continue(());
    let first = passes.start;
    for index in passes {
        let condition = observer.stop_condition().filter(|_| !is_first || index > first);
        let report = match renderer.pass(index, &mut Stopping { inner: &mut *observer, condition }) {
            Ok(PassEnd::Done(report)) => report,
            Ok(PassEnd::Last(report)) => {
                flow = ControlFlow::Break(());
                report
            }
            Ok(PassEnd::Cancelled) => {
                flow = ControlFlow::Break(());
                break;
            }
            Err(error) => {
                // The first error matters; if the device is lost, so is the film.
                let _ = renderer.take();
                return Err(error);
            }
        };
        outcome.add(report);
        if flow.is_break() {
            break;
        }
    }
    Ok((renderer.take()?, flow))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_whole() {
        assert_eq!(Blocks::new(4..8, 2).unwrap().passes(), 4..8);
        for (passes, grain, culprit) in
            [(0..0, 1, "at least one"), (0..5, 2, "grain 2"), (3..4, 2, "multiple"), (0..4, 0, "grain")]
        {
            let text = Blocks::new(passes, grain).unwrap_err().to_string();
            assert!(text.contains(culprit), "{text}");
        }
    }

    #[test]
    fn a_film_is_continued_where_it_ends() {
        let blocks = Blocks::new(4..12, 2).unwrap();
        let rest = |film: &PassSet| blocks.remaining(film, 3);
        assert_eq!(rest(&PassSet::default()).unwrap(), Some(blocks.clone()));
        assert_eq!(rest(&PassSet::of(3, 4..8)).unwrap(), Some(Blocks::new(8..12, 2).unwrap()));
        assert_eq!(rest(&PassSet::of(3, 4..12)).unwrap(), None);
        let mut gap = PassSet::of(3, 4..6);
        gap.merge(&PassSet::of(3, 8..10)).unwrap();
        for (film, culprit) in [
            (gap, "gaps"),
            (PassSet::of(2, 4..8), "seed"),
            (PassSet::of(3, 0..8), "first"),
            (PassSet::of(3, 4..14), "more passes"),
            (PassSet::of(3, 4..7), "within a block"),
        ] {
            let text = rest(&film).unwrap_err().to_string();
            assert!(text.contains(culprit) && text.contains(&film.to_string()), "{text}");
        }
    }
}
