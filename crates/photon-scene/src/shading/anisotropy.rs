//! Anisotropy in its simplest form.

use photon_core::{Anisotropy, MaterialTextures, ggx};

use crate::describe::{MaterialDesc, Surface};
use crate::texture::TextureRef;

/// Multiplies strength and direction by a texture of one colour. Only glossy surfaces have an anisotropy, and none that is
/// narrower than what is rendered.
pub(super) fn fold_anisotropy(material: &mut MaterialDesc, color_of: impl Fn(TextureRef) -> Option<[f64; 3]>) {
    if let Some([x, y, strength]) = material.textures.anisotropy.and_then(&color_of) {
        material.anisotropy *= strength;
        // As of a texel, the direction 0 is that of the tangent.
        let (x, y) = (2.0 * x - 1.0, 2.0 * y - 1.0);
        if x != 0.0 || y != 0.0 {
            material.anisotropy_rotation += libm::atan2(y, x);
        }
        material.textures.anisotropy = None;
    }
    let is_wider = match material.surface {
        Surface::Glossy { roughness, .. } => {
            let across = roughness * roughness;
            let along = across + (1.0 - across) * material.anisotropy * material.anisotropy;
            material.anisotropy > 0.0 && along > f64::from(ggx::MIN_ALPHA)
        }
        _ => false,
    };
    if !is_wider {
        remove(material);
    }
}

/// Removes the anisotropy of surfaces that are not glossy.
pub(super) fn remove_anisotropy(material: &mut MaterialDesc) {
    if !matches!(material.surface, Surface::Glossy { .. }) {
        remove(material);
    }
}

fn remove(material: &mut MaterialDesc) {
    (material.anisotropy, material.anisotropy_rotation) = (0.0, 0.0);
    material.textures.anisotropy = None;
}

/// The record of a material; `texture` is its use. `None` without anisotropy.
pub(super) fn record(material: &MaterialDesc, texture: u32) -> Option<Anisotropy> {
    let angle = material.anisotropy_rotation;
    let direction = [libm::cos(angle) as f32, libm::sin(angle) as f32];
    (material.anisotropy > 0.0).then_some(Anisotropy { strength: material.anisotropy as f32, direction, texture })
}

/// The texture whose coordinates the tangents of a material follow: none for UV set 0 as it is.
pub(super) fn tangent_map(material: &MaterialDesc) -> Option<TextureRef> {
    let textures = &material.textures;
    textures.normal.or(textures.anisotropy).or(textures.clearcoat_normal)
}

/// Whether a material reads tangents.
pub(super) fn has_tangents(material: &MaterialDesc) -> bool {
    let textures = &material.textures;
    textures.normal.is_some() || material.anisotropy > 0.0 || textures.clearcoat_normal.is_some()
}

/// [`MaterialTextures::anisotropy`] of a record that is added to `all`.
pub(super) fn add(all: &mut Vec<Anisotropy>, record: Option<Anisotropy>) -> u32 {
    let Some(record) = record else { return MaterialTextures::NONE };
    all.push(record);
    all.len() as u32 - 1
}
