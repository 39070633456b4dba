//! Rounds of blocks: each rank renders one, then all are added.

use mpi::collective::SystemOperation;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};
use photon_core::{Blocks, Error, ErrorTarget, Film, Forecast, Observer, PassSet, Render, Result, render_block};

use crate::exchange::Sums;

/// Results of a render, on each rank.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Outcome {
    /// The error of the film, on rank 0, if the blocks have a target.
    pub reached: Option<Forecast>,
    /// The film, on rank 0; `None` on others, and if no block was finished.
    pub film: Option<Film>,
    /// Passes that were added.
    pub passes: u32,
    /// Whether an observer or an error on some rank ended it early.
    pub stopped: bool,
}

/// What rank 0 does with the film between rounds.
pub trait Checkpoints {
    /// Whether the film is wanted after this round. Collecting it takes time.
    fn due(&mut self) -> bool;

    /// Receives the film.
    fn save(&mut self, film: &Film);
}

/// No checkpoints.
impl Checkpoints for () {
    fn due(&mut self) -> bool {
        false
    }

    fn save(&mut self, _film: &Film) {}
}

/// Renders blocks on all ranks, which call this together with renderers of the same scene, view and settings. All use the
/// radii of rank 0. `seed` is that of the settings, `errors` whether films have error statistics.
///
/// A round is one block for each rank. If an observer stops a rank, or there is an error, all stop after the round, and the
/// blocks before the first that is not whole are in the film. If the blocks have a target, rounds also end where the film is
/// to be examined, so that it ends at the same pass for any number of ranks. `film` of rank 0 is continued; those of others are ignored.
/// `checkpoints` is asked on rank 0.
///
/// # Errors
/// On all ranks: [`Error::InvalidSetting`] if their renderers differ. On the rank where it happened: an error of its
/// renderer; the others get an [`Outcome`] that is stopped.
pub fn render(
    world: &SimpleCommunicator,
    renderer: &mut dyn Render,
    blocks: &Blocks,
    (seed, errors): (u64, bool),
    film: Option<Film>,
    observer: &mut dyn Observer,
    checkpoints: &mut dyn Checkpoints,
) -> Result<Outcome> {
    let (rank, ranks) = (world.rank() as usize, world.size() as usize);
    agree(world, renderer)?;
    let root = world.process_at_rank(0);
    let empty = empty(renderer)?;
    let mut sums = Sums::new(world, empty.pixels.len(), errors);
    let mut continued = film.is_some();
    root.broadcast_into(&mut continued);
    if continued {
        sums.scatter(film.as_ref());
    }
    let mut found = film.as_ref().map_or(0, |film| film.passes);
    root.broadcast_into(&mut found);
    let mut contains = film.map_or_else(PassSet::default, |film| film.contains);
    let (mut outcome, mut failure, mut empty_sums) = (Outcome::default(), None, !continued);
    // Whether to end, on all ranks; an error is that of rank 0, and the others stop.
    let examine = |sums: &Sums<'_>, contains: &PassSet, outcome: &mut Outcome, failure: &mut Option<Error>| {
        let Some(target) = blocks.target() else { return false };
        if ErrorTarget::next_look(found + outcome.passes, blocks.grain()) != found + outcome.passes {
            return false;
        }
        let (mut ends, mut fails) = (false, false);
        if let Some(film) = sums.gather((rank == 0).then(|| empty.clone()), contains) {
            match target.examine(&film, blocks.grain(), film.passes, 0.0) {
                Ok(forecast) => ends = forecast.is_some_and(|forecast| forecast.is_reached()),
                Err(why) => {
                    *failure = Some(why);
                    (ends, fails) = (true, true);
                }
            }
        }
        root.broadcast_into(&mut ends);
        root.broadcast_into(&mut fails);
        outcome.stopped |= fails;
        ends
    };
    let mut ends = continued && examine(&sums, &contains, &mut outcome, &mut failure);
    let mut start = blocks.passes().start;
    while !ends && start < blocks.passes().end {
        let round = round(blocks, start, found + outcome.passes, ranks);
        start += round.len() as u32 * blocks.grain();
        let mut block = None;
        if let Some(&start) = round.get(rank) {
            // Without a film, the first pass of each rank is not abandoned.
            match render_block(renderer, start..start + blocks.grain(), empty_sums, observer) {
                Ok(film) => block = film,
                Err(error) => failure = Some(error),
            }
        }
        // The blocks before the first one that is not whole.
        let mine = if block.is_some() || rank >= round.len() { round.len() } else { rank };
        let mut whole = 0_u64;
        world.all_reduce_into(&(mine as u64), &mut whole, SystemOperation::min());
        if whole > 0 {
            let passes = round[0]..round[0] + whole as u32 * blocks.grain();
            sums.add(block.as_ref(), whole as usize);
            empty_sums = false;
            outcome.passes += passes.end - passes.start;
            if rank == 0 {
                contains.merge(&PassSet::of(seed, passes))?;
            }
        }
        outcome.stopped = (whole as usize) < round.len();
        if outcome.stopped {
            break;
        }
        ends = examine(&sums, &contains, &mut outcome, &mut failure);
        let mut due = rank == 0 && checkpoints.due();
        root.broadcast_into(&mut due);
        if due && let Some(film) = sums.gather((rank == 0).then(|| empty.clone()), &contains) {
            checkpoints.save(&film);
        }
    }
    if !empty_sums {
        outcome.film = sums.gather((rank == 0).then_some(empty), &contains);
    }
    if let (Some(target), Some(film)) = (blocks.target(), &outcome.film) {
        outcome.reached = target.forecast(film, film.passes, 0.0);
    }
    // The caller gets no film with an error.
    if let (Some(_), Some(film)) = (&failure, &outcome.film) {
        checkpoints.save(film);
    }
    failure.map_or(Ok(outcome), Err)
}

