//! The node format for GPUs: compressed wide BVH, eight children with boxes in bytes (Ylitie, Karras
//! and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs"), made
//! from the binary tree.

mod collapse;
mod node;

use photon_core::parallel;

use super::AccelError;
use super::binary::{self, Arranged, Binary, padded};
use super::chunked;
use super::concat::{concat, starts};
use super::regions::Regions;
use super::shallow::first_fitting;

pub use node::CompressedNode;

/// Maximum number of triangles in a leaf: the node format stores the count in unary, in three bits.
const LEAF: u32 = 3;

/// A compressed wide BVH of a scene in normalised space, for upload to a device.
#[derive(Debug)]
#[non_exhaustive]
pub struct CompressedTree {
    /// Nodes, the root first, children of a node one after another; empty without triangles.
    pub nodes: Vec<CompressedNode>,
    /// Triangle indices as the user numbers them, in the order that leaves refer to. A device stores
    /// its triangle table in this order.
    pub order: Vec<u32>,
}

impl CompressedTree {
    /// Levels of the deepest tree that [`CompressedTree::build`] produces: a traversal needs a stack of
    /// that many entries; `BVH_MAX_DEPTH` in GLSL.
    pub const MAX_DEPTH: u32 = 32;

    /// Vertices this close to the plane through the origin of a ray, perpendicular to the largest component of its
    /// direction, may be on either side of it: 16 rounding errors of a distance in a unit box. The intersection test
    /// then computes the distance of a hit from the plane of the triangle. `BVH_PLANE_TOLERANCE` in GLSL.
    pub const PLANE_TOLERANCE: f32 = 1.0 / 2_097_152.0;

    /// Builds the tree by all cores. It does not depend on their number.
    ///
    /// # Errors
    /// [`AccelError`], which names the triangle or the vertex.
    pub fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, AccelError> {
        Self::build_by(positions, triangles, parallel::threads())
    }

    /// As [`Self::build`], by at most `threads` threads, the calling one among them. Those that it starts have ended when it
    /// returns.
    ///
    /// # Errors
    /// As [`Self::build`].
    pub fn build_by(positions: &[[f32; 3]], triangles: &[[u32; 3]], threads: usize) -> Result<Self, AccelError> {
        let boxes = padded(positions, triangles, threads)?;
        if boxes.is_empty() {
            return Ok(Self { nodes: Vec::new(), order: Vec::new() });
        }
        let tree = binary::tree(&boxes, 1, threads);
        // Some trees are too deep for the stack.
        Ok(first_fitting(&tree, &boxes, 1, threads, |tree| {
            let (tree, depth) = widen(tree, threads);
            (tree, depth <= Self::MAX_DEPTH)
        }))
    }
}

/// Subtrees of a large tree that are made by several threads.
const TASKS: usize = 512;

/// The wide tree and its depth.
fn widen((nodes, order): &Arranged, threads: usize) -> (CompressedTree, u32) {
    let tree = Regions::of(nodes, threads);
    let collapse = collapse::Collapse::of(&tree, LEAF, threads);
    let tasks = if order.len() < chunked::MANY { usize::MAX } else { TASKS };
    let (top, rest) = Wide::below((0, 1), tasks, &tree.nodes, order, &collapse);
    let parts: Vec<Wide> =
        parallel::map(threads, rest.iter(), |_, &root| Wide::below(root, usize::MAX, &tree.nodes, order, &collapse).0);
    // The roots of the parts come first, as their parents expect.
    let nodes = starts(top.nodes.len() + parts.len(), parts.iter().map(|part| part.nodes.len() - 1));
    let triangles = starts(top.order.len(), parts.iter().map(|part| part.order.len()));
    let moved = |part: usize, node: CompressedNode| node.moved_by(nodes[part] - 1, triangles[part]);
    let mut first = top.nodes;
    first.extend(parts.iter().enumerate().map(|(i, part)| moved(i, part.nodes[0])));
    let others: Vec<&[CompressedNode]> = parts.iter().map(|part| &part.nodes[1..]).collect();
    let nodes = concat(&first, &others, threads, moved);
    let others: Vec<&[u32]> = parts.iter().map(|part| part.order.as_slice()).collect();
    let order = concat(&top.order, &others, threads, |_, id| id);
    let depth = parts.iter().fold(top.depth, |depth, part| depth.max(part.depth));
    (CompressedTree { nodes, order }, depth)
}

/// A wide tree, or a part of one, in breadth-first order.
struct Wide {
    nodes: Vec<CompressedNode>,
    order: Vec<u32>,
    depth: u32,
}

impl Wide {
    /// The wide nodes that replace a binary node at a depth and those below it, and the roots that are left: none, or at
    /// least `tasks`. These come after the nodes.
    fn below(
        root: (u32, u32),
        tasks: usize,
        nodes: &[Binary],
        order: &[u32],
        collapse: &collapse::Collapse,
    ) -> (Self, Vec<(u32, u32)>) {
        let mut wide = Self { nodes: Vec::new(), order: Vec::new(), depth: root.1 };
        // The binary node that each wide node replaces, and its depth.
        let mut roots = vec![root];
        let mut next = 0;
        while next < roots.len() && roots.len() - next < tasks {
            let (root, depth) = roots[next];
            next += 1;
            let slots = node::slots(nodes, root, &collapse.children(nodes, root));
            let (first_child, first_triangle) = (roots.len() as u32, wide.order.len() as u32);
            let mut new = CompressedNode::around(&nodes[root as usize], first_child, first_triangle);
            for (slot, child) in slots.iter().enumerate() {
                let Some(child) = *child else { continue };
                let inside = &nodes[child as usize];
                if collapse.is_leaf(child) {
                    let before = wide.order.len() as u32;
                    collapse.triangles(nodes, order, child, &mut wide.order);
                    new.put_leaf(slot, inside, before - first_triangle, wide.order.len() as u32 - before);
                } else {
                    roots.push((child, depth + 1));
                    new.put_node(slot, inside);
                }
            }
            wide.nodes.push(new);
            wide.depth = depth;
        }
        (wide, roots.split_off(next))
    }
}

#[cfg(test)]
mod tests;
