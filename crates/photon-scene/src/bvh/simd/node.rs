//! Eight-wide nodes, collapsed from a binary tree.

use super::triangle::{LANES, Packet};
use crate::bvh::Binary;

/// Children per node.
pub(crate) const WIDTH: usize = 8;

/// Bounding boxes of eight children in SIMD layout: lower and upper bound of x, of y, of z.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) bounds: [[f32; WIDTH]; 6],
    pub(crate) children: [Child; WIDTH],
}

/// Either an inner node, by index, or a leaf: packets, by first index and count.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct Child {
    pub(crate) first: u32,
    /// Number of packets; 0 for an inner node.
    pub(crate) packets: u32,
}

impl Node {
    /// An empty slot: no ray enters a box whose lower bound is above its upper one.
    const EMPTY: Self = Self {
        bounds: [
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [Child { first: 0, packets: 0 }; WIDTH],
    };
}

/// The wide tree: nodes, packets, and its depth. The root is node 0.
pub(crate) fn widen(
    tree: &[Binary],
    order: &[u32],
    corners: &dyn Fn(u32) -> [[f32; 3]; 3],
) -> (Vec<Node>, Vec<Packet>, usize) {
    let mut nodes = vec![Node::EMPTY];
    let mut packets = Vec::new();
    let mut deepest = 0;
    // A work list instead of recursion: binary node, wide node to fill, depth.
    let mut open = vec![(0_u32, 0_usize, 1_usize)];
    while let Some((root, place, depth)) = open.pop() {
        deepest = deepest.max(depth);
        for (lane, &index) in children(tree, root).iter().enumerate() {
            let from = &tree[index as usize];
            for axis in 0..3 {
                nodes[place].bounds[2 * axis][lane] = from.low[axis];
                nodes[place].bounds[2 * axis + 1][lane] = from.high[axis];
            }
            nodes[place].children[lane] = if from.count > 0 {
                let first = packets.len() as u32;
                let ids = &order[from.first as usize..(from.first + from.count) as usize];
                packets.extend(ids.chunks(LANES).map(|ids| Packet::of(ids, corners)));
                Child { first, packets: packets.len() as u32 - first }
            } else {
                let first = nodes.len();
                nodes.push(Node::EMPTY);
                open.push((index, first, depth + 1));
                Child { first: first as u32, packets: 0 }
            };
        }
    }
    (nodes, packets, deepest)
}

/// Up to eight nodes that together cover `root`, found by repeatedly opening the largest box.
fn children(tree: &[Binary], root: u32) -> Vec<u32> {
    let mut list = vec![root];
    loop {
        let area = |index: u32| {
            let node = &tree[index as usize];
            let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| node.high[axis] - node.low[axis]);
            x * y + y * z + z * x
        };
        let largest = (0..list.len())
            .filter(|&i| tree[list[i] as usize].count == 0)
            .max_by(|&i, &j| area(list[i]).total_cmp(&area(list[j])).then(j.cmp(&i)));
        let Some(largest) = largest else { return list };
        if list.len() == WIDTH {
            return list;
        }
        let first = tree[list[largest] as usize].first;
        list[largest] = first;
        list.push(first + 1);
    }
}
