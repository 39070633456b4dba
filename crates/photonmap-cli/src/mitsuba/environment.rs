//! The environment, as an emitter of Mitsuba.

use std::path::Path;

use photon_scene::Scene;

use super::rgb;
use crate::exr_file;
use crate::fault::Fault;

/// The emitter of the environment; empty without one. An image is written to `folder`, of which `folder_name` is the name
/// beside the XML file.
///
/// Columns of Mitsuba's images stand for the same φ as here, turned by half a turn: their centres for φ = 2π (i + ½)/W
/// from −z. Its rows stand for θ = π j/(H − 1), the poles included. With a row at the centre of each of our rows, between
/// any two, and at the poles, bilinear interpolation gives the same radiance as here.
pub(super) fn emitter(scene: &Scene, folder: &Path, folder_name: &str) -> Result<String, Fault> {
    let Some(map) = scene.view().environment else { return Ok(String::new()) };
    let scale = scene.units().radiance_to_user();
    if let [[r, g, b, _]] = map.texels() {
        let radiance = rgb("radiance", [r, g, b].map(|c| f64::from(*c) * scale));
        return Ok(format!("    <emitter type=\"constant\">{radiance}</emitter>\n"));
    }
    let (width, rows) = (map.width(), 2 * map.height());
    let texel = |row: u32, column: u32| {
        let (u, v) = ((column as f32 + 0.5) / width as f32, row as f32 / rows as f32);
        map.bilinear(u, v).to_array().map(|c| (f64::from(c) * scale) as f32)
    };
    let pixels = (0..=rows).flat_map(|row| (0..width).map(move |column| texel(row, column))).collect();
    let file = "environment.exr";
    let picture = exr_file::Picture { width: width as usize, height: rows as usize + 1, pixels };
    exr_file::write_picture(&folder.join(file), &picture)?;
    let degrees = 180.0 + 360.0 * f64::from(map.rotation());
    Ok(format!(
        "    <emitter type=\"envmap\">\n        <string name=\"filename\" value=\"{}/{file}\"/>\n        <transform \
         name=\"to_world\"><rotate y=\"1\" angle=\"{degrees}\"/></transform>\n    </emitter>\n",
        super::escaped(folder_name)
    ))
}
