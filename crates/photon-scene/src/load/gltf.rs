//! glTF 2.0: `.gltf` with external or embedded buffers, and `.glb`.
//!
//! | glTF | here |
//! |---|---|
//! | node | its matrix or translation, rotation and scale, in f64; a mirrored mesh keeps its front side |
//! | primitive | one mesh for each node that refers to it; triangle lists, strips and fans |
//! | base colour | base colour of a glossy surface, or tint of transmitted light |
//! | metallic, roughness, `specular`, `ior` | glossy surface; rendered as a mirror if it is all metal and smooth, diffuse without specular reflection |
//! | `pbrSpecularGlossiness` | glossy: a metal of its specular colour, or a coat over its diffuse colour |
//! | skins, morph targets | in the default pose: joints as their nodes are, default weights of the targets |
//! | `transmission` | share of glass, by texel: a thin sheet, or a solid dielectric where `volume` gives a thickness; rough by the roughness |
//! | `ior` | refractive index; default 1.5 |
//! | `volume` | absorption `−ln(colour) / distance`, per length of the scene |
//! | `emissiveFactor` × `emissive_strength` | radiance, W/(m²·sr); from both sides if `doubleSided` |
//! | `lights_punctual` | candela are W/sr, lux are W/m²: no factor of 683, unless by [`crate::LightUnits`] |
//! | textures of base colour, metal and roughness, the specular factor and colour, emission and normals | with their UV sets, transforms, wrap modes and magnification filters |
//! | other textures | their mean |
//! | normals, tangents, colours, UV sets | those in use; normals by the inverse transpose of the node's matrix |
//! | `alphaMode`, `alphaCutoff`, alpha of base colour, its texture and `COLOR_0` | alpha coverage; solids are opaque |
//! | `KHR_meshopt_compression`, `EXT_` | decoded; Draco is refused |
//! | zeros after the JSON; backslashes in URIs; wrapped or URL-safe base64; last rows of matrices within 10⁻⁴ of 0 0 0 1 | as they are meant |
//! | `extras.photonmap` | the same in double precision, as [`crate::glb`] writes it |
//!
//! Everything that is left out is a line of the report. The document is read without the parser's own
//! validation, which rejects extensions that are supported here; instead, every index is checked
//! where it is used, and an error names the object with an invalid reference.

mod accessor;
mod attributes;
mod buffers;
mod container;
mod extensions;
mod factors;
mod fault;
mod material;
mod mean;
mod meshes;
mod meshopt;
mod morph;
mod nodes;
mod parameters;
mod primitive;
mod punctual;
mod reserve;
mod scatter;
mod skin;
mod slot;
mod specular_glossiness;
mod survey;
mod texture;
mod uri;

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::Path;

use gltf::json::Root;

use self::accessor::Accessors;
use self::buffers::Buffers;
use self::fault::{Fault, label};
use self::meshes::Meshes;
use self::texture::Textures;
pub(in crate::load) use self::uri::leaves_folder;
use super::budget::Budget;
use super::light_units::LIGHTS;
use super::read_within;
use super::text::content;
use crate::builder::SceneBuilder;
use crate::error::SceneError;
use crate::extras::{self, NodeExtras};
use crate::report::LoadReport;

/// Reads a glTF 2.0 file, `.gltf` or `.glb`; its first bytes determine which.
///
/// # Errors
///
/// [`SceneError::Read`] if the file cannot be read; [`SceneError::Content`] if it or a buffer that it
/// refers to is missing, truncated or inconsistent, or requires an extension that is not supported.
/// Numbers out of range (an albedo of 2) are reported by [`SceneBuilder::build`].
pub fn load_gltf(path: &Path) -> Result<(SceneBuilder, LoadReport), SceneError> {
    load_within(path, &Budget::unlimited())
}

/// As [`load_gltf`], within a limit on memory.
pub(in crate::load) fn load_within(path: &Path, budget: &Budget) -> Result<(SceneBuilder, LoadReport), SceneError> {
    let bytes = read_within(path, budget, 1)?;
    content(path, &bytes, &["gltf", "glb"])?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let (builder, mut report) = assemble_within(&bytes, folder, budget).map_err(|fault| fault.in_file(path))?;
    let has_extension = |name| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(name));
    match bytes.starts_with(container::MAGIC) {
        true if has_extension("gltf") => {
            report.note("the file", "is a GLB in spite of its extension, and read as that")
        }
        false if has_extension("glb") => {
            report.note("the file", "is a glTF file of JSON in spite of its extension, and read as that");
        }
        _ => {}
    }
    Ok((builder, report))
}

