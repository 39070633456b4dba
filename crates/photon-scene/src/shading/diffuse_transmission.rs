//! Diffuse transmission in its simplest form.

use photon_core::DiffuseTransmission;

use crate::describe::{MaterialDesc, Surface};
use crate::texture::TextureRef;

/// Multiplies share and colour by textures of one colour. Only surfaces with a diffuse base transmit.
pub(super) fn fold_diffuse_transmission(
    material: &mut MaterialDesc,
    color_of: impl Fn(TextureRef) -> Option<[f64; 3]>,
    alpha_of: impl Fn(TextureRef) -> Option<f64>,
) {
    let textures = &mut material.textures;
    let has_base = match material.surface {
        Surface::Lambert { .. } => true,
        Surface::Glossy { metallic, .. } => metallic < 1.0 || textures.metallic_roughness.is_some(),
        Surface::Mirror { .. } | Surface::Dielectric { .. } | Surface::Boundary { .. } | Surface::Thin { .. } => false,
    };
    if !has_base {
        material.diffuse_transmission = 0.0;
    }
    if let Some(alpha) = textures.diffuse_transmission.and_then(alpha_of) {
        material.diffuse_transmission *= alpha;
        textures.diffuse_transmission = None;
    }
    let color = &mut material.diffuse_transmission_color;
    if *color == [0.0; 3] {
        textures.diffuse_transmission_color = None;
    } else if let Some(uniform) = textures.diffuse_transmission_color.and_then(color_of) {
        *color = std::array::from_fn(|channel| color[channel] * uniform[channel]);
        textures.diffuse_transmission_color = None;
    }
    if material.diffuse_transmission == 0.0 {
        *color = [1.0; 3];
        (textures.diffuse_transmission, textures.diffuse_transmission_color) = (None, None);
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
