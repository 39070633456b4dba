//! Extras of textures: transforms in double precision, and texels as floats.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Exact;
use super::agrees::close;
use crate::color::linear_to_srgb;
use crate::parameter::{TEXTURES, TextureParameter};
use crate::texture::{TextureRef, TexturesDesc};

type Transform = [[Exact; 3]; 2];

/// Extras of a material with textures: those of [`TEXTURES`] that have a transform, by their fields.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TexturesExtras {
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    transforms: BTreeMap<String, Transform>,
    normal_scale: Exact,
    clearcoat_normal_scale: Exact,
}

impl TexturesExtras {
    /// `None` for a material that has nothing to refine.
    pub(crate) fn new(textures: &TexturesDesc) -> Option<Self> {
        // In glTF, alpha is that of the base colour's texture.
        let textures = TexturesDesc { base_color: textures.base_color.or(textures.alpha), ..*textures };
        let transforms: BTreeMap<String, Transform> = TEXTURES
            .iter()
            .filter(|texture| !texture.gltf.is_empty())
            .filter_map(|texture| {
                let transform = texture.of(&textures)?.transform;
                let exact = transform.map(|row| row.map(Exact));
                (transform != TextureRef::IDENTITY).then(|| (texture.field.to_owned(), exact))
            })
            .collect();
        let [normal_scale, clearcoat_normal_scale] =
            [textures.normal_scale, textures.clearcoat_normal_scale].map(Exact);
        let is_plain = transforms.is_empty() && normal_scale.0 == 1.0 && clearcoat_normal_scale.0 == 1.0;
        (!is_plain).then_some(Self { transforms, normal_scale, clearcoat_normal_scale })
    }

    /// The textures of the file with exact numbers; `None` if these disagree.
    pub(crate) fn refine(&self, textures: TexturesDesc) -> Option<TexturesDesc> {
        let mut refined = textures;
        for (field, exact) in &self.transforms {
            let Some(used) = TextureParameter::find(field)?.of_mut(&mut refined) else { continue };
            let exact = exact.map(|row| row.map(|part| part.0));
            let greatest = exact.as_flattened().iter().fold(0.0_f64, |most, part| most.max(part.abs()));
            let mut pairs = exact.as_flattened().iter().zip(used.transform.as_flattened());
            // Single precision does not reach below 1e-45.
            if !pairs.all(|(exact, found)| (exact - found).abs() <= 1e-4 * greatest + 1e-30) {
                return None;
            }
            used.transform = exact;
        }
        // Without a normal map, its scale does not matter.
        let agrees = |map: Option<TextureRef>, found: f64, exact: Exact| map.is_none() || close(found, exact.0);
        let (scale, coat_scale) = (self.normal_scale, self.clearcoat_normal_scale);
        if !agrees(textures.normal, textures.normal_scale, scale)
            || !agrees(textures.clearcoat_normal, textures.clearcoat_normal_scale, coat_scale)
        {
            return None;
        }
        (refined.normal_scale, refined.clearcoat_normal_scale) = (scale.0, coat_scale.0);
        // In glTF, the same texture.
        refined.alpha = textures.alpha.and(refined.base_color);
        Some(refined)
    }
}

/// Extras of an image.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ImageExtras {
    /// Index of the buffer view with four 32-bit floats for each texel.
    pub(crate) floats: usize,
}

/// The texel of bytes that stands for one of floats in other programs.
pub(crate) fn fallback(texel: &[u32; 4], is_linear: bool) -> u32 {
    let [r, g, b, a] = texel.map(|word| f64::from(f32::from_bits(word)).clamp(0.0, 1.0));
    let curve = |part: f64| if is_linear { part } else { linear_to_srgb(part) };
    u32::from_le_bytes([curve(r), curve(g), curve(b), a].map(|part| (part * 255.0).round() as u8))
}

/// The floats of an image whose texels are the bytes that stand for them; `None` if they are of another image.
pub(crate) fn agreeing_floats(texels: &[u32], bytes: &[u8]) -> Option<Vec<u32>> {
    let words: Vec<u32> = bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    let (floats, rest) = words.as_chunks::<4>();
    let valid = |word: &u32| f32::from_bits(*word).is_finite() && f32::from_bits(*word) >= 0.0;
    if floats.len() != texels.len() || !rest.is_empty() || !words.iter().all(valid) {
        return None;
    }
    let agrees = |is_linear| floats.iter().map(|texel| fallback(texel, is_linear)).eq(texels.iter().copied());
    (agrees(false) || agrees(true)).then_some(words)
}
