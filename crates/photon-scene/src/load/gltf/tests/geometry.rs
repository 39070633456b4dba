//! Nodes, primitives and accessors.

use super::file::{File, floats, glb, says};
use crate::describe::MaterialDesc;
use crate::mesh::Mesh;

#[track_caller]
fn only_mesh(file: &File) -> Mesh {
    let (builder, _) = file.load();
    assert_eq!(builder.meshes.len(), 1);
    builder.meshes[0].clone()
}

/// Largest difference of any coordinate.
fn distance(mesh: &Mesh, expected: &[[f64; 3]]) -> f64 {
    assert_eq!(mesh.positions.len(), expected.len());
    let pairs = mesh.positions.as_flattened().iter().zip(expected.as_flattened());
    pairs.map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max)
}

#[test]
fn the_plain_triangle_is_read_as_it_is() {
    let mesh = only_mesh(&File::new());
    assert_eq!(mesh.positions, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(&*mesh.name, "tri");
    let (_, report) = File::new().material(r#""pbrMetallicRoughness": {"metallicFactor": 0}"#).load();
    assert!(report.is_exact(), "{report}");
}

#[test]
fn a_glb_holds_its_buffer() {
    let mut bin = floats(&[0., 0., 0., 2., 0., 0., 0., 2., 0.]);
    bin.extend([0, 0, 1, 0, 2, 0]);
    let json = File::new().with("buffers", r#"[{"byteLength": 42}]"#).json();
    let (builder, _) = super::super::assemble(&glb(&json, &bin), ".".as_ref()).unwrap();
    assert_eq!(builder.meshes[0].positions[1], [2., 0., 0.]);
    // Trailing bytes, and chunks of other types, are skipped.
    let mut longer = glb(&json, &bin);
    longer.extend(b"junk");
    assert!(super::super::assemble(&longer, ".".as_ref()).is_ok());
}

#[test]
fn transforms_are_chained_from_the_root() {
    // A quarter turn about z, scaled by two, then translated; the parent translates by (0, 0, 10).
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let file = File::new().with(
        "nodes",
        format!(
            r#"[{{"children": [1], "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,10,1]}},
                {{"mesh": 0, "name": "child", "translation": [5, 0, 0], "rotation": [0, 0, {h}, {h}], "scale": [2, 2, 2]}}]"#
        ),
    );
    let mesh = only_mesh(&file);
    assert!(distance(&mesh, &[[5., 0., 10.], [5., 2., 10.], [3., 0., 10.]]) < 1e-12, "{mesh:?}");
    assert_eq!(&*mesh.name, "child");
}

#[test]
fn mirrored_meshes_keep_their_front() {
    for (scale, expected) in
        [("[-1, 1, 1]", [0, 2, 1]), ("[-1, -1, 1]", [0, 1, 2]), ("[1e-30, -1e-30, 1e-30]", [0, 2, 1])]
    {
        let file = File::new().with("nodes", format!(r#"[{{"mesh": 0, "scale": {scale}}}]"#));
        assert_eq!(only_mesh(&file).triangles, [expected], "{scale}");
    }
}

#[test]
fn a_mesh_is_added_once_for_each_node_and_not_where_it_is_scaled_to_nothing() {
    let file = File::new()
        .with("nodes", r#"[{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "translation": [0, 0, 1]}, {"mesh": 0, "name": "c", "scale": [0, 0, 0]}]"#)
        .with("scenes", r#"[{"nodes": [0, 1, 2]}]"#);
    let (builder, report) = file.load();
    let names: Vec<&str> = builder.meshes.iter().map(|mesh| &*mesh.name).collect();
    assert_eq!(names, ["a", "b"]);
    assert!(says(&report, "'c'", "scaled to zero"));
}

#[test]
fn the_default_scene_else_the_first_else_all_roots() {
    let nodes = r#"[{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b"}]"#;
    let scenes = r#"[{"nodes": [0]}, {"nodes": [1], "name": "second"}]"#;
    let file = File::new().with("nodes", nodes).with("scenes", scenes);
    assert_eq!(&*only_mesh(&file).name, "a");
    let chosen = file.clone().with("scene", "1");
    assert_eq!(&*only_mesh(&chosen).name, "b");
    assert!(says(&chosen.load().1, "file", "second"));
    assert_eq!(file.without("scenes").load().0.meshes.len(), 2);
    // A scene need not have nodes.
    assert!(File::new().with("scenes", "[{}]").load().0.meshes.is_empty());
}

#[test]
fn indices_may_be_of_any_unsigned_type_or_none() {
    for (kind, bytes) in
        [(5121, vec![2, 0, 1]), (5123, vec![2, 0, 0, 0, 1, 0]), (5125, vec![2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0])]
    {
        let mut data = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
        data.extend(&bytes);
        let file = File::new()
            .data(&data)
            .with("bufferViews", format!(r#"[{{"buffer": 0, "byteLength": 36}}, {{"buffer": 0, "byteOffset": 36, "byteLength": {}}}]"#, bytes.len()))
            .with("accessors", format!(r#"[{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}, {{"bufferView": 1, "componentType": {kind}, "count": 3, "type": "SCALAR"}}]"#));
        assert_eq!(only_mesh(&file).triangles, [[2, 0, 1]], "{kind}");
    }
    let bare = File::new().with("meshes", r#"[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]"#);
    assert_eq!(only_mesh(&bare).triangles, [[0, 1, 2]]);
}

#[test]
fn views_may_be_interleaved() {
    let data = floats(&[9., 0., 0., 0., 9., 1., 0., 0., 9., 0., 1., 0.]);
    let file = File::new()
        .data(&data)
        .with("bufferViews", r#"[{"buffer": 0, "byteLength": 48, "byteStride": 16}]"#)
        .with("accessors", r#"[{"bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 3, "type": "VEC3"}]"#)
        .with("meshes", r#"[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]"#);
    assert_eq!(only_mesh(&file).positions, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
}

#[test]
fn sparse_accessors_replace_elements_or_zeros() {
    // Sparse: element 2 becomes (0, 7, 0). With base data the others are the triangle's, without they are zero.
    let mut data = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 7., 0.]);
    data.extend([2, 0, 0, 0]);
    for (base, second) in [(r#""bufferView": 0,"#, 1.0), ("", 0.0)] {
        let file = File::new()
            .data(&data)
            .with("bufferViews", r#"[{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12}, {"buffer": 0, "byteOffset": 48, "byteLength": 1}]"#)
            .with("accessors", format!(r#"[{{{base} "componentType": 5126, "count": 3, "type": "VEC3",
                "sparse": {{"count": 1, "indices": {{"bufferView": 2, "componentType": 5121}}, "values": {{"bufferView": 1}}}}}}]"#))
            .with("meshes", r#"[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]"#);
        assert_eq!(only_mesh(&file).positions, [[0., 0., 0.], [second, 0., 0.], [0., 7., 0.]]);
    }
}

#[test]
fn quantised_positions_are_read() {
    let mut data: Vec<u8> = Vec::new();
    for value in [0_i16, 0, 0, 32767, 0, 0, 0, -32768, 0] {
        data.extend(value.to_le_bytes());
    }
    for (normalized, expected) in [("true", [1.0, -1.0]), ("false", [32767.0, -32768.0])] {
        let file = File::new()
            .data(&data)
            .with("extensionsRequired", r#"["KHR_mesh_quantization"]"#)
            .with("bufferViews", r#"[{"buffer": 0, "byteLength": 18}]"#)
            .with("accessors", format!(r#"[{{"bufferView": 0, "componentType": 5122, "normalized": {normalized}, "count": 3, "type": "VEC3"}}]"#))
            .with("meshes", r#"[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]"#);
        let [x, y] = expected;
        assert_eq!(only_mesh(&file).positions, [[0., 0., 0.], [x, 0., 0.], [0., y, 0.]]);
    }
}

#[test]
fn points_and_lines_are_reported_and_stray_vertices_too() {
    let mesh = |mode: u32| {
        format!(
            r#"[{{"name": "m", "primitives": [{{"attributes": {{"POSITION": 0}}, "material": 0, "mode": {mode}}}]}}]"#
        )
    };
    for mode in 0..4 {
        let (builder, report) = File::new().with("meshes", mesh(mode)).load();
        assert!(builder.meshes.is_empty() && says(&report, "mesh 0 'm' primitive 0", "no surface"));
    }
    for mode in 4..7 {
        assert_eq!(only_mesh(&File::new().with("meshes", mesh(mode))).triangles.len(), 1, "{mode}");
    }
    let file = File::new()
        .with("meshes", mesh(4))
        .with("accessors", r#"[{"bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3"}]"#);
    let (builder, report) = file.load();
    assert!(builder.meshes[0].triangles.is_empty() && says(&report, "mesh 0", "2 vertices at its end"));
}

#[test]
fn what_meshes_lose_is_said_once() {
    let mesh = |attributes: &str| format!(r#"[{{"primitives": [{{"attributes": {{"POSITION": 0, {attributes}}}}}]}}]"#);
    let file = File::new()
        .with("meshes", mesh(r#""NORMAL": 0"#))
        .with("nodes", r#"[{"mesh": 0, "skin": 0}]"#)
        .with("skins", r#"[{"joints": [0]}]"#)
        .with("animations", r#"[{"channels": [{"sampler": 0, "target": {"path": "pointer"}}], "samplers": []}]"#)
        .with("extensionsUsed", r#"["EXT_mesh_gpu_instancing"]"#);
    let (builder, report) = file.load();
    for (subject, text) in [
        ("file", "an animation"),
        ("file", "EXT_mesh_gpu_instancing"),
        ("mesh 0 primitive 0", "a skin, but no JOINTS_0"),
    ] {
        assert!(says(&report, subject, text), "{text}: {report}");
    }
    // The format's default is a rough white metal, which is not an approximation.
    let default = builder.materials.iter().find(|material| material.name == "default").unwrap();
    assert_eq!(*default, MaterialDesc::metal("default", [1.0; 3], 1.0));
    assert!(!report.to_string().contains("no material"), "{report}");
}

#[test]
fn hidden_nodes_are_left_out_with_their_children() {
    let hide = |visible: bool| format!(r#""extensions": {{"KHR_node_visibility": {{"visible": {visible}}}}}"#);
    for visible in [true, false] {
        let nodes = format!(r#"[{{"children": [1], {}}}, {{"mesh": 0, "name": "child"}}]"#, hide(visible));
        let file = File::new().with("nodes", nodes).with("extensionsRequired", r#"["KHR_node_visibility"]"#);
        assert_eq!(file.load().0.meshes.len(), usize::from(visible));
    }
}
