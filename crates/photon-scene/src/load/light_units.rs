//! Units of point, spot and directional lights in glTF files.

use crate::builder::SceneBuilder;
use crate::describe::LightDesc;
use crate::report::LoadReport;

/// Luminous efficacy of monochromatic radiation of 540 THz, lm/W: the constant that defines the candela (BIPM, The
/// International System of Units, 9th edition, 2019). Blender's glTF exporter converts by it, whatever the colour.
const LUMENS_PER_WATT: f64 = 683.0;

/// Subject of report lines about all lights of a file.
pub(super) const LIGHTS: &str = "the lights";

/// What a glTF file gives for its point, spot and directional lights. The names are those of the lighting modes of Blender's
/// exporter, which writes emissive surfaces as radiance, W/(m²·sr), in both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum LightUnits {
    /// Radiant intensity, W/sr, and irradiance, W/m². Also for files whose surfaces emit in nits (cd/m²) as glTF defines:
    /// the picture is then right up to one factor.
    #[default]
    Unitless,
    /// Luminous intensity, cd, and illuminance, lux, which are divided by 683 lm/W.
    Standard,
}

impl LightUnits {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Unitless, Self::Standard];

    /// The name in override files and options.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unitless => "unitless",
            Self::Standard => "standard",
        }
    }

    /// Converts the lights that the scene has so far to W/sr and W/m².
    pub(super) fn convert(self, scene: &mut SceneBuilder, report: &mut LoadReport) {
        report.lines.retain(|line| line.subject != LIGHTS);
        match self {
            Self::Unitless => {}
            Self::Standard => {
                for (_, light) in &mut scene.lights {
                    let (LightDesc::Point { intensity: strength, .. }
                    | LightDesc::Spot { intensity: strength, .. }
                    | LightDesc::Directional { irradiance: strength, .. }) = light;
                    *strength = strength.map(|channel| channel / LUMENS_PER_WATT);
                }
                let count = scene.lights.len();
                if count > 0 {
                    report.note(LIGHTS, format!("{count} in cd and lux are divided by {LUMENS_PER_WATT} lm/W"));
                }
            }
        }
    }
}
