//! Damaged files: each is rejected with an error that names the object at fault.

use std::path::Path;

use super::super::assemble;
use super::file::{File, floats};

const HERE: &str = ".";

#[track_caller]
fn check(file: &File, words: &[&str]) {
    let error = file.error();
    assert!(words.iter().all(|word| error.contains(word)), "{words:?} not all in: {error}");
    assert!(error.contains("; "), "no hint in: {error}");
}

#[test]
fn nodes_must_be_a_tree() {
    let nodes = |json: &str| File::new().with("nodes", json);
    check(&nodes(r#"[{"children": [1]}, {"children": [0], "name": "b"}]"#), &["node 0", "ancestor of itself"]);
    check(&nodes(r#"[{}, {"children": [1]}]"#), &["node 1", "ancestor of itself"]);
    check(&nodes(r#"[{"children": [2]}, {"children": [2]}, {"name": "c"}]"#), &["node 2 'c'", "node 0", "node 1"]);
    check(&nodes(r#"[{"children": [1, 1]}, {}]"#), &["node 1", "child of both"]);
    check(&nodes(r#"[{"children": [9]}]"#), &["node 0", "node 9"]);
    check(&nodes("[{}]").with("scenes", r#"[{"nodes": [0, 0]}]"#), &["node 0", "twice"]);
    check(&nodes(r#"[{"children": [1]}, {}]"#).with("scenes", r#"[{"nodes": [0, 1]}]"#), &["node 1", "twice"]);
    check(&nodes("[{}]").with("scenes", r#"[{"nodes": [3], "name": "s"}]"#), &["scene 0 's'", "node 3"]);
    check(&File::new().with("scene", "5"), &["default scene", "scene 5"]);
    // A deep chain is processed neither recursively nor slowly.
    let chain: Vec<String> = (1..100_000).map(|child| format!(r#"{{"children": [{child}]}}"#)).collect();
    let deep = nodes(&format!("[{}, {{\"mesh\": 0}}]", chain.join(",")));
    assert_eq!(deep.load().0.meshes.len(), 1);
}

#[test]
fn transforms_must_make_sense() {
    let node = |json: &str| File::new().with("nodes", format!(r#"[{{"mesh": 0, "name": "n", {json}}}]"#));
    check(&node(r#""rotation": [0, 0, 0, 0]"#), &["node 0 'n'", "quaternion"]);
    check(&node(r#""translation": [1e39, 0, 0]"#), &["node 0 'n'", "not finite"]);
    check(&node(r#""matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2]"#), &["node 0 'n'", "last row"]);
}

#[test]
fn references_must_lead_somewhere() {
    let mesh = |json: &str| File::new().with("meshes", format!(r#"[{{"name": "m", "primitives": [{{{json}}}]}}]"#));
    check(&File::new().with("nodes", r#"[{"mesh": 4}]"#), &["node 0", "mesh 4"]);
    check(&mesh(r#""attributes": {"POSITION": 7}"#), &["mesh 0 'm' primitive 0", "accessor 7"]);
    check(&mesh(r#""attributes": {"POSITION": 0}, "indices": 8"#), &["mesh 0 'm' primitive 0", "accessor 8"]);
    check(&mesh(r#""attributes": {"POSITION": 0}, "material": 3"#), &["mesh 0 'm' primitive 0", "material 3"]);
    check(&mesh(r#""attributes": {"POSITION": 0}, "mode": 9"#), &["mesh 0 'm' primitive 0", "mode"]);
    check(&mesh(r#""attributes": {"POSITION": 1}"#), &["accessor 1", "Vec3"]);
    check(&mesh(r#""attributes": {"POSITION": 0}, "indices": 0"#), &["accessor 0", "component type"]);
    check(
        &mesh(r#""attributes": {"POSITION": 4294967296}"#),
        &["meshes/0/primitives/0/attributes/POSITION", "4294967295"],
    );
    check(&mesh(r#""attributes": {"POSITION": 0}, "material": -1"#), &["number 0 of meshes", "-1"]);
    check(&File::new().with("bufferViews", "[]"), &["accessor 0", "buffer view 0"]);
    check(&File::new().with("buffers", "[]"), &["buffer view 0", "buffer 0"]);
    check(&File::new().with("buffers", r#"[{"byteLength": 44}]"#), &["buffer 0", "no URI"]);
}

#[test]
fn data_must_be_there() {
    let view = |json: &str| File::new().with("bufferViews", json);
    let accessor = |json: &str| {
        File::new()
            .with("accessors", format!("[{json}]"))
            .with("meshes", r#"[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]"#)
    };
    check(&view(r#"[{"buffer": 0, "byteLength": 99}]"#), &["buffer view 0", "99 bytes", "44"]);
    check(&view(r#"[{"buffer": 0, "byteLength": 2, "byteOffset": 18446744073709551615}]"#), &["buffer view 0"]);
    check(&view(r#"[{"buffer": 0, "byteLength": 35}]"#), &["accessor 0", "36 bytes", "35"]);
    check(&view(r#"[{"buffer": 0, "byteLength": 36, "byteStride": 0}]"#), &["accessor 0", "0 apart"]);
    check(
        &accessor(r#"{"bufferView": 0, "componentType": 5126, "count": 18446744073709551615, "type": "VEC3"}"#),
        &["mesh 0 primitive 0", "33554432"],
    );
    check(
        &accessor(r#"{"bufferView": 0, "componentType": 5126, "count": 10000000, "type": "VEC3"}"#),
        &["accessor 0", "120000000 bytes"],
    );
    check(
        &accessor(
            r#"{"bufferView": 0, "componentType": 5126, "count": 1, "byteOffset": 18446744073709551615, "type": "VEC3"}"#,
        ),
        &["accessor 0"],
    );
    check(&accessor(r#"{"componentType": 5126, "count": 10000000, "type": "VEC3"}"#), &["accessor 0", "no data"]);
    check(
        &accessor(r#"{"bufferView": 0, "componentType": 1, "count": 1, "type": "VEC3"}"#),
        &["accessor 0", "component type"],
    );
    check(
        &accessor(r#"{"bufferView": 0, "componentType": 5126, "count": 1, "type": "VEC9"}"#),
        &["accessor 0", "Vec3"],
    );
    let sparse = |indices: &str, values: &str, count: u64| {
        accessor(&format!(
            r#"{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "sparse": {{"count": {count}, "indices": {indices}, "values": {values}}}}}"#
        ))
    };
    let good = r#"{"bufferView": 1, "componentType": 5123}"#;
    check(&sparse(good, r#"{"bufferView": 0}"#, 4), &["accessor 0", "8 bytes", "6"]);
    check(&sparse(good, r#"{"bufferView": 5}"#, 1), &["accessor 0", "buffer view 5"]);
    check(
        &sparse(r#"{"bufferView": 0, "byteOffset": 14, "componentType": 5123}"#, r#"{"bufferView": 0}"#, 1),
        &["accessor 0", "replaces element 16256"],
    );
    check(&sparse(r#"{"bufferView": 0, "componentType": 5126}"#, r#"{"bufferView": 0}"#, 1), &["accessor 0", "sparse"]);
}

#[test]
fn vertices_must_be_somewhere_and_indices_in_range() {
    for bad in [f32::NAN, f32::INFINITY] {
        let mut data = floats(&[0., 0., 0., 1., bad, 0., 0., 1., 0.]);
        data.extend([0, 0, 1, 0, 2, 0]);
        check(&File::new().data(&data), &["mesh 0 'tri' primitive 0", "vertex 1", "finite"]);
        // One that no triangle uses may be anything.
        let end = data.len() - 6;
        data[end..].copy_from_slice(&[0, 0, 2, 0, 2, 0]);
        let (builder, _) = File::new().data(&data).load();
        assert!(builder.build().is_ok());
    }
    let mut data = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    data.extend([0, 0, 1, 0, 3, 0]);
    check(&File::new().data(&data), &["mesh 0 'tri' primitive 0", "index 2", "triangle 0", "vertex 3", "there are 3"]);
}

#[test]
fn instances_cannot_ask_for_all_the_memory() {
    let nodes = vec![r#"{"mesh": 0}"#; 100].join(",");
    let file = File::new()
        .with("nodes", format!("[{nodes}]"))
        .without("scenes")
        .with("meshes", r#"[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0, "mode": 5}]}]"#)
        .with("accessors", r#"[{"componentType": 5126, "count": 300000000, "type": "VEC3"}]"#);
    check(&file, &["mesh 0 primitive 0", "leave out instances"]);
}

#[test]
fn buffers_must_be_there_whole() {
    let buffer = |json: &str| File::new().with("buffers", format!("[{json}]"));
    check(
        &buffer(r#"{"byteLength": 44, "uri": "no such file.bin"}"#),
        &["buffer 0", "no such file.bin", "does not exist"],
    );
    check(&buffer(r#"{"byteLength": 44, "uri": "https://example.org/a.bin"}"#), &["buffer 0", "https", "download"]);
    check(&buffer(r#"{"byteLength": 44, "uri": "data:;base64,AAAA"}"#), &["buffer 0", "44 bytes", "has 3"]);
    check(&buffer(r#"{"byteLength": 44, "uri": "data:;base64,A*AA"}"#), &["buffer 0", "damaged"]);
    check(&buffer(r#"{"byteLength": 44, "uri": "data:nothing"}"#), &["buffer 0", "damaged"]);
}

#[test]
fn documents_must_be_gltf_2() {
    for (bytes, words) in [
        (&b"{"[..], &["JSON", "line 1"][..]),
        (b"not json", &["JSON", "line 1"]),
        (b"[]", &["JSON"]),
        (b"{}", &["JSON", "asset"]),
        (b"{\"asset\": {\"version\": \"2.0\"}, \"nodes\": 3}", &["nodes: invalid type"]),
        (
            b"{\"asset\": {\"version\": \"2.0\"}, \"scenes\": [{}], \"nodes\": [{}, {\"mesh\": \"a\"}]}",
            &["number 1 of nodes", "string"],
        ),
        (b"glTF", &["GLB header", "12 bytes"]),
        (b"glTF\x01\0\0\0\x0c\0\0\0", &["version 1"]),
        (b"glTF\x02\0\0\0\x05\0\0\0", &["GLB chunk", "0 are left"]),
        (b"glTF\x02\0\0\0\x0c\0\0\0", &["GLB chunk", "0 are left"]),
        (b"glTF\x02\0\0\0\xff\0\0\0", &["255 bytes", "has 12"]),
        (b"glTF\x02\0\0\0\x14\0\0\0\0\0\0\0BIN\0", &["first GLB chunk"]),
        (b"glTF\x02\0\0\0\x14\0\0\0\xff\xff\xff\xffJSON", &["4294967295 bytes"]),
    ] {
        let Err(fault) = assemble(bytes, Path::new(HERE)) else { panic!("{bytes:?}") };
        let error = fault.to_string();
        let file = fault.in_file(Path::new("some.gltf")).to_string();
        assert!(file.starts_with("some.gltf") && file.contains("; "), "{file}");
        assert!(words.iter().all(|word| error.contains(word) || file.contains(word)), "{words:?}: {file}");
    }
    check(&File::new().with("asset", r#"{"version": "1.0"}"#), &["version 1.0"]);
    check(&File::new().with("asset", r#"{"version": "2.1", "minVersion": "2.1"}"#), &["version 2.1"]);
    assert!(File::new().with("asset", r#"{"version": "2.1"}"#).try_load().is_ok());
    let mut marked = b"\xef\xbb\xbf".to_vec();
    marked.extend(File::new().json().as_bytes());
    assert!(assemble(&marked, Path::new(HERE)).is_ok());
}

#[test]
fn required_extensions_must_be_known() {
    let requires = |name: &str| File::new().with("extensionsRequired", format!(r#"["{name}"]"#));
    check(&requires("KHR_draco_mesh_compression"), &["KHR_draco_mesh_compression", "without Draco"]);
    check(&requires("EXT_mesh_gpu_instancing"), &["EXT_mesh_gpu_instancing", "instances real"]);
    check(&requires("EXT_lights_image_based"), &["EXT_lights_image_based", "--environment"]);
    check(&requires("ACME_rocket"), &["ACME_rocket", "without it"]);
    for name in
        ["KHR_materials_volume", "KHR_materials_transmission", "KHR_texture_transform", "EXT_meshopt_compression"]
    {
        assert!(requires(name).try_load().is_ok(), "{name}");
    }
}
