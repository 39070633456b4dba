//! Grids of densities on the device.

use photon_core::{Result, SceneView};

use super::Upload;

host_struct! {
    /// `GridTables` of scene.glsl.
    struct GridTables {
        grids: u64,
        bricks: u64,
        densities: u64,
    }
}

/// Address of the tables; 0 in a scene of homogeneous media.
pub(super) fn upload(upload: &mut Upload<'_>, view: &SceneView<'_>) -> Result<u64> {
    const LABEL: &str = "grids of densities";
    let tables = view.grids;
    if tables.grids.is_empty() {
        return Ok(0);
    }
    let record = GridTables {
        grids: upload.table(LABEL, tables.grids)?,
        bricks: upload.table(LABEL, tables.bricks)?,
        // None if all bricks are even.
        densities: if tables.densities.is_empty() { 0 } else { upload.table(LABEL, tables.densities)? },
    };
    upload.table(LABEL, &[record])
}
