//! Materials in their simplest form: textures that a factor can replace, which are images of one colour and those whose
//! factor is 0, and glossy surfaces that are diffuse.

use photon_core::{Texture, ggx};

use super::alpha::uniform_alpha;
use super::anisotropy::{fold_anisotropy, remove_anisotropy};
use super::clearcoat::fold_clearcoat_normal;
use super::diffuse_transmission::remove_without_base;
use super::specular_color::fold_specular_color;
use super::texel::Decoder;
use super::transmission::fold_transmission;
use crate::describe::{MaterialDesc, Surface};
use crate::parameter::{Channel, PARAMETERS};
use crate::texture::{TextureDesc, TextureRef};

/// Multiplies the factors of each material by its textures of one colour, and removes those textures; then replaces its
/// surface by its [`simplest`] form.
pub(crate) fn fold(materials: &mut [MaterialDesc], all: &[TextureDesc]) {
    let colors: Vec<Option<[f64; 3]>> = all.iter().map(|desc| uniform(&desc.image)).collect();
    let color_of = |used: TextureRef| colors[used.texture.0 as usize];
    for material in materials {
        let textures = &mut material.textures;
        let base = albedo_of(&mut material.surface);
        if let Some(used) = textures.base_color {
            if *base == [0.0; 3] {
                textures.base_color = None;
            } else if let Some(color) = color_of(used) {
                *base = times(*base, color);
                textures.base_color = None;
            }
        }
        if let Some(used) = textures.emission {
            if material.emission == [0.0; 3] {
                textures.emission = None;
            } else if let Some(color) = color_of(used) {
                material.emission = times(material.emission, color);
                textures.emission = None;
            }
        }
        fold_roughness(&mut material.surface, &mut textures.metallic_roughness, color_of);
        fold_transmission(material, color_of);
        let textures = &mut material.textures;
        let alpha_of = |used: TextureRef| uniform_alpha(&all[used.texture.0 as usize].image);
        let has_gloss = textures.metallic_roughness.is_some();
        fold_specular(&mut material.surface, &mut textures.specular, has_gloss, alpha_of);
        let flat = |used: TextureRef| textures.normal_scale == 0.0 || color_of(used).is_some_and(is_flat);
        if textures.normal.is_some_and(flat) {
            textures.normal = None;
        }
        fold_anisotropy(material, color_of);
        // Glass has the refractive index and roughness of a glossy surface.
        if material.transmission == 0.0 {
            material.surface = simplest(material.surface.clone());
        }
        remove_anisotropy(material);
        let textures = &mut material.textures;
        if roughness_of(&mut material.surface).is_none() {
            (textures.metallic_roughness, textures.specular) = (None, None);
        }
        fold_specular_color(material, color_of);
        remove_without_base(material);
        fold_layers(material, color_of, alpha_of);
        fold_clearcoat_normal(material, color_of);
    }
}

/// The same surface without a glossy reflection where it has none: a base without a coat is diffuse. A coat of refractive
/// index 1 reflects nothing, since light passes a boundary between equal indices.
pub(crate) fn simplest(surface: Surface) -> Surface {
    let Surface::Glossy { base_color, metallic, roughness, specular, ior } = surface else { return surface };
    let specular = if ior == 1.0 { 0.0 } else { specular };
    if specular == 0.0 && metallic == 0.0 {
        return Surface::Lambert { albedo: base_color };
    }
    Surface::Glossy { base_color, metallic, roughness, specular, ior }
}

/// Whether a surface is rendered as a mirror with the reflectance of a metal: it is metal alone, and its distribution is
/// narrower than what is rendered. Not if a texture multiplies roughness and metal, if the reflection is anisotropic, or if
/// there is another layer.
pub(crate) fn is_smooth_metal(desc: &MaterialDesc) -> bool {
    let Surface::Glossy { metallic, roughness, .. } = desc.surface else { return false };
    let is_bare = desc.clearcoat == 0.0 && desc.sheen_color == [0.0; 3];
    let is_varied = desc.textures.metallic_roughness.is_some() || desc.anisotropy > 0.0;
    metallic >= 1.0 && roughness * roughness < f64::from(ggx::MIN_ALPHA) && is_bare && !is_varied
}

