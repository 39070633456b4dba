//! Sixteen distances at once. Written over arrays of fixed length, which the compiler turns into
//! whatever vectors the surrounding function may use.
//!
//! Squared distances are `(dx·dx + dy·dy) + dz·dz` in `f32`, each operation rounded, none fused. As
//! rounding is monotonic, a box's distance computed the same way from its nearest corner is never
//! above that of a point in it, nor below it from its farthest: pruning by boxes loses nothing and
//! needs no tolerance.

use crate::index::layout::{Block, Node, WIDTH};
use crate::index::points::Item;
use crate::index::rank::{Key, key};
use photon_core::glam::Vec4;

/// Sixteen squared distances.
pub(crate) type Distances = [f32; WIDTH];

/// From the query to the points of a block; NaN in empty lanes.
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

/// From the query to the nearest corner, edge or face of the children's boxes, 0 inside; NaN in empty lanes.
#[inline(always)]
pub(crate) fn to_boxes(node: &Node, query: [f32; 3]) -> Distances {
    let mut d2 = [0.0; WIDTH];
    for lane in 0..WIDTH {
        let mut sum = 0.0;
        for axis in 0..3 {
            let below = node.lo[axis][lane] - query[axis];
            let above = query[axis] - node.hi[axis][lane];
            let outside = if below > above { below } else { above };
            // In this order of operands a NaN stays.
            let gap = if 0.0 > outside { 0.0 } else { outside };
            sum += gap * gap;
        }
        d2[lane] = sum;
    }
    d2
}

/// From the query to the farthest corners of the children's boxes; NaN in empty lanes.
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

/// What instruction sets do differently.
pub(crate) trait Lanes: Copy {
    /// Whether one vector holds sixteen lanes.
    const WIDE: bool = false;

    /// One bit for each lane that is at most `limit`.
    #[inline(always)]
    fn at_most(self, d2: &Distances, limit: f32) -> u32 {
        let limit = Vec4::splat(limit);
        let mut mask = 0;
        for four in 0..WIDTH / 4 {
            mask |= Vec4::from_slice(&d2[4 * four..]).cmple(limit).bitmask() << (4 * four);
        }
        mask
    }

    /// Writes a key for each lane in `hits` to the front of `keys`, which has room for all sixteen; how many.
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

    /// Copies points to `to`, in their order: those at most at `last` along `AXIS` from the start on, the others
    /// from `left` on; as many as vectors reach.
    #[inline(always)]
    fn distribute<const AXIS: usize>(self, _from: &[Item], _to: &mut [Item], _left: usize, _last: f32) -> Distributed {
        Distributed::default()
    }

    /// Collects the coordinates along `AXIS` that are in [`low`, `high`], of as many points as vectors reach.
    /// `to` is at least four longer than `items`.
    #[inline(always)]
    fn collect<const AXIS: usize>(self, _items: &[Item], _to: &mut [f32], _low: f32, _high: f32) -> Collected {
        Collected::default()
    }
}

/// How far [`Lanes::distribute`] came.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Distributed {
    /// Points done.
    pub(crate) done: usize,
    /// How many of those went left.
    pub(crate) went_left: usize,
}

/// How far [`Lanes::collect`] came.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Collected {
    /// Points done.
    pub(crate) done: usize,
    /// How many of those were below the range.
    pub(crate) below: usize,
    /// How many were in it.
    pub(crate) inside: usize,
}

/// What every target has.
#[derive(Clone, Copy)]
pub(crate) struct Baseline;

impl Lanes for Baseline {}
