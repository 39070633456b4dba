//! Alpha of materials in its simplest form: most are opaque, and need nothing.

use photon_core::Texture;

use crate::describe::{AlphaMode, MaterialDesc};
use crate::mesh::Mesh;
use crate::texture::TextureDesc;

/// Multiplies the alpha of each material by its textures of one alpha, and removes those; materials that are there
/// everywhere become opaque, those that are nowhere get an alpha of 0.
pub(crate) fn fold_alpha(materials: &mut [MaterialDesc], textures: &[TextureDesc], meshes: &[Mesh]) {
    for (index, material) in materials.iter_mut().enumerate() {
        let has_holes = |mesh: &Mesh| {
            mesh.material.0 as usize == index && mesh.attributes.colors.iter().any(|&[.., alpha]| alpha < 1.0)
        };
        if material.alpha_mode != AlphaMode::Opaque {
            let used = material.textures.alpha.map(|used| uniform_alpha(&textures[used.texture.0 as usize].image));
            if let Some(Some(alpha)) = used {
                material.alpha *= alpha;
            }
            let varies = used == Some(None) || meshes.iter().any(has_holes);
            (material.alpha_mode, material.alpha) = simplest(material.alpha_mode, material.alpha, varies);
            if material.alpha == 0.0 {
                material.emission = [0.0; 3];
            }
            if used != Some(None) || material.alpha == 0.0 {
                material.textures.alpha = None;
            }
        }
        if material.alpha_mode == AlphaMode::Opaque {
            (material.alpha, material.textures.alpha) = (1.0, None);
        }
    }
}

/// The mode of the largest alpha `most`, if textures or vertex colours reduce it in places (`varies`).
fn simplest(mode: AlphaMode, most: f64, varies: bool) -> (AlphaMode, f64) {
    match mode {
        AlphaMode::Mask { cutoff } if (most as f32) < cutoff as f32 => (AlphaMode::Blend, 0.0),
        AlphaMode::Mask { cutoff } if !varies || cutoff as f32 == 0.0 => (AlphaMode::Opaque, 1.0),
        AlphaMode::Blend if !varies && most == 1.0 => (AlphaMode::Opaque, 1.0),
        AlphaMode::Opaque | AlphaMode::Mask { .. } | AlphaMode::Blend => (mode, most),
    }
}

/// The alpha of an image all of whose texels have the same.
pub(crate) fn uniform_alpha(image: &Texture) -> Option<f64> {
    let words = &image.texels;
    if image.format.is_float() {
        let alpha = words[3];
        words.chunks_exact(4).all(|texel| texel[3] == alpha).then(|| f64::from(f32::from_bits(alpha)))
    } else {
        let alpha = words[0] >> 24;
        words.iter().all(|word| word >> 24 == alpha).then(|| f64::from(alpha) / 255.0)
    }
}
