//! Search among photons, or any other points: the nearest k, or all within a radius.
//!
//! Every answer is exact, the same set in the same order as by brute force, for any input; the kinds of
//! index differ in the time that they take.

mod accept;
#[cfg(target_arch = "x86_64")]
mod compress;
mod dispatch;
mod lanes;
mod layout;
mod median;
mod morton;
mod nearest;
mod points;
mod radix;
mod range;
mod rank;
mod select;
mod vvh;
mod workspace;

#[cfg(test)]
mod tests;

pub use nearest::{Neighbour, Neighbours};
pub use photon_core::IndexKind;
pub use workspace::Workspace;

use dispatch::Isa;
use layout::{Block, Extra, Node, Tree};
use points::Item;
use rayon::prelude::*;

/// Why no index could be built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IndexError {
    /// A coordinate is NaN or infinite.
    #[error("point {index} has the coordinates {position:?}: leave out or repair points that are not finite")]
    NotFinite {
        /// Which point.
        index: usize,
        /// What it is.
        position: [f32; 3],
    },
    /// More points than 32 bits can number.
    #[error("{count} points are more than an index can number ({max}): split them over several", max = u32::MAX - 1)]
    TooMany {
        /// How many.
        count: usize,
    },
}

/// Points arranged for search.
#[derive(Clone, Debug)]
pub struct PointIndex {
    kind: IndexKind,
    isa: Isa,
    tree: Tree,
}

impl PointIndex {
    /// Arranges `points`, on as many threads as the current rayon pool has; the result depends on their
    /// number in nothing. −0 is stored as 0.
    ///
    /// # Errors
    ///
    /// [`IndexError::NotFinite`] for the first point with a coordinate that is not finite,
    /// [`IndexError::TooMany`] for more than `u32::MAX − 1` points.
    pub fn build(points: &[[f32; 3]], kind: IndexKind) -> Result<Self, IndexError> {
        Self::build_in(points, kind, &mut Workspace::default())
    }

    /// The same, in memory that the caller keeps for the next build.
    ///
    /// # Errors
    ///
    /// As [`PointIndex::build`].
    pub fn build_in(points: &[[f32; 3]], kind: IndexKind, workspace: &mut Workspace) -> Result<Self, IndexError> {
        Self::build_with(points, kind, Isa::detect(), workspace)
    }

    fn build_with(
        points: &[[f32; 3]],
        kind: IndexKind,
        isa: Isa,
        workspace: &mut Workspace,
    ) -> Result<Self, IndexError> {
        if points.len() >= u32::MAX as usize {
            return Err(IndexError::TooMany { count: points.len() });
        }
        let bounds = points::checked_bounds(points)?;
        let blocks = points.len().div_ceil(layout::WIDTH);
        let tree = match kind {
            IndexKind::Median => {
                let Workspace { items, other } = workspace;
                points::number(points, items);
                median::arrange(items, workspace::room(other, points.len()), isa);
                layout::lay_out(points::order(items), |slot, _| items[slot], layout::regular_nodes(blocks))
            }
            IndexKind::Vvh => {
                let Workspace { items, other } = workspace;
                points::number(points, items);
                let nodes = vvh::arrange(items, workspace::room(other, points.len()), isa);
                layout::lay_out(points::order(items), |slot, _| items[slot], nodes)
            }
            IndexKind::Morton => {
                let order = morton::order(points, &bounds, isa);
                layout::lay_out(order, |_, id| Item::new(points[id as usize], id), layout::regular_nodes(blocks))
            }
        };
        Ok(Self { kind, isa, tree })
    }

