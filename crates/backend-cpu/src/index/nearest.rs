//! The k nearest points, exactly.
//!
//! A heap of k entries costs most of a k-NN search. Here a radius is guessed that should hold a little
//! more than k points, all points within it are collected without order, and only these few are ranked.
//! The guess comes from the query before, as photon density changes slowly along a picture's rows.
//! A wrong guess costs time, never exactness: too small a radius is enlarged, and one that holds far too
//! many points, like no guess at all, leads to a search from near to far whose radius shrinks as points
//! are found.

use crate::index::dispatch::Search;
use crate::index::lanes::{at_most, to_boxes, to_points};
use crate::index::layout::{LEAF, Tree, WIDTH};
use crate::index::range::blocks_within;
use crate::index::rank::{Key, d2_bits, keep_lowest, key, settle_ties, slot, sort};

/// One of the points nearest to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Squared distance, `(dx·dx + dy·dy) + dz·dz` in `f32`.
    pub d2: f32,
    /// Index of the point in the slice from which the index was built.
    pub id: u32,
    /// Where the point stands in the index's own order.
    pub slot: u32,
}

/// The result of a search for the nearest, and its working memory: reuse one for many searches. It
/// remembers the last search, which makes the next one faster if it is close by, and changes no result.
#[derive(Clone, Debug, Default)]
pub struct Neighbours {
    pub(crate) found: Vec<Neighbour>,
    keys: Vec<Key>,
    sorted: Vec<Key>,
    stack: Vec<(f32, u32)>,
    hint: Option<Hint>,
}

/// What the last search found.
#[derive(Clone, Copy, Debug)]
struct Hint {
    query: [f32; 3],
    k: usize,
    /// Squared distance of the k-th.
    r2: f32,
}

impl Neighbours {
    /// Empty.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// What the last search found, nearest first, equal distances by ascending id.
    #[must_use]
    pub fn as_slice(&self) -> &[Neighbour] {
        &self.found
    }

    /// A squared radius that should hold a few more than `k` points around `query`.
    #[inline]
    fn guess(&self, query: [f32; 3], k: usize) -> Option<f32> {
        let hint = self.hint.as_ref()?;
        if hint.k != k {
            return None;
        }
        let [dx, dy, dz] = [query[0] - hint.query[0], query[1] - hint.query[1], query[2] - hint.query[2]];
        let moved = dx * dx + dy * dy + dz * dz;
        // Far away the last radius says nothing.
        if !(moved <= 4.0 * hint.r2) {
            return None;
        }
        // By the triangle inequality this radius holds k points (but for rounding, and for points that
        // `accept` turns away), and is the better choice after a small step.
        let sure = hint.r2.sqrt() + moved.sqrt();
        let likely = hint.r2 * MARGIN;
        Some(if sure * sure < likely { sure * sure * 1.000_01 } else { likely })
    }
}

/// By how much a guessed squared radius exceeds the last one: the spread of the count of k = 50 points
/// is a seventh, and a second attempt costs more than a quarter more points.
const MARGIN: f32 = 1.25;

/// The search for the nearest.
pub(crate) struct Nearest<'a, A> {
    pub(crate) tree: &'a Tree,
    pub(crate) query: [f32; 3],
    pub(crate) k: usize,
    pub(crate) max_r2: f32,
    pub(crate) accept: A,
    pub(crate) out: &'a mut Neighbours,
}

