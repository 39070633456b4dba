//! The kd-tree split by the Voxel Volume Heuristic (Wald, Günther, Slusallek 2004, *Balancing Considered Harmful:
//! Faster Photon Mapping using the Voxel Volume Heuristic*): of all planes across the longest axis of a voxel, the
//! one that minimises volume × photons, summed over both sides.
//!
//! Both volumes share the voxel's other two extents, so along one axis the cost of a plane at x is
//! (x − lo)·N_left + (hi − x)·N_right. It is evaluated at 31 planes; the count of the best one is then rounded to
//! whole blocks, so that no lane of a block is empty. Voxels are the tight bounding boxes of their points, so empty
//! margins never need a split of their own.

use photon_core::kd_tree;
use photon_core::memory::{self, OutOfMemory};

use crate::index::dispatch::Isa;
use crate::index::layout::{INDEX, LEAF, Node, WIDTH};
use crate::index::median::left_size;
use crate::index::points::{Bounds, Item};
use crate::index::select::{Scratch, split};

/// Slabs per voxel; the planes lie between them.
const SLABS: usize = kd_tree::SLABS as usize;

/// Maximum number of points that are counted (at least half as many, if the segment has them). A regular subsample
/// of every segment, in order of ids, shows where its photons are dense as well as all of them do.
const SAMPLE: usize = kd_tree::SAMPLE as usize;

/// Segments longer than this are split into two parallel tasks.
const TASK: usize = 1 << 13;

/// Sorts `items`, which are in ascending order of their ids, into tree order, and returns the nodes over them, with
/// only `child` filled in. `other` is scratch memory of the same length.
pub(crate) fn arrange(items: &mut [Item], other: &mut [Item], isa: Isa) -> Result<Vec<Node>, OutOfMemory> {
    if items.is_empty() {
        return Ok(Vec::new());
    }
    let blocks = items.len().div_ceil(WIDTH);
    // Number of blocks in the left part of every split, in preorder: of the m − 1 splits of m blocks, the first is
    // the segment's own, followed by those of its left part, then those of its right.
    let mut splits = memory::zeroed(blocks - 1, INDEX)?;
    segment(items, other, true, &mut splits, 0, &mut Scratch::new(isa, items.len())?)?;
    let mut nodes = memory::with_capacity(blocks / 8 + 1, INDEX)?;
    collapse(&splits, blocks, &mut nodes)?;
    Ok(nodes)
}

/// Arranges the points in `items`; the result is in `items` if `in_place`, otherwise in `other`.
fn segment(
    items: &mut [Item],
    other: &mut [Item],
    in_place: bool,
    splits: &mut [u32],
    depth: u32,
    scratch: &mut Scratch,
) -> Result<(), OutOfMemory> {
    let Some((own, below)) = splits.split_first_mut() else {
        if !in_place {
            other.copy_from_slice(items);
        }
        return Ok(());
    };
    let bounds = Bounds::around(items);
    let (axis, extent) = bounds.longest();
    let left = if depth < kd_tree::HEURISTIC_DEPTH {
        plane(items, axis, bounds.lo[axis], extent)
    } else {
        left_size(items.len())
    };
    *own = (left / WIDTH) as u32;
    split(items, other, left, axis, scratch);
    let (low, high) = other.split_at_mut(left);
    let (other_low, other_high) = items.split_at_mut(left);
    let (splits_low, splits_high) = below.split_at_mut(left / WIDTH - 1);
    if low.len().min(high.len()) > TASK {
        let mut another = scratch.other(high.len())?;
        let (low, high) = rayon::join(
            || segment(low, other_low, !in_place, splits_low, depth + 1, scratch),
            || segment(high, other_high, !in_place, splits_high, depth + 1, &mut another),
        );
        low.and(high)
    } else {
        segment(low, other_low, !in_place, splits_low, depth + 1, scratch)?;
        segment(high, other_high, !in_place, splits_high, depth + 1, scratch)
    }
}

/// Number of points left of the best plane, a multiple of the block size.
fn plane(items: &[Item], axis: usize, lo: f32, extent: f32) -> usize {
    let blocks = items.len().div_ceil(WIDTH);
    let scale = SLABS as f32 / extent;
    // Two blocks leave no choice. If the extent is zero, almost zero or beyond the range of f32, slabs cannot be
    // computed.
    if blocks == 2 || !(scale > 0.0 && scale < f32::INFINITY) {
        return left_size(items.len());
    }
    let mut counts = [0_u32; SLABS];
    let sample = items.iter().step_by(items.len().div_ceil(SAMPLE));
    let sampled = sample.len() as u32;
    for item in sample {
        let slab = ((item.0[axis] - lo) * scale) as i32 as usize;
        counts[slab.min(SLABS - 1)] += 1;
    }
    let (mut best, mut best_cost, mut left) = (0, u32::MAX, 0);
    for (slab, count) in (1..).zip(&counts[..SLABS - 1]) {
        left += count;
        // In units of slabs × points.
        let cost = slab * left + (SLABS as u32 - slab) * (sampled - left);
        if left > 0 && cost < best_cost {
            (best, best_cost) = (left, cost);
        }
    }
    let best = (u64::from(best) * items.len() as u64 / u64::from(sampled)) as usize;
    ((best + WIDTH / 2) / WIDTH).clamp(1, blocks - 1) * WIDTH
}

/// A segment of blocks in the binary tree: its first block, its number of blocks, and the index of its first split.
#[derive(Clone, Copy)]
struct Segment {
    first: usize,
    blocks: usize,
    splits: usize,
}

/// Collapses the binary tree into nodes of up to sixteen children, by repeatedly opening the largest child.
fn collapse(splits: &[u32], blocks: usize, nodes: &mut Vec<Node>) -> Result<(), OutOfMemory> {
    nodes.push(Node::EMPTY);
    let mut open = vec![(0_usize, Segment { first: 0, blocks, splits: 0 })];
    while let Some((number, segment)) = open.pop() {
        let mut children = Vec::with_capacity(WIDTH);
        children.push(segment);
        while children.len() < WIDTH {
            let Some(largest) = (0..children.len())
                .filter(|&c| children[c].blocks > 1)
                .max_by_key(|&c| (children[c].blocks, WIDTH - c))
            else {
                break;
            };
            let parent = children[largest];
            let left = splits[parent.splits] as usize;
            children[largest] = Segment { first: parent.first, blocks: left, splits: parent.splits + 1 };
            children.insert(
                largest + 1,
                Segment { first: parent.first + left, blocks: parent.blocks - left, splits: parent.splits + left },
            );
        }
        memory::reserve_doubling(nodes, WIDTH, INDEX)?;
        memory::reserve_doubling(&mut open, WIDTH, INDEX)?;
        for (lane, child) in children.iter().enumerate() {
            nodes[number].child[lane] = if child.blocks == 1 {
                LEAF | child.first as u32
            } else {
                nodes.push(Node::EMPTY);
                open.push((nodes.len() - 1, *child));
                (nodes.len() - 1) as u32
            };
        }
    }
    Ok(())
}
