//! Writes scenes as glTF 2.0 binary files.

mod container;
mod material;
mod mesh;
mod texture;

use glam::{DMat3, DQuat, DVec3};
use serde_json::{Value, json};

use self::container::pack;
use self::texture::Textures;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, LightDesc, Projection};
use crate::error::SceneError;
use crate::extras::{CameraExtras, LightExtras, NodeExtras};
use crate::shading;

/// Writes the scene as a glTF 2.0 binary file (`.glb`), which [`crate::load_gltf`] reads back as the same scene: its
/// picture is the same, bit for bit.
///
/// Meshes, cameras, point, spot and directional lights become their glTF equivalents, materials the nearest match:
///
/// | here | glTF |
/// |---|---|
/// | diffuse | roughness 1, no metal, `KHR_materials_specular` of 0 |
/// | mirror | metal of roughness 0 |
/// | solid dielectric | `KHR_materials_transmission`, `KHR_materials_ior`, `KHR_materials_volume` with its absorption, `KHR_materials_dispersion` |
/// | thin sheet | the same without a volume |
/// | partly glass | the share as `transmissionFactor` and its texture |
/// | emission | `emissiveFactor` × `KHR_materials_emissive_strength` |
/// | textures | PNG, with samplers and `KHR_texture_transform`; textures of one colour become factors |
/// | vertex attributes | normals and tangents of unit length, colours in `[0, 1]`, UV sets |
///
/// glTF has single precision. `extras.photonmap` of materials, of nodes with lights or cameras and of primitives store
/// the same numbers in double precision, as decimal strings, or as the index of a buffer view with 64-bit floats; also
/// the priority of a solid, the formula of its dispersion, its scattering (whose extension of glTF is a draft), and whether a
/// non-emissive surface would emit from both sides. Textures of floats are written
/// as floats beside their PNG. The loader uses them as long
/// as they agree with the standard glTF content.
///
/// # Errors
/// The errors of [`SceneBuilder::build`], and [`SceneError::Extreme`] for numbers beyond single precision or a file
/// beyond 4 GiB. [`SceneError::Export`] for what glTF has no place for: an environment, portals, an ambient medium, grids, base colours and emission of
/// linear bytes, normal maps in sRGB, and transforms of textures with shear.
pub fn glb(scene: &SceneBuilder) -> Result<Vec<u8>, SceneError> {
    refuse_environment(scene)?;
    if scene.medium.is_some_and(|medium| !medium.is_vacuum()) {
        let hint = "write the scene without it, and give it again in an override file when the file is rendered";
        return Err(SceneError::Export { what: "the ambient medium".to_owned(), hint });
    }
    if let Some(material) = scene.materials.iter().find(|material| material.grid.is_some()) {
        let hint = "write the scene without it, and give it again in an override file when the file is rendered";
        return Err(SceneError::Export { what: format!("the grid of the material '{}'", material.name), hint });
    }
    scene.clone().build()?;
    let mut file = File::default();
    let mut descs = scene.materials.clone();
    shading::fold(&mut descs, &scene.textures);
    let mut materials = Vec::with_capacity(descs.len());
    for desc in &descs {
        let textures = file.textures(desc, &scene.textures)?;
        materials.push(material::material(desc, &textures)?);
    }
    for mesh in &scene.meshes {
        // glTF does not allow meshes without triangles.
        if !mesh.triangles.is_empty() {
            file.mesh(mesh)?;
        }
    }
    let lights: Vec<Value> =
        scene.lights.iter().map(|(name, desc)| file.light(name, desc)).collect::<Result<_, _>>()?;
    let cameras: Vec<Value> =
        scene.cameras.iter().map(|(name, desc)| file.camera(name, desc)).collect::<Result<_, _>>()?;
    file.finish(materials, lights, cameras)
}

/// glTF has no environment in its core or in a ratified extension, no light with a disc, and no portals.
fn refuse_environment(scene: &SceneBuilder) -> Result<(), SceneError> {
    if scene.environment.is_none() && scene.sun.is_none() {
        if scene.portals.is_empty() {
            return Ok(());
        }
        let hint = "write the scene without them, and give them again when the file is rendered";
        return Err(SceneError::Export { what: "portals".to_owned(), hint });
    }
    let text = scene.environment_text.as_ref().map_or_else(String::new, |text| format!(" ({text})"));
    Err(SceneError::Export {
        what: if scene.environment.is_none() { "the sun".to_owned() } else { format!("the environment{text}") },
        hint: "write the scene without it, and give it again when the file is rendered",
    })
}

#[derive(Default)]
struct File {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    images: Textures,
    lights: usize,
    cameras: usize,
}