impl<A: FnMut(u32) -> bool> Search for Nearest<'_, A> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let out = &mut *self.out;
        out.found.clear();
        out.keys.clear();
        if self.tree.nodes.is_empty() || self.k == 0 || !(self.max_r2 >= 0.0) || self.query.iter().any(|c| c.is_nan()) {
            return;
        }
        let k = self.k.min(self.tree.order.len());
        let cap = 4 * k + 64;
        // Where the ranking may expect the greatest distance.
        let mut reach = f32::INFINITY;
        let mut complete = false;
        let mut bound = self.max_r2;
        let mut guess = out.guess(self.query, self.k).unwrap_or(f32::INFINITY);
        for _ in 0..3 {
            if guess == f32::INFINITY {
                break;
            }
            let last = !(guess < self.max_r2);
            let r2 = if last { self.max_r2 } else { guess };
            out.keys.clear();
            let keys = &mut out.keys;
            let accept = &mut self.accept;
            blocks_within(self.tree, self.query, r2, |block, mut hits, d2| {
                while hits != 0 {
                    let lane = hits.trailing_zeros();
                    hits &= hits - 1;
                    let slot = block * WIDTH as u32 + lane;
                    if accept(slot) {
                        keys.push(key(d2[lane as usize % WIDTH], slot));
                    }
                }
                keys.len() <= cap
            });
            let found = out.keys.len();
            if found > cap {
                // Far too many: the k-th of those seen bounds the true one.
                keep_lowest(&mut out.keys, k, &self.tree.order);
                bound = out.keys.last().map_or(bound, |&last| f32::from_bits(d2_bits(last)));
                break;
            }
            if found >= k || last {
                complete = true;
                reach = r2;
                break;
            }
            guess *= (1.4 * k as f32 / found.max(1) as f32).clamp(1.5, 8.0);
        }
        if !complete {
            shrink(self.tree, self.query, k, bound, &mut self.accept, out);
            reach = bound;
        }
        if out.keys.len() > k {
            keep_lowest(&mut out.keys, k, &self.tree.order);
            reach = out.keys.last().map_or(reach, |&last| f32::from_bits(d2_bits(last)));
        }
        sort(&mut out.keys, &mut out.sorted, reach);
        settle_ties(&mut out.keys, &self.tree.order);
        out.found.extend(out.keys.iter().map(|&key| Neighbour {
            d2: f32::from_bits(d2_bits(key)),
            id: self.tree.order[slot(key) as usize],
            slot: slot(key),
        }));
        out.hint = match out.found.last() {
            Some(last) if out.found.len() == self.k => Some(Hint { query: self.query, k: self.k, r2: last.d2 }),
            _ if self.max_r2 < f32::INFINITY => Some(Hint { query: self.query, k: self.k, r2: self.max_r2 }),
            _ => None,
        };
    }
}

/// Collects into `out.keys` the k nearest within `bound`, and perhaps others, from near to far.
#[inline(always)]
fn shrink(
    tree: &Tree,
    query: [f32; 3],
    k: usize,
    bound: f32,
    accept: &mut impl FnMut(u32) -> bool,
    out: &mut Neighbours,
) {
    let Neighbours { keys, stack, .. } = out;
    keys.clear();
    stack.clear();
    stack.push((0.0, 0));
    let cap = 2 * k + 32;
    // Beyond this distance, or at it with a greater id, nothing matters any more.
    let (mut bound, mut bound_id) = (bound, u32::MAX);
    while let Some((d2, child)) = stack.pop() {
        let (leaf, number) = (child & LEAF != 0, (child & !LEAF) as usize);
        if d2 >= bound {
            // Ties matter: a million equal points must not all be looked at.
            let extra = if leaf { &tree.block_extra[number] } else { &tree.node_extra[number] };
            if d2 > bound || extra.min_id > bound_id {
                continue;
            }
        }
        if leaf {
            let d2 = to_points(&tree.blocks[number], query);
            let mut hits = at_most(&d2, bound);
            while hits != 0 {
                let lane = hits.trailing_zeros();
                hits &= hits - 1;
                let slot = number as u32 * WIDTH as u32 + lane;
                if accept(slot) {
                    keys.push(key(d2[lane as usize % WIDTH], slot));
                }
            }
            if keys.len() > cap {
                keep_lowest(keys, k, &tree.order);
                if let Some(&last) = keys.last() {
                    bound = f32::from_bits(d2_bits(last));
                    bound_id = tree.order[slot(last) as usize];
                }
            }
        } else {
            let node = &tree.nodes[number];
            let d2 = to_boxes(node, query);
            let mut hits = at_most(&d2, bound);
            let first = stack.len();
            while hits != 0 {
                // From the last lane, so that of equally near children the first ends on top.
                let lane = 31 - hits.leading_zeros();
                hits ^= 1 << lane;
                let entry = (d2[lane as usize % WIDTH], node.child[lane as usize % WIDTH]);
                // Far below, near on top.
                let mut at = stack.len();
                stack.push(entry);
                while at > first && stack[at - 1].0 < entry.0 {
                    stack[at] = stack[at - 1];
                    at -= 1;
                }
                stack[at] = entry;
            }
        }
    }
}
