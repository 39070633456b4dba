//! Random damage to a file: truncation, changed bytes, changed numbers. None may cause a
//! panic.

use std::path::Path;

use super::super::assemble;
use super::file::{File, data_uri, floats, glb, png};

const HERE: &str = ".";

/// A file that uses every feature, to be damaged.
fn rich() -> (File, Vec<u8>) {
    let mut bin = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    bin.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    bin.extend(png(&[[9, 99, 199, 128], [0, 255, 255, 255]]));
    let image = bin.len() - 44;
    bin.resize(bin.len().next_multiple_of(4), 0);
    let joints = bin.len();
    bin.extend([0, 0, 1, 1].repeat(3));
    let identity: [f32; 16] = std::array::from_fn(|at| if at % 5 == 0 { 1.0 } else { 0.0 });
    bin.extend(floats(&[identity, identity].concat()));
    let uri = data_uri("image/png", &png(&[[1, 2, 3, 255]]));
    let file = File::new()
        .with("buffers", format!(r#"[{{"byteLength": {}}}]"#, bin.len()))
        .with("bufferViews", format!(r#"[{{"buffer": 0, "byteLength": 36, "byteStride": 12}}, {{"buffer": 0, "byteOffset": 36, "byteLength": 6}}, {{"buffer": 0, "byteOffset": 44, "byteLength": {image}}},
            {{"buffer": 0, "byteOffset": {joints}, "byteLength": 140}}]"#))
        .with("accessors", r#"[{"bufferView": 0, "byteOffset": 0, "componentType": 5126, "count": 3, "type": "VEC3", "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"},
            {"bufferView": 0, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5121, "count": 3, "type": "VEC4"},
            {"bufferView": 3, "byteOffset": 12, "componentType": 5126, "count": 2, "type": "MAT4"}]"#)
        .with("skins", r#"[{"joints": [1, 2], "inverseBindMatrices": 5}]"#)
        .with("materials", r#"[{"name": "a", "alphaMode": "BLEND", "emissiveFactor": [1, 1, 1], "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 0}}, "emissiveTexture": {"index": 1}, "normalTexture": {"index": 0, "scale": 2, "texCoord": 1, "extensions": {"KHR_texture_transform": {"offset": [1, 2], "rotation": 1, "scale": [2, 3], "texCoord": 0}}},
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 1, "attenuationColor": [0.5, 0.5, 0.5]}, "KHR_materials_ior": {"ior": 1.5}, "KHR_materials_emissive_strength": {"emissiveStrength": 3}}}]"#)
        .with("textures", r#"[{"source": 0, "sampler": 0}, {"source": 1}]"#)
        .with("samplers", r#"[{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]"#)
        .with("images", format!(r#"[{{"bufferView": 2, "mimeType": "image/png"}}, {{"uri": "{uri}"}}]"#))
        .with("meshes", r#"[{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0, "TANGENT": 3, "COLOR_0": 3, "TEXCOORD_0": 2, "JOINTS_0": 4, "WEIGHTS_0": 3}, "targets": [{"POSITION": 0, "NORMAL": 0, "TANGENT": 0}], "indices": 1, "material": 0, "mode": 4}, {"attributes": {"POSITION": 0}, "mode": 5}]}]"#)
        .with("cameras", r#"[{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}]"#)
        .with("nodes", r#"[{"children": [1, 2, 3]}, {"mesh": 0, "scale": [1, -1, 1]}, {"camera": 0, "rotation": [0, 0, 0, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"mesh": 0, "skin": 0, "weights": [0.5]}]"#)
        .with("scene", "0")
        .with("extensions", r#"{"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 1, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}}]}}"#);
    (file, bin)
}

/// Loads and builds; any result but a panic, or tables that backends refuse, is accepted.
fn survive(bytes: &[u8]) -> bool {
    let built = assemble(bytes, Path::new(HERE)).map(|(builder, _)| builder.build());
    built.is_ok_and(|built| built.is_ok_and(|scene| scene.view().validate().map(|()| true).unwrap()))
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let (file, bin) = rich();
    let whole = glb(&file.json(), &bin);
    assert!(survive(&whole));
    for length in 0..whole.len() {
        assert!(assemble(&whole[..length], Path::new(HERE)).is_err(), "{length} of {}", whole.len());
    }
    let json = File::new().json();
    for length in 0..json.len() {
        assert!(assemble(&json.as_bytes()[..length], Path::new(HERE)).is_err(), "{length}");
    }
}

#[test]
fn no_changed_byte_brings_it_down() {
    let (file, bin) = rich();
    let whole = glb(&file.json(), &bin);
    let mut survivors = 0;
    for place in 0..whole.len() {
        for flip in [0x01, 0x10, 0x80, 0xff] {
            let mut damaged = whole.clone();
            damaged[place] ^= flip;
            survivors += usize::from(survive(&damaged));
        }
    }
    // Many bytes do not matter (coordinates, names), so that both outcomes must have occurred.
    assert!(survivors > 0 && survivors < 4 * whole.len(), "{survivors}");
}

#[test]
fn no_changed_number_brings_it_down() {
    let (file, bin) = rich();
    let json = file.json();
    let is_digit = |byte: u8| byte.is_ascii_digit();
    let mut at = 0;
    let mut tried = 0;
    while let Some(start) = json[at..].find(|c: char| c.is_ascii_digit()).map(|found| at + found) {
        let end = json[start..].bytes().position(|byte| !is_digit(byte)).map_or(json.len(), |len| start + len);
        for hostile in [
            "0",
            "1",
            "2",
            "3",
            "7",
            "255",
            "-1",
            "0.5",
            "1e30",
            "1e39",
            "4294967295",
            "4294967296",
            "99999999999",
            "18446744073709551615",
            "null",
            "[]",
            "{}",
        ] {
            survive(&glb(&[&json[..start], hostile, &json[end..]].concat(), &bin));
            tried += 1;
        }
        at = end;
    }
    assert!(tried > 1000, "{tried}");
}
