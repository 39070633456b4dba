//! Nearest-neighbour and range searches over photons or any other points: the nearest k, or all within a radius.
//!
//! Every result is exact, for any input: the same set in the same order as by brute force. The kinds of index
//! differ only in speed.

mod accept;
mod along;
#[cfg(target_arch = "x86_64")]
mod compress;
pub(crate) mod dispatch;
pub(crate) mod lanes;
mod layout;
mod median;
mod morton;
mod nearest;
mod points;
mod radix;
mod range;
mod rank;
mod segment;
mod select;
mod vvh;
mod workspace;

#[cfg(test)]
mod tests;

pub use nearest::{Neighbour, Neighbours};
pub use photon_core::IndexKind;
use photon_core::memory::OutOfMemory;
pub use workspace::Workspace;

use dispatch::Isa;
pub(crate) use layout::WIDTH;
use layout::{Block, Extra, Node, Tree};
use points::Item;
pub(crate) use range::{Batches, Fold};
use rayon::prelude::*;

/// Reason for which an index could not be built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IndexError {
    /// A coordinate is NaN or infinite.
    #[error("point {index} at {position:?} is not finite: remove or repair such points")]
    NotFinite {
        /// Index of the point.
        index: usize,
        /// Its coordinates.
        position: [f32; 3],
    },
    /// More points than 32-bit ids can number.
    #[error("{count} points exceed an index's limit of {max}: split them over several indices", max = u32::MAX - 1)]
    TooMany {
        /// Number of points.
        count: usize,
    },
    /// An allocation failed.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

/// A search index over points.
#[derive(Clone, Debug)]
pub struct PointIndex {
    kind: IndexKind,
    isa: Isa,
    tree: Tree,
}

impl PointIndex {
    /// Builds an index over `points`, in parallel on the current rayon pool. The result does not depend on the
    /// number of threads. −0 is stored as 0.
    ///
    /// # Errors
    ///
    /// [`IndexError::NotFinite`] for the first point with a coordinate that is not finite,
    /// [`IndexError::TooMany`] for more than `u32::MAX − 1` points, [`IndexError::OutOfMemory`].
    pub fn build(points: &[[f32; 3]], kind: IndexKind) -> Result<Self, IndexError> {
        Self::build_in(points, kind, &mut Workspace::default())
    }

