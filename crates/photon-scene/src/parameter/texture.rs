//! Textures of materials as data.

use crate::texture::{TextureRef, TexturesDesc};

/// Channels of a texture that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    Color,
    Red,
    Green,
    Alpha,
    /// Green and blue, each for a factor of its own.
    Pair,
    /// A direction: no factor stands for a texture of one colour.
    Vector,
}

/// Encoding of the bytes of an image in glTF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    Srgb,
    Linear,
    /// The alpha of colours in sRGB, of which there are no others.
    Alpha,
}

/// A texture of materials.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextureParameter {
    /// Field of [`TexturesDesc`].
    pub(crate) field: &'static str,
    /// Name in messages.
    pub(crate) label: &'static str,
    pub(crate) channel: Channel,
    pub(crate) encoding: Encoding,
    /// Names of the objects that lead to it in a material of glTF; none for alpha, which is that of the base colour.
    pub(crate) gltf: &'static [&'static str],
    get: fn(&TexturesDesc) -> Option<TextureRef>,
    access: fn(&mut TexturesDesc) -> &mut Option<TextureRef>,
}

impl TextureParameter {
    /// The texture of a material.
    pub(crate) fn of(&self, textures: &TexturesDesc) -> Option<TextureRef> {
        (self.get)(textures)
    }

    pub(crate) fn of_mut<'a>(&self, textures: &'a mut TexturesDesc) -> &'a mut Option<TextureRef> {
        (self.access)(textures)
    }

    /// This texture with another name in messages.
    #[cfg(feature = "files")]
    pub(crate) const fn labelled(self, label: &'static str) -> Self {
        Self { label, ..self }
    }

    /// The texture with this field.
    pub(crate) fn find(field: &str) -> Option<&'static Self> {
        TEXTURES.iter().find(|texture| texture.field == field)
    }
}

/// The field, the name in messages, channels, encoding, and names in glTF.
macro_rules! texture {
    ($field:ident, $label:literal, $channel:ident, $encoding:ident $(, $name:literal)*) => {
        TextureParameter {
            field: stringify!($field),
            label: $label,
            channel: Channel::$channel,
            encoding: Encoding::$encoding,
            gltf: &[$($name),*],
            get: |textures| textures.$field,
            access: |textures| &mut textures.$field,
        }
    };
}

pub(crate) const BASE_COLOR: TextureParameter =
    texture!(base_color, "base colour", Color, Srgb, "pbrMetallicRoughness", "baseColorTexture");
pub(crate) const EMISSION: TextureParameter = texture!(emission, "emission", Color, Srgb, "emissiveTexture");
pub(crate) const NORMAL: TextureParameter = texture!(normal, "normal map", Vector, Linear, "normalTexture");
pub(crate) const METALLIC_ROUGHNESS: TextureParameter = texture!(
    metallic_roughness,
    "metal and roughness",
    Pair,
    Linear,
    "pbrMetallicRoughness",
    "metallicRoughnessTexture"
);
pub(crate) const SPECULAR: TextureParameter =
    texture!(specular, "specular", Alpha, Alpha, "extensions", "KHR_materials_specular", "specularTexture");
pub(crate) const TRANSMISSION: TextureParameter = texture!(
    transmission,
    "transmission",
    Red,
    Linear,
    "extensions",
    "KHR_materials_transmission",
    "transmissionTexture"
);

/// All of them.
#[rustfmt::skip]
pub(crate) const TEXTURES: &[TextureParameter] = &[
    BASE_COLOR,
    EMISSION,
    NORMAL,
    METALLIC_ROUGHNESS,
    texture!(alpha, "alpha", Alpha, Alpha),
    SPECULAR,
    texture!(specular_color, "specular colour", Color, Srgb, "extensions", "KHR_materials_specular", "specularColorTexture"),
    texture!(clearcoat, "clearcoat", Red, Linear, "extensions", "KHR_materials_clearcoat", "clearcoatTexture"),
    texture!(clearcoat_roughness, "clearcoat roughness", Green, Linear,
        "extensions", "KHR_materials_clearcoat", "clearcoatRoughnessTexture"),
    texture!(clearcoat_normal, "normal map", Vector, Linear,
        "extensions", "KHR_materials_clearcoat", "clearcoatNormalTexture"),
    texture!(anisotropy, "anisotropy", Vector, Linear, "extensions", "KHR_materials_anisotropy", "anisotropyTexture"),
    texture!(diffuse_transmission, "diffuse transmission", Alpha, Alpha,
        "extensions", "KHR_materials_diffuse_transmission", "diffuseTransmissionTexture"),
    texture!(diffuse_transmission_color, "diffuse transmission colour", Color, Srgb,
        "extensions", "KHR_materials_diffuse_transmission", "diffuseTransmissionColorTexture"),
    TRANSMISSION,
    texture!(sheen_color, "sheen colour", Color, Srgb, "extensions", "KHR_materials_sheen", "sheenColorTexture"),
    texture!(sheen_roughness, "sheen roughness", Alpha, Alpha,
        "extensions", "KHR_materials_sheen", "sheenRoughnessTexture"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::TextureId;

    /// A field without a line would be neither checked nor written: beside the textures there are two scales.
    #[test]
    fn every_field_has_a_line() {
        let textures = TEXTURES.len() * size_of::<Option<TextureRef>>();
        assert_eq!(size_of::<TexturesDesc>(), textures + 2 * size_of::<f64>());
        let mut all = TexturesDesc::default();
        for texture in TEXTURES {
            assert_eq!(texture.of(&all), None, "{}", texture.field);
            *texture.of_mut(&mut all) = Some(TextureRef::new(TextureId(0)));
            assert!(texture.of(&all).is_some(), "{}", texture.field);
        }
    }
}
