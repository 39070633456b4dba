//! How a material refers to a texture: number, UV set and `KHR_texture_transform`.

use gltf::json::Value;
use gltf::json::material::NormalTexture;
use gltf::json::texture::Info;

use crate::texture::{TextureId, TextureRef};

/// A reference to a texture of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slot {
    pub(super) texture: usize,
    pub(super) uv_set: u32,
    transform: [[f64; 3]; 2],
    /// Whether the transform turns the texture.
    pub(super) is_turned: bool,
}

impl Slot {
    pub(super) fn of(info: &Info) -> Self {
        let extensions = info.extensions.as_ref().map(|all| &all.others);
        Self::new(info.index.value(), info.tex_coord, extensions.and_then(|all| all.get(TRANSFORM)))
    }

    pub(super) fn of_normal(info: &NormalTexture) -> Self {
        let extensions = info.extensions.as_ref().map(|all| &all.others);
        Self::new(info.index.value(), info.tex_coord, extensions.and_then(|all| all.get(TRANSFORM)))
    }

    /// From the JSON of an extension that the parser does not know.
    pub(super) fn of_json(info: &Value) -> Option<Self> {
        let texture = usize::try_from(info.get("index")?.as_u64()?).ok()?;
        Some(Self::new(
            texture,
            number(info.get("texCoord")),
            info.get("extensions").and_then(|all| all.get(TRANSFORM)),
        ))
    }

    fn new(texture: usize, uv_set: u32, transform: Option<&Value>) -> Self {
        let Some(extension) = transform else {
            return Self { texture, uv_set, transform: TextureRef::IDENTITY, is_turned: false };
        };
        let pair = |field: &str, default: f64| {
            let numbers = extension.get(field).and_then(Value::as_array);
            let of = |at: usize| numbers.and_then(|all| all.get(at)?.as_f64()).unwrap_or(default);
            [of(0), of(1)]
        };
        let ([x, y], [sx, sy]) = (pair("offset", 0.0), pair("scale", 1.0));
        let angle = extension.get("rotation").and_then(Value::as_f64).unwrap_or(0.0);
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        // Translation · rotation · scale; the rotation is counter-clockwise with v downwards.
        // Zeros without a sign, so that equal transforms have equal bits.
        let transform = [[cos * sx, sin * sy, x], [-sin * sx, cos * sy, y]].map(|row| row.map(|part| part + 0.0));
        let uv_set = extension.get("texCoord").map_or(uv_set, |set| number(Some(set)));
        Self { texture, uv_set, transform, is_turned: angle != 0.0 }
    }

    /// The reference to the texture in the scene.
    pub(super) fn used(&self, texture: TextureId) -> TextureRef {
        TextureRef { texture, uv_set: self.uv_set, transform: self.transform }
    }
}

const TRANSFORM: &str = "KHR_texture_transform";

/// An index; one that cannot exist in place of anything else.
fn number(value: Option<&Value>) -> u32 {
    value.map_or(0, |value| value.as_u64().and_then(|number| u32::try_from(number).ok()).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the extension's specification: rotation about the upper left corner, after the scale.
    #[test]
    fn transforms_are_translation_rotation_scale() {
        let parse = |text: &str| -> Value { gltf::json::deserialize::from_str(text).unwrap() };
        let json = parse(
            r#"{"index": 3, "texCoord": 1, "extensions": {"KHR_texture_transform":
            {"offset": [0, 1], "rotation": 1.5707963267948966, "scale": [0.5, 0.25], "texCoord": 2}}}"#,
        );
        let slot = Slot::of_json(&json).unwrap();
        assert_eq!((slot.texture, slot.uv_set, slot.is_turned), (3, 2, true));
        let expected = [[0.0, 0.25, 0.0], [-0.5, 0.0, 1.0]];
        let pairs = slot.transform.as_flattened().iter().zip(expected.as_flattened());
        assert!(pairs.into_iter().all(|(found, expected)| (found - expected).abs() < 1e-15), "{slot:?}");
        // V11: many turns.
        let json = r#"{"index": 0, "extensions": {"KHR_texture_transform": {"rotation": 1e9}}}"#;
        let [[cos, sin, _], _] = Slot::of_json(&parse(json)).unwrap().transform;
        assert!((cos - 0.837_887_181_363_902).abs() < 1e-14 && (sin - 0.545_843_449_448_699_6).abs() < 1e-14);
        let plain = Slot::of_json(&parse(r#"{"index": 0}"#)).unwrap();
        assert_eq!((plain.uv_set, plain.transform, plain.is_turned), (0, TextureRef::IDENTITY, false));
        assert_eq!(Slot::of_json(&parse(r#"{"texCoord": 0}"#)), None);
        let odd = parse(r#"{"index": 0, "extensions": {"KHR_texture_transform": {"offset": "x", "texCoord": -1}}}"#);
        assert_eq!(Slot::of_json(&odd).unwrap().uv_set, u32::MAX);
    }
}
