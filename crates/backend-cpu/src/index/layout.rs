//! Where points and boxes lie in memory: blocks of sixteen points under a tree with sixteen children
//! to a node. One layout serves all three builders; they differ in the order of the points and in
//! which blocks share a node.

use rayon::prelude::*;

/// Points in a block, and children of a node: one AVX-512 register of `f32`, two of AVX2.
pub(crate) const WIDTH: usize = 16;

/// Set in a child that is a block of points; the other bits are its number.
pub(crate) const LEAF: u32 = 1 << 31;

/// Deepest tree that a builder may hand over, counted in nodes from the root to a block.
pub(crate) const MAX_DEPTH: usize = 64;

/// A point on its way into the index.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(crate) struct Item {
    /// Finite, without negative zeros.
    pub(crate) position: [f32; 3],
    /// Where it stood in the caller's slice.
    pub(crate) id: u32,
}

/// Sixteen points, coordinate by coordinate. Lanes past the last point are NaN, so that no
/// comparison with a radius, not even an infinite one, lets them in.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Block {
    pub(crate) x: [f32; WIDTH],
    pub(crate) y: [f32; WIDTH],
    pub(crate) z: [f32; WIDTH],
}

/// Up to sixteen children and the boxes around their points. Boxes of absent children are NaN, for
/// the reason given at [`Block`].
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) lo: [[f32; WIDTH]; 3],
    pub(crate) hi: [[f32; WIDTH]; 3],
    /// Number of a node, or `LEAF |` number of a block.
    pub(crate) child: [u32; WIDTH],
}

impl Node {
    pub(crate) const EMPTY: Node = Node { lo: [[f32::NAN; WIDTH]; 3], hi: [[f32::NAN; WIDTH]; 3], child: [u32::MAX; WIDTH] };
}

/// What a search never reads unless distances tie or a whole subtree counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extra {
    /// Lowest id below.
    pub(crate) min_id: u32,
    /// Points below.
    pub(crate) count: u32,
}

/// An axis-parallel box.
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
            // Selections instead of `min` and `max`: one instruction each, as there is no NaN here.
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
        // Four boxes at once break the chain of dependent comparisons.
        let mut part = [Bounds::NONE; 4];
        let chunks = items.chunks_exact(4);
        let rest = chunks.remainder();
        for chunk in chunks {
            for (bounds, item) in part.iter_mut().zip(chunk) {
                bounds.grow(item.position);
            }
        }
        let [mut all, b, c, d] = part;
        for other in [b, c, d] {
            all.join(&other);
        }
        for item in rest {
            all.grow(item.position);
        }
        all
    }

    /// The longest axis, the lowest of equals, and its length, which may overflow to infinity.
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

/// The arrays that searches read.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) blocks: Vec<Block>,
    /// The root is node 0; parents come before their children.
    pub(crate) nodes: Vec<Node>,
    pub(crate) block_extra: Vec<Extra>,
    pub(crate) node_extra: Vec<Extra>,
    /// Slot to id.
    pub(crate) order: Vec<u32>,
    pub(crate) bounds: Bounds,
}

/// Lays out items that stand in their final order, under nodes of which only `child` is filled in.
pub(crate) fn lay_out(items: &[Item], mut nodes: Vec<Node>) -> Tree {
    let (blocks, below): (Vec<Block>, Vec<(Bounds, Extra)>) = items.par_chunks(WIDTH).with_min_len(512).map(block).unzip();
    let order = items.par_iter().with_min_len(1 << 14).map(|item| item.id).collect();
    let mut node_bounds = vec![(Bounds::NONE, Extra { min_id: u32::MAX, count: 0 }); nodes.len()];
    // Children stand after their parents: backwards, each is finished before it is asked for.
    for number in (0..nodes.len()).rev() {
        let node = &mut nodes[number];
        let (mut all, mut extra) = (Bounds::NONE, Extra { min_id: u32::MAX, count: 0 });
        for lane in 0..WIDTH {
            let child = node.child[lane];
            if child == u32::MAX {
                continue;
            }
            let (bounds, child_extra) = if child & LEAF != 0 { below[(child & !LEAF) as usize] } else { node_bounds[child as usize] };
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
    Tree {
        blocks,
        nodes,
        block_extra: below.into_iter().map(|(_, extra)| extra).collect(),
        node_extra: node_bounds.into_iter().map(|(_, extra)| extra).collect(),
        order,
        bounds,
    }
}

fn block(items: &[Item]) -> (Block, (Bounds, Extra)) {
    let mut block = Block { x: [f32::NAN; WIDTH], y: [f32::NAN; WIDTH], z: [f32::NAN; WIDTH] };
    let mut bounds = Bounds::NONE;
    let mut extra = Extra { min_id: u32::MAX, count: items.len() as u32 };
    for (lane, item) in items.iter().enumerate() {
        block.x[lane] = item.position[0];
        block.y[lane] = item.position[1];
        block.z[lane] = item.position[2];
        bounds.grow(item.position);
        extra.min_id = extra.min_id.min(item.id);
    }
    (block, (bounds, extra))
}

/// Nodes over `blocks` consecutive blocks, sixteen to a node, level upon level: the topology of the
/// median tree and of the Morton order.
pub(crate) fn regular_nodes(blocks: usize) -> Vec<Node> {
    // Numbers of nodes per level, from just above the blocks up to the root.
    let mut levels = Vec::new();
    let mut count = blocks;
    while count > 1 || levels.is_empty() {
        if blocks == 0 {
            return Vec::new();
        }
        count = count.div_ceil(WIDTH);
        levels.push(count);
    }
    let mut nodes = Vec::with_capacity(levels.iter().sum());
    let mut first = 0;
    for level in (0..levels.len()).rev() {
        let below = if level == 0 { blocks } else { levels[level - 1] };
        // Where the next level down begins; blocks are numbered from 0.
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
    nodes
}
