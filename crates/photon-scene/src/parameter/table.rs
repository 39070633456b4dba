//! The table of the parameters that are one number or a colour.

use super::{Field, Kind, Layer, Parameter, Range, Value};
use crate::describe::Surface;

const LAYERED: &[Kind] = &[Kind::Lambert, Kind::Mirror, Kind::Glossy];
const BASED: &[Kind] = &[Kind::Lambert, Kind::Glossy];
const REFRACTING: &[Kind] = &[Kind::Glass, Kind::Thin, Kind::Glossy];
const TINTED: &[Kind] = &[Kind::Glass, Kind::Thin];
const FILLED: &[Kind] = &[Kind::Glass, Kind::Boundary];
const GLOSSY: &[Kind] = &[Kind::Glossy];

const SPECULAR: &str = "KHR_materials_specular";
const CLEARCOAT: &str = "KHR_materials_clearcoat";
const ANISOTROPY: &str = "KHR_materials_anisotropy";
const LEAF: &str = "KHR_materials_diffuse_transmission";
const TRANSMISSION: &str = "KHR_materials_transmission";
const SHEEN: &str = "KHR_materials_sheen";

/// A parameter of a surface: the key, the kinds, the variants of [`Surface`] with their members, and the texture.
macro_rules! of_surface {
    ($key:literal, $kinds:ident, $value:ident: $($surface:ident $member:ident)+ $(, $texture:ident)?) => {
        Parameter {
            key: $key,
            kinds: $kinds,
            is_angle: false,
            layer: None,
            texture: texture!($($texture)?),
            get: |desc| match &desc.surface {
                $(Surface::$surface { $member, .. } => Some(Value::$value(*$member)),)+
                _ => None,
            },
            access: |desc| match &mut desc.surface {
                $(Surface::$surface { $member, .. } => Some(Field::$value($member)),)+
                _ => None,
            },
        }
    };
}

/// A parameter of a layer: the key, the field of the description with its default, the kinds, the range, the key of the
/// leading parameter, the factor in glTF, and the texture.
macro_rules! of_layer {
    ($key:literal, $field:ident: $value:ident = $default:expr, $kinds:ident, $range:ident, $leader:literal
        $(, $extension:ident $factor:literal)? $(; $texture:ident)?) => {
        Parameter {
            key: $key,
            kinds: $kinds,
            is_angle: false,
            layer: Some(Layer {
                field: stringify!($field),
                range: Range::$range,
                default: Value::$value($default),
                leader: $leader,
                gltf: pair!($($extension $factor)?),
            }),
            texture: texture!($($texture)?),
            get: |desc| Some(Value::$value(desc.$field)),
            access: |desc| Some(Field::$value(&mut desc.$field)),
        }
    };
}

macro_rules! texture {
    () => {
        None
    };
    ($field:ident) => {
        Some(stringify!($field))
    };
}

macro_rules! pair {
    () => {
        None
    };
    ($extension:ident $factor:literal) => {
        Some(($extension, $factor))
    };
}

/// All of them. Files are written in this order.
#[rustfmt::skip]
pub(crate) const PARAMETERS: &[Parameter] = &[
    of_surface!("albedo", LAYERED, Color: Lambert albedo Mirror reflectance Glossy base_color, base_color),
    of_surface!("ior", REFRACTING, Number: Dielectric ior Thin ior Glossy ior),
    of_surface!("tint", TINTED, Color: Dielectric tint Thin tint, base_color),
    of_surface!("absorption", FILLED, Color: Dielectric absorption Boundary absorption),
    of_surface!("metallic", GLOSSY, Number: Glossy metallic, metallic_roughness),
    of_surface!("roughness", REFRACTING, Number: Dielectric roughness Thin roughness Glossy roughness, metallic_roughness),
    of_surface!("specular", GLOSSY, Number: Glossy specular, specular),
    of_layer!("scattering", scattering: Color = [0.0; 3], FILLED, NotNegative, "scattering"),
    of_layer!("specular_color", specular_color: Color = [1.0; 3], GLOSSY, NotNegative, "specular_color",
        SPECULAR "specularColorFactor"; specular_color),
    of_layer!("clearcoat", clearcoat: Number = 0.0, LAYERED, Share, "clearcoat",
        CLEARCOAT "clearcoatFactor"; clearcoat),
    of_layer!("clearcoat_roughness", clearcoat_roughness: Number = 0.0, LAYERED, Share, "clearcoat",
        CLEARCOAT "clearcoatRoughnessFactor"; clearcoat_roughness),
    of_layer!("anisotropy", anisotropy: Number = 0.0, GLOSSY, Share, "anisotropy",
        ANISOTROPY "anisotropyStrength"; anisotropy),
    Parameter { is_angle: true, ..
        of_layer!("anisotropy_degrees", anisotropy_rotation: Number = 0.0, GLOSSY, Finite, "anisotropy",
            ANISOTROPY "anisotropyRotation"; anisotropy) },
    of_layer!("diffuse_transmission", diffuse_transmission: Number = 0.0, BASED, Share, "diffuse_transmission",
        LEAF "diffuseTransmissionFactor"; diffuse_transmission),
    of_layer!("diffuse_transmission_color", diffuse_transmission_color: Color = [1.0; 3], BASED, Share, "diffuse_transmission",
        LEAF "diffuseTransmissionColorFactor"; diffuse_transmission_color),
    of_layer!("transmission", transmission: Number = 0.0, GLOSSY, Share, "transmission",
        TRANSMISSION "transmissionFactor"; transmission),
    of_layer!("sheen", sheen_color: Color = [0.0; 3], LAYERED, Share, "sheen",
        SHEEN "sheenColorFactor"; sheen_color),
    of_layer!("sheen_roughness", sheen_roughness: Number = 0.0, LAYERED, Share, "sheen",
        SHEEN "sheenRoughnessFactor"; sheen_roughness),
];
