//! Memory layout of points and boxes: blocks of sixteen points under a tree with sixteen children per node. All
//! three builders use the same layout; they differ in the order of the points and in which blocks share a node.

use crate::index::points::{Bounds, Item};
use photon_core::kd_tree;
use photon_core::memory::{self, OutOfMemory};
use rayon::prelude::*;

/// Points per block and children per node: one AVX-512 register of `f32`, or two of AVX2.
pub(crate) const WIDTH: usize = kd_tree::WIDTH as usize;

/// Set in a child that is a block of points; the other bits are the block's number.
pub(crate) const LEAF: u32 = kd_tree::LEAF;

/// Maximum depth of a tree, counted in nodes from the root to a block.
pub(crate) const MAX_DEPTH: usize = kd_tree::MAX_DEPTH as usize;

/// Sixteen points as a structure of arrays. Lanes past the last point are NaN, so that they fail every comparison
/// with a radius, even an infinite one.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Block {
    pub(crate) x: [f32; WIDTH],
    pub(crate) y: [f32; WIDTH],
    pub(crate) z: [f32; WIDTH],
}

impl Block {
    pub(crate) const EMPTY: Block = Block { x: [f32::NAN; WIDTH], y: [f32::NAN; WIDTH], z: [f32::NAN; WIDTH] };
}

/// Up to sixteen children and the bounding boxes of their points. Boxes of absent children are NaN, for the reason
/// given at [`Block`].
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) lo: [[f32; WIDTH]; 3],
    pub(crate) hi: [[f32; WIDTH]; 3],
    /// A node's number, or `LEAF |` a block's number.
    pub(crate) child: [u32; WIDTH],
}

impl Node {
    pub(crate) const EMPTY: Node =
        Node { lo: [[f32::NAN; WIDTH]; 3], hi: [[f32::NAN; WIDTH]; 3], child: [u32::MAX; WIDTH] };
}

/// Data that a search reads only if distances tie or a whole subtree counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extra {
    /// Lowest id in the subtree.
    pub(crate) min_id: u32,
    /// Number of points in the subtree.
    pub(crate) count: u32,
}

impl Extra {
    pub(crate) const NONE: Extra = Extra { min_id: u32::MAX, count: 0 };
}

/// The arrays that searches read.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) blocks: Vec<Block>,
    /// The root is node 0; parents come before their children.
    pub(crate) nodes: Vec<Node>,
    pub(crate) block_extra: Vec<Extra>,
    pub(crate) node_extra: Vec<Extra>,
    /// Maps slots to ids.
    pub(crate) order: Vec<u32>,
    pub(crate) bounds: Bounds,
}

/// Label of its memory.
pub(crate) const INDEX: &str = "photon index";

/// Blocks per parallel task, and blocks whose points are fetched together.
const TASK: usize = 512;
const NEAR: usize = 8;

/// Fills blocks with the points in their final order, and the nodes over them. `item` returns the point in a given
/// slot with a given id; of `nodes`, only `child` is filled in.
pub(crate) fn lay_out(
    order: Vec<u32>,
    item: impl Fn(usize, u32) -> Item + Sync,
    mut nodes: Vec<Node>,
) -> Result<Tree, OutOfMemory> {
    let count = order.len().div_ceil(WIDTH);
    // In parallel, since the system allocates pages when they are first written.
    let mut blocks = memory::with_capacity(count, INDEX)?;
    let mut below = memory::with_capacity(count, INDEX)?;
    (0..count)
        .into_par_iter()
        .with_min_len(TASK)
        .map(|_| (Block::EMPTY, (Bounds::NONE, Extra::NONE)))
        .unzip_into_vecs(&mut blocks, &mut below);
    blocks
        .par_chunks_mut(TASK)
        .zip(below.par_chunks_mut(TASK))
        .zip(order.par_chunks(TASK * WIDTH))
        .enumerate()
        .for_each(|(task, ((blocks, below), ids))| {
            // Points may be scattered in memory; fetching many at a time overlaps the cache misses.
            let mut near = [Item::default(); NEAR * WIDTH];
            let some = blocks.chunks_mut(NEAR).zip(below.chunks_mut(NEAR)).zip(ids.chunks(NEAR * WIDTH));
            for (part, ((blocks, below), ids)) in some.enumerate() {
                let first = task * TASK * WIDTH + part * NEAR * WIDTH;
                for (at, (near, &id)) in near.iter_mut().zip(ids).enumerate() {
                    *near = item(first + at, id);
                }
                for ((block, below), items) in blocks.iter_mut().zip(below).zip(near[..ids.len()].chunks(WIDTH)) {
                    *below = fill(block, items);
                }
            }
        });
    let mut node_bounds = memory::filled(nodes.len(), (Bounds::NONE, Extra::NONE), INDEX)?;
    // Children come after their parents, so going backwards finishes each child before its parent reads it.
    for number in (0..nodes.len()).rev() {
        let node = &mut nodes[number];
        let (mut all, mut extra) = (Bounds::NONE, Extra::NONE);
        for lane in 0..WIDTH {
            let child = node.child[lane];
            if child == u32::MAX {
                continue;
            }
            let (bounds, child_extra) =
                if child & LEAF != 0 { below[(child & !LEAF) as usize] } else { node_bounds[child as usize] };
            for axis in 0..3 {
                node.lo[axis][lane] = bounds.lo[axis];
                node.hi[axis][lane] = bounds.hi[axis];
            }
            all.join(&bounds);
            extra.min_id = extra.min_id.min(child_extra.min_id);
            extra.count += child_extra.count;
        }
        node_bounds[number] = (all, extra);
    }
    let bounds = node_bounds.first().map_or(Bounds::NONE, |root| root.0);
    let block_extra = memory::collected(below.iter().map(|(_, extra)| *extra), INDEX)?;
    let node_extra = memory::collected(node_bounds.iter().map(|(_, extra)| *extra), INDEX)?;
    Ok(Tree { blocks, nodes, block_extra, node_extra, order, bounds })
}

fn fill(block: &mut Block, items: &[Item]) -> (Bounds, Extra) {
    let mut extra = Extra { min_id: u32::MAX, count: items.len() as u32 };
    for (lane, item) in items.iter().enumerate() {
        [block.x[lane], block.y[lane], block.z[lane]] = item.position();
        extra.min_id = extra.min_id.min(item.id());
    }
    (Bounds::around(items), extra)
}

/// Nodes over `blocks` consecutive blocks, sixteen per node, level by level: the topology of the median tree and of
/// the Morton order.
pub(crate) fn regular_nodes(blocks: usize) -> Result<Vec<Node>, OutOfMemory> {
    // Number of nodes per level, from just above the blocks up to the root.
    let mut levels = Vec::new();
    let mut count = blocks;
    while count > 1 || levels.is_empty() {
        if blocks == 0 {
            return Ok(Vec::new());
        }
        count = count.div_ceil(WIDTH);
        levels.push(count);
    }
    let mut nodes = memory::with_capacity(levels.iter().sum(), INDEX)?;
    let mut first = 0;
    for level in (0..levels.len()).rev() {
        let below = if level == 0 { blocks } else { levels[level - 1] };
        // Number of the first child on the next level down; blocks are numbered from 0.
        let base = if level == 0 { LEAF as usize } else { first + levels[level] };
        for number in 0..levels[level] {
            let mut node = Node::EMPTY;
            for lane in 0..WIDTH.min(below - number * WIDTH) {
                node.child[lane] = (base + number * WIDTH + lane) as u32;
            }
            nodes.push(node);
        }
        first += levels[level];
    }
    Ok(nodes)
}
