//! Clearcoats in their simplest form.

use photon_core::ClearcoatNormal;

use crate::describe::MaterialDesc;
use crate::texture::TextureRef;

use super::fold::is_flat;

/// Removes the normal map of a clearcoat that does not turn the normal.
pub(super) fn fold_clearcoat_normal(material: &mut MaterialDesc, color_of: impl Fn(TextureRef) -> Option<[f64; 3]>) {
    let textures = &mut material.textures;
    if material.clearcoat == 0.0 {
        textures.clearcoat_normal = None;
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
