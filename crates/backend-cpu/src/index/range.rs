//! Range search: all points within a radius.

use crate::index::dispatch::Dispatched;
use crate::index::lanes::{Distances, Lanes, to_boxes, to_far_corners, to_points};
use crate::index::layout::{LEAF, MAX_DEPTH, Node, Tree, WIDTH};

/// A search through the tree. Both methods have to be `#[inline(always)]`, to be compiled for its instruction set.
pub(crate) trait Search<L: Lanes> {
    /// The bit mask of the children that have to be visited.
    fn children(&self, lanes: L, node: &Node) -> u32;

    /// Searches a block, by its number. Returns false to stop.
    fn block(&mut self, lanes: L, number: u32) -> bool;
}

/// Calls [`Search::block`] for every block that is reached. Their order depends only on the tree and the masks.
#[inline(always)]
pub(crate) fn walk<L: Lanes>(lanes: L, tree: &Tree, search: &mut impl Search<L>) {
    let Some(root) = tree.nodes.first() else {
        return;
    };
    // One entry per level: a node, and the mask of its children still to be visited.
    let mut stack = [(0_u32, 0_u32); MAX_DEPTH];
    let mut depth = 0;
    let (mut node, mut mask) = (root, search.children(lanes, root));
    let mut number = 0;
    loop {
        while mask == 0 {
            if depth == 0 {
                return;
            }
            depth -= 1;
            (number, mask) = stack[depth];
            node = &tree.nodes[number as usize];
        }
        let lane = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        let child = node.child[lane % WIDTH];
        if child & LEAF != 0 {
            if !search.block(lanes, child & !LEAF) {
                return;
            }
        } else {
            if mask != 0 {
                stack[depth] = (number, mask);
                depth += 1;
            }
            number = child;
            node = &tree.nodes[number as usize];
            mask = search.children(lanes, node);
        }
    }
}

/// The blocks with a point within a radius.
struct Blocks<'a, F> {
    tree: &'a Tree,
    query: [f32; 3],
    r2: f32,
    found: F,
}

impl<L: Lanes, F: FnMut(u32, u32, &Distances) -> bool> Search<L> for Blocks<'_, F> {
    #[inline(always)]
    fn children(&self, lanes: L, node: &Node) -> u32 {
        lanes.at_most(&to_boxes(node, self.query), self.r2)
    }

    #[inline(always)]
    fn block(&mut self, lanes: L, number: u32) -> bool {
        let d2 = to_points(&self.tree.blocks[number as usize], self.query);
        let hits = lanes.at_most(&d2, self.r2);
        hits == 0 || (self.found)(number, hits, &d2)
    }
}

/// Calls `found` for every block with a point within `r2`, passing the block's number, the bit mask of the lanes
/// within, and the squared distances of all lanes. The order of blocks depends only on the tree, the query and the
/// radius. Stops when `found` returns false.
#[inline(always)]
pub(crate) fn blocks_within<L: Lanes>(
    lanes: L,
    tree: &Tree,
    query: [f32; 3],
    r2: f32,
    found: impl FnMut(u32, u32, &Distances) -> bool,
) {
    walk(lanes, tree, &mut Blocks { tree, query, r2, found });
}

/// Effect of every point within a radius on a state.
pub(crate) trait Fold<T> {
    /// The state after the point in `slot`. An implementation that is `#[inline(always)]` is compiled for the instruction set of
    /// the search; a large closure might be called instead.
    fn fold(&mut self, state: T, slot: u32, d2: f32) -> T;
}

impl<T, F: FnMut(T, u32, f32) -> T> Fold<T> for F {
    #[inline(always)]
    fn fold(&mut self, state: T, slot: u32, d2: f32) -> T {
        self(state, slot, d2)
    }
}

/// Folds the slot and squared distance of every point within `r2` into `state`.
pub(crate) struct Within<'a, T, F> {
    pub(crate) tree: &'a Tree,
    pub(crate) query: [f32; 3],
    pub(crate) r2: f32,
    pub(crate) state: T,
    pub(crate) fold: F,
}

impl<T, F: Fold<T>> Dispatched for Within<'_, T, F> {
    type Output = T;

    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) -> T {
        // Passed by value through the loop, so that it stays in registers.
        let mut state = Some(self.state);
        blocks_within(lanes, self.tree, self.query, self.r2, |block, mut hits, d2| {
            while hits != 0 {
                let lane = hits.trailing_zeros();
                hits &= hits - 1;
                state = state.take().map(|s| self.fold.fold(s, block * WIDTH as u32 + lane, d2[lane as usize % WIDTH]));
            }
            true
        });
        state.expect("the state is put back after every point")
    }
}

