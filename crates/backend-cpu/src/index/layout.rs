//! Where points and boxes lie in memory: blocks of sixteen points under a tree with sixteen children
//! to a node. One layout serves all three builders; they differ in the order of the points and in
//! which blocks share a node.

use crate::index::IndexError;
use photon_core::glam::Vec4;
use rayon::prelude::*;

/// Points in a block, and children of a node: one AVX-512 register of `f32`, two of AVX2.
pub(crate) const WIDTH: usize = 16;

/// Set in a child that is a block of points; the other bits are its number.
pub(crate) const LEAF: u32 = 1 << 31;

/// Deepest tree that a builder may hand over, counted in nodes from the root to a block.
pub(crate) const MAX_DEPTH: usize = 64;

/// A point on its way into the index: its coordinates, finite and without negative zeros, and the bits of
/// its id. Four numbers of one type, so that one instruction handles all.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(crate) struct Item(pub(crate) [f32; 4]);

impl Item {
    pub(crate) fn new(position: [f32; 3], id: u32) -> Item {
        // Adding 0 turns −0 into 0, so that equal coordinates are equal bits.
        Item([position[0] + 0.0, position[1] + 0.0, position[2] + 0.0, f32::from_bits(id)])
    }

    #[inline(always)]
    pub(crate) fn position(&self) -> [f32; 3] {
        [self.0[0], self.0[1], self.0[2]]
    }

    /// Where the point stood in the caller's slice.
    #[inline(always)]
    pub(crate) fn id(&self) -> u32 {
        self.0[3].to_bits()
    }
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

impl Block {
    pub(crate) const EMPTY: Block = Block { x: [f32::NAN; WIDTH], y: [f32::NAN; WIDTH], z: [f32::NAN; WIDTH] };
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
    pub(crate) const EMPTY: Node =
        Node { lo: [[f32::NAN; WIDTH]; 3], hi: [[f32::NAN; WIDTH]; 3], child: [u32::MAX; WIDTH] };
}

/// What a search never reads unless distances tie or a whole subtree counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extra {
    /// Lowest id below.
    pub(crate) min_id: u32,
    /// Points below.
    pub(crate) count: u32,
}

impl Extra {
    pub(crate) const NONE: Extra = Extra { min_id: u32::MAX, count: 0 };
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
        // The id's lane comes along, for one instruction to compare all four. Two boxes break the
        // chain of dependent comparisons.
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

/// The box around `points`.
pub(crate) fn checked_bounds(points: &[[f32; 3]]) -> Result<Bounds, IndexError> {
    const CHUNK: usize = 1 << 14;
    let parts: Vec<Option<Bounds>> = points
        .par_chunks(CHUNK)
        .map(|points| {
            // Four points are three registers; each lane sees one coordinate only.
            let (fours, rest) = points.as_flattened().split_at(points.len() / 4 * 12);
            let (mut lo, mut hi) = ([Vec4::INFINITY; 3], [Vec4::NEG_INFINITY; 3]);
            // What is not finite leaves a NaN behind: ∞·0 and NaN·0 are NaN.
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
        .collect();
    let mut all = Bounds::NONE;
    for (number, part) in parts.iter().enumerate() {
        if let Some(bounds) = part {
            all.join(bounds);
            continue;
        }
        for (index, &position) in points.iter().enumerate().skip(number * CHUNK) {
            if !position.iter().all(|c| c.is_finite()) {
                return Err(IndexError::NotFinite { index, position });
            }
        }
    }
    Ok(Bounds { lo: all.lo.map(|c| c + 0.0), hi: all.hi.map(|c| c + 0.0) })
}

/// The points with their ids.
pub(crate) fn items(points: &[[f32; 3]]) -> Vec<Item> {
    let mut items = Vec::new();
    let numbered = points.par_iter().enumerate().with_min_len(1 << 14);
    numbered.map(|(id, &position)| Item::new(position, id as u32)).collect_into_vec(&mut items);
    items
}

/// Blocks to a task, and blocks whose points are fetched together.
const TASK: usize = 512;
const NEAR: usize = 8;

/// The ids of items.
pub(crate) fn order(items: &[Item]) -> Vec<u32> {
    let mut order = Vec::new();
    items.par_iter().with_min_len(1 << 14).map(Item::id).collect_into_vec(&mut order);
    order
}

/// Lays out points in their final order, of which `item` tells the one in a slot with an id, under nodes of which
/// only `child` is filled in.
pub(crate) fn lay_out(order: Vec<u32>, item: impl Fn(usize, u32) -> Item + Sync, mut nodes: Vec<Node>) -> Tree {
    let count = order.len().div_ceil(WIDTH);
    // In parallel, as the system hands out memory where it is first written.
    let (mut blocks, mut below) = (Vec::new(), Vec::new());
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
            // Points may come from all over memory: fetched many at a time, they do not wait for each other.
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
    let mut node_bounds = vec![(Bounds::NONE, Extra::NONE); nodes.len()];
    // Children stand after their parents: backwards, each is finished before it is asked for.
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
    Tree {
        blocks,
        nodes,
        block_extra: below.into_iter().map(|(_, extra)| extra).collect(),
        node_extra: node_bounds.into_iter().map(|(_, extra)| extra).collect(),
        order,
        bounds,
    }
}

fn fill(block: &mut Block, items: &[Item]) -> (Bounds, Extra) {
    let mut extra = Extra { min_id: u32::MAX, count: items.len() as u32 };
    for (lane, item) in items.iter().enumerate() {
        [block.x[lane], block.y[lane], block.z[lane]] = item.position();
        extra.min_id = extra.min_id.min(item.id());
    }
    (Bounds::around(items), extra)
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
