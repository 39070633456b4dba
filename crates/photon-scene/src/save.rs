//! Writes scenes as glTF 2.0 binary files.

use glam::{DMat3, DQuat, DVec3};
use serde_json::{Value, json};

use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, LightDesc, MaterialDesc, Projection, Surface};
use crate::error::SceneError;
use crate::extras::{CameraExtras, LightExtras, MaterialExtras, NodeExtras};

/// Writes the scene as a glTF 2.0 binary file (`.glb`), which [`crate::load_gltf`] reads back as the same scene: its
/// picture is the same, bit for bit.
///
/// Meshes, cameras, point, spot and directional lights become their glTF equivalents, materials the nearest match:
///
/// | here | glTF |
/// |---|---|
/// | diffuse | roughness 1, no metal, `KHR_materials_specular` of 0 |
/// | mirror | metal of roughness 0 |
/// | solid dielectric | `KHR_materials_transmission`, `KHR_materials_ior`, `KHR_materials_volume` with its absorption |
/// | thin sheet | the same without a volume |
/// | emission | `emissiveFactor` × `KHR_materials_emissive_strength` |
///
/// glTF has single precision. `extras.photonmap` of materials, of nodes with lights or cameras and of primitives store
/// the same numbers in double precision, as decimal strings, or as the index of a buffer view with 64-bit floats; also
/// the priority of a solid, and whether a non-emissive surface would emit from both sides. The loader uses them as long
/// as they agree with the standard glTF content.
///
/// # Errors
/// The errors of [`SceneBuilder::build`]; [`SceneError::Export`] for textures, vertex attributes and an environment,
/// which are not written; [`SceneError::Extreme`] for numbers beyond single precision or a file
/// beyond 4 GiB.
pub fn glb(scene: &SceneBuilder) -> Result<Vec<u8>, SceneError> {
    scene.clone().build()?;
    refuse_textures(scene)?;
    refuse_environment(scene)?;
    let mut file = File::default();
    let materials: Vec<Value> = scene.materials.iter().map(material).collect::<Result<_, _>>()?;
    for mesh in &scene.meshes {
        // glTF does not allow meshes without triangles.
        if !mesh.triangles.is_empty() {
            file.mesh(&mesh.name, &mesh.positions, &mesh.triangles, mesh.material.0)?;
        }
    }
    let lights: Vec<Value> =
        scene.lights.iter().map(|(name, desc)| file.light(name, desc)).collect::<Result<_, _>>()?;
    let cameras: Vec<Value> =
        scene.cameras.iter().map(|(name, desc)| file.camera(name, desc)).collect::<Result<_, _>>()?;
    file.finish(materials, lights, cameras)
}

/// Textures and vertex attributes are not written yet; they must not be lost silently.
fn refuse_textures(scene: &SceneBuilder) -> Result<(), SceneError> {
    let what = match scene.meshes.iter().find(|mesh| !mesh.attributes.is_empty()) {
        _ if !scene.textures.is_empty() => format!("{} textures", scene.textures.len()),
        Some(mesh) => format!("the vertex attributes of mesh '{}'", mesh.name),
        None => return Ok(()),
    };
    Err(SceneError::Export { what, hint: "remove them from the scene first" })
}

