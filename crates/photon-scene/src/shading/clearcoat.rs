//! Clearcoats in their simplest form.

use crate::describe::{MaterialDesc, Surface};
use crate::texture::TextureRef;

/// Multiplies the factors of a clearcoat by textures of one colour. Glass has no clearcoat.
pub(super) fn fold_clearcoat(material: &mut MaterialDesc, color_of: impl Fn(TextureRef) -> Option<[f64; 3]>) {
    let textures = &mut material.textures;
    if matches!(material.surface, Surface::Dielectric { .. } | Surface::Thin { .. }) {
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
        (textures.clearcoat, textures.clearcoat_roughness) = (None, None);
    }
    if material.clearcoat_roughness == 0.0 {
        textures.clearcoat_roughness = None;
    }
}
