//! Clearcoats in their simplest form.

use photon_core::ClearcoatNormal;

use crate::describe::{MaterialDesc, Surface};
use crate::texture::TextureRef;

use super::fold::is_flat;

/// Multiplies the factors of a clearcoat by textures of one colour. Glass has no clearcoat.
pub(super) fn fold_clearcoat(material: &mut MaterialDesc, color_of: impl Fn(TextureRef) -> Option<[f64; 3]>) {
    let textures = &mut material.textures;
    if matches!(material.surface, Surface::Dielectric { .. } | Surface::Boundary { .. } | Surface::Thin { .. }) {
        material.clearcoat = 0.0;
    }
    if let Some([red, ..]) = textures.clearcoat.and_then(&color_of) {
        material.clearcoat *= red;
        textures.clearcoat = None;
    }
    if let Some([_, green, _]) = textures.clearcoat_roughness.and_then(&color_of) {
        material.clearcoat_roughness *= green;
        textures.clearcoat_roughness = None;
    }
    if material.clearcoat == 0.0 {
        material.clearcoat_roughness = 0.0;
        (textures.clearcoat, textures.clearcoat_roughness, textures.clearcoat_normal) = (None, None, None);
    }
    if material.clearcoat_roughness == 0.0 {
        textures.clearcoat_roughness = None;
    }
    let is_even = |used: TextureRef| color_of(used).is_some_and(is_flat);
    if textures.clearcoat_normal_scale == 0.0 || textures.clearcoat_normal.is_some_and(is_even) {
        textures.clearcoat_normal = None;
    }
    if textures.clearcoat_normal.is_none() {
        textures.clearcoat_normal_scale = 1.0;
    }
}

/// The record of a material, whose texture is given by its use. Only beside a normal map the normals of the clearcoat may
/// differ from those below it.
pub(super) fn record(material: &MaterialDesc, texture: u32) -> ClearcoatNormal {
    let textures = &material.textures;
    let differs = textures.normal.is_some() || textures.clearcoat_normal.is_some();
    if material.clearcoat == 0.0 || !differs {
        return ClearcoatNormal::NONE;
    }
    ClearcoatNormal { is_own: 1, texture, scale: textures.clearcoat_normal_scale as f32, reserved: 0 }
}