    /// How many points there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tree.order.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tree.order.is_empty()
    }

    /// Slot to id: `order()[slot]` is the index, in the slice that was built from, of the point in that slot.
    /// Bring what belongs to the points into this order, and a search reads it from nearby memory.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.tree.order
    }

    /// The point in a slot.
    #[inline]
    pub(crate) fn position(&self, slot: u32) -> [f32; 3] {
        let block = &self.tree.blocks[slot as usize / layout::WIDTH];
        let lane = slot as usize % layout::WIDTH;
        [block.x[lane], block.y[lane], block.z[lane]]
    }

    /// How the points are arranged.
    #[must_use]
    pub fn kind(&self) -> IndexKind {
        self.kind
    }

    /// Bytes of memory held.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let Tree { blocks, nodes, block_extra, node_extra, order, .. } = &self.tree;
        let total = size_of::<Self>()
            + blocks.capacity() * size_of::<Block>()
            + nodes.capacity() * size_of::<Node>()
            + (block_extra.capacity() + node_extra.capacity()) * size_of::<Extra>()
            + order.capacity() * size_of::<u32>();
        total as u64
    }

    /// Lowest and highest coordinates; `(+∞, −∞)` of no points.
    #[must_use]
    pub fn bounds(&self) -> ([f32; 3], [f32; 3]) {
        (self.tree.bounds.lo, self.tree.bounds.hi)
    }

    /// Calls `visit` with slot and squared distance of every point within the squared radius `r2`, rim
    /// included, in an order that depends on the points, the query and `r2` alone.
    ///
    /// Squared distances are `(dx·dx + dy·dy) + dz·dz` in `f32`; where they overflow, the point is
    /// infinitely far, and within an infinite radius. NaN anywhere finds nothing, nor does `r2` < 0.
    #[inline]
    pub fn within(&self, query: [f32; 3], r2: f32, mut visit: impl FnMut(u32, f32)) {
        self.fold_within(query, r2, (), |(), slot, d2| visit(slot, d2));
    }

    /// As [`Self::within`], with a state that goes from point to point by value: the quickest way to sum
    /// over photons, as the sum stays in registers.
    ///
    /// ```
    /// # use backend_cpu::index::{IndexKind, PointIndex};
    /// let points = [[0.0, 0.0, 0.0], [0.0, 0.5, 0.0], [3.0, 0.0, 0.0]];
    /// let index = PointIndex::build(&points, IndexKind::Morton)?;
    /// let mean_d2 = index.fold_within([0.0; 3], 1.0, 0.0, |sum, _slot, d2| sum + d2) / 2.0;
    /// assert_eq!(mean_d2, 0.125);
    /// # Ok::<(), backend_cpu::index::IndexError>(())
    /// ```
    #[inline]
    pub fn fold_within<T>(&self, query: [f32; 3], r2: f32, state: T, fold: impl FnMut(T, u32, f32) -> T) -> T {
        self.isa.run(range::Within { tree: &self.tree, query, r2, state, fold })
    }

    /// How many points [`Self::within`] would visit.
    #[must_use]
    pub fn count_within(&self, query: [f32; 3], r2: f32) -> u32 {
        self.isa.run(range::Count { tree: &self.tree, query, r2 })
    }

    /// Finds the `k` nearest of the points within the squared radius `max_r2` for whose slot `accept` is
    /// true: fewer if there are fewer. In order of (squared distance, id), which leaves no ties.
    ///
    /// `accept` may be asked for any slot, in any order and more than once, and must answer a slot
    /// always alike. Squared distances and NaN are as with [`Self::within`].
    #[inline]
    pub fn nearest(
        &self,
        query: [f32; 3],
        k: usize,
        max_r2: f32,
        accept: impl FnMut(u32) -> bool,
        out: &mut Neighbours,
    ) {
        self.isa.run(nearest::Nearest { tree: &self.tree, query, k, max_r2, accept: accept::If(accept), out });
    }

    /// [`Self::nearest`] of all points, a little quicker than with an `accept` that is always true.
    pub fn nearest_of_all(&self, query: [f32; 3], k: usize, max_r2: f32, out: &mut Neighbours) {
        self.isa.run(nearest::Nearest { tree: &self.tree, query, k, max_r2, accept: accept::All, out });
    }

    /// [`Self::nearest`] of every query, without a filter, in parallel: row by row the ids, nearest first,
    /// then `u32::MAX` where there are fewer than `k`.
    ///
    /// # Panics
    ///
    /// If `out` has not `queries.len() * k` elements.
    pub fn nearest_many(&self, queries: &[[f32; 3]], k: usize, max_r2: f32, out: &mut [u32]) {
        assert_eq!(Some(out.len()), queries.len().checked_mul(k), "one row of k ids for every query");
        if k == 0 {
            return;
        }
        out.par_chunks_mut(k * CHUNK).zip(queries.par_chunks(CHUNK)).for_each(|(rows, queries)| {
            let mut found = Neighbours::new();
            for (row, &query) in rows.chunks_exact_mut(k).zip(queries) {
                self.nearest_of_all(query, k, max_r2, &mut found);
                row.fill(u32::MAX);
                for (id, neighbour) in row.iter_mut().zip(found.as_slice()) {
                    *id = neighbour.id;
                }
            }
        });
    }

    /// [`Self::count_within`] of every query, in parallel.
    ///
    /// # Panics
    ///
    /// If `out` has not as many elements as `queries`.
    pub fn count_within_many(&self, queries: &[[f32; 3]], r2: f32, out: &mut [u32]) {
        assert_eq!(out.len(), queries.len(), "one count for every query");
        out.par_chunks_mut(CHUNK).zip(queries.par_chunks(CHUNK)).for_each(|(counts, queries)| {
            for (count, &query) in counts.iter_mut().zip(queries) {
                *count = self.count_within(query, r2);
            }
        });
    }
}

/// Queries to a task: enough for the radius of one to help the next.
const CHUNK: usize = 512;
