//! Eight-wide nodes, collapsed from a binary tree.

use std::collections::VecDeque;

use photon_core::parallel;

use super::triangle::{LANES, Packet};
use crate::bvh::binary::{Arranged, Binary};
use crate::bvh::chunked;
use crate::bvh::concat::{append, concat, starts};

/// Children per node.
pub(crate) const WIDTH: usize = 8;

/// Bounding boxes of eight children in SIMD layout: lower and upper bound of x, of y, of z.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) bounds: [[f32; WIDTH]; 6],
    pub(crate) children: [Child; WIDTH],
}

/// Either an inner node, by index, or a leaf: packets, by first index and count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

    /// The node in a table in which nodes have been moved. Empty lanes change too, and are never read.
    fn moved_by(mut self, nodes: u32) -> Self {
        for child in self.children.iter_mut().filter(|child| child.packets == 0) {
            child.first += nodes;
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
    let mut top = Wide::new(0);
    let mut open = VecDeque::from([Open { root: 0, place: 0, depth: 1 }]);
    if order.len() < chunked::MANY {
        let mut packets = Vec::with_capacity(packets_below(tree, 0));
        top.fill_all(tree, order, corners, open.into(), &mut |packet| packets.push(packet));
        return (top.nodes, packets, top.depth);
    }
    let mut packets = Vec::new();
    while open.len() < TASKS
        && let Some(next) = open.pop_front()
    {
        top.fill(tree, order, corners, next, &mut |packet| packets.push(packet), |child| open.push_back(child));
    }
    let counts = parallel::map(threads, open.iter(), |_, open| packets_below(tree, open.root));
    let parts = append(&mut packets, &counts, threads, |i, start, room| {
        let mut part = Wide::new(start);
        // Most have more than four children.
        part.nodes.reserve(counts[i] / 4);
        part.fill_all(tree, order, corners, vec![Open { place: 0, ..open[i] }], &mut |packet| room.push(packet));
        part
    });
    // The first node of a part has its place in the top; the others follow.
    let nodes = starts(top.nodes.len(), parts.iter().map(|part| part.nodes.len() - 1));
    let moved = |part: usize, node: Node| node.moved_by(nodes[part] - 1);
    for (i, (part, open)) in parts.iter().zip(&open).enumerate() {
        top.nodes[open.place] = moved(i, part.nodes[0]);
    }
    let others: Vec<&[Node]> = parts.iter().map(|part| &part.nodes[1..]).collect();
    let nodes = concat(&top.nodes, &others, threads, moved);
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

/// Number of packets of the leaves below a node.
fn packets_below(tree: &[Binary], root: u32) -> usize {
    let (mut count, mut open) = (0, vec![root]);
    while let Some(index) = open.pop() {
        let node = &tree[index as usize];
        if node.count == 0 {
            open.extend([node.first, node.first + 1]);
        }
        count += node.count.div_ceil(LANES as u32) as usize;
    }
    count
}

/// A wide tree, or a part of one.
struct Wide {
    nodes: Vec<Node>,
    /// Index of the next packet.
    packets: u32,
    depth: usize,
}

impl Wide {
    fn new(packets: u32) -> Self {
        Self { nodes: vec![Node::EMPTY], packets, depth: 0 }
    }

    /// Fills the open nodes, and all below them; packets are handed to `put` in order.
    fn fill_all(
        &mut self,
        tree: &[Binary],
        order: &[u32],
        corners: Corners<'_>,
        mut open: Vec<Open>,
        put: &mut impl FnMut(Packet),
    ) {
        while let Some(next) = open.pop() {
            self.fill(tree, order, corners, next, put, |child| open.push(child));
        }
    }

    fn fill(
        &mut self,
        tree: &[Binary],
        order: &[u32],
        corners: Corners<'_>,
        Open { root, place, depth }: Open,
        put: &mut impl FnMut(Packet),
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
                let first = self.packets;
                for ids in order[from.first as usize..(from.first + from.count) as usize].chunks(LANES) {
                    put(Packet::of(ids, corners));
                    self.packets += 1;
                }
                Child { first, packets: self.packets - first }
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
