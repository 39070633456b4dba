//! Schema of override files. Unknown keys are errors, so that misspelt ones are found.

use super::light_units::LightUnits;
use crate::parameter::{Kind, Value};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The whole file.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct File {
    pub(super) light_units: Option<LightUnits>,
    pub(super) materials: BTreeMap<String, Material>,
    pub(super) lights: Vec<Light>,
    pub(super) quads: Vec<Quad>,
    pub(super) cameras: Vec<Camera>,
    pub(super) environment: Option<Environment>,
    pub(super) medium: Option<Medium>,
}

/// Keys of materials: those with a type of their own, colours, and numbers.
macro_rules! material_keys {
    ($($special:ident: $type:ty,)* ; $($color:ident)* ; $($number:ident)*) => {
        /// `[materials."name"]`: the given properties replace those of the scene.
        #[derive(Clone, Debug, Deserialize)]
        #[serde(deny_unknown_fields, expecting = "the keys of a material, such as { kind = \"glass\", ior = 1.5 }")]
        pub(super) struct Material {
            /// Adds a material to the scene instead of changing an existing one.
            #[serde(default)]
            pub(super) new: bool,
            $(pub(super) $color: Option<Colour>,)*
            $(pub(super) $number: Option<f64>,)*
            $(pub(super) $special: Option<$type>,)*
        }

        impl Material {
            /// The number or colour of a key.
            pub(super) fn value(&self, key: &str) -> Option<Value> {
                match key {
                    $(stringify!($color) => self.$color.map(|given| Value::Color(given.rgb())),)*
                    $(stringify!($number) => self.$number.map(Value::Number),)*
                    _ => None,
                }
            }
        }
    };
}

material_keys! {
    kind: Kind,
    cauchy: [f64; 2],
    sellmeier: [f64; 6],
    phase: String,
    grid: PathBuf,
    transform: [[f64; 4]; 4],
    priority: u32,
    emits_both_sides: bool,
    ;
    albedo absorption tint scattering specular_color diffuse_transmission_color sheen emission
    ;
    ior abbe droplet_micrometres density_scale metallic roughness specular clearcoat clearcoat_roughness anisotropy
    anisotropy_degrees diffuse_transmission transmission sheen_roughness alpha
}

/// One number for all channels, or one for each.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged, expecting = "a number, or three numbers in brackets, is expected")]
pub(super) enum Colour {
    Grey(f64),
    Rgb([f64; 3]),
}

impl Colour {
    pub(super) fn rgb(self) -> [f64; 3] {
        match self {
            Self::Grey(value) => [value; 3],
            Self::Rgb(value) => value,
        }
    }
}

/// `[[lights]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(
    tag = "type",
    rename_all = "lowercase",
    deny_unknown_fields,
    expecting = "a light, such as { type = \"point\", position = [0, 1, 0], intensity = 1 }"
)]
pub(super) enum Light {
    Point {
        name: Option<String>,
        #[serde(default)]
        relative: bool,
        position: [f64; 3],
        intensity: Colour,
    },
    Spot {
        name: Option<String>,
        #[serde(default)]
        relative: bool,
        position: [f64; 3],
        direction: [f64; 3],
        intensity: Colour,
        #[serde(default)]
        inner_degrees: f64,
        outer_degrees: f64,
    },
    Directional {
        name: Option<String>,
        direction: [f64; 3],
        irradiance: Colour,
    },
    Quad {
        name: Option<String>,
        #[serde(default)]
        relative: bool,
        corner: [f64; 3],
        edges: [[f64; 3]; 2],
        radiance: Colour,
        #[serde(default)]
        emits_both_sides: bool,
    },
}

/// `[[quads]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a quadrilateral with corner, edges and material")]
pub(super) struct Quad {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) relative: bool,
    pub(super) corner: [f64; 3],
    pub(super) edges: [[f64; 3]; 2],
    pub(super) material: String,
}

/// `[[cameras]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a camera with name, from, to and fov_degrees")]
pub(super) struct Camera {
    pub(super) name: String,
    #[serde(default)]
    pub(super) relative: bool,
    pub(super) from: [f64; 3],
    pub(super) to: [f64; 3],
    #[serde(default = "upwards")]
    pub(super) up: [f64; 3],
    pub(super) fov_degrees: Option<f64>,
    pub(super) half_height: Option<f64>,
    pub(super) aperture: Option<f64>,
    pub(super) focus: Option<f64>,
}

fn upwards() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

/// `[medium]`: the medium around all solids.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a medium, such as { scattering = 0.1, absorption = 0.01 }")]
pub(super) struct Medium {
    pub(super) scattering: Option<Colour>,
    pub(super) absorption: Option<Colour>,
    pub(super) anisotropy: Option<f64>,
    pub(super) phase: Option<String>,
    pub(super) droplet_micrometres: Option<f64>,
    #[serde(rename = "box")]
    pub(super) bounds: Option<[[f64; 3]; 2]>,
}

/// `[environment]`: at most one of `file`, `radiance` and `sky`, and portals.
#[derive(Clone, Debug, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "an environment, such as { sky = { elevation = 30, turbidity = 3 } } or { file = \"studio.exr\" }"
)]
pub(super) struct Environment {
    pub(super) file: Option<PathBuf>,
    pub(super) radiance: Option<Colour>,
    pub(super) sky: Option<Sky>,
    /// Names of materials or meshes.
    #[serde(default)]
    pub(super) portals: Vec<String>,
    #[serde(default)]
    pub(super) portal: Vec<Portal>,
    #[serde(default)]
    pub(super) rotate_degrees: f64,
    #[serde(default = "unscaled")]
    pub(super) scale: f64,
}

/// `[[environment.portal]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a portal with corners")]
pub(super) struct Portal {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) relative: bool,
    /// Three, or four of a flat quadrilateral, in order around it.
    pub(super) corners: Vec<[f64; 3]>,
}

/// The clear sky of an environment.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a sky, such as { elevation = 30, turbidity = 3 }")]
pub(super) struct Sky {
    pub(super) elevation: f64,
    pub(super) turbidity: f64,
}

fn unscaled() -> f64 {
    1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::describe::MaterialDesc;
    use crate::parameter::PARAMETERS;

    #[test]
    fn every_parameter_is_a_key() {
        for parameter in PARAMETERS {
            let text = format!("[materials.a]\n{} = 0.5", parameter.key);
            let file: File = toml::from_str(&text).unwrap();
            let value = file.materials["a"].value(parameter.key);
            for kind in parameter.kinds {
                let mut desc = MaterialDesc::new("a", kind.surface());
                assert!(value.is_some_and(|value| parameter.set(&mut desc, value)), "{text}");
            }
        }
    }
}
