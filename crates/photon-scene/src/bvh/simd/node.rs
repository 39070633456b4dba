//! Eight-wide nodes, collapsed from a binary tree.

use std::collections::VecDeque;

use bytemuck::Zeroable;
use photon_core::parallel;

use super::triangle::{LANES, Packet};
use crate::bvh::binary::{Arranged, Binary};
use crate::bvh::chunked;
use crate::bvh::concat::{concat, starts};

/// Children per node.
pub(crate) const WIDTH: usize = 8;

/// Bounding boxes of eight children in SIMD layout: lower and upper bound of x, of y, of z.
#[derive(Clone, Copy, Debug, PartialEq, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) bounds: [[f32; WIDTH]; 6],
    pub(crate) children: [Child; WIDTH],
}

/// Either an inner node, by index, or a leaf: packets, by first index and count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Zeroable)]
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

    /// The node in a table in which nodes and packets have been moved. Empty lanes change too, and are never read.
    fn moved_by(mut self, nodes: u32, packets: u32) -> Self {
        for child in &mut self.children {
            child.first += if child.packets == 0 { nodes } else { packets };
        }
        self
    }
}

/// Subtrees of a large tree that are made by several threads.
const TASKS: usize = 512;

/// Vertices of a triangle by its index.
pub(crate) type Corners<'a> = &'a (dyn Fn(u32) -> [[f32; 3]; 3] + Sync);

/// The wide tree: nodes, packets, and its depth. The root is node 0.
pub(crate) fn widen((tree, order): &Arranged, corners: Corners<'_>, threads: usize) -> (Vec<Node>, Vec<Packet>, usize) {
    let mut top = Wide::new();
    let mut open = VecDeque::from([Open { root: 0, place: 0, depth: 1 }]);
    if order.len() < chunked::MANY {
        top.fill_all(tree, order, corners, open.into());
        return (top.nodes, top.packets, top.depth);
    }
    while open.len() < TASKS
        && let Some(next) = open.pop_front()
    {
        top.fill(tree, order, corners, next, |child| open.push_back(child));
    }
    let parts: Vec<Wide> = parallel::map(threads, open.iter(), |_, &Open { root, depth, .. }| {
        let mut part = Wide::new();
        part.fill_all(tree, order, corners, vec![Open { root, place: 0, depth }]);
        part
    });
    // The first node of a part has its place in the top; the others follow.
    let nodes = starts(top.nodes.len(), parts.iter().map(|part| part.nodes.len() - 1));
    let packets = starts(top.packets.len(), parts.iter().map(|part| part.packets.len()));
    let moved = |part: usize, node: Node| node.moved_by(nodes[part] - 1, packets[part]);
    for (i, (part, open)) in parts.iter().zip(&open).enumerate() {
        top.nodes[open.place] = moved(i, part.nodes[0]);
    }
    let others: Vec<&[Node]> = parts.iter().map(|part| &part.nodes[1..]).collect();
    let nodes = concat(&top.nodes, &others, threads, moved);
    let others: Vec<&[Packet]> = parts.iter().map(|part| part.packets.as_slice()).collect();
    let packets = concat(&top.packets, &others, threads, |_, packet| packet);
    (nodes, packets, parts.iter().fold(top.depth, |depth, part| depth.max(part.depth)))
}

/// A wide node to be filled.
#[derive(Clone, Copy)]
struct Open {
    /// The binary node that it replaces.
    root: u32,
    place: usize,
    depth: usize,
}

/// A wide tree, or a part of one.
struct Wide {
    nodes: Vec<Node>,
    packets: Vec<Packet>,
    depth: usize,
}

impl Wide {
    fn new() -> Self {
        Self { nodes: vec![Node::EMPTY], packets: Vec::new(), depth: 0 }
    }

    /// Fills the open nodes, and all below them.
    fn fill_all(&mut self, tree: &[Binary], order: &[u32], corners: Corners<'_>, mut open: Vec<Open>) {
        while let Some(next) = open.pop() {
            self.fill(tree, order, corners, next, |child| open.push(child));
        }
    }

    fn fill(
        &mut self,
        tree: &[Binary],
        order: &[u32],
        corners: Corners<'_>,
        Open { root, place, depth }: Open,
        mut open: impl FnMut(Open),
    ) {
        self.depth = self.depth.max(depth);
        for (lane, &index) in children(tree, root).iter().enumerate() {
            let from = &tree[index as usize];
            for axis in 0..3 {
                self.nodes[place].bounds[2 * axis][lane] = from.low[axis];
                self.nodes[place].bounds[2 * axis + 1][lane] = from.high[axis];
            }
            self.nodes[place].children[lane] = if from.count > 0 {
                let first = self.packets.len() as u32;
                let ids = &order[from.first as usize..(from.first + from.count) as usize];
                self.packets.extend(ids.chunks(LANES).map(|ids| Packet::of(ids, corners)));
                Child { first, packets: self.packets.len() as u32 - first }
            } else {
                let first = self.nodes.len();
                self.nodes.push(Node::EMPTY);
                open(Open { root: index, place: first, depth: depth + 1 });
                Child { first: first as u32, packets: 0 }
            };
        }
    }
}

/// Up to eight nodes that together cover `root`, found by repeatedly opening the largest box.
fn children(tree: &[Binary], root: u32) -> Vec<u32> {
    let mut list = Vec::with_capacity(WIDTH);
    list.push(root);
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
