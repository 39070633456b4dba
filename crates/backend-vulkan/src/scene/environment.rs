//! An environment map on the device.

use photon_core::{Result, SceneView};

use super::Upload;

host_struct! {
    /// `EnvironmentRef` of scene.glsl.
    struct EnvironmentRef {
        texels: u64,
        rows: u64,
        starts: u64,
        width: u32,
        height: u32,
        rows_count: u32,
        columns: u32,
        step_texels: u32,
        rotation: f32,
    }
}

/// Uploads [`SceneView::environment`]; returns the address of its record, or 0 without one.
pub(super) fn upload(upload: &mut Upload<'_>, view: &SceneView<'_>) -> Result<u64> {
    let Some(map) = view.environment else { return Ok(0) };
    // The guide tables follow the starts, entry for entry.
    let guides = map.row_guide().iter().chain(map.column_guides()).map(|&index| u32::from(index));
    let starts: Vec<u32> = map.row_starts().iter().chain(map.column_starts()).copied().chain(guides).collect();
    let record = EnvironmentRef {
        texels: upload.table("environment", map.texels())?,
        rows: upload.table("environment", map.rows())?,
        starts: upload.table("environment", &starts)?,
        width: map.width(),
        height: map.height(),
        rows_count: map.rows().len() as u32,
        columns: map.columns(),
        step_texels: map.step(),
        rotation: map.rotation(),
    };
    upload.table("scene", &[record])
}
