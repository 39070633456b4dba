//! Splits a segment of points at a rank: the lowest along an axis to the left, the rest to the right. The split is
//! stable.
//!
//! Points start in order of their ids, and every split preserves that order on both sides. Equal coordinates
//! therefore go left by lower id without comparing ids, and blocks end up in order of their ids without a sort.

use photon_core::memory::{self, OutOfMemory};

use crate::index::dispatch::{Dispatched, Isa};
use crate::index::lanes::{Collected, Distributed, Lanes};
use crate::index::points::Item;

/// Up to this many points, all are compared with all; up to twice as many with sixteen-lane vectors.
const COMPARED: usize = 64;

/// From this many points on, a sample narrows the range of the coordinate at the rank.
const SAMPLED: usize = 1024;

/// Scratch memory of [`split`].
#[derive(Debug)]
pub(crate) struct Scratch {
    isa: Isa,
    coordinates: Vec<f32>,
    keys: Vec<i32>,
}

impl Scratch {
    /// For segments of up to `length` points.
    pub(crate) fn new(isa: Isa, length: usize) -> Result<Scratch, OutOfMemory> {
        let coordinates = memory::with_capacity(length + 4, "sorting photons")?;
        Ok(Scratch { isa, coordinates, keys: memory::with_capacity(length, "sorting photons")? })
    }

    /// New scratch memory for another task.
    pub(crate) fn other(&self, length: usize) -> Result<Scratch, OutOfMemory> {
        Scratch::new(self.isa, length)
    }
}

/// Copies `from` to `to`, the `left` lowest along `axis` first; of equal coordinates, the earlier ones count as
/// lower. Requires `0 < left < from.len()` and slices of equal length.
pub(crate) fn split(from: &[Item], to: &mut [Item], left: usize, axis: usize, scratch: &mut Scratch) {
    debug_assert!(0 < left && left < from.len() && from.len() == to.len(), "a split must leave points on both sides");
    // Specialised per axis, since the loops are short.
    match axis {
        0 => scratch.isa.run(Split::<0> { from, to, left, scratch }),
        1 => scratch.isa.run(Split::<1> { from, to, left, scratch }),
        _ => scratch.isa.run(Split::<2> { from, to, left, scratch }),
    }
}

struct Split<'a, const AXIS: usize> {
    from: &'a [Item],
    to: &'a mut [Item],
    left: usize,
    scratch: &'a mut Scratch,
}

impl<const AXIS: usize> Dispatched for Split<'_, AXIS> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        split_along::<AXIS, L>(lanes, self.from, self.to, self.left, self.scratch);
    }
}

/// Maps coordinates, which are finite and never −0, to integers in the same order.
#[inline(always)]
fn rank_key(coordinate: f32) -> i32 {
    let bits = coordinate.to_bits() as i32;
    bits ^ ((bits >> 31) as u32 >> 1) as i32
}

/// Inverse of [`rank_key`]: the bit mapping is its own inverse.
#[inline(always)]
fn coordinate(key: i32) -> f32 {
    f32::from_bits((key ^ ((key >> 31) as u32 >> 1) as i32) as u32)
}

#[inline(always)]
fn split_along<const AXIS: usize, L: Lanes>(
    lanes: L,
    from: &[Item],
    to: &mut [Item],
    left: usize,
    scratch: &mut Scratch,
) {
    let Cut { last, below, tied } = if from.len() <= COMPARED / 2 {
        cut_few::<AXIS, { COMPARED / 2 }>(from, left)
    } else if from.len() <= COMPARED {
        cut_few::<AXIS, COMPARED>(from, left)
    } else if from.len() <= 2 * COMPARED && L::WIDE {
        cut_few::<AXIS, { 2 * COMPARED }>(from, left)
    } else {
        cut_many::<AXIS, L>(lanes, from, left - 1, scratch)
    };
    let mut next_left = 0;
    if below + tied == left {
        // The cut does not go through a tie.
        let Distributed { done, went_left } = lanes.distribute::<AXIS>(from, to, left, last);
        next_left = went_left;
        for (at, item) in from.iter().enumerate().skip(done) {
            let goes_left = item.0[AXIS] <= last;
            to[if goes_left { next_left } else { left + at - next_left }] = *item;
            next_left += usize::from(goes_left);
        }
        return;
    }
    // Of the points at the cut coordinate, only as many as there is room for go left.
    let mut room = left - below;
    for (at, item) in from.iter().enumerate() {
        let c = item.0[AXIS];
        let fits = (c == last) & (room > 0);
        room -= usize::from(fits);
        let goes_left = (c < last) | fits;
        to[if goes_left { next_left } else { left + at - next_left }] = *item;
        next_left += usize::from(goes_left);
    }
}