/// Use of the points that a search finds, up to sixteen at a time.
pub(crate) trait Batches {
    /// Whether a point counts. Has to be `#[inline(always)]`, as [`Self::take`].
    fn accepts(&self, slot: u32) -> bool;

    /// Takes the first `count` of these points; the others are valid too, but do not count. Has to be `#[inline(always)]`, to
    /// be compiled for the instruction set of the search.
    fn take(&mut self, slots: &[u32; WIDTH], d2: &Distances, count: usize);
}

/// Passes every point within `r2` that is accepted to `batches`, in the order of [`Within`].
pub(crate) struct WithinBatches<'a, B> {
    pub(crate) tree: &'a Tree,
    pub(crate) query: [f32; 3],
    pub(crate) r2: f32,
    pub(crate) batches: &'a mut B,
}

impl<B: Batches> Dispatched for WithinBatches<'_, B> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let mut waiting = Waiting::default();
        blocks_within(lanes, self.tree, self.query, self.r2, |block, hits, d2| {
            waiting.add(self.batches, block, hits, d2);
            true
        });
        waiting.finish(self.batches);
    }
}

/// Points that wait for a batch.
#[derive(Default)]
pub(crate) struct Waiting {
    slots: [u32; WIDTH],
    d2: Distances,
    count: usize,
}

impl Waiting {
    /// Adds those lanes of a block that are in the bit mask `hits`, if they are accepted.
    #[inline(always)]
    pub(crate) fn add(&mut self, batches: &mut impl Batches, block: u32, mut hits: u32, d2: &Distances) {
        while hits != 0 {
            let lane = hits.trailing_zeros();
            hits &= hits - 1;
            let slot = block * WIDTH as u32 + lane;
            (self.slots[self.count], self.d2[self.count]) = (slot, d2[lane as usize % WIDTH]);
            self.count += usize::from(batches.accepts(slot));
            if self.count == WIDTH {
                batches.take(&self.slots, &self.d2, WIDTH);
                self.count = 0;
            }
        }
    }

    /// Passes on the last ones.
    #[inline(always)]
    pub(crate) fn finish(&self, batches: &mut impl Batches) {
        if self.count > 0 {
            batches.take(&self.slots, &self.d2, self.count);
        }
    }
}

/// Counts the points within `r2`. Subtrees that lie entirely inside are not traversed.
pub(crate) struct Count<'a> {
    pub(crate) tree: &'a Tree,
    pub(crate) query: [f32; 3],
    pub(crate) r2: f32,
}

impl Dispatched for Count<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> u32 {
        let Count { tree, query, r2 } = self;
        if tree.nodes.is_empty() {
            return 0;
        }
        let mut total = 0;
        let mut stack = [(0_u32, 0_u32); MAX_DEPTH];
        let mut depth = 0;
        let mut number = 0;
        let enter = |number: u32, total: &mut u32| {
            let node = &tree.nodes[number as usize];
            let touched = lanes.at_most(&to_boxes(node, query), r2);
            let mut inside = lanes.at_most(&to_far_corners(node, query), r2);
            let rest = touched & !inside;
            while inside != 0 {
                let lane = inside.trailing_zeros() as usize;
                inside &= inside - 1;
                let child = node.child[lane % WIDTH];
                let extra = if child & LEAF != 0 {
                    &tree.block_extra[(child & !LEAF) as usize]
                } else {
                    &tree.node_extra[child as usize]
                };
                *total += extra.count;
            }
            rest
        };
        let mut mask = enter(0, &mut total);
        loop {
            while mask == 0 {
                if depth == 0 {
                    return total;
                }
                depth -= 1;
                (number, mask) = stack[depth];
            }
            let lane = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            let child = tree.nodes[number as usize].child[lane % WIDTH];
            if child & LEAF != 0 {
                let d2 = to_points(&tree.blocks[(child & !LEAF) as usize], query);
                total += lanes.at_most(&d2, r2).count_ones();
            } else {
                if mask != 0 {
                    stack[depth] = (number, mask);
                    depth += 1;
                }
                number = child;
                mask = enter(number, &mut total);
            }
        }
    }
}
