//! Sheen in its simplest form.

use photon_core::SheenLayer;

use crate::describe::{MaterialDesc, Surface};
use crate::texture::TextureRef;

/// Multiplies colour and roughness by textures of one colour. Glass has no sheen.
pub(super) fn fold_sheen(
    material: &mut MaterialDesc,
    color_of: impl Fn(TextureRef) -> Option<[f64; 3]>,
    alpha_of: impl Fn(TextureRef) -> Option<f64>,
) {
    let textures = &mut material.textures;
    let color = &mut material.sheen_color;
    if matches!(material.surface, Surface::Dielectric { .. } | Surface::Boundary { .. } | Surface::Thin { .. }) {
        *color = [0.0; 3];
    }
    if let Some(uniform) = textures.sheen_color.and_then(color_of) {
        *color = std::array::from_fn(|channel| color[channel] * uniform[channel]);
        textures.sheen_color = None;
    }
    if let Some(alpha) = textures.sheen_roughness.and_then(alpha_of) {
        material.sheen_roughness *= alpha;
        textures.sheen_roughness = None;
    }
    if *color == [0.0; 3] {
        material.sheen_roughness = 0.0;
        (textures.sheen_color, textures.sheen_roughness) = (None, None);
    }
    if material.sheen_roughness == 0.0 {
        textures.sheen_roughness = None;
    }
}

/// The record of a material; its textures are given by their uses.
pub(super) fn record(material: &MaterialDesc, color_texture: u32, roughness_texture: u32) -> SheenLayer {
    SheenLayer {
        color: material.sheen_color.map(|part| part as f32),
        roughness: material.sheen_roughness as f32,
        color_texture,
        roughness_texture,
        ..SheenLayer::NONE
    }
}
