//! Splitting a segment of points at a rank: the lowest along an axis to the left, the rest to the right,
//! both in the order in which they stood.
//!
//! Points start in order of their ids, and every split keeps that order on both sides. So equal
//! coordinates go to the left by lower ids without a comparison, and blocks end up in order of their ids
//! without a sort.

use crate::index::layout::Item;

/// Up to this many, ranks are counted by comparing all with all.
const COUNTED: usize = 32;

/// From this many, a sample narrows down the rank's coordinate.
const SAMPLED: usize = 1024;

/// Working memory of [`split`].
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    keys: Vec<i32>,
    sample: Vec<i32>,
}

/// Copies `from` to `to`, the `left` lowest along `axis` first; of equal coordinates those that stand
/// first count as lower. `0 < left < from.len()`, and both slices are of one length.
pub(crate) fn split(from: &[Item], to: &mut [Item], left: usize, axis: usize, scratch: &mut Scratch) {
    debug_assert!(0 < left && left < from.len() && from.len() == to.len(), "a split leaves points on both sides");
    // A copy of the code for each axis, as its loops are short.
    match axis {
        0 => split_along::<0>(from, to, left, scratch),
        1 => split_along::<1>(from, to, left, scratch),
        _ => split_along::<2>(from, to, left, scratch),
    }
}

/// Integers in the order of the coordinates, which are finite and never −0.
#[inline(always)]
fn rank_key(coordinate: f32) -> i32 {
    let bits = coordinate.to_bits() as i32;
    bits ^ ((bits >> 31) as u32 >> 1) as i32
}

/// The coordinate of a key: the mapping is its own inverse.
#[inline(always)]
fn coordinate(key: i32) -> f32 {
    f32::from_bits((key ^ ((key >> 31) as u32 >> 1) as i32) as u32)
}

#[inline(always)]
fn split_along<const AXIS: usize>(from: &[Item], to: &mut [Item], left: usize, scratch: &mut Scratch) {
    if from.len() <= COUNTED {
        split_few::<AXIS>(from, to, left);
        return;
    }
    let Cut { last, below, tied } = nth::<AXIS>(from, left - 1, scratch);
    let mut next_left = 0;
    if below + tied == left {
        // No tie goes through the cut.
        let last = coordinate(last);
        for (at, item) in from.iter().enumerate() {
            let goes_left = item.0[AXIS] <= last;
            to[if goes_left { next_left } else { left + at - next_left }] = *item;
            next_left += usize::from(goes_left);
        }
        return;
    }
    // Of the points at the last coordinate, as many as there is room for.
    let mut room = left - below;
    for (at, item) in from.iter().enumerate() {
        let key = rank_key(item.0[AXIS]);
        let fits = (key == last) & (room > 0);
        room -= usize::from(fits);
        let goes_left = (key < last) | fits;
        to[if goes_left { next_left } else { left + at - next_left }] = *item;
        next_left += usize::from(goes_left);
    }
}

#[inline(always)]
fn split_few<const AXIS: usize>(from: &[Item], to: &mut [Item], left: usize) {
    // Absent points rank last.
    let mut keys = [i32::MAX; COUNTED];
    for (key, item) in keys.iter_mut().zip(from) {
        *key = rank_key(item.0[AXIS]);
    }
    // How many precede each: those before it that are not greater, and those after it that are less.
    let mut ranks = [0_i32; COUNTED];
    for (at, &key) in keys.iter().enumerate() {
        for (other, rank) in ranks.iter_mut().enumerate() {
            let precedes = if at < other { key <= keys[other] } else { key < keys[other] };
            *rank += i32::from(precedes);
        }
    }
    let mut next_left = 0;
    for (at, (item, &rank)) in from.iter().zip(&ranks).enumerate() {
        let goes_left = (rank as usize) < left;
        to[if goes_left { next_left } else { left + at - next_left }] = *item;
        next_left += usize::from(goes_left);
    }
}

/// Where a segment is cut.
struct Cut {
    /// The greatest key on the left.
    last: i32,
    /// Keys less than that.
    below: usize,
    /// Keys equal to it.
    tied: usize,
}

/// The cut whose `last` is the key at `rank` in ascending order.
#[inline(always)]
fn nth<const AXIS: usize>(items: &[Item], rank: usize, scratch: &mut Scratch) -> Cut {
    let Scratch { keys, sample } = scratch;
    if items.len() >= SAMPLED {
        // Floyd and Rivest 1975: two sampled keys that most likely embrace the rank.
        let stride = (items.len() / 2048).max(16);
        sample.clear();
        sample.extend(items.iter().step_by(stride).map(|item| rank_key(item.0[AXIS])));
        sample.sort_unstable();
        let expected = rank * sample.len() / items.len();
        let margin = (sample.len() as f64).sqrt() as usize + 4;
        let low = if expected > margin { sample[expected - margin] } else { rank_key(f32::NEG_INFINITY) };
        let high = sample.get(expected + margin).copied().unwrap_or(rank_key(f32::INFINITY));
        if keys.len() < items.len() {
            keys.resize(items.len(), 0);
        }
        let (mut below, mut inside) = (0, 0);
        let (low, high) = (coordinate(low), coordinate(high));
        for item in items {
            let c = item.0[AXIS];
            below += usize::from(c < low);
            keys[inside] = rank_key(c);
            inside += usize::from((c >= low) & (c <= high));
        }
        if (below..below + inside).contains(&rank) {
            return nth_of(&mut keys[..inside], rank - below, below);
        }
        // The sample misled.
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
    Cut { last, below: below + rank - lower_ties, tied: lower_ties + 1 + higher_ties }
}
