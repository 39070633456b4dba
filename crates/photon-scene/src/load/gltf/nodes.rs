//! The node hierarchy: which nodes belong to the scene, and their transforms.

use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::json::{Node, Root};

use super::fault::{AGAIN, Fault, label};
use crate::report::LoadReport;

/// Greatest difference of the last row of a matrix from 0 0 0 1 that is taken as rounding: matrices are stored in single
/// precision, and computed from products and inverses.
const ROW_TOLERANCE: f64 = 1e-4;

/// A node of the scene and its transform.
#[derive(Debug)]
pub(super) struct Placed {
    /// Index of the node.
    pub(super) node: usize,
    /// From the node's space to that of the scene; affine and finite.
    pub(super) transform: DMat4,
}

/// Name of a node in messages.
pub(super) fn node_label(root: &Root, index: usize) -> String {
    label("node", index, root.nodes.get(index).and_then(|node| node.name.as_deref()))
}

/// The nodes of the scene, parents before children, siblings in order; those that `KHR_node_visibility` hides are left
/// out, with all below them.
pub(super) fn place(root: &Root) -> Result<Vec<Placed>, Fault> {
    let parents = parents(root)?;
    refuse_cycles(root, &parents)?;

    let mut placed = Vec::new();
    let mut seen = vec![false; root.nodes.len()];
    let mut pending: Vec<(usize, DMat4)> =
        roots(root, &parents)?.into_iter().rev().map(|node| (node, DMat4::IDENTITY)).collect();
    while let Some((node, above)) = pending.pop() {
        if std::mem::replace(&mut seen[node], true) {
            return Err(Fault::new(
                node_label(root, node),
                "is in the scene twice",
                "list it once, at the root of the scene or below one parent",
            ));
        }
        if is_hidden(&root.nodes[node]) {
            continue;
        }
        let transform = above * local(&root.nodes[node], &node_label(root, node))?;
        if !transform.is_finite() {
            return Err(Fault::new(
                node_label(root, node),
                "has a transform that is not finite",
                "give it and its parents translations, rotations and scales of sensible size",
            ));
        }
        pending.extend(children(&root.nodes[node]).rev().map(|child| (child, transform)));
        placed.push(Placed { node, transform });
    }
    Ok(placed)
}

/// From the space of each node to that of the scene, also of nodes outside of the scene and of hidden ones: a skin may
/// refer to any node. May not be finite.
pub(super) fn globals(root: &Root) -> Result<Vec<DMat4>, Fault> {
    let parents = parents(root)?;
    refuse_cycles(root, &parents)?;
    let mut globals = vec![DMat4::IDENTITY; root.nodes.len()];
    let mut pending: Vec<usize> = (0..parents.len()).filter(|&node| parents[node].is_none()).collect();
    while let Some(node) = pending.pop() {
        let above = parents[node].map_or(DMat4::IDENTITY, |parent| globals[parent]);
        globals[node] = above * local(&root.nodes[node], &node_label(root, node))?;
        pending.extend(children(&root.nodes[node]));
    }
    Ok(globals)
}

fn is_hidden(node: &Node) -> bool {
    let extension = node.extensions.as_ref().and_then(|all| all.others.get("KHR_node_visibility"));
    extension.and_then(|extension| extension.get("visible")?.as_bool()) == Some(false)
}

/// The root nodes: those of the default scene, else of the first scene, else every node
/// without a parent.
fn roots(root: &Root, parents: &[Option<usize>]) -> Result<Vec<usize>, Fault> {
    if root.scenes.is_empty() && root.scene.is_none() {
        let orphans = parents.iter().enumerate().filter(|(_, parent)| parent.is_none());
        return Ok(orphans.map(|(node, _)| node).collect());
    }
    let index = root.scene.map_or(0, |scene| scene.value());
    let scene = root
        .scenes
        .get(index)
        .ok_or_else(|| Fault::dangling("the default scene", "scene", index, root.scenes.len()))?;
    let part = label("scene", index, scene.name.as_deref());
    scene
        .nodes
        .iter()
        .map(|node| match node.value() {
            node if node < root.nodes.len() => Ok(node),
            node => Err(Fault::dangling(&part, "node", node, root.nodes.len())),
        })
        .collect()
}

