//! A light tree on the device.

use photon_core::light_tree::{LightNode, LightTree, WIDTH};
use photon_core::{Result, SceneView};

use super::Upload;

host_struct! {
    /// `LightTreeRef` of scene.glsl.
    struct LightTreeRef {
        nodes: u64,
        trails: u64,
    }
}

/// Builds and uploads the tree of the lights of a scene; returns the address of its record. Node after node, the children
/// lie one after the other.
pub(super) fn upload(upload: &mut Upload<'_>, view: &SceneView<'_>) -> Result<u64> {
    let tree = LightTree::new(view);
    let nodes: Vec<LightNode> =
        tree.nodes().iter().flat_map(|nodes| (0..WIDTH).map(|child| nodes.node(child))).collect();
    let record =
        LightTreeRef { nodes: upload.table("light tree", &nodes)?, trails: upload.table("light tree", tree.trails())? };
    upload.table("scene", &[record])
}
