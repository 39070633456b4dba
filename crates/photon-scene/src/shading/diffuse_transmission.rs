//! Diffuse transmission in its simplest form.

use photon_core::DiffuseTransmission;

use crate::describe::{MaterialDesc, Surface};

/// Removes diffuse transmission from surfaces without a diffuse base.
pub(super) fn remove_without_base(material: &mut MaterialDesc) {
    let has_base = match material.surface {
        Surface::Lambert { .. } => true,
        Surface::Glossy { metallic, .. } => metallic < 1.0 || material.textures.metallic_roughness.is_some(),
        Surface::Mirror { .. } | Surface::Dielectric { .. } | Surface::Boundary { .. } | Surface::Thin { .. } => false,
    };
    if !has_base {
        material.diffuse_transmission = 0.0;
    }
}

/// The record of a material; its textures are given by their uses.
pub(super) fn record(material: &MaterialDesc, color_texture: u32, factor_texture: u32) -> DiffuseTransmission {
    DiffuseTransmission {
        color: material.diffuse_transmission_color.map(|part| part as f32),
        factor: material.diffuse_transmission as f32,
        color_texture,
        factor_texture,
        ..DiffuseTransmission::NONE
    }
}
