//! What other programs write although the standard does not allow it: read as it is meant, with a line in the report.

use std::path::Path;

use super::super::{assemble, load_gltf};
use super::file::{File, data_uri, floats, glb, png, says};

#[test]
fn chunks_may_be_filled_up_with_zeros() {
    let file = File::new();
    for zeros in 1..=4 {
        let json = format!("{}{}", file.json(), "\0".repeat(zeros));
        assert!(assemble(&glb(&json, &[]), Path::new(".")).is_ok(), "{zeros}");
        assert!(assemble(json.as_bytes(), Path::new(".")).is_ok());
    }
    let junk = format!("{}\0x", file.json());
    assert!(assemble(&glb(&junk, &[]), Path::new(".")).is_err());
}

/// Names in Latin-1 are read; text in UTF-16 and compressed files are named.
#[test]
fn other_encodings_are_read_or_named() {
    let json = File::new().with("extras", r#""caf?""#).json();
    let latin: Vec<u8> = json.bytes().map(|byte| if byte == b'?' { 0xE9 } else { byte }).collect();
    let (_, report) = assemble(&latin, Path::new(".")).unwrap();
    assert!(says(&report, "the file", "taken as Latin-1") && report.is_exact(), "{report}");
    let wide: Vec<u8> = json.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    for (bytes, name) in
        [(&wide[..], "UTF-16; save"), (&[&b"\xFF\xFE"[..], &wide].concat(), "UTF-16"), (b"\x1F\x8B\x08", "gzip")]
    {
        std::fs::write(&path, bytes).unwrap();
        let error = load_gltf(&path).map(drop).unwrap_err().to_string();
        assert!(error.contains("a.gltf: it is ") && error.contains(name), "{error}");
    }
}

#[test]
fn numbers_without_a_value_are_named_with_their_place() {
    for word in ["NaN", "nan", "Infinity", "-Infinity", "-inf", "inf", "-NaN"] {
        let file = File::new().with("extras", format!(r#"{{"a": [1,{word}]}}"#));
        let line = file.json().lines().position(|line| line.contains("extras")).unwrap() + 1;
        let column = file.json().lines().nth(line - 1).unwrap().find(word).unwrap() + 1;
        let error = file.error();
        let expected = format!("has {word}, which is no number, at line {line}, column {column}");
        assert!(error.contains(&expected), "{expected}: {error}");
    }
    for other in ["Nan0", "no", "infinite", "1e", "-"] {
        let error = File::new().with("extras", format!("[{other}]")).error();
        assert!(!error.contains("no number") && error.contains("the JSON"), "{other}: {error}");
    }
}

#[test]
fn matrices_may_be_rounded() {
    let node = |last: [&str; 4]| {
        let [x, y, z, w] = last;
        let matrix = format!("[2,0,0,{x}, 0,2,0,{y}, 0,0,2,{z}, 5,6,7,{w}]");
        File::new().with("nodes", format!(r#"[{{"mesh": 0, "matrix": {matrix}}}]"#))
    };
    for last in [["0", "0", "0", "0.99999994"], ["1e-9", "0", "-3e-8", "1.00005"]] {
        let (builder, report) = node(last).load();
        assert_eq!(builder.meshes[0].positions, [[5., 6., 7.], [7., 6., 7.], [5., 8., 7.]]);
        assert!(says(&report, "node 0", "nearly 0 0 0 1") && report.is_exact(), "{report}");
    }
    assert!(node(["0", "0", "0", "1"]).load().1.lines.is_empty());
    for last in [["0", "0", "0", "1.001"], ["0", "0.001", "0", "1"]] {
        assert!(node(last).error().contains("last row"), "{last:?}");
    }
}

#[test]
fn backslashes_are_slashes() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("textures")).unwrap();
    std::fs::write(folder.path().join("textures/a b.png"), png(&[[255, 0, 0, 255]])).unwrap();
    let material = r#""pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}"#;
    let load = |uri: &str| {
        let file = File::new().material(material).with("textures", r#"[{"source": 0}]"#);
        let file = file.with("images", format!(r#"[{{"uri": "{uri}"}}]"#));
        assemble(file.json().as_bytes(), folder.path()).unwrap()
    };
    for (uri, is_noted) in [
        (r"textures\\a b.png", true),
        ("textures%5Ca%20b.png", true),
        (r".\\textures%5ca b.png", true),
        ("textures/a%20b.png", false),
    ] {
        let (_, report) = load(uri);
        assert!(report.is_exact(), "{uri}: {report}");
        assert_eq!(report.to_string().contains("backslashes"), is_noted, "{uri}: {report}");
    }
    for (uri, part) in [(r"textures\\none.png", "does not exist"), (r"..\\a.png", "outside"), ("..%5Ca.png", "outside")]
    {
        let (_, report) = load(uri);
        assert!(!report.is_exact() && report.to_string().contains(part), "{uri}: {report}");
    }
}

/// Four vertices, of which the last is used by no triangle, and has no place.
#[test]
fn vertices_that_no_triangle_has_are_left_out() {
    let mut data = floats(&[f32::NAN, 0., 0., 0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    for index in [1_u16, 2, 3] {
        data.extend(index.to_le_bytes());
    }
    let views = r#"[{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 6}]"#;
    let accessors = r#"[{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
        {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}]"#;
    let file = File::new().data(&data).with("bufferViews", views).with("accessors", accessors);
    let mesh = &file.load().0.meshes[0];
    assert_eq!(mesh.positions, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
}

#[test]
fn what_is_not_rendered_is_reported() {
    let hidden =
        r#"[{"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": false}}}, {"mesh": 0}, {"mesh": 0}, {}]"#;
    let (_, report) = File::new().with("nodes", hidden).with("scenes", r#"[{"nodes": [0, 1]}]"#).load();
    assert!(says(&report, "the file", "2 nodes with meshes"), "{report}");
    let without =
        r#"[{"primitives": [{"attributes": {"NORMAL": 0}, "material": 0}, {"attributes": {"POSITION": 0}}]}]"#;
    let (_, report) = File::new().with("meshes", without).load();
    assert!(says(&report, "mesh 0 primitive 0", "no POSITION") && !report.is_exact(), "{report}");
    // Extensions that are not declared.
    let instances = r#"[{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {}}}}]"#;
    let (_, report) = File::new().with("nodes", instances).load();
    assert!(says(&report, "the file", "EXT_mesh_gpu_instancing") && !report.is_exact(), "{report}");
    let declared =
        File::new().with("nodes", instances).with("extensionsUsed", r#"["EXT_mesh_gpu_instancing"]"#).load().1;
    assert_eq!(declared.lines.iter().filter(|line| line.text.contains("EXT_mesh_gpu_instancing")).count(), 1);
    let named = r#"[{"mesh": 0, "extras": {"extensions": {"mine": 1}}}]"#;
    assert!(File::new().with("nodes", named).load().1.lines.is_empty());
}

/// Small files that stand for much: the same zeros, indices or images again and again.
#[test]
fn repetition_has_a_limit() {
    let nodes = [r#"{"mesh": 0}"#; 3].join(",");
    let zeros = File::new()
        .with("nodes", format!("[{nodes}]"))
        .without("scenes")
        .with("meshes", r#"[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]"#)
        .with("accessors", r#"[{"componentType": 5126, "count": 1500000, "type": "VEC3"}]"#);
    let error = zeros.error();
    assert!(error.contains("accessor 0") && error.contains("over 4194304"), "{error}");
    // Instances of what the file has: 256 vertices and indices for each of its bytes.
    assert_eq!(super::super::meshes::most_elements(1000), 1 << 25);
    assert_eq!(super::super::meshes::most_elements(1 << 18), 1 << 26);
    assert_eq!(super::super::meshes::most_elements(1 << 40), 1 << 28);
}

/// One image under many names, by data and by view, is decoded once.
#[test]
fn images_of_many_names_are_one() {
    let uri = data_uri("image/png", &png(&[[255, 0, 0, 255], [0, 0, 255, 255]]));
    let image = format!(r#"{{"uri": "{uri}"}}"#);
    let names = ["baseColorTexture", "metallicRoughnessTexture"];
    let slots: Vec<String> =
        names.iter().enumerate().map(|(at, name)| format!(r#""{name}": {{"index": {at}}}"#)).collect();
    let file = File::new()
        .material(&format!(r#""pbrMetallicRoughness": {{{}}}"#, slots.join(",")))
        .with("textures", r#"[{"source": 0}, {"source": 1, "name": "again"}]"#)
        .with("images", format!("[{image}, {image}]"));
    let (builder, _) = file.load();
    let texels: Vec<_> = builder.textures.iter().map(|desc| desc.image.texels.as_ptr()).collect();
    assert_eq!(texels.len(), 2);
    assert_eq!(texels[0], texels[1]);
}