fn children(node: &Node) -> impl DoubleEndedIterator<Item = usize> {
    node.children.iter().flatten().map(|child| child.value())
}

/// The parent of each node; glTF requires at most one.
fn parents(root: &Root) -> Result<Vec<Option<usize>>, Fault> {
    let mut parents: Vec<Option<usize>> = vec![None; root.nodes.len()];
    for (index, node) in root.nodes.iter().enumerate() {
        for child in children(node) {
            let Some(parent) = parents.get_mut(child) else {
                let count = root.nodes.len();
                return Err(Fault::dangling(&node_label(root, index), "node", child, count));
            };
            if let Some(other) = parent.replace(index) {
                let (one, two) = (node_label(root, other), node_label(root, index));
                return Err(Fault::new(
                    node_label(root, child),
                    format!("is a child of both {one} and {two}"),
                    "give it one parent, and copy it for the other",
                ));
            }
        }
    }
    Ok(parents)
}

/// Given one parent each, a node that is not reachable from a root is in or below a cycle.
fn refuse_cycles(root: &Root, parents: &[Option<usize>]) -> Result<(), Fault> {
    let mut reached = vec![false; parents.len()];
    let mut pending: Vec<usize> = (0..parents.len()).filter(|&node| parents[node].is_none()).collect();
    while let Some(node) = pending.pop() {
        reached[node] = true;
        pending.extend(children(&root.nodes[node]));
    }
    match reached.iter().position(|&reached| !reached) {
        None => Ok(()),
        Some(node) => Err(Fault::new(
            node_label(root, node),
            "is an ancestor of itself, or below a node that is",
            "take the cycle out of the children of these nodes",
        )),
    }
}

/// Whether the matrix of a node is rounded in its last row.
pub(super) fn is_nearly_affine(node: &Node) -> bool {
    node.matrix.is_some_and(|m| [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0])
}

/// The matrix with the exact last row 0 0 0 1.
pub(super) fn affine(mut matrix: DMat4) -> DMat4 {
    [matrix.x_axis.w, matrix.y_axis.w, matrix.z_axis.w, matrix.w_axis.w] = [0.0, 0.0, 0.0, 1.0];
    matrix
}

/// Reports the nodes that are not in the scene, and hidden ones, if anything is at them or below them.
pub(super) fn report_absent(root: &Root, placed: &[Placed], report: &mut LoadReport) {
    let mut is_placed = vec![false; root.nodes.len()];
    placed.iter().for_each(|placed| is_placed[placed.node] = true);
    let has_content = |node: &Node| {
        let extensions = node.extensions.as_ref();
        node.mesh.is_some() || node.camera.is_some() || extensions.is_some_and(|all| all.khr_lights_punctual.is_some())
    };
    let absent = root.nodes.iter().zip(is_placed).filter(|(node, is_placed)| !is_placed && has_content(node)).count();
    if absent > 0 {
        let text = format!("has {absent} nodes with meshes, lights or cameras that are hidden or not in the scene");
        report.note("the file", text);
    }
}

/// The transform of a node relative to its parent.
fn local(node: &Node, part: &str) -> Result<DMat4, Fault> {
    if let Some(matrix) = node.matrix {
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        if !(matrix.row(3) - DVec4::W).abs().cmple(DVec4::splat(ROW_TOLERANCE)).all() {
            let why = format!("has a matrix whose last row is {}, not 0 0 0 1", matrix.row(3));
            return Err(Fault::new(part, why, AGAIN));
        }
        return Ok(affine(matrix));
    }
    let vector = |value: Option<[f32; 3]>, default| value.map_or(default, |v| DVec3::from(v.map(f64::from)));
    let rotation = match node.rotation {
        None => DQuat::IDENTITY,
        Some(rotation) => {
            let rotation = DQuat::from_array(rotation.0.map(f64::from));
            if rotation.length() == 0.0 || !rotation.is_finite() {
                return Err(Fault::new(
                    part,
                    format!("has the rotation {:?}, a quaternion that is zero or not finite", rotation.to_array()),
                    AGAIN,
                ));
            }
            rotation.normalize()
        }
    };
    Ok(DMat4::from_scale_rotation_translation(
        vector(node.scale, DVec3::ONE),
        rotation,
        vector(node.translation, DVec3::ZERO),
    ))
}
