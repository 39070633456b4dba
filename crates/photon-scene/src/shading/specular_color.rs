//! Specular colours in their simplest form.

use crate::describe::{MaterialDesc, Surface};
use crate::texture::TextureRef;

/// Multiplies the specular colour by a texture of one colour, and replaces a grey one by a refractive index. Surfaces without
/// a coat have none.
pub(super) fn fold_specular_color(material: &mut MaterialDesc, color_of: impl Fn(TextureRef) -> Option<[f64; 3]>) {
    let transmits = material.transmission > 0.0;
    let MaterialDesc { surface, specular_color: color, textures, .. } = material;
    let may_have_coat = |metallic: f64| metallic < 1.0 || textures.metallic_roughness.is_some();
    let coat = match surface {
        Surface::Glossy { metallic, specular, ior, .. } if may_have_coat(*metallic) && *specular > 0.0 => Some(ior),
        _ => None,
    };
    let Some(ior) = coat else {
        (*color, textures.specular_color) = ([1.0; 3], None);
        return;
    };
    if *color == [0.0; 3] {
        textures.specular_color = None;
    } else if let Some(uniform) = textures.specular_color.and_then(color_of) {
        *color = std::array::from_fn(|channel| color[channel] * uniform[channel]);
        textures.specular_color = None;
    }
    let [red, green, blue] = *color;
    // A coat of index 1 would be none, but a black one still reflects at grazing angles. Glass has an index of its own.
    if !transmits && textures.specular_color.is_none() && red == green && green == blue && red > 0.0 && red != 1.0 {
        *ior = index_of((reflectance_of(*ior) * red).min(1.0));
        *color = [1.0; 3];
    }
}

/// Reflectance at normal incidence of a boundary of refractive index n, `((n−1)/(n+1))²`; 1 for the index 0.
fn reflectance_of(ior: f64) -> f64 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}

/// The inverse, for indices from 1; 0 for a reflectance of 1.
pub(crate) fn index_of(reflectance: f64) -> f64 {
    let root = libm::sqrt(reflectance);
    if root < 1.0 { (1.0 + root) / (1.0 - root) } else { 0.0 }
}
