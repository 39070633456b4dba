//! Trees of many primitives by several threads: one for each chunk, below a common top, which is improved afterwards. The
//! chunks, and so the tree, do not depend on the number of threads.

use std::collections::BinaryHeap;

use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use photon_core::parallel;

use super::binary::{Arranged, Binary, Padded, obvhs_vec, part};
use super::concat::{concat, starts};
use super::cut::{Cut, Top, cut};
use super::shallow::primitives;

/// From this many primitives on, trees are built in chunks.
pub(crate) const MANY: usize = 1 << 16;

/// Up to this many primitives in a chunk, often the large ones, leaves are chosen with more care.
const FEW: usize = 64;

/// Leaves of the top that is improved: the largest nodes of all.
const TOP: usize = 1 << 12;

/// Share of the nodes of the top that are tried at other places, in the first of 16 rounds.
const TRIED: f32 = 0.25;

/// As [`super::binary::tree`], for many primitives.
pub(crate) fn tree(boxes: &[Padded], leaf: usize, threads: usize) -> Arranged {
    let Cut { nodes: top, chunks } = cut(boxes, threads);
    let trees: Vec<Arranged> = parallel::map(threads, chunks.into_iter(), |_, ids| {
        let own: Vec<Padded> = ids.iter().map(|&id| boxes[id as usize]).collect();
        let (nodes, order) = if own.len() <= FEW { grouped(&part(&own, 1), leaf) } else { part(&own, leaf) };
        (nodes, order.into_iter().map(|at| ids[at as usize]).collect())
    });
    let mut tree = join(&top, &trees, threads);
    improve(&mut tree.0);
    tree
}

/// The tree with leaves of up to `leaf` primitives where the surface of a leaf is not larger than that of those within it:
/// leaves are tested as a whole.
fn grouped((nodes, order): &Arranged, leaf: usize) -> Arranged {
    let mut parents_first = vec![0];
    let mut next = 0;
    while let Some(&at) = parents_first.get(next) {
        next += 1;
        let node: Binary = nodes[at];
        if node.count == 0 {
            parents_first.extend([node.first as usize, node.first as usize + 1]);
        }
    }
    // Number of primitives below each node, surface of the leaves, and whether it becomes one.
    let mut found = vec![(0, 0.0_f32, true); nodes.len()];
    for &at in parents_first.iter().rev() {
        let (node, own) = (nodes[at], f32::from_bits(area(&nodes[at])));
        found[at] = (node.count as usize, own, true);
        if node.count == 0 {
            let [a, b] = [found[node.first as usize], found[node.first as usize + 1]];
            let (count, apart) = (a.0 + b.0, a.1 + b.1);
            let joins = count <= leaf && own <= apart && a.2 && b.2;
            found[at] = (count, if joins { own } else { apart }, joins);
        }
    }
    let mut result: Arranged = (vec![nodes[0]], Vec::with_capacity(order.len()));
    let mut open = vec![(0, 0)];
    while let Some((from, to)) = open.pop() {
        let (count, _, joins) = found[from];
        if joins {
            (result.0[to].first, result.0[to].count) = (result.1.len() as u32, count as u32);
            result.1.extend(primitives(nodes, order, from as u32));
        } else {
            let (child, place) = (nodes[from].first as usize, result.0.len());
            result.0[to].first = place as u32;
            result.0.extend([nodes[child], nodes[child + 1]]);
            open.extend([(child, place), (child + 1, place + 1)]);
        }
    }
    result
}

/// The tree of a top and of the trees of its chunks.
fn join(top: &[Top], trees: &[Arranged], threads: usize) -> Arranged {
    // A node of a chunk other than its root comes one place earlier than its index in the chunk says.
    let first_nodes = starts(top.len(), trees.iter().map(|(nodes, _)| nodes.len() - 1));
    let first_ids = starts(0, trees.iter().map(|(_, order)| order.len()));
    let moved = |chunk: usize, node: Binary| moved_by(node, (first_nodes[chunk] - 1, first_ids[chunk]));
    let mut above = vec![trees[0].0[0]; top.len()];
    // Children come after their parents.
    for (place, &node) in top.iter().enumerate().rev() {
        above[place] = match node {
            Top::Chunk(chunk) => moved(chunk as usize, trees[chunk as usize].0[0]),
            Top::Inner(first) => {
                let [a, b] = [above[first as usize], above[first as usize + 1]];
                Binary {
                    low: std::array::from_fn(|axis| a.low[axis].min(b.low[axis])),
                    high: std::array::from_fn(|axis| a.high[axis].max(b.high[axis])),
                    first,
                    count: 0,
                }
            }
        };
    }
    let below: Vec<&[Binary]> = trees.iter().map(|(nodes, _)| &nodes[1..]).collect();
    let nodes = concat(&above, &below, threads, moved);
    (nodes, trees.iter().flat_map(|(_, order)| order).copied().collect())
}

fn moved_by(node: Binary, (nodes, ids): (u32, u32)) -> Binary {
    Binary { first: node.first + if node.count == 0 { nodes } else { ids }, ..node }
}

/// Moves nodes of the top, the part of the tree above its largest nodes, to where they cost less.
fn improve(nodes: &mut [Binary]) {
    // Places in the tree of the nodes of the top, and its nodes.
    let mut places = vec![0_u32];
    let mut top = vec![leaf_of_top(&nodes[0], 0)];
    let mut open = BinaryHeap::from([(area(&nodes[0]), 0_u32)]);
    let mut leaves = 1;
    while leaves < TOP
        && let Some((_, at)) = open.pop()
    {
        let node = nodes[places[at as usize] as usize];
        if node.count > 0 {
            continue;
        }
        let first = places.len() as u32;
        top[at as usize].make_inner(first);
        for child in [node.first, node.first + 1] {
            let own = &nodes[child as usize];
            open.push((area(own), places.len() as u32));
            top.push(leaf_of_top(own, places.len() as u32));
            places.push(child);
        }
        leaves += 1;
    }
    let originals: Vec<Binary> = places.iter().map(|&place| nodes[place as usize]).collect();
    let mut tree = Bvh2 {
        primitive_indices: (0..top.len() as u32).collect(),
        nodes: top,
        // No path is longer.
        max_depth: leaves,
        ..Bvh2::default()
    };
    ReinsertionOptimizer::default().run(&mut tree, TRIED, None);
    for (&place, node) in places.iter().zip(&tree.nodes) {
        nodes[place as usize] = if node.is_leaf() {
            originals[node.first_index as usize]
        } else {
            let (low, high) = (node.aabb().min.to_array(), node.aabb().max.to_array());
            Binary { low, high, first: places[node.first_index as usize], count: 0 }
        };
    }
}

/// A node as a leaf of the top, `at` its place in it.
fn leaf_of_top(node: &Binary, at: u32) -> Bvh2Node {
    Bvh2Node::new(Aabb { min: obvhs_vec(node.low), max: obvhs_vec(node.high) }, 1, at)
}

/// The bits of the area of a node, which compare as the area does.
fn area(node: &Binary) -> u32 {
    let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| node.high[axis] - node.low[axis]);
    (x * y + y * z + z * x).to_bits()
}

#[cfg(test)]
mod tests;
