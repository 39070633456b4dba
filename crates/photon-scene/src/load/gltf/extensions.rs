//! Which glTF extensions are supported, and which are rejected if required.

use std::collections::BTreeSet;

use gltf::json::{Root, Value};

use super::fault::Fault;
use crate::report::LoadReport;

/// Extensions that are supported, or whose loss is reported for each material.
const KNOWN: &[&str] = &[
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_meshopt_compression",
    "EXT_meshopt_compression",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
    // Images that cannot be decoded are reported where they are used.
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "EXT_texture_avif",
    "MSFT_texture_dds",
];

/// Extensions that only carry metadata.
const HARMLESS: &[&str] = &["KHR_xmp", "KHR_xmp_json_ld"];

/// What the user can do about an unsupported extension that the data depend on.
fn hint(extension: &str) -> &'static str {
    match extension {
        "KHR_draco_mesh_compression" => "export the file without Draco mesh compression",
        "EXT_mesh_gpu_instancing" => "make the instances real before the export",
        "EXT_lights_image_based" => "give its image as the environment, with --environment or in an override file",
        _ => "export the file without it",
    }
}

/// Rejects a file that requires an unsupported extension, and reports the other ones.
///
/// Material extensions are never rejected: they change how a surface looks, which the report
/// says, and a picture without them still shows the scene.
pub(super) fn check(root: &Root, report: &mut LoadReport) -> Result<(), Fault> {
    for name in root.extensions_required.iter().map(String::as_str) {
        if !is_read(name) {
            let why = format!("requires the extension {name}, which is not supported");
            return Err(Fault::new("extensionsRequired", why, hint(name)));
        }
    }
    for name in root.extensions_used.iter().map(String::as_str) {
        if name == "KHR_materials_variants" {
            report.note("the file", "has material variants; the default ones are rendered");
        } else if !is_read(name) {
            report.left_out("the file", format!("the extension {name} is not supported; {}", hint(name)));
        }
    }
    Ok(())
}

/// Reports extensions that objects have, but the file does not declare, and that are not read.
pub(super) fn report_undeclared(document: &Value, report: &mut LoadReport) {
    let declared = |name: &str| {
        let all = document.get("extensionsUsed").and_then(Value::as_array);
        all.is_some_and(|all| all.iter().any(|known| known.as_str() == Some(name)))
    };
    let mut found = BTreeSet::new();
    let mut pending = vec![document];
    while let Some(value) = pending.pop() {
        match value {
            Value::Array(items) => pending.extend(items),
            Value::Object(fields) => {
                let extensions = fields.get("extensions").and_then(Value::as_object);
                found.extend(extensions.into_iter().flat_map(|all| all.keys()).filter(|name| !declared(name)));
                pending.extend(fields.iter().filter(|(name, _)| *name != "extras").map(|(_, field)| field));
            }
            _ => {}
        }
    }
    for name in found.into_iter().filter(|name| !is_read(name)) {
        report.left_out("the file", format!("the extension {name} is not supported; {}", hint(name)));
    }
}

/// Whether the extension is supported, only carries metadata, or is reported for each material.
fn is_read(name: &str) -> bool {
    KNOWN.contains(&name) || HARMLESS.contains(&name) || name.contains("_materials_")
}