impl File {
    /// Appends a buffer view, aligned to 8 bytes, and returns its index.
    fn view(&mut self, bytes: impl Iterator<Item = u8>) -> usize {
        while !self.bin.len().is_multiple_of(8) {
            self.bin.push(0);
        }
        let start = self.bin.len();
        self.bin.extend(bytes);
        self.views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bin.len() - start }));
        self.views.len() - 1
    }

    fn light(&mut self, name: &str, desc: &LightDesc) -> Result<Value, SceneError> {
        let what = || format!("light '{name}'");
        let (kind, position, direction, strength) = match *desc {
            LightDesc::Point { position, intensity } => ("point", position, None, intensity),
            LightDesc::Spot { position, direction, intensity, .. } => ("spot", position, Some(direction), intensity),
            LightDesc::Directional { direction, irradiance } => ("directional", [0.0; 3], Some(direction), irradiance),
        };
        let (intensity, color) = scaled(strength);
        let mut light = json!({
            "name": name, "type": kind, "intensity": single(intensity, what)?, "color": singles(color, what)?
        });
        if let LightDesc::Spot { inner_angle, outer_angle, .. } = desc {
            light["spot"] = json!({ "innerConeAngle": *inner_angle as f32, "outerConeAngle": *outer_angle as f32 });
        }
        let direction = direction.unwrap_or([0.0, 0.0, -1.0]);
        let up = DVec3::from(direction).normalize_or_zero().any_orthonormal_vector().to_array();
        let extras = NodeExtras { light: Some(LightExtras::new(desc)), camera: None };
        let mut node = placed(name, position, direction, up, &extras, what)?;
        node["extensions"] = json!({ "KHR_lights_punctual": { "light": self.lights } });
        self.lights += 1;
        self.nodes.push(node);
        Ok(light)
    }

    fn camera(&mut self, name: &str, desc: &CameraDesc) -> Result<Value, SceneError> {
        let what = || format!("camera '{name}'");
        let extras = NodeExtras { light: None, camera: Some(CameraExtras::new(desc)) };
        let mut node = placed(name, desc.position, desc.direction, desc.up, &extras, what)?;
        node["camera"] = json!(self.cameras);
        self.cameras += 1;
        self.nodes.push(node);
        Ok(match desc.projection {
            Projection::Perspective { vertical_fov } => json!({
                "name": name, "type": "perspective", "perspective": { "yfov": vertical_fov as f32, "znear": 0.001 }
            }),
            Projection::Orthographic { half_height } => {
                let half = single(half_height, what)?;
                json!({
                    "name": name,
                    "type": "orthographic",
                    "orthographic": { "xmag": half, "ymag": half, "znear": 0.001, "zfar": 1e6 }
                })
            }
        })
    }

    fn finish(mut self, materials: Vec<Value>, lights: Vec<Value>, cameras: Vec<Value>) -> Result<Vec<u8>, SceneError> {
        while !self.bin.len().is_multiple_of(4) {
            self.bin.push(0);
        }
        let mut root = json!({
            "asset": { "version": "2.0", "generator": concat!("photonmap ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "nodes": (0..self.nodes.len()).collect::<Vec<_>>() }],
            "nodes": self.nodes,
        });
        // glTF does not allow empty lists.
        let lists = [
            ("materials", materials),
            ("meshes", self.meshes),
            ("accessors", self.accessors),
            ("bufferViews", self.views),
            ("textures", self.images.textures),
            ("samplers", self.images.samplers),
            ("images", self.images.images),
            ("cameras", cameras),
        ];
        for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            root[key] = Value::Array(list);
        }
        if !self.bin.is_empty() {
            root["buffers"] = json!([{ "byteLength": self.bin.len() }]);
        }
        let mut used = Vec::new();
        for extension in [
            "KHR_materials_anisotropy",
            "KHR_materials_clearcoat",
            "KHR_materials_diffuse_transmission",
            "KHR_materials_dispersion",
            "KHR_materials_emissive_strength",
            "KHR_materials_ior",
            "KHR_materials_sheen",
            "KHR_materials_specular",
            "KHR_materials_transmission",
            "KHR_materials_volume",
        ] {
            let materials = root["materials"].as_array();
            if materials.into_iter().flatten().any(|material| !material["extensions"][extension].is_null()) {
                used.push(extension);
            }
        }
        if self.images.has_transforms {
            used.push("KHR_texture_transform");
        }
        if !lights.is_empty() {
            root["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
            used.push("KHR_lights_punctual");
        }
        if !used.is_empty() {
            root["extensionsUsed"] = json!(used);
        }
        let mut text = root.to_string().into_bytes();
        while !text.len().is_multiple_of(4) {
            text.push(b' ');
        }
        pack(&text, &self.bin)
    }
}

/// A node at `position` whose −Z axis is `direction`.
fn placed(
    name: &str,
    position: [f64; 3],
    direction: [f64; 3],
    up: [f64; 3],
    extras: &NodeExtras,
    what: impl Fn() -> String + Copy,
) -> Result<Value, SceneError> {
    let forward = DVec3::from(direction).normalize_or_zero();
    let right = forward.cross(DVec3::from(up).normalize_or_zero()).normalize_or_zero();
    let rotation = DQuat::from_mat3(&DMat3::from_cols(right, right.cross(forward), -forward)).normalize();
    Ok(json!({
        "name": name,
        "translation": singles(position, what)?,
        "rotation": rotation.to_array().map(|c| c as f32),
        "extras": { "photonmap": extras },
    }))
}

/// The largest of three numbers ≥ 0, and the numbers relative to it.
fn scaled(values: [f64; 3]) -> (f64, [f64; 3]) {
    let greatest = values.into_iter().fold(0.0, f64::max);
    (greatest, if greatest > 0.0 { values.map(|value| value / greatest) } else { [1.0; 3] })
}

fn single(value: f64, what: impl Fn() -> String) -> Result<f32, SceneError> {
    let rounded = value as f32;
    if rounded.is_finite() {
        return Ok(rounded);
    }
    Err(SceneError::Extreme {
        what: what(),
        value: value.to_string(),
        hint: "glTF has single precision; use another unit of length or of power",
    })
}

fn singles(values: [f64; 3], what: impl Fn() -> String + Copy) -> Result<[f32; 3], SceneError> {
    let [x, y, z] = values;
    Ok([single(x, what)?, single(y, what)?, single(z, what)?])
}
