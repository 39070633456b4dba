//! Exact k-nearest-neighbour search.
//!
//! Maintaining a heap of k entries is most of the cost of a k-NN search. Here, instead, a radius is guessed that
//! should contain slightly more than k points; all points within it are collected unordered, and only these few are
//! sorted. The guess comes from the previous query, since photon density changes slowly along the rows of an image.
//! A wrong guess costs time but never exactness: a radius that is too small is enlarged; if it contains far too
//! many points, or there is no guess at all, the tree is traversed from near to far with a radius that shrinks as
//! points are found.

use photon_core::memory::{self, OutOfMemory};

use crate::index::accept::Accept;
use crate::index::dispatch::Dispatched;
use crate::index::lanes::{Lanes, to_boxes, to_points};
use crate::index::layout::{LEAF, Tree, WIDTH};
use crate::index::range::blocks_within;
use crate::index::rank::{Key, d2_bits, keep_lowest, settle_ties, slot, sort_lowest};

/// A point found by a nearest-neighbour search.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Neighbour {
    /// Squared distance, `(dx·dx + dy·dy) + dz·dz` in `f32`.
    pub d2: f32,
    /// Index of the point in the slice that the index was built from.
    pub id: u32,
    /// The point's slot in the index order.
    pub slot: u32,
}

/// The result and scratch memory of a nearest-neighbour search; reuse one for many searches. It remembers the last
/// search, which speeds up the next one if it is close by but never changes a result.
#[derive(Clone, Debug, Default)]
pub struct Neighbours {
    pub(crate) found: Vec<Neighbour>,
    keys: Vec<Key>,
    sorted: Vec<Key>,
    stack: Vec<(f32, u32)>,
    hint: Option<Hint>,
}

/// The outcome of the last search.
#[derive(Clone, Copy, Debug)]
struct Hint {
    query: [f32; 3],
    k: usize,
    /// Squared distance of the k-th point.
    r2: f32,
    /// Whether the search before found its k-th point at a similar distance.
    steady: bool,
}

impl Neighbours {
    /// Creates an empty result.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty result with room for the `k` nearest, so that searches allocate nothing more.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn for_nearest(k: usize) -> Result<Self, OutOfMemory> {
        const LABEL: &str = "nearest points";
        let room = collected_at_most(k).saturating_add(2 * WIDTH + 1);
        let (keys, sorted) = (memory::with_capacity(room, LABEL)?, memory::with_capacity(room, LABEL)?);
        Ok(Self { found: memory::with_capacity(k, LABEL)?, keys, sorted, stack: Vec::new(), hint: None })
    }

    /// The points found by the last search, nearest first; equal distances by ascending id.
    #[must_use]
    pub fn as_slice(&self) -> &[Neighbour] {
        &self.found
    }

    /// A squared radius that should contain slightly more than `k` points around `query`.
    #[inline]
    fn guess(&self, query: [f32; 3], k: usize) -> Option<f32> {
        let hint = self.hint.as_ref()?;
        if hint.k != k {
            return None;
        }
        let [dx, dy, dz] = [query[0] - hint.query[0], query[1] - hint.query[1], query[2] - hint.query[2]];
        let moved = dx * dx + dy * dy + dz * dz;
        // After a large step, the last radius is informative only where density is even.
        if !(moved <= 4.0 * hint.r2 || hint.steady) {
            return None;
        }
        // By the triangle inequality this radius contains k points (up to rounding, and unless `accept` rejects
        // some). It is the better choice after a small step.
        let sure = hint.r2.sqrt() + moved.sqrt();
        let likely = hint.r2 * (1.0 + MARGIN / (k as f32).sqrt());
        Some(if sure * sure < likely { sure * sure * 1.000_01 } else { likely })
    }
}

/// Number of points after which a search for the nearest `k` within a guessed radius is given up.
fn collected_at_most(k: usize) -> usize {
    k.saturating_mul(4).saturating_add(64)
}

/// By how many standard deviations a guessed squared radius exceeds the last one: a second attempt costs more than
/// these few extra points. The relative standard deviation of a count of k is 1/√k.
const MARGIN: f32 = 1.8;

/// A k-nearest-neighbour search.
pub(crate) struct Nearest<'a, A> {
    pub(crate) tree: &'a Tree,
    pub(crate) query: [f32; 3],
    pub(crate) k: usize,
    pub(crate) max_r2: f32,
    pub(crate) accept: A,
    pub(crate) out: &'a mut Neighbours,
}

