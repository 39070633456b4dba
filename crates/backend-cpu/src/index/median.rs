//! The left-balanced kd-tree: split at the median along the longest axis (split rule from Jensen 2001, *Realistic
//! Image Synthesis Using Photon Mapping*, chapter 6), with one canonical result.
//!
//! # The canonical order
//!
//! Any builder, on any device, that follows these rules produces the same permutation, bit for bit:
//!
//! 1. Negative zeros count as zeros. The whole set is one segment.
//! 2. A segment of at most 16 points is a block: its points in ascending order of their ids.
//! 3. A longer segment of n points has the tight bounding box of its points. Its axis is the one with the
//!    greatest `hi − lo` in `f32`; of equal axes, the lowest.
//! 4. Its left part is the first 16·2^j points, 2^j the greatest power of two below ⌈n/16⌉, in the
//!    order (coordinate on the axis, id); its right part is the rest. Both are segments.
//!
//! So every left part is a perfect tree, all blocks but the last are full, and the parts of one level all begin at
//! multiples of one size: a breadth-first builder only has to track the level. Four levels of splits make one node
//! with sixteen children.

use photon_core::memory::OutOfMemory;

use crate::index::dispatch::Isa;
use crate::index::layout::WIDTH;
use crate::index::points::{Bounds, Item};
use crate::index::select::{Scratch, split};

/// Segments longer than this are split into two parallel tasks.
const TASK: usize = 1 << 13;

/// Brings `items`, which are in ascending order of their ids, into the canonical order. `other` is scratch memory
/// of the same length.
pub(crate) fn arrange(items: &mut [Item], other: &mut [Item], isa: Isa) -> Result<(), OutOfMemory> {
    let mut scratch = Scratch::new(isa, items.len())?;
    segment(items, other, true, &mut scratch)
}

/// Arranges the points in `items`; the result is in `items` if `in_place`, otherwise in `other`.
fn segment(items: &mut [Item], other: &mut [Item], in_place: bool, scratch: &mut Scratch) -> Result<(), OutOfMemory> {
    if items.len() <= WIDTH {
        if !in_place {
            other.copy_from_slice(items);
        }
        return Ok(());
    }
    let left = left_size(items.len());
    let (axis, _) = Bounds::around(items).longest();
    split(items, other, left, axis, scratch);
    let (low, high) = other.split_at_mut(left);
    let (other_low, other_high) = items.split_at_mut(left);
    // The recursion is at most 28 levels deep: 2³² points in blocks of 2⁴.
    if low.len() > TASK {
        let mut another = scratch.other(high.len())?;
        let (low, high) = rayon::join(
            || segment(low, other_low, !in_place, scratch),
            || segment(high, other_high, !in_place, &mut another),
        );
        low.and(high)
    } else {
        segment(low, other_low, !in_place, scratch)?;
        segment(high, other_high, !in_place, scratch)
    }
}

/// Number of points in the left part of a segment of `len` > 16 points.
pub(crate) fn left_size(len: usize) -> usize {
    let blocks = len.div_ceil(WIDTH);
    WIDTH << (blocks - 1).ilog2()
}