/// The position of a cut.
struct Cut {
    /// The greatest coordinate on the left.
    last: f32,
    /// Number of coordinates less than `last`.
    below: usize,
    /// Number of coordinates equal to `last`.
    tied: usize,
}

/// Finds the cut that leaves `left` of at most `MAX_COUNT` points on the left.
#[inline(always)]
fn cut_few<const AXIS: usize, const MAX_COUNT: usize>(from: &[Item], left: usize) -> Cut {
    let mut coordinates = [f32::INFINITY; MAX_COUNT];
    for (c, item) in coordinates.iter_mut().zip(from) {
        *c = item.0[AXIS];
    }
    // For each coordinate, how many are less than it; the same for equal ones.
    let mut less = [0_i32; MAX_COUNT];
    for &c in &coordinates[..from.len()] {
        for lane in 0..MAX_COUNT {
            less[lane] += i32::from(c < coordinates[lane]);
        }
    }
    // The greatest count below `left`; absent points have larger counts.
    let mut below = 0;
    for lane in 0..MAX_COUNT {
        below = below.max(if less[lane] < left as i32 { less[lane] } else { 0 });
    }
    let (mut tied, mut place) = (0, MAX_COUNT as i32 - 1);
    for lane in 0..MAX_COUNT {
        tied += i32::from(less[lane] == below);
        place = place.min(if less[lane] == below { lane as i32 } else { i32::MAX });
    }
    Cut { last: coordinates[place as usize], below: below as usize, tied: tied as usize }
}

/// Finds the cut whose `last` is the coordinate at `rank` in ascending order.
#[inline(always)]
fn cut_many<const AXIS: usize, L: Lanes>(lanes: L, items: &[Item], rank: usize, scratch: &mut Scratch) -> Cut {
    let Scratch { coordinates, keys, .. } = scratch;
    if items.len() >= SAMPLED {
        // Floyd and Rivest 1975: two sampled keys that most likely enclose the rank.
        let stride = (items.len() / 2048).max(16);
        keys.clear();
        keys.extend(items.iter().step_by(stride).map(|item| rank_key(item.0[AXIS])));
        keys.sort_unstable();
        let expected = rank * keys.len() / items.len();
        let margin = (keys.len() as f64).sqrt() as usize + 4;
        let low = if expected > margin { coordinate(keys[expected - margin]) } else { f32::NEG_INFINITY };
        let high = keys.get(expected + margin).map_or(f32::INFINITY, |&key| coordinate(key));
        // Four more, since vector stores may write past the last element.
        if coordinates.len() < items.len() + 4 {
            coordinates.resize(items.len() + 4, 0.0);
        }
        let Collected { done, mut below, mut inside } = lanes.collect::<AXIS>(items, coordinates, low, high);
        for item in &items[done..] {
            let c = item.0[AXIS];
            below += usize::from(c < low);
            coordinates[inside] = c;
            inside += usize::from((c >= low) & (c <= high));
        }
        if (below..below + inside).contains(&rank) {
            keys.clear();
            keys.extend(coordinates[..inside].iter().map(|&c| rank_key(c)));
            return nth_of(keys, rank - below, below);
        }
        // The sample did not enclose the rank.
    }
    keys.clear();
    keys.extend(items.iter().map(|item| rank_key(item.0[AXIS])));
    nth_of(keys, rank, 0)
}

#[inline(always)]
fn nth_of(keys: &mut [i32], rank: usize, below: usize) -> Cut {
    let (lower, &mut last, higher) = keys.select_nth_unstable(rank);
    let lower_ties = lower.iter().filter(|&&key| key == last).count();
    let higher_ties = higher.iter().filter(|&&key| key == last).count();
    Cut { last: coordinate(last), below: below + rank - lower_ties, tied: lower_ties + 1 + higher_ties }
}
