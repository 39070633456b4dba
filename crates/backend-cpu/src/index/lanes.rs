//! Sixteen distances at a time, written as loops over fixed-length arrays, which the compiler vectorises for the
//! instruction set of the surrounding function.
//!
//! Squared distances are `(dx·dx + dy·dy) + dz·dz` in `f32`; each operation is rounded, none is fused. Rounding is
//! monotonic, so the distance to a box's nearest corner, computed the same way, is never above that to a point in
//! the box, and the distance to its farthest corner is never below. Pruning by boxes is therefore exact and needs
//! no tolerance.

use crate::index::layout::{Block, Node, WIDTH};
use crate::index::points::Item;
use crate::index::rank::{Key, key};
use photon_core::glam::Vec4;

/// Sixteen squared distances.
pub(crate) type Distances = [f32; WIDTH];

/// Squared distances from the query to the points of a block; NaN in empty lanes.
#[inline(always)]
pub(crate) fn to_points(block: &Block, query: [f32; 3]) -> Distances {
    let mut d2 = [0.0; WIDTH];
    for lane in 0..WIDTH {
        let dx = query[0] - block.x[lane];
        let dy = query[1] - block.y[lane];
        let dz = query[2] - block.z[lane];
        d2[lane] = dx * dx + dy * dy + dz * dz;
    }
    d2
}

/// Squared distances from the query to the nearest points of the children's boxes, 0 inside; NaN in empty lanes.
#[inline(always)]
pub(crate) fn to_boxes(node: &Node, query: [f32; 3]) -> Distances {
    let mut d2 = [0.0; WIDTH];
    for lane in 0..WIDTH {
        let mut sum = 0.0;
        for axis in 0..3 {
            let below = node.lo[axis][lane] - query[axis];
            let above = query[axis] - node.hi[axis][lane];
            let outside = if below > above { below } else { above };
            // This order of operands propagates NaN.
            let gap = if 0.0 > outside { 0.0 } else { outside };
            sum += gap * gap;
        }
        d2[lane] = sum;
    }
    d2
}

/// Squared distances from the query to the farthest corners of the children's boxes; NaN in empty lanes.
#[inline(always)]
pub(crate) fn to_far_corners(node: &Node, query: [f32; 3]) -> Distances {
    let mut d2 = [0.0; WIDTH];
    for lane in 0..WIDTH {
        let mut sum = 0.0;
        for axis in 0..3 {
            let below = query[axis] - node.lo[axis][lane];
            let above = node.hi[axis][lane] - query[axis];
            let far = if below > above { below } else { above };
            sum += far * far;
        }
        d2[lane] = sum;
    }
    d2
}

/// Operations with a separate implementation per instruction set.
pub(crate) trait Lanes: Copy {
    /// Whether one vector register holds sixteen lanes.
    const WIDE: bool = false;

    /// A bit mask of the lanes that are at most `limit`.
    #[inline(always)]
    fn at_most(self, d2: &Distances, limit: f32) -> u32 {
        let limit = Vec4::splat(limit);
        let mut mask = 0;
        for four in 0..WIDTH / 4 {
            mask |= Vec4::from_slice(&d2[4 * four..]).cmple(limit).bitmask() << (4 * four);
        }
        mask
    }

    /// Writes a key for each lane in `hits` to the front of `keys`, which must have room for all sixteen. Returns
    /// how many.
    #[inline(always)]
    fn append(self, keys: &mut [Key], hits: u32, first_slot: u32, d2: &Distances) -> usize {
        let mut rest = hits;
        let mut count = 0;
        while rest != 0 {
            let lane = rest.trailing_zeros();
            rest &= rest - 1;
            keys[count] = key(d2[lane as usize % WIDTH], first_slot + lane);
            count += 1;
        }
        count
    }

    /// Copies points to `to`, preserving their order: those with a coordinate of at most `last` along `AXIS` to the
    /// front, the others from index `left` on. Processes whole vectors only; may stop early.
    #[inline(always)]
    fn distribute<const AXIS: usize>(self, _from: &[Item], _to: &mut [Item], _left: usize, _last: f32) -> Distributed {
        Distributed::default()
    }

    /// Collects the coordinates along `AXIS` that are in [`low`, `high`]. Processes whole vectors only. `to` must
    /// be at least four elements longer than `items`.
    #[inline(always)]
    fn collect<const AXIS: usize>(self, _items: &[Item], _to: &mut [f32], _low: f32, _high: f32) -> Collected {
        Collected::default()
    }
}

/// How far [`Lanes::distribute`] got.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Distributed {
    /// Points processed.
    pub(crate) done: usize,
    /// How many of them went left.
    pub(crate) went_left: usize,
}

/// How far [`Lanes::collect`] got.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Collected {
    /// Points processed.
    pub(crate) done: usize,
    /// How many of them were below the range.
    pub(crate) below: usize,
    /// How many of them were in the range.
    pub(crate) inside: usize,
}

/// Implemented without intrinsics, for every target.
#[derive(Clone, Copy)]
pub(crate) struct Baseline;

impl Lanes for Baseline {}