    /// As [`PointIndex::build`], with scratch memory that the caller keeps for the next build.
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
                points::number(points, items)?;
                median::arrange(items, workspace::room(other, points.len())?, isa)?;
                layout::lay_out(points::order(items)?, |slot, _| items[slot], layout::regular_nodes(blocks)?)
            }
            IndexKind::Vvh => {
                let Workspace { items, other } = workspace;
                points::number(points, items)?;
                let nodes = vvh::arrange(items, workspace::room(other, points.len())?, isa)?;
                layout::lay_out(points::order(items)?, |slot, _| items[slot], nodes)
            }
            IndexKind::Morton => {
                let order = morton::order(points, &bounds, isa)?;
                layout::lay_out(order, |_, id| Item::new(points[id as usize], id), layout::regular_nodes(blocks)?)
            }
        }?;
        Ok(Self { kind, isa, tree })
    }

    /// The number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tree.order.len()
    }

    /// Whether the index has no points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tree.order.is_empty()
    }

    /// Maps slots to ids: `order()[slot]` is the position, in the slice that the index was built from, of the point
    /// in that slot. Store per-point data in this order, and a search reads it from nearby memory.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.tree.order
    }

    /// The point in `slot`.
    #[inline]
    pub(crate) fn position(&self, slot: u32) -> [f32; 3] {
        let block = &self.tree.blocks[slot as usize / layout::WIDTH];
        let lane = slot as usize % layout::WIDTH;
        [block.x[lane], block.y[lane], block.z[lane]]
    }

    /// The kind of index.
    #[must_use]
    pub fn kind(&self) -> IndexKind {
        self.kind
    }

    /// Memory held, in bytes.
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

    /// Minimum and maximum coordinates; `(+∞, −∞)` if there are no points.
    #[must_use]
    pub fn bounds(&self) -> ([f32; 3], [f32; 3]) {
        (self.tree.bounds.lo, self.tree.bounds.hi)
    }

    /// Calls `visit` with the slot and squared distance of every point within the squared radius `r2`, boundary
    /// included, in an order that depends only on the points, the query and `r2`.
    ///
    /// Squared distances are `(dx·dx + dy·dy) + dz·dz` in `f32`; where they overflow, the point is infinitely far
    /// away, and within an infinite radius. If any argument is NaN, or `r2` < 0, nothing is found.
    #[inline]
    pub fn within(&self, query: [f32; 3], r2: f32, mut visit: impl FnMut(u32, f32)) {
        self.fold_within(query, r2, (), |(), slot, d2| visit(slot, d2));
    }

    /// As [`Self::within`], with a state that is passed from point to point by value: the fastest way to sum over
    /// photons, since the sum stays in registers.
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
        self.fold_with(query, r2, state, fold)
    }

    #[inline]
    pub(crate) fn fold_with<T>(&self, query: [f32; 3], r2: f32, state: T, fold: impl Fold<T>) -> T {
        self.isa.run(range::Within { tree: &self.tree, query, r2, state, fold })
    }

    /// As [`Self::within`], up to sixteen points at a time.
    #[inline]
    pub(crate) fn batches_within(&self, query: [f32; 3], r2: f32, batches: &mut impl Batches) {
        self.isa.run(range::WithinBatches { tree: &self.tree, query, r2, batches });
    }

    /// Passes every point within `radius` of a segment, with its squared distance from the line, to `batches`, in an order that
    /// depends only on the arguments. `direction` is a unit vector. Points count whose foot on the line is at most eight radii
    /// beyond an end, so that a caller can end the segment by oblique planes.
    #[inline]
    pub(crate) fn batches_along(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        length: f32,
        radius: f32,
        batches: &mut impl Batches,
    ) {
        let range = [-8.0 * radius, length + 8.0 * radius];
        let line = along::Line { origin, direction, range, radius };
        self.isa.run(along::Along { tree: &self.tree, line, batches });
    }

    /// The number of points that [`Self::within`] would visit.
    #[must_use]
    pub fn count_within(&self, query: [f32; 3], r2: f32) -> u32 {
        self.isa.run(range::Count { tree: &self.tree, query, r2 })
    }

    /// Finds the `k` nearest of those points within the squared radius `max_r2` for whose slot `accept` returns
    /// true, or fewer if there are fewer. Sorted by (squared distance, id), so there are no ties.
    ///
    /// `accept` may be called for any slot, in any order and more than once, and must always return the same result
    /// for a slot. Squared distances and NaN are as in [`Self::within`].
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

    /// [`Self::nearest`] without a filter; slightly faster than with an `accept` that always returns true.
    pub fn nearest_of_all(&self, query: [f32; 3], k: usize, max_r2: f32, out: &mut Neighbours) {
        self.isa.run(nearest::Nearest { tree: &self.tree, query, k, max_r2, accept: accept::All, out });
    }

    /// [`Self::nearest`] for every query, without a filter, in parallel. `out` has one row per query: the ids,
    /// nearest first, padded with `u32::MAX` if there are fewer than `k`.
    ///
    /// # Errors
    ///
    /// [`IndexError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// If `out` does not have `queries.len() * k` elements.
    pub fn nearest_many(&self, queries: &[[f32; 3]], k: usize, max_r2: f32, out: &mut [u32]) -> Result<(), IndexError> {
        assert_eq!(Some(out.len()), queries.len().checked_mul(k), "`out` must have k elements per query");
        if k == 0 {
            return Ok(());
        }
        out.par_chunks_mut(k * CHUNK).with_max_len(1).zip(queries.par_chunks(CHUNK)).try_for_each(|(rows, queries)| {
            let mut found = Neighbours::for_nearest(k.min(self.len()))?;
            for (row, &query) in rows.chunks_exact_mut(k).zip(queries) {
                self.nearest_of_all(query, k, max_r2, &mut found);
                row.fill(u32::MAX);
                for (id, neighbour) in row.iter_mut().zip(found.as_slice()) {
                    *id = neighbour.id;
                }
            }
            Ok(())
        })
    }

    /// [`Self::count_within`] for every query, in parallel.
    ///
    /// # Panics
    ///
    /// If `out` and `queries` differ in length.
    pub fn count_within_many(&self, queries: &[[f32; 3]], r2: f32, out: &mut [u32]) {
        assert_eq!(out.len(), queries.len(), "`out` must have one element per query");
        out.par_chunks_mut(CHUNK).with_max_len(1).zip(queries.par_chunks(CHUNK)).for_each(|(counts, queries)| {
            for (count, &query) in counts.iter_mut().zip(queries) {
                *count = self.count_within(query, r2);
            }
        });
    }
}

/// Queries per parallel task: enough for the radius of one query to help the next.
const CHUNK: usize = 512;
