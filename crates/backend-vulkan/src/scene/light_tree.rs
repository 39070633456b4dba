//! A light tree on the device.

use bytemuck::{Pod, Zeroable};
use photon_core::light_tree::LightTree;
use photon_core::{Result, SceneView};

use super::Upload;

/// `LightTreeRef` of scene.glsl.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Record {
    nodes: u64,
    trails: u64,
}

/// Builds and uploads the tree of the lights of a scene; returns the address of its record.
pub(super) fn upload(upload: &mut Upload<'_>, view: &SceneView<'_>) -> Result<u64> {
    let tree = LightTree::new(view);
    let record =
        Record { nodes: upload.table("light tree", tree.nodes())?, trails: upload.table("light tree", tree.trails())? };
    upload.table("scene", &[record])
}
