//! The node format for GPUs: compressed wide BVH, eight children with boxes in bytes (Ylitie, Karras
//! and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs"), made
//! from the binary tree.

mod collapse;
mod node;

use super::AccelError;
use super::binary::{self, Arranged, padded};
use super::shallow::first_fitting;

pub use node::CompressedNode;

/// Maximum number of triangles in a leaf: the node format stores the count in unary, in three bits.
const LEAF: u32 = 3;

/// A compressed wide BVH of a scene in normalised space, for upload to a device.
#[derive(Debug)]
#[non_exhaustive]
pub struct CompressedTree {
    /// Nodes in breadth-first order, the root first; empty without triangles.
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

    /// Builds the tree. The result is deterministic, on any number of threads.
    ///
    /// # Errors
    /// [`AccelError`], which names the triangle or the vertex.
    pub fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, AccelError> {
        let boxes = padded(positions, triangles)?;
        if boxes.is_empty() {
            return Ok(Self { nodes: Vec::new(), order: Vec::new() });
        }
        let tree = binary::tree(&boxes, 1);
        // Some trees are too deep for the stack.
        Ok(first_fitting(&tree, &boxes, 1, |tree| {
            let (tree, depth) = widen(tree);
            (tree, depth <= Self::MAX_DEPTH)
        }))
    }
}

/// The wide tree and its depth.
fn widen((nodes, order): &Arranged) -> (CompressedTree, u32) {
    let mut tree = CompressedTree { nodes: Vec::new(), order: Vec::with_capacity(order.len()) };
    if nodes.is_empty() {
        return (tree, 0);
    }
    let collapse = collapse::Collapse::of(nodes, LEAF);
    // Wide nodes in breadth-first order: the binary node that each replaces, and its depth.
    let mut roots = vec![(0_u32, 1_u32)];
    let mut next = 0;
    while next < roots.len() {
        let (root, depth) = roots[next];
        next += 1;
        let slots = node::slots(nodes, root, &collapse.children(nodes, root));
        let (first_child, first_triangle) = (roots.len() as u32, tree.order.len() as u32);
        let mut wide = CompressedNode::around(&nodes[root as usize], first_child, first_triangle);
        for (slot, child) in slots.iter().enumerate() {
            let Some(child) = *child else { continue };
            let inside = &nodes[child as usize];
            if collapse.is_leaf(child) {
                let before = tree.order.len() as u32;
                collapse.triangles(nodes, order, child, &mut tree.order);
                wide.put_leaf(slot, inside, before - first_triangle, tree.order.len() as u32 - before);
            } else {
                roots.push((child, depth + 1));
                wide.put_node(slot, inside);
            }
        }
        tree.nodes.push(wide);
    }
    let depth = roots.last().map_or(0, |&(_, depth)| depth);
    (tree, depth)
}

#[cfg(test)]
mod tests;