/// glTF has no environment in its core or in a ratified extension.
fn refuse_environment(scene: &SceneBuilder) -> Result<(), SceneError> {
    if scene.environment.is_none() && scene.sun.is_none() {
        return Ok(());
    }
    let what = scene.environment_text.as_ref().map_or_else(String::new, |text| format!(" ({text})"));
    Err(SceneError::Export {
        what: format!("the environment{what}"),
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

    fn mesh(
        &mut self,
        name: &str,
        positions: &[[f64; 3]],
        triangles: &[[u32; 3]],
        material: u32,
    ) -> Result<(), SceneError> {
        let what = || format!("mesh '{name}'");
        let rounded: Vec<[f32; 3]> = positions.iter().map(|at| singles(*at, what)).collect::<Result<_, _>>()?;
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for at in &rounded {
            for axis in 0..3 {
                low[axis] = low[axis].min(at[axis]);
                high[axis] = high[axis].max(at[axis]);
            }
        }
        let view = self.view(rounded.iter().flatten().flat_map(|c| c.to_le_bytes()));
        let floats = 5126;
        self.accessors.push(json!({
            "bufferView": view, "componentType": floats, "type": "VEC3", "count": positions.len(), "min": low, "max": high
        }));
        let view = self.view(triangles.iter().flatten().flat_map(|index| index.to_le_bytes()));
        let unsigned = 5125;
        self.accessors.push(json!({
            "bufferView": view, "componentType": unsigned, "type": "SCALAR", "count": 3 * triangles.len()
        }));
        let mut primitive = json!({
            "attributes": { "POSITION": self.accessors.len() - 2 },
            "indices": self.accessors.len() - 1,
            "material": material,
        });
        let is_exact = |(exact, rounded): (&[f64; 3], &[f32; 3])| {
            rounded.map(|c| f64::from(c).to_bits()) == exact.map(f64::to_bits)
        };
        if !positions.iter().zip(&rounded).all(is_exact) {
            let view = self.view(positions.iter().flatten().flat_map(|c| c.to_le_bytes()));
            primitive["extras"] = json!({ "photonmap": { "positions": view } });
        }
        self.nodes.push(json!({ "name": name, "mesh": self.meshes.len() }));
        self.meshes.push(json!({ "name": name, "primitives": [primitive] }));
        Ok(())
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
            "KHR_materials_emissive_strength",
            "KHR_materials_ior",
            "KHR_materials_specular",
            "KHR_materials_transmission",
            "KHR_materials_volume",
        ] {
            let materials = root["materials"].as_array();
            if materials.into_iter().flatten().any(|material| !material["extensions"][extension].is_null()) {
                used.push(extension);
            }
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

/// Assembles header and chunks (glTF 2.0 specification, section 4.4).
fn pack(json: &[u8], bin: &[u8]) -> Result<Vec<u8>, SceneError> {
    let length = 12 + 8 + json.len() + if bin.is_empty() { 0 } else { 8 + bin.len() };
    let Ok(total) = u32::try_from(length) else {
        return Err(SceneError::Extreme {
            what: "the size of the file".to_owned(),
            value: format!("{length} bytes"),
            hint: "a .glb holds at most 4 GiB; split the scene",
        });
    };
    let mut file = Vec::with_capacity(length);
    file.extend(b"glTF");
    file.extend(2_u32.to_le_bytes());
    file.extend(total.to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", bin)].into_iter().filter(|(_, chunk)| !chunk.is_empty()) {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    Ok(file)
}

fn material(desc: &MaterialDesc) -> Result<Value, SceneError> {
    let what = || format!("material '{}'", desc.name);
    let (base, metallic, roughness) = match desc.surface {
        Surface::Lambert { albedo } => (albedo, 0.0, 1.0),
        Surface::Mirror { reflectance } => (reflectance, 1.0, 0.0),
        Surface::Dielectric { tint, .. } | Surface::Thin { tint, .. } => (tint, 0.0, 0.0),
    };
    let [r, g, b] = singles(base, what)?;
    let mut extensions = json!({});
    match desc.surface {
        Surface::Lambert { .. } => extensions["KHR_materials_specular"] = json!({ "specularFactor": 0.0 }),
        Surface::Mirror { .. } => {}
        Surface::Dielectric { ior, .. } | Surface::Thin { ior, .. } => {
            extensions["KHR_materials_transmission"] = json!({ "transmissionFactor": 1.0 });
            extensions["KHR_materials_ior"] = json!({ "ior": single(ior, what)? });
        }
    }
    if let Surface::Dielectric { absorption, .. } = desc.surface {
        let mut volume = json!({ "thicknessFactor": 1.0 });
        // Distance at which the strongest channel falls to 1/e; an absorption that underflows f32 is invisible.
        let (greatest, relative) = scaled(absorption);
        let distance = 1.0 / greatest;
        if greatest > 0.0 && (distance as f32).is_finite() {
            volume["attenuationDistance"] = json!(single(distance, what)?);
            volume["attenuationColor"] = json!(relative.map(|share| (-share).exp() as f32));
        }
        extensions["KHR_materials_volume"] = volume;
    }
    let (strength, factor) = scaled(desc.emission);
    if strength > 0.0 {
        extensions["KHR_materials_emissive_strength"] = json!({ "emissiveStrength": single(strength, what)? });
    }
    // Other programs cull the back of surfaces that are not double-sided; here every surface has two sides.
    let both =
        if desc.is_emissive() { desc.emits_both_sides } else { !matches!(desc.surface, Surface::Dielectric { .. }) };
    let mut material = json!({
        "name": desc.name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [r, g, b, 1.0], "metallicFactor": metallic, "roughnessFactor": roughness
        },
        "doubleSided": both,
        "extras": { "photonmap": MaterialExtras::new(desc) },
    });
    if strength > 0.0 {
        material["emissiveFactor"] = json!(singles(factor, what)?);
    }
    if extensions.as_object().is_some_and(|all| !all.is_empty()) {
        material["extensions"] = extensions;
    }
    Ok(material)
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