#[cfg(test)]
fn assemble(bytes: &[u8], folder: &Path) -> Result<(SceneBuilder, LoadReport), Fault> {
    assemble_within(bytes, folder, &Budget::unlimited())
}

/// Builds the scene from the bytes of a file; relative URIs are resolved in `folder`.
fn assemble_within(bytes: &[u8], folder: &Path, budget: &Budget) -> Result<(SceneBuilder, LoadReport), Fault> {
    let mut report = LoadReport::default();
    let mut builder = SceneBuilder::new();
    // The document as it is parsed, with its data URIs.
    budget.take(reserve::json(container::json_of(bytes)), || "its JSON".to_owned())?;
    let (root, bin) = container::open(bytes, &mut report)?;
    extensions::check(&root, &mut report)?;
    let buffers = Buffers::new(&root, folder, bin, budget);

    buffers.report_backslashes(&mut report);
    let mut textures = Textures::new(&root, &buffers);
    survey::plan(&mut textures)?;
    let mut materials = Vec::with_capacity(root.materials.len());
    for index in 0..root.materials.len() {
        let desc = material::describe(&root, index, &textures, &mut builder, &mut report)?;
        materials.push(builder.material(desc));
    }

    textures.report(&builder, &mut report);
    let mut meshes = Meshes {
        root: &root,
        accessors: Accessors::new(&root, &buffers),
        budget,
        materials,
        default_material: None,
        elements: 0,
        most_elements: meshes::most_elements(buffers.file_bytes(bytes.len() as u64)),
        globals: OnceCell::new(),
        skins: BTreeMap::new(),
    };
    let mut camera_names = Vec::new();
    let placed = nodes::place(&root)?;
    nodes::report_absent(&root, &placed, &mut report);
    for placed in placed {
        let node = &root.nodes[placed.node];
        let part = nodes::node_label(&root, placed.node);
        if nodes::is_nearly_affine(node) {
            report.note(&part, "has a matrix whose last row is nearly 0 0 0 1, and taken to be");
        }
        if let Some(mesh) = node.mesh {
            meshes.add(placed.node, mesh.value(), &placed.transform, &mut builder, &mut report)?;
        }
        let exact = extras::read::<NodeExtras>(node.extras.as_deref().map(|raw| raw.get()));
        let exact = exact.unwrap_or_else(|why| {
            report.note(&part, why);
            None
        });
        let NodeExtras { light: exact_light, camera: exact_camera } = exact.unwrap_or_default();
        if let Some(camera) = node.camera {
            let (camera, names) = ((camera.value(), exact_camera), &mut camera_names);
            punctual::add_camera(&root, &part, camera, &placed.transform, names, &mut builder, &mut report)?;
        }
        let lights = node.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref());
        if let Some(light) = lights.map(|holder| holder.light.value()) {
            let light = (light, exact_light);
            punctual::add_light(&root, &part, light, &placed.transform, &mut builder, &mut report)?;
        }
    }
    // "Khronos glTF Blender I/O v4.2.57"; its lighting mode is not in the file.
    if !builder.lights.is_empty() && root.asset.generator.as_deref().is_some_and(|by| by.contains("Blender")) {
        report.note(
            LIGHTS,
            "are read as W/sr and W/m²; Blender writes cd and lux, which are 683 times as much, unless its Lighting Mode \
             is Unitless: give light units, standard or unitless",
        );
    }
    report_rest(&root, &mut report);
    Ok((builder, report))
}

/// Reports what concerns the file as a whole.
fn report_rest(root: &Root, report: &mut LoadReport) {
    if root.scenes.len() > 1 {
        let index = root.scene.map_or(0, |scene| scene.value());
        let name = root.scenes.get(index).and_then(|scene| scene.name.as_deref());
        let text = format!("has {} scenes; {} is rendered", root.scenes.len(), label("scene", index, name));
        report.note("the file", text);
    }
    match root.animations.len() {
        0 => {}
        1 => report.note("the file", "has an animation; the default pose is rendered"),
        count => report.note("the file", format!("has {count} animations; the default pose is rendered")),
    }
}

#[cfg(test)]
mod tests;
