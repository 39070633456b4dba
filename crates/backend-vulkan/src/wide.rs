//! The tree that rays are sent through on the device: nodes of eight children with boxes in bytes
//! (Ylitie, Karras and Laine 2017), made from the binary tree of photon-scene.

mod collapse;
mod node;

use photon_scene::{AccelError, BinaryTree};

pub(crate) use node::WideNode;

/// Deepest tree that the stack of the shader serves; `TREE_DEPTH` in intersect.glsl.
const MAX_DEPTH: u32 = 32;
/// Triangles that a leaf may hold: they are counted in one of three bits each.
const LEAF: u32 = 3;

/// Nodes, the root first, and the order of triangles that they refer to.
#[derive(Debug)]
pub(crate) struct WideTree {
    pub(crate) nodes: Vec<WideNode>,
    /// Indices of triangles as the user numbers them.
    pub(crate) order: Vec<u32>,
}

impl WideTree {
    /// The same triangles give the same tree.
    pub(crate) fn build(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Self, AccelError> {
        let (tree, depth) = widen(&BinaryTree::build(positions, triangles, 1)?);
        if depth <= MAX_DEPTH {
            return Ok(tree);
        }
        // Too deep for the stack; split at medians it never is.
        Ok(widen(&BinaryTree::balanced(positions, triangles, 1)?).0)
    }
}

/// The wide tree, and how deep it is.
fn widen(binary: &BinaryTree) -> (WideTree, u32) {
    let mut tree = WideTree { nodes: Vec::new(), order: Vec::with_capacity(binary.order.len()) };
    if binary.nodes.is_empty() {
        return (tree, 0);
    }
    let plan = collapse::Plan::of(&binary.nodes, LEAF);
    // Wide nodes in order of breadth: the binary node that each stands for, and its depth.
    let mut roots = vec![(0_u32, 1_u32)];
    let mut next = 0;
    while next < roots.len() {
        let (root, depth) = roots[next];
        next += 1;
        let slots = node::slots(&binary.nodes, root, &plan.children(&binary.nodes, root));
        let (first_child, first_triangle) = (roots.len() as u32, tree.order.len() as u32);
        let mut wide = WideNode::around(&binary.nodes[root as usize], first_child, first_triangle);
        for (slot, child) in slots.iter().enumerate() {
            let Some(child) = *child else { continue };
            let inside = &binary.nodes[child as usize];
            if plan.is_leaf(child) {
                let before = tree.order.len() as u32;
                plan.triangles(binary, child, &mut tree.order);
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
