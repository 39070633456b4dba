//! Materials as glTF.

use serde_json::{Map, Value as Json, json};

use super::{scaled, single, singles};
use crate::describe::{AlphaMode, MaterialDesc, Surface};
use crate::error::SceneError;
use crate::extras::MaterialExtras;
use crate::parameter::{self, TextureParameter, Value};

/// The material; `textures` are those that it uses.
pub(super) fn material(desc: &MaterialDesc, textures: &[(&TextureParameter, Json)]) -> Result<Json, SceneError> {
    let what = || format!("material '{}'", desc.name);
    let (base, metallic, roughness) = match desc.surface {
        Surface::Lambert { albedo } => (albedo, 0.0, 1.0),
        Surface::Mirror { reflectance } => (reflectance, 1.0, 0.0),
        Surface::Boundary { .. } => ([1.0; 3], 0.0, 0.0),
        Surface::Dielectric { tint, roughness, .. } | Surface::Thin { tint, roughness, .. } => (tint, 0.0, roughness),
        Surface::Glossy { base_color, metallic, roughness, .. } => (base_color, metallic, roughness),
    };
    let [r, g, b] = singles(base, what)?;
    let alpha = if desc.alpha_mode == AlphaMode::Opaque { 1.0 } else { single(desc.alpha, what)? };
    let mut extensions = json!({});
    match desc.surface {
        Surface::Lambert { .. } => extensions["KHR_materials_specular"] = json!({ "specularFactor": 0.0 }),
        Surface::Mirror { .. } => {}
        Surface::Glossy { specular, ior, .. } => {
            if specular != 1.0 {
                extensions["KHR_materials_specular"]["specularFactor"] = json!(single(specular, what)?);
            }
            if ior != 1.5 {
                extensions["KHR_materials_ior"] = json!({ "ior": single(ior, what)? });
            }
        }
        // glTF has no boundaries: glass of the index of the air.
        Surface::Boundary { .. } => {
            extensions["KHR_materials_transmission"] = json!({ "transmissionFactor": 1.0 });
            extensions["KHR_materials_ior"] = json!({ "ior": 1.0 });
        }
        Surface::Dielectric { ior, .. } | Surface::Thin { ior, .. } => {
            extensions["KHR_materials_transmission"] = json!({ "transmissionFactor": 1.0 });
            extensions["KHR_materials_ior"] = json!({ "ior": single(ior, what)? });
        }
    }
    let inside = match desc.surface {
        Surface::Dielectric { absorption, .. } | Surface::Boundary { absorption } => Some(absorption),
        _ => desc.transmission_absorption.filter(|_| desc.transmission > 0.0),
    };
    if let Some(absorption) = inside {
        let mut volume = json!({ "thicknessFactor": 1.0 });
        // Distance at which the strongest channel falls to 1/e; an absorption that underflows f32 is invisible.
        let (greatest, relative) = scaled(absorption);
        let distance = 1.0 / greatest;
        if greatest > 0.0 && (distance as f32).is_finite() {
            volume["attenuationDistance"] = json!(single(distance, what)?);
            volume["attenuationColor"] = json!(relative.map(|share| (-share).exp() as f32));
        }
        extensions["KHR_materials_volume"] = volume;
        let strength = desc.dispersion.zip(desc.ior()).map_or(0.0, |(dispersion, ior)| dispersion.strength(ior));
        if strength > 0.0 {
            extensions["KHR_materials_dispersion"] = json!({ "dispersion": single(strength, what)? });
        }
    }
    for (parameter, value) in parameter::values(desc).filter(|(parameter, _)| parameter.is_present(desc)) {
        let Some((extension, factor)) = parameter.layer.and_then(|layer| layer.gltf) else { continue };
        extensions[extension][factor] = match value {
            Value::Number(value) => json!(single(value, what)?),
            Value::Color(value) => json!(singles(value, what)?),
        };
    }
    let (strength, factor) = scaled(desc.emission);
    if strength > 0.0 {
        extensions["KHR_materials_emissive_strength"] = json!({ "emissiveStrength": single(strength, what)? });
    }
    // Other programs cull the back of surfaces that are not double-sided; here every surface has two sides.
    let both = if desc.is_emissive() { desc.emits_both_sides } else { !(desc.is_solid() || desc.is_boundary()) };
    let mut material = json!({
        "name": desc.name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [r, g, b, alpha],
            "metallicFactor": metallic as f32,
            "roughnessFactor": roughness as f32
        },
        "doubleSided": both,
        "extras": { "photonmap": MaterialExtras::new(desc) },
    });
    if strength > 0.0 {
        material["emissiveFactor"] = json!(singles(factor, what)?);
    }
    material["extensions"] = extensions;
    for (texture, info) in textures {
        let place = texture.gltf.iter().fold(&mut material, |object, name| &mut object[*name]);
        *place = info.clone();
    }
    match desc.alpha_mode {
        AlphaMode::Opaque => {}
        AlphaMode::Mask { cutoff } => {
            material["alphaMode"] = json!("MASK");
            material["alphaCutoff"] = json!(single(cutoff, what)?);
        }
        AlphaMode::Blend => material["alphaMode"] = json!("BLEND"),
    }
    if let Some(all) = material.as_object_mut()
        && all["extensions"].as_object().is_some_and(Map::is_empty)
    {
        all.remove("extensions");
    }
    Ok(material)
}