/// The first passes of the next blocks, at most one for each rank, from `start` on: up to where a film with `done` passes is
/// examined next.
fn round(blocks: &Blocks, start: u32, done: u32, ranks: usize) -> Vec<u32> {
    let look = match blocks.target() {
        Some(_) => ErrorTarget::next_look(done + 1, blocks.grain()) - done,
        None => u32::MAX,
    };
    let end = blocks.passes().end.min(start.saturating_add(look));
    (start..end).step_by(blocks.grain() as usize).take(ranks).collect()
}

/// An empty film of the renderer, which it is left with.
fn empty(renderer: &mut dyn Render) -> Result<Film> {
    let film = renderer.take()?;
    if film.passes > 0 {
        return Err(Error::InvalidSetting {
            name: "film of the renderer",
            value: format!("of {} passes", film.passes),
            hint: "must be empty before blocks are rendered; take it first",
        });
    }
    Ok(film)
}

/// Checks that all ranks render the same passes, and gives all the radii of rank 0.
fn agree(world: &SimpleCommunicator, renderer: &mut dyn Render) -> Result<()> {
    let (facts, mut radii) = (renderer.facts(), renderer.radii());
    let mine = [u64::from(facts.photons), facts.aimed.map_or(u64::MAX, u64::from), radii.len() as u64];
    let (mut least, mut most) = ([0_u64; 3], [0_u64; 3]);
    world.all_reduce_into(&mine, &mut least, SystemOperation::min());
    world.all_reduce_into(&mine, &mut most, SystemOperation::max());
    if least != most {
        return Err(Error::InvalidSetting {
            name: "ranks",
            value: format!("of {} to {} paths a pass, {} to {} maps", least[0], most[0], least[2], most[2]),
            hint: "must render the same passes: give all the same options, and a number of paths that fits the memory of each",
        });
    }
    world.process_at_rank(0).broadcast_into(&mut radii[..]);
    renderer.set_radii(&radii)
}
