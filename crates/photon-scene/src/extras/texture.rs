//! Extras of textures: transforms in double precision, and texels as floats.

use serde::{Deserialize, Serialize};

use super::Exact;
use super::agrees::close;
use crate::color::linear_to_srgb;
use crate::texture::{TextureRef, TexturesDesc};

type Transform = [[Exact; 3]; 2];

/// Extras of a material with textures.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TexturesExtras {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    base_color: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    emission: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    normal: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    metallic_roughness: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    specular: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    specular_color: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    clearcoat: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    clearcoat_roughness: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    clearcoat_normal: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    clearcoat_normal_scale: Option<Exact>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    anisotropy: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    diffuse_transmission: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    diffuse_transmission_color: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    transmission: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sheen_color: Option<Transform>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sheen_roughness: Option<Transform>,
    normal_scale: Exact,
}

impl TexturesExtras {
    /// `None` for a material that has nothing to refine.
    pub(crate) fn new(textures: &TexturesDesc) -> Option<Self> {
        let of = |used: Option<TextureRef>| {
            let transform = used?.transform;
            (transform != TextureRef::IDENTITY).then(|| transform.map(|row| row.map(Exact)))
        };
        // In glTF, alpha is that of the base colour's texture.
        let base_color = of(textures.base_color.or(textures.alpha));
        let (emission, normal) = (of(textures.emission), of(textures.normal));
        let (metallic_roughness, specular) = (of(textures.metallic_roughness), of(textures.specular));
        let specular_color = of(textures.specular_color);
        let (clearcoat, clearcoat_roughness) = (of(textures.clearcoat), of(textures.clearcoat_roughness));
        let clearcoat_normal = of(textures.clearcoat_normal);
        let coat_scale = textures.clearcoat_normal_scale;
        let clearcoat_normal_scale = (coat_scale != 1.0).then_some(Exact(coat_scale));
        let anisotropy = of(textures.anisotropy);
        let diffuse_transmission = of(textures.diffuse_transmission);
        let diffuse_transmission_color = of(textures.diffuse_transmission_color);
        let transmission = of(textures.transmission);
        let (sheen_color, sheen_roughness) = (of(textures.sheen_color), of(textures.sheen_roughness));
        let normal_scale = Exact(textures.normal_scale);
        let all = [
            &base_color,
            &emission,
            &normal,
            &metallic_roughness,
            &specular,
            &specular_color,
            &clearcoat,
            &clearcoat_roughness,
            &clearcoat_normal,
            &anisotropy,
            &diffuse_transmission,
            &diffuse_transmission_color,
            &transmission,
            &sheen_color,
            &sheen_roughness,
        ];
        let is_plain = all.iter().all(|used| used.is_none());
        (!is_plain || normal_scale.0 != 1.0 || clearcoat_normal_scale.is_some()).then_some(Self {
            base_color,
            emission,
            normal,
            metallic_roughness,
            specular,
            specular_color,
            clearcoat,
            clearcoat_roughness,
            clearcoat_normal,
            clearcoat_normal_scale,
            anisotropy,
            diffuse_transmission,
            diffuse_transmission_color,
            transmission,
            sheen_color,
            sheen_roughness,
            normal_scale,
        })
    }

    /// The textures of the file with exact numbers; `None` if these disagree.
    pub(crate) fn refine(&self, textures: TexturesDesc) -> Option<TexturesDesc> {
        let of = |used: Option<TextureRef>, exact: &Option<Transform>| -> Option<Option<TextureRef>> {
            let (Some(used), Some(exact)) = (used, exact) else { return Some(used) };
            let exact = exact.map(|row| row.map(|part| part.0));
            let greatest = exact.as_flattened().iter().fold(0.0_f64, |most, part| most.max(part.abs()));
            let mut pairs = exact.as_flattened().iter().zip(used.transform.as_flattened());
            // Single precision does not reach below 1e-45.
            let agree = pairs.all(|(exact, found)| (exact - found).abs() <= 1e-4 * greatest + 1e-30);
            agree.then_some(Some(TextureRef { transform: exact, ..used }))
        };
        // Without a normal map, its scale does not matter.
        let agrees = textures.normal.is_none() || close(textures.normal_scale, self.normal_scale.0);
        let coat_scale = self.clearcoat_normal_scale.map_or(1.0, |scale| scale.0);
        let agrees =
            agrees && (textures.clearcoat_normal.is_none() || close(textures.clearcoat_normal_scale, coat_scale));
        let base_color = of(textures.base_color, &self.base_color)?;
        agrees.then_some(TexturesDesc {
            base_color,
            emission: of(textures.emission, &self.emission)?,
            normal: of(textures.normal, &self.normal)?,
            metallic_roughness: of(textures.metallic_roughness, &self.metallic_roughness)?,
            specular: of(textures.specular, &self.specular)?,
            specular_color: of(textures.specular_color, &self.specular_color)?,
            clearcoat: of(textures.clearcoat, &self.clearcoat)?,
            clearcoat_roughness: of(textures.clearcoat_roughness, &self.clearcoat_roughness)?,
            clearcoat_normal: of(textures.clearcoat_normal, &self.clearcoat_normal)?,
            clearcoat_normal_scale: coat_scale,
            anisotropy: of(textures.anisotropy, &self.anisotropy)?,
            diffuse_transmission: of(textures.diffuse_transmission, &self.diffuse_transmission)?,
            diffuse_transmission_color: of(textures.diffuse_transmission_color, &self.diffuse_transmission_color)?,
            transmission: of(textures.transmission, &self.transmission)?,
            sheen_color: of(textures.sheen_color, &self.sheen_color)?,
            sheen_roughness: of(textures.sheen_roughness, &self.sheen_roughness)?,
            normal_scale: self.normal_scale.0,
            // In glTF, the same texture.
            alpha: textures.alpha.and(base_color),
        })
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
