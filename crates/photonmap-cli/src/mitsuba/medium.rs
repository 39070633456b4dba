//! Media as Mitsuba has them: homogeneous, with its phase functions.

use std::fmt::Write as _;

use photon_core::Medium;
use photon_core::glam::Vec3;
use photon_core::phase::{Mie, Phase};
use photon_scene::Scene;

use super::rgb;

/// Reference to the medium around all solids, for the sensor, emitters and the outer sides of solids; empty without one.
pub(super) fn around(scene: &Scene) -> &'static str {
    if scene.view().media[0].attenuates() { "<ref id=\"ambient\"/>" } else { "" }
}

/// The medium around all solids; empty without one.
pub(super) fn ambient(scene: &Scene) -> String {
    let text = element(&scene.view().media[0], scene.units().scale, "id=\"ambient\"");
    text.map_or_else(String::new, |text| format!("    {text}\n"))
}

/// The media on both sides of a boundary of a solid.
pub(super) fn sides(scene: &Scene, inside: &Medium) -> String {
    let mut text = String::new();
    if let Some(interior) = element(inside, scene.units().scale, "name=\"interior\"") {
        let _ = writeln!(text, "        {interior}");
    }
    if scene.view().media[0].attenuates() {
        text += "        <ref name=\"exterior\" id=\"ambient\"/>\n";
    }
    text
}

/// `None` for a medium that changes no light.
fn element(medium: &Medium, unit: f64, attribute: &str) -> Option<String> {
    if !medium.attenuates() {
        return None;
    }
    let scattering = medium.scattering.map(f64::from);
    let extinction: [f64; 3] =
        std::array::from_fn(|channel| f64::from(medium.absorption[channel]) + scattering[channel]);
    // Mitsuba reads sigma_t like a reflectance and refuses what exceeds 1, so that the scale has the magnitude.
    let greatest = extinction.into_iter().fold(0.0, f64::max);
    let albedo = std::array::from_fn(|channel| match extinction[channel] {
        0.0 => 0.0,
        extinction => scattering[channel] / extinction,
    });
    let phase = phase(Phase::of(medium));
    Some(format!(
        "<medium {attribute} type=\"homogeneous\">{}<float name=\"scale\" value=\"{}\"/>{}{phase}</medium>",
        rgb("sigma_t", extinction.map(|part| part / greatest)),
        greatest / unit,
        rgb("albedo", albedo)
    ))
}

/// A phase function; empty for even scattering, Mitsuba's default.
fn phase(of: Phase) -> String {
    let lobe = |g: f32| format!("<phase type=\"hg\"><float name=\"g\" value=\"{g}\"/></phase>");
    match of {
        Phase::HenyeyGreenstein(0.0) => String::new(),
        Phase::HenyeyGreenstein(g) => lobe(g),
        Phase::Rayleigh => "<phase type=\"rayleigh\"/>".to_owned(),
        // Only the narrow lobe is there; the wide one is a table by the cosine, from -1 to 1.
        Phase::Mie(mie) => {
            let wide = Phase::Mie(Mie { share: 1.0, ..mie });
            let value = |step: u32| {
                let cosine = f64::from(step) / f64::from(TABLE_STEPS / 2) - 1.0;
                let to = Vec3::new((1.0 - cosine * cosine).sqrt() as f32, cosine as f32, 0.0);
                format!("{:.7}", wide.value(Vec3::Y, to))
            };
            let values: Vec<String> = (0..=TABLE_STEPS).map(value).collect();
            format!(
                "<phase type=\"blendphase\"><float name=\"weight\" value=\"{}\"/>{}<phase type=\"tabphase\"><string \
                 name=\"values\" value=\"{}\"/></phase></phase>",
                mie.share,
                lobe(mie.forward),
                values.join(", ")
            )
        }
    }
}

/// Steps of tables of phase functions, of which linear interpolation is off by less than 2·10⁻⁴.
const TABLE_STEPS: u32 = 1024;
