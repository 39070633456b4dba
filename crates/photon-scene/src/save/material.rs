//! Materials as glTF.

use serde_json::{Value, json};

use super::{scaled, single, singles};
use crate::describe::{AlphaMode, MaterialDesc, Surface};
use crate::error::SceneError;
use crate::extras::MaterialExtras;

/// The material; `textures` are those that it uses, with their slots.
pub(super) fn material(desc: &MaterialDesc, textures: &[(&'static str, Value)]) -> Result<Value, SceneError> {
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
            if desc.specular_color != [1.0; 3] {
                extensions["KHR_materials_specular"]["specularColorFactor"] =
                    json!(singles(desc.specular_color, what)?);
            }
            if ior != 1.5 {
                extensions["KHR_materials_ior"] = json!({ "ior": single(ior, what)? });
            }
            if desc.transmission > 0.0 {
                let factor = single(desc.transmission, what)?;
                extensions["KHR_materials_transmission"] = json!({ "transmissionFactor": factor });
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
    if desc.clearcoat > 0.0 {
        extensions["KHR_materials_clearcoat"] = json!({
            "clearcoatFactor": single(desc.clearcoat, what)?,
            "clearcoatRoughnessFactor": single(desc.clearcoat_roughness, what)?,
        });
    }
    if desc.anisotropy > 0.0 {
        extensions["KHR_materials_anisotropy"] = json!({
            "anisotropyStrength": single(desc.anisotropy, what)?,
            "anisotropyRotation": single(desc.anisotropy_rotation, what)?,
        });
    }
    if desc.sheen_color != [0.0; 3] {
        extensions["KHR_materials_sheen"] = json!({
            "sheenColorFactor": singles(desc.sheen_color, what)?,
            "sheenRoughnessFactor": single(desc.sheen_roughness, what)?,
        });
    }
    if desc.diffuse_transmission > 0.0 {
        extensions["KHR_materials_diffuse_transmission"] = json!({
            "diffuseTransmissionFactor": single(desc.diffuse_transmission, what)?,
            "diffuseTransmissionColorFactor": singles(desc.diffuse_transmission_color, what)?,
        });
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
    for (slot, info) in textures {
        match *slot {
            "base_color" => material["pbrMetallicRoughness"]["baseColorTexture"] = info.clone(),
            "emission" => material["emissiveTexture"] = info.clone(),
            "metallic_roughness" => {
                material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = info.clone();
            }
            "clearcoat" => extensions["KHR_materials_clearcoat"]["clearcoatTexture"] = info.clone(),
            "clearcoat_roughness" => {
                extensions["KHR_materials_clearcoat"]["clearcoatRoughnessTexture"] = info.clone();
            }
            "clearcoat_normal" => {
                extensions["KHR_materials_clearcoat"]["clearcoatNormalTexture"] = info.clone();
            }
            "anisotropy" => extensions["KHR_materials_anisotropy"]["anisotropyTexture"] = info.clone(),
            "diffuse_transmission" => {
                extensions["KHR_materials_diffuse_transmission"]["diffuseTransmissionTexture"] = info.clone();
            }
            "diffuse_transmission_color" => {
                extensions["KHR_materials_diffuse_transmission"]["diffuseTransmissionColorTexture"] = info.clone();
            }
            "transmission" => extensions["KHR_materials_transmission"]["transmissionTexture"] = info.clone(),
            "sheen_color" => extensions["KHR_materials_sheen"]["sheenColorTexture"] = info.clone(),
            "sheen_roughness" => extensions["KHR_materials_sheen"]["sheenRoughnessTexture"] = info.clone(),
            "specular_color" => {
                extensions["KHR_materials_specular"]["specularColorTexture"] = info.clone();
            }
            "specular" => extensions["KHR_materials_specular"]["specularTexture"] = info.clone(),
            _ => material["normalTexture"] = info.clone(),
        }
    }
    match desc.alpha_mode {
        AlphaMode::Opaque => {}
        AlphaMode::Mask { cutoff } => {
            material["alphaMode"] = json!("MASK");
            material["alphaCutoff"] = json!(single(cutoff, what)?);
        }
        AlphaMode::Blend => material["alphaMode"] = json!("BLEND"),
    }
    if extensions.as_object().is_some_and(|all| !all.is_empty()) {
        material["extensions"] = extensions;
    }
    Ok(material)
}
