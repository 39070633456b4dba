//! Textures from arrays, and how materials use them.

use numpy::PyReadonlyArray1;
use photonmap::scene::{AlphaMode, MaterialDesc, TextureDesc, TextureId, TextureRef, TexturesDesc};
use photonmap::{Filter, Wrap};

use crate::error::Failure;

/// Uses, numbers and UV sets of a material's textures, factor on its normal map, and cutoff of its alpha.
pub(crate) type TextureUses = (Vec<(String, usize, u32)>, f64, Option<f64>);

/// The size of an image of so many texels.
fn size(name: &str, texels: usize, width: u32) -> Result<[u32; 2], Failure> {
    let wrong = || Failure::input(format!("{name}: {texels} texels do not fill rows of {width}"));
    let height = u32::try_from(texels).ok().and_then(|texels| texels.checked_div(width)).ok_or_else(wrong)?;
    if height == 0 || u64::from(height) * u64::from(width) != texels as u64 {
        Err(wrong())
    } else {
        Ok([width, height])
    }
}

/// An image of bytes, four for each texel.
pub(crate) fn bytes(
    name: &str,
    texels: &PyReadonlyArray1<'_, u8>,
    width: u32,
    is_color: bool,
) -> Result<TextureDesc, Failure> {
    let flat: Vec<u8> = texels.as_array().iter().copied().collect();
    let (texels, _) = flat.as_chunks::<4>();
    let [width, height] = size(name, texels.len(), width)?;
    let make = if is_color { TextureDesc::srgb8 } else { TextureDesc::linear8 };
    Ok(make(name, width, height, texels))
}

/// An image of linear numbers, four for each texel.
pub(crate) fn floats(name: &str, texels: &PyReadonlyArray1<'_, f32>, width: u32) -> Result<TextureDesc, Failure> {
    let flat: Vec<f32> = texels.as_array().iter().copied().collect();
    let (texels, _) = flat.as_chunks::<4>();
    let [width, height] = size(name, texels.len(), width)?;
    Ok(TextureDesc::float32(name, width, height, texels))
}

/// The texture with wrap modes by their numbers, and with the nearest texel in place of a bilinear filter.
pub(crate) fn placed(texture: TextureDesc, (u, v): (u8, u8), nearest: bool) -> TextureDesc {
    let wrap = |number| match number {
        0 => Wrap::Repeat,
        1 => Wrap::Mirror,
        _ => Wrap::Clamp,
    };
    let texture = texture.wrapped([wrap(u), wrap(v)]);
    if nearest { texture.filtered(Filter::Nearest) } else { texture }
}

/// The material with its textures, which are numbered as in `textures`.
pub(crate) fn used(
    material: MaterialDesc,
    (uses, normal_scale, cutoff): TextureUses,
    textures: &[TextureId],
) -> Result<MaterialDesc, Failure> {
    let mut all = TexturesDesc::default();
    for (name, number, uv_set) in uses {
        let unknown = || Failure::input(format!("{name}: no texture has the number {number}"));
        let texture = TextureRef::new(*textures.get(number).ok_or_else(unknown)?).with_uv_set(uv_set);
        all = match name.as_str() {
            "color_texture" => all.with_base_color(texture),
            "emission_texture" => all.with_emission(texture),
            "roughness_texture" => all.with_metallic_roughness(texture),
            "normal_map" => all.with_normal(texture).with_normal_scale(normal_scale),
            "alpha_texture" => all.with_alpha(texture),
            other => return Err(Failure::input(format!("materials have no texture called {other:?}"))),
        };
    }
    let has_alpha = all.alpha.is_some();
    let material = material.with_textures(all);
    Ok(match cutoff {
        Some(cutoff) => material.with_alpha(AlphaMode::Mask { cutoff }, 1.0),
        None if has_alpha => material.with_alpha(AlphaMode::Blend, 1.0),
        None => material,
    })
}
