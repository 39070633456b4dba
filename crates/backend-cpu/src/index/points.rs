//! Points during index construction, and bounding boxes.

use crate::index::IndexError;
use photon_core::glam::Vec4;
use photon_core::memory::{self, OutOfMemory};
use rayon::prelude::*;

/// A point during index construction: its coordinates, finite and without negative zeros, and the bits of its id.
/// Four values of one type, so that one instruction handles all of them.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(crate) struct Item(pub(crate) [f32; 4]);

impl Item {
    pub(crate) fn new(position: [f32; 3], id: u32) -> Item {
        // Adding 0 turns −0 into 0, so that equal coordinates have equal bits.
        Item([position[0] + 0.0, position[1] + 0.0, position[2] + 0.0, f32::from_bits(id)])
    }

    #[inline(always)]
    pub(crate) fn position(&self) -> [f32; 3] {
        [self.0[0], self.0[1], self.0[2]]
    }

    /// Index of the point in the caller's slice.
    #[inline(always)]
    pub(crate) fn id(&self) -> u32 {
        self.0[3].to_bits()
    }
}

/// The bounding box of `points`; an error if a coordinate is not finite.
pub(crate) fn checked_bounds(points: &[[f32; 3]]) -> Result<Bounds, IndexError> {
    const CHUNK: usize = 1 << 14;
    let join = |a: Option<Bounds>, b: Option<Bounds>| {
        let (mut all, other) = (a?, b?);
        all.join(&other);
        Some(all)
    };
    let all = points
        .par_chunks(CHUNK)
        .map(|points| {
            // Four points fill three registers; each lane sees only one coordinate.
            let (fours, rest) = points.as_flattened().split_at(points.len() / 4 * 12);
            let (mut lo, mut hi) = ([Vec4::INFINITY; 3], [Vec4::NEG_INFINITY; 3]);
            // Non-finite values leave a NaN: ∞·0 and NaN·0 are NaN.
            let mut trace = [Vec4::ZERO; 3];
            for four in fours.chunks_exact(12) {
                for part in 0..3 {
                    let c = Vec4::from_slice(&four[4 * part..]);
                    lo[part] = c.min(lo[part]);
                    hi[part] = c.max(hi[part]);
                    trace[part] += c * 0.0;
                }
            }
            let mut finite = trace == [Vec4::ZERO; 3];
            let mut bounds = Bounds::NONE;
            for lane in 0..12 {
                bounds.lo[lane % 3] = lo[lane / 4][lane % 4].min(bounds.lo[lane % 3]);
                bounds.hi[lane % 3] = hi[lane / 4][lane % 4].max(bounds.hi[lane % 3]);
            }
            for point in rest.chunks_exact(3) {
                bounds.grow([point[0], point[1], point[2]]);
                finite &= point.iter().all(|c| c.is_finite());
            }
            finite.then_some(bounds)
        })
        .reduce(|| Some(Bounds::NONE), join);
    // Negative zeros become zeros, so that the bits do not depend on the order in which boxes were joined.
    if let Some(all) = all {
        return Ok(Bounds { lo: all.lo.map(|c| c + 0.0), hi: all.hi.map(|c| c + 0.0) });
    }
    let finite = |position: &[f32; 3]| position.iter().all(|c| c.is_finite());
    let index = points.iter().position(|position| !finite(position)).unwrap_or_default();
    Err(IndexError::NotFinite { index, position: points[index] })
}

/// Fills `items` with the points and their ids.
pub(crate) fn number(points: &[[f32; 3]], items: &mut Vec<Item>) -> Result<(), OutOfMemory> {
    items.clear();
    memory::reserve(items, points.len(), "sorting photons")?;
    let numbered = points.par_iter().enumerate().with_min_len(1 << 14);
    numbered.map(|(id, &position)| Item::new(position, id as u32)).collect_into_vec(items);
    Ok(())
}

/// The ids of `items`.
pub(crate) fn order(items: &[Item]) -> Result<Vec<u32>, OutOfMemory> {
    let mut order = memory::with_capacity(items.len(), "order of the photons")?;
    items.par_iter().with_min_len(1 << 14).map(Item::id).collect_into_vec(&mut order);
    Ok(order)
}

/// An axis-aligned bounding box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) lo: [f32; 3],
    pub(crate) hi: [f32; 3],
}

impl Bounds {
    pub(crate) const NONE: Bounds = Bounds { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };

    #[inline]
    pub(crate) fn grow(&mut self, position: [f32; 3]) {
        for axis in 0..3 {
            // Comparisons instead of `min` and `max`: one instruction each, since there are no NaNs here.
            self.lo[axis] = if position[axis] < self.lo[axis] { position[axis] } else { self.lo[axis] };
            self.hi[axis] = if position[axis] > self.hi[axis] { position[axis] } else { self.hi[axis] };
        }
    }

    #[inline]
    pub(crate) fn join(&mut self, other: &Bounds) {
        self.grow(other.lo);
        self.grow(other.hi);
    }

    pub(crate) fn around(items: &[Item]) -> Bounds {
        // The id's lane is included so that one instruction compares all four. Two boxes shorten the chain of
        // dependent comparisons.
        let mut lo = [Vec4::INFINITY; 2];
        let mut hi = [Vec4::NEG_INFINITY; 2];
        let mut pairs = items.chunks_exact(2);
        for pair in &mut pairs {
            for part in 0..2 {
                let point = Vec4::from_array(pair[part].0);
                lo[part] = point.min(lo[part]);
                hi[part] = point.max(hi[part]);
            }
        }
        let mut all = Bounds { lo: lo[0].min(lo[1]).truncate().to_array(), hi: hi[0].max(hi[1]).truncate().to_array() };
        for item in pairs.remainder() {
            all.grow(item.position());
        }
        all
    }

    /// The longest axis (the lowest, of equal ones) and its length, which may overflow to infinity.
    #[inline]
    pub(crate) fn longest(&self) -> (usize, f32) {
        let extent = [self.hi[0] - self.lo[0], self.hi[1] - self.lo[1], self.hi[2] - self.lo[2]];
        let mut axis = 0;
        for other in 1..3 {
            if extent[other] > extent[axis] {
                axis = other;
            }
        }
        (axis, extent[axis])
    }
}
