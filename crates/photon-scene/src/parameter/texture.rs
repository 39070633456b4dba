//! Textures of materials as data.

use crate::texture::{TextureRef, TexturesDesc};

/// Channels of a texture that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    Color,
    Red,
    Green,
    Alpha,
    /// Several, which mean different things: no factor stands for a texture of one colour.
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
    /// Names of the objects that lead to it in a material of glTF.
    pub(crate) gltf: &'static [&'static str],
    access: fn(&mut TexturesDesc) -> &mut Option<TextureRef>,
}

impl TextureParameter {
    /// The texture of a material.
    pub(crate) fn of(&self, textures: &TexturesDesc) -> Option<TextureRef> {
        *(self.access)(&mut textures.clone())
    }

    pub(crate) fn of_mut<'a>(&self, textures: &'a mut TexturesDesc) -> &'a mut Option<TextureRef> {
        (self.access)(textures)
    }

    /// The texture with this field.
    pub(crate) fn find(field: &str) -> Option<&'static Self> {
        TEXTURES.iter().find(|texture| texture.field == field)
    }
}

/// A line of the table: the field, the name in messages, channels, encoding, and names in glTF.
macro_rules! texture {
    ($field:ident, $label:literal, $channel:ident, $encoding:ident, $($name:literal)+) => {
        TextureParameter {
            field: stringify!($field),
            label: $label,
            channel: Channel::$channel,
            encoding: Encoding::$encoding,
            gltf: &[$($name),+],
            access: |textures| &mut textures.$field,
        }
    };
}

/// All but that of alpha, which is the base colour in glTF.
#[rustfmt::skip]
pub(crate) const TEXTURES: &[TextureParameter] = &[
    texture!(base_color, "base colour", Color, Srgb, "pbrMetallicRoughness" "baseColorTexture"),
    texture!(emission, "emission", Color, Srgb, "emissiveTexture"),
    texture!(normal, "normal map", Vector, Linear, "normalTexture"),
    texture!(metallic_roughness, "metal and roughness", Vector, Linear, "pbrMetallicRoughness" "metallicRoughnessTexture"),
    texture!(specular, "specular", Alpha, Alpha, "extensions" "KHR_materials_specular" "specularTexture"),
    texture!(specular_color, "specular colour", Color, Srgb, "extensions" "KHR_materials_specular" "specularColorTexture"),
    texture!(clearcoat, "clearcoat", Red, Linear, "extensions" "KHR_materials_clearcoat" "clearcoatTexture"),
    texture!(clearcoat_roughness, "clearcoat roughness", Green, Linear,
        "extensions" "KHR_materials_clearcoat" "clearcoatRoughnessTexture"),
    texture!(clearcoat_normal, "normal map", Vector, Linear,
        "extensions" "KHR_materials_clearcoat" "clearcoatNormalTexture"),
    texture!(anisotropy, "anisotropy", Vector, Linear, "extensions" "KHR_materials_anisotropy" "anisotropyTexture"),
    texture!(diffuse_transmission, "diffuse transmission", Alpha, Alpha,
        "extensions" "KHR_materials_diffuse_transmission" "diffuseTransmissionTexture"),
    texture!(diffuse_transmission_color, "diffuse transmission colour", Color, Srgb,
        "extensions" "KHR_materials_diffuse_transmission" "diffuseTransmissionColorTexture"),
    texture!(transmission, "transmission", Red, Linear, "extensions" "KHR_materials_transmission" "transmissionTexture"),
    texture!(sheen_color, "sheen colour", Color, Srgb, "extensions" "KHR_materials_sheen" "sheenColorTexture"),
    texture!(sheen_roughness, "sheen roughness", Alpha, Alpha,
        "extensions" "KHR_materials_sheen" "sheenRoughnessTexture"),
];
