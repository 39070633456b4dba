//! Partial transmission in its simplest form.

use photon_core::PartialTransmission;

use crate::describe::{MaterialDesc, Surface};
use crate::texture::TextureRef;

/// Multiplies the share by a texture of one colour. Surfaces that are glass everywhere, and those that are glass nowhere,
/// become what they are. Factor and texture of metal have been folded.
pub(super) fn fold_transmission(material: &mut MaterialDesc, color_of: impl Fn(TextureRef) -> Option<[f64; 3]>) {
    let textures = &mut material.textures;
    if let Some([red, ..]) = textures.transmission.and_then(color_of) {
        material.transmission *= red;
        textures.transmission = None;
    }
    let Surface::Glossy { metallic, .. } = material.surface else {
        return remove(material);
    };
    let is_metal = metallic >= 1.0 && textures.metallic_roughness.is_none();
    // What is 0 in single precision is none.
    if material.transmission as f32 == 0.0 || is_metal {
        return remove(material);
    }
    if material.transmission >= 1.0 && metallic == 0.0 && textures.transmission.is_none() {
        if let Some(glass) = material.transmitting_surface() {
            material.surface = glass;
        }
        remove(material);
    }
}

fn remove(material: &mut MaterialDesc) {
    (material.transmission, material.transmission_absorption) = (0.0, None);
    material.textures.transmission = None;
}

/// The record of a material; `factor_texture` is the use of its texture, and `glass` the index of its glass.
pub(super) fn record(material: &MaterialDesc, factor_texture: u32, glass: u32) -> PartialTransmission {
    if material.transmission == 0.0 {
        return PartialTransmission::NONE;
    }
    PartialTransmission { factor: material.transmission as f32, factor_texture, glass, ..PartialTransmission::NONE }
}