impl<A: Accept> Dispatched for Nearest<'_, A> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Nearest { tree, query, k, max_r2, mut accept, out } = self;
        out.found.clear();
        out.keys.clear();
        if tree.nodes.is_empty() || k == 0 || !(max_r2 >= 0.0) || query.iter().any(|c| c.is_nan()) {
            return;
        }
        let wanted = k.min(tree.order.len());
        let mut bound = max_r2;
        // Upper bound on the distances, used for sorting.
        let mut reach = None;
        let mut guess = out.guess(query, k);
        for _ in 0..3 {
            let Some(r2) = guess else {
                break;
            };
            let last = !(r2 < max_r2);
            let r2 = if last { max_r2 } else { r2 };
            let most = collected_at_most(wanted);
            let found = collect(lanes, tree, query, r2, most, &mut accept, &mut out.keys);
            if found > most {
                // Far too many: the k-th nearest of those collected is an upper bound on the true distance.
                keep_lowest(&mut out.keys, wanted, &tree.order);
                bound = out.keys.last().map_or(bound, |&last| f32::from_bits(d2_bits(last)));
                break;
            }
            if found >= wanted || last {
                reach = Some(r2);
                break;
            }
            guess = Some(r2 * (1.4 * wanted as f32 / found.max(1) as f32).clamp(1.5, 8.0));
        }
        let reach = reach.unwrap_or_else(|| {
            shrink(lanes, tree, query, wanted, bound, &mut accept, out);
            let greatest = out.keys.iter().max().map_or(0, |&key| d2_bits(key));
            f32::from_bits(greatest)
        });
        sort_lowest(&mut out.keys, &mut out.sorted, wanted, reach);
        settle_ties(&mut out.keys, &tree.order);
        out.keys.truncate(wanted);
        out.found.extend(out.keys.iter().map(|&key| Neighbour {
            d2: f32::from_bits(d2_bits(key)),
            id: tree.order[slot(key) as usize],
            slot: slot(key),
        }));
        let r2 = match out.found.last() {
            Some(last) if out.found.len() == k => last.d2,
            // Fewer than k within this radius: the next search should start from it.
            _ => max_r2,
        };
        let steady = out.hint.is_some_and(|before| r2 < 2.0 * before.r2 && before.r2 < 2.0 * r2);
        out.hint = (r2 < f32::INFINITY).then_some(Hint { query, k, r2, steady });
    }
}

/// Collects into `keys` the accepted points within `r2`, stopping once there are more than `most`. Returns how
/// many.
#[inline(always)]
fn collect<L: Lanes>(
    lanes: L,
    tree: &Tree,
    query: [f32; 3],
    r2: f32,
    most: usize,
    accept: &mut impl Accept,
    keys: &mut Vec<Key>,
) -> usize {
    // Room for the block that exceeds `most`, and for vector stores past its end.
    keys.resize(most + 2 * WIDTH + 1, 0);
    let mut found = 0;
    blocks_within(lanes, tree, query, r2, |block, hits, d2| {
        let first = block * WIDTH as u32;
        found += lanes.append(&mut keys[found..], accept.among(hits, first), first, d2);
        found <= most
    });
    keys.truncate(found);
    found
}

/// Collects into `out.keys` the k nearest within `bound`, and possibly others, traversing from near to far.
#[inline(always)]
fn shrink<L: Lanes>(
    lanes: L,
    tree: &Tree,
    query: [f32; 3],
    k: usize,
    bound: f32,
    accept: &mut impl Accept,
    out: &mut Neighbours,
) {
    let Neighbours { keys, stack, .. } = out;
    keys.clear();
    stack.clear();
    stack.push((0.0, 0));
    let most = 2 * k + 32;
    // Points beyond this distance, or at this distance with a greater id, are irrelevant.
    let (mut bound, mut bound_id) = (bound, u32::MAX);
    while let Some((d2, child)) = stack.pop() {
        let (leaf, number) = (child & LEAF != 0, (child & !LEAF) as usize);
        if d2 >= bound {
            // Ids break ties: a search must not visit all of a million equal points.
            let extra = if leaf { &tree.block_extra[number] } else { &tree.node_extra[number] };
            if d2 > bound || extra.min_id > bound_id {
                continue;
            }
        }
        if leaf {
            let d2 = to_points(&tree.blocks[number], query);
            let hits = lanes.at_most(&d2, bound);
            if hits == 0 {
                continue;
            }
            let (first, found) = (number as u32 * WIDTH as u32, keys.len());
            keys.resize(found + WIDTH, 0);
            let added = lanes.append(&mut keys[found..], accept.among(hits, first), first, &d2);
            keys.truncate(found + added);
            if keys.len() > most {
                keep_lowest(keys, k, &tree.order);
                if let Some(&last) = keys.last() {
                    bound = f32::from_bits(d2_bits(last));
                    bound_id = tree.order[slot(last) as usize];
                }
            }
        } else {
            let node = &tree.nodes[number];
            let d2 = to_boxes(node, query);
            let mut hits = lanes.at_most(&d2, bound);
            let first = stack.len();
            while hits != 0 {
                // From the last lane, so that among equally near children the first ends on top of the stack.
                let lane = 31 - hits.leading_zeros();
                hits ^= 1 << lane;
                let entry = (d2[lane as usize % WIDTH], node.child[lane as usize % WIDTH]);
                // Insertion sort: far children below, near ones on top.
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