/// Multiplies the factors of layers by their textures of one colour, and removes layers that the surface does not have. The
/// specular colour follows rules of its own, as do directions.
fn fold_layers(
    material: &mut MaterialDesc,
    color_of: impl Fn(TextureRef) -> Option<[f64; 3]>,
    alpha_of: impl Fn(TextureRef) -> Option<f64>,
) {
    for parameter in PARAMETERS.iter().filter(|parameter| parameter.key != "specular_color") {
        let Some(texture) = parameter.texture().filter(|texture| texture.channel != Channel::Vector) else { continue };
        if parameter.layer.is_none() {
            continue;
        }
        if !parameter.is_present(material) {
            parameter.remove(material);
            continue;
        }
        let mean = texture.of(&material.textures).and_then(|used| match texture.channel {
            Channel::Alpha => alpha_of(used).map(|alpha| ([1.0; 3], alpha)),
            Channel::Green => color_of(used).map(|color| (color, color[1])),
            _ => color_of(used).map(|color| (color, color[0])),
        });
        if let Some((color, channel)) = mean {
            parameter.multiply(material, color, channel);
        }
        if mean.is_some() || parameter.is_zero(material) {
            *texture.of_mut(&mut material.textures) = None;
        }
    }
}

/// The same for a texture of roughness and metal; surfaces that have neither do not use it.
fn fold_roughness(
    surface: &mut Surface,
    texture: &mut Option<TextureRef>,
    color_of: impl Fn(TextureRef) -> Option<[f64; 3]>,
) {
    let Some(used) = *texture else { return };
    let metallic = if let Surface::Glossy { metallic, .. } = surface { *metallic } else { 0.0 };
    let Some(roughness) = roughness_of(surface) else {
        *texture = None;
        return;
    };
    if let Some([_, green, blue]) = color_of(used) {
        *roughness *= green;
        if let Surface::Glossy { metallic, .. } = surface {
            *metallic *= blue;
        }
        *texture = None;
    } else if metallic == 0.0 && *roughness == 0.0 {
        *texture = None;
    }
}

/// The roughness of surfaces that have one.
fn roughness_of(surface: &mut Surface) -> Option<&mut f64> {
    match surface {
        Surface::Lambert { .. } | Surface::Mirror { .. } | Surface::Boundary { .. } => None,
        Surface::Dielectric { roughness, .. } | Surface::Thin { roughness, .. } | Surface::Glossy { roughness, .. } => {
            Some(roughness)
        }
    }
}

/// The same for the alpha of a texture of the specular factor, which metals do not have.
fn fold_specular(
    surface: &mut Surface,
    texture: &mut Option<TextureRef>,
    has_gloss: bool,
    alpha_of: impl Fn(TextureRef) -> Option<f64>,
) {
    let (Some(used), Surface::Glossy { metallic, specular, ior, .. }) = (*texture, surface) else {
        *texture = None;
        return;
    };
    let is_metal = *metallic >= 1.0 && !has_gloss;
    if is_metal || *specular == 0.0 || *ior == 1.0 {
        *texture = None;
    } else if let Some(alpha) = alpha_of(used) {
        *specular *= alpha;
        *texture = None;
    }
}

/// The colour that a base colour texture multiplies.
fn albedo_of(surface: &mut Surface) -> &mut [f64; 3] {
    match surface {
        Surface::Lambert { albedo } => albedo,
        Surface::Mirror { reflectance } => reflectance,
        Surface::Dielectric { tint, .. } | Surface::Thin { tint, .. } => tint,
        // It has no texture.
        Surface::Boundary { absorption } => absorption,
        Surface::Glossy { base_color, .. } => base_color,
    }
}

fn times(factor: [f64; 3], color: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|channel| factor[channel] * color[channel])
}

/// The colour of an image all of whose texels are equal, apart from alpha.
pub(crate) fn uniform(image: &Texture) -> Option<[f64; 3]> {
    const RGB: u32 = 0x00FF_FFFF;
    let words = &image.texels;
    let equal = if image.format.is_float() {
        words.chunks_exact(4).all(|texel| texel[..3] == words[..3])
    } else {
        words.iter().all(|word| word & RGB == words[0] & RGB)
    };
    equal.then(|| Decoder::new(image).color(0, 0))
}

/// Whether a normal map of this colour leaves normals as they are, up to its rounding to 8 bits.
pub(super) fn is_flat([x, y, z]: [f64; 3]) -> bool {
    let tilt = |part: f64| (part - 0.5).abs() <= 0.5 / 255.0 + 1e-9;
    tilt(x) && tilt(y) && z > 0.5
}
