//! Skins and morph targets in the default pose.

use super::file::{File, floats, says};
use crate::mesh::Mesh;

/// A buffer and its views and accessors, filled one by one.
#[derive(Default)]
struct Data {
    bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Data {
    fn add(&mut self, bytes: &[u8], count: usize, kind: &str) -> &mut Self {
        let (view, offset) = (self.views.len(), self.bytes.len());
        self.views.push(format!(r#"{{"buffer": 0, "byteOffset": {offset}, "byteLength": {}}}"#, bytes.len()));
        self.accessors.push(format!(r#"{{"bufferView": {view}, "count": {count}, {kind}}}"#));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self
    }

    fn floats(&mut self, values: &[f32], count: usize, shape: &str) -> &mut Self {
        self.add(&floats(values), count, &format!(r#""componentType": 5126, "type": "{shape}""#))
    }

    fn file(&self) -> File {
        File::new()
            .data(&self.bytes)
            .material(DIFFUSE)
            .with("bufferViews", format!("[{}]", self.views.join(",")))
            .with("accessors", format!("[{}]", self.accessors.join(",")))
    }
}

const DIFFUSE: &str = r#""pbrMetallicRoughness": {"metallicFactor": 0}"#;
const JOINTS: &str = r#""componentType": 5121, "type": "VEC4""#;

/// A triangle (0,0,0), (2,0,0), (1,1,0): the first corner follows joint 0, which rests, the second joint 1, which is
/// turned by 90° about z at (1,0,0), the third follows `numbers` with `weights`.
fn skinned(numbers: [u8; 4], weights: [f32; 4]) -> File {
    let [a, b, c, d] = weights;
    let mut data = Data::default();
    data.floats(&[0., 0., 0., 2., 0., 0., 1., 1., 0.], 3, "VEC3")
        .floats(&[0., 0., 1., 1., 0., 0., 0., 2., 0.], 3, "VEC3")
        .add(&[[0, 0, 0, 0], [1, 0, 0, 0], numbers].concat(), 3, JOINTS)
        .floats(&[1., 0., 0., 0., 1., 0., 0., 0., a, b, c, d], 3, "VEC4");
    let mut matrices = [0.0_f32; 32];
    (0..2).for_each(|joint| (0..4).for_each(|axis| matrices[16 * joint + 5 * axis] = 1.0));
    matrices[16 + 12] = -1.0;
    data.floats(&matrices, 2, "MAT4");
    let half = std::f64::consts::FRAC_1_SQRT_2;
    data.file()
        .with("meshes", mesh(r#""POSITION": 0, "NORMAL": 1, "JOINTS_0": 2, "WEIGHTS_0": 3"#))
        .with("skins", r#"[{"name": "s", "joints": [1, 2], "inverseBindMatrices": 4}]"#)
        .with(
            "nodes",
            // The transform of the node of a skinned mesh has no effect.
            format!(
                r#"[{{"mesh": 0, "skin": 0, "scale": [0, 0, 0]}}, {{"children": [2]}},
                    {{"translation": [1, 0, 0], "rotation": [0, 0, {half}, {half}]}}]"#
            ),
        )
        .with("scenes", r#"[{"nodes": [0, 1]}]"#)
}

fn mesh(attributes: &str) -> String {
    format!(r#"[{{"name": "m", "primitives": [{{"attributes": {{{attributes}}}, "material": 0}}]}}]"#)
}

fn is_near<const N: usize>(found: &[[f64; N]], expected: &[[f64; N]]) -> bool {
    let pairs = || found.as_flattened().iter().zip(expected.as_flattened());
    found.len() == expected.len() && pairs().all(|(found, expected)| (found - expected).abs() < 1e-6)
}

#[track_caller]
fn only_mesh(file: &File) -> Mesh {
    let (builder, report) = file.load();
    assert!(report.is_exact(), "{report}");
    builder.meshes[0].clone()
}

#[test]
fn vertices_follow_the_mean_of_their_joints() {
    // Joint 0 leaves (1,1,0) there; joint 1 turns it about (1,0,0) to (0,0,0).
    let posed = only_mesh(&skinned([0, 1, 0, 0], [0.5, 0.5, 0.0, 0.0]));
    assert!(is_near(&posed.positions, &[[0., 0., 0.], [1., 1., 0.], [0.5, 0.5, 0.]]), "{posed:?}");
    assert_eq!(posed.triangles, [[0, 1, 2]]);
    let normals: Vec<[f64; 3]> = posed.attributes.normals;
    // The mean of the identity and a quarter turn is a turn by 45°, scaled by √½: so is its cofactor matrix.
    assert!(is_near(&normals[..2], &[[0., 0., 1.], [0., 1., 0.]]), "{normals:?}");
    let [x, y, z] = normals[2];
    assert!((x + y).abs() < 1e-6 && y > 0.5 && z == 0.0, "{normals:?}");
    // A joint with all of the weight.
    let posed = only_mesh(&skinned([1, 7, 0, 0], [1.0, 0.0, 0.0, 0.0]));
    assert!(is_near(&posed.positions, &[[0., 0., 0.], [1., 1., 0.], [0., 0., 0.]]), "{posed:?}");
}

#[test]
fn inverse_bind_matrices_are_the_identity_by_default() {
    let file = skinned([0, 1, 0, 0], [0.5, 0.5, 0.0, 0.0]).with("skins", r#"[{"joints": [1, 2]}]"#);
    assert!(is_near(&only_mesh(&file).positions, &[[0., 0., 0.], [1., 2., 0.], [0.5, 1., 0.]]));
}

#[test]
fn every_set_of_joints_counts_and_weights_may_be_integers() {
    let mut data = Data::default();
    let half = [128, 0, 0, 0].repeat(3);
    let weights = r#""componentType": 5121, "normalized": true, "type": "VEC4""#;
    data.floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.], 3, "VEC3").add(&[0; 12], 3, JOINTS).add(&half, 3, weights).add(
        &[1, 0, 0, 0].repeat(3),
        3,
        JOINTS,
    );
    let file = data
        .file()
        .with("meshes", mesh(r#""POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2, "JOINTS_1": 3, "WEIGHTS_1": 2"#))
        .with("skins", r#"[{"joints": [1, 2]}]"#)
        .with("nodes", r#"[{"mesh": 0, "skin": 0}, {}, {"translation": [0, 0, 4]}]"#);
    // 256/255 in all: scaled to 1 without a word, since that is rounding.
    assert!(is_near(&only_mesh(&file).positions, &[[0., 0., 2.], [1., 0., 2.], [0., 1., 2.]]));
}

#[test]
fn mirrored_joints_keep_the_front() {
    let file = skinned([0, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]).with(
        "nodes",
        r#"[{"mesh": 0, "skin": 0}, {"scale": [-1, 1, 1], "children": [2]}, {"translation": [1, 0, 0]}]"#,
    );
    let posed = only_mesh(&file);
    assert_eq!(posed.triangles, [[0, 2, 1]]);
    assert!(is_near(&posed.positions, &[[0., 0., 0.], [-2., 0., 0.], [-1., 1., 0.]]), "{posed:?}");
    assert!(is_near(&posed.attributes.normals[..2], &[[0., 0., 1.], [-1., 0., 0.]]), "{posed:?}");
}

#[test]
fn invalid_skins_are_refused_or_reported() {
    let good = || skinned([0, 1, 0, 0], [0.5, 0.5, 0.0, 0.0]);
    for (file, words) in [
        (skinned([0, 2, 0, 0], [0.5, 0.5, 0.0, 0.0]), ["vertex 2", "joint 2 of skin 0 's', but there are 2"]),
        (skinned([0, 1, 0, 0], [f32::NAN, 0.5, 0.0, 0.0]), ["vertex 2", "NaN"]),
        (skinned([0, 1, 0, 0], [-0.5, 1.5, 0.0, 0.0]), ["vertex 2", "-0.5"]),
        (skinned([0, 1, 0, 0], [f32::INFINITY, 0.5, 0.0, 0.0]), ["vertex 2", "inf"]),
        (good().with("skins", "[]"), ["node 0", "skin 0"]),
        (good().with("skins", r#"[{"joints": []}]"#), ["skin 0", "no joints"]),
        (good().with("skins", r#"[{"joints": [1, 9]}]"#), ["skin 0", "node 9"]),
        (good().with("skins", r#"[{"joints": [1, 2, 0], "inverseBindMatrices": 4}]"#), ["3 joints", "2 inverse bind"]),
        (good().with("skins", r#"[{"joints": [1, 2], "inverseBindMatrices": 0}]"#), ["accessor 0", "Mat4"]),
        (good().with("meshes", mesh(r#""POSITION": 0, "JOINTS_0": 2"#)), ["JOINTS_0", "no WEIGHTS_0"]),
        (good().with("meshes", mesh(r#""POSITION": 0, "WEIGHTS_0": 3"#)), ["WEIGHTS_0", "no JOINTS_0"]),
        (good().with("meshes", mesh(r#""POSITION": 0, "JOINTS_0": 3, "WEIGHTS_0": 3"#)), ["accessor 3", "component"]),
        (
            good()
                .with("nodes", r#"[{"mesh": 0, "skin": 0}, {"children": [2]}, {}, {"translation": [1e39, 0, 0]}]"#)
                .with("skins", r#"[{"joints": [1, 3]}]"#),
            ["skin 0", "not finite"],
        ),
    ] {
        let error = file.error();
        assert!(words.iter().all(|word| error.contains(word)), "{words:?} not all in: {error}");
    }
    let (builder, report) = skinned([0, 1, 0, 0], [0.0; 4]).load();
    assert!(says(&report, "mesh 0 'm'", "1 vertices have no joint weights"), "{report}");
    assert!(is_near(&builder.meshes[0].positions[2..], &[[1., 1., 0.]]));
    let (builder, report) = skinned([0, 1, 0, 0], [2.0, 2.0, 0.0, 0.0]).load();
    assert!(says(&report, "mesh 0 'm'", "of 1 vertices do not add up to 1"), "{report}");
    assert!(is_near(&builder.meshes[0].positions[2..], &[[0.5, 0.5, 0.]]));
}

/// A triangle with two targets: one lifts the third corner and turns its normal and tangent, one moves all.
fn morphed(weights: &str, node: &str) -> File {
    let mut data = Data::default();
    data.floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.], 3, "VEC3")
        .floats(&[0., 0., 1., 0., 0., 1., 0., 0., 1.], 3, "VEC3")
        .floats(&[0., 0., 0., 0., 0., 0., 0., 0., 2.], 3, "VEC3")
        .floats(&[10., 0., 0., 10., 0., 0., 10., 0., 0.], 3, "VEC3")
        .floats(&[1., 0., 0., -1., 1., 0., 0., -1., 1., 0., 0., -1.], 3, "VEC4")
        .floats(&[0.; 6], 3, "VEC2");
    data.file()
        .with("materials", format!(r#"[{{{DIFFUSE}, "normalTexture": {{"index": 0}}}}]"#))
        .with("textures", "[{\"source\": 0}]")
        .with(
            "images",
            format!(
                r#"[{{"uri": "{}"}}]"#,
                super::file::data_uri("image/png", &super::file::png(&[[128, 128, 255, 255], [255, 128, 128, 255]]))
            ),
        )
        .with(
            "meshes",
            format!(
                r#"[{{"name": "m", {weights} "primitives": [{{"material": 0,
            "attributes": {{"POSITION": 0, "NORMAL": 1, "TANGENT": 4, "TEXCOORD_0": 5}},
            "targets": [{{"POSITION": 2, "NORMAL": 2, "TANGENT": 2}}, {{"POSITION": 3}}]}}]}}]"#
            ),
        )
        .with("nodes", format!(r#"[{{"mesh": 0{node}}}]"#))
}

#[test]
fn morph_targets_have_their_default_weights() {
    let rest = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
    let plain = only_mesh(&morphed("", ""));
    assert_eq!(plain.positions, rest);
    assert_eq!(plain.attributes.normals[2], [0., 0., 1.]);

    let by_mesh = only_mesh(&morphed(r#""weights": [0.5, 0],"#, ""));
    assert_eq!(by_mesh.positions, [[0., 0., 0.], [1., 0., 0.], [0., 1., 1.]]);
    assert_eq!(by_mesh.attributes.normals[2], [0., 0., 2.]);
    assert_eq!(by_mesh.attributes.tangents[1..], [[1., 0., 0., -1.], [1., 0., 1., -1.]]);

    // The weights of the node replace those of the mesh.
    let by_node = only_mesh(&morphed(r#""weights": [0.5, 0],"#, r#", "weights": [0.25, -0.5]"#));
    assert_eq!(by_node.positions, [[-5., 0., 0.], [-4., 0., 0.], [-5., 1., 0.5]]);
}

#[test]
fn joints_move_the_morphed_shape() {
    let file = skinned([0, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]).with(
        "meshes",
        r#"[{"name": "m", "weights": [1], "primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3},
            "targets": [{"POSITION": 0}], "material": 0}]}]"#,
    );
    // (2,0,0) is doubled to (4,0,0), then turned about (1,0,0).
    assert!(is_near(&only_mesh(&file).positions, &[[0., 0., 0.], [1., 3., 0.], [2., 2., 0.]]));
}

#[test]
fn invalid_morph_targets_are_refused_or_reported() {
    for (file, words) in [
        (morphed(r#""weights": [1e39],"#, ""), ["mesh 0 'm'", "inf"]),
        (
            morphed("", "").with("meshes", r#"[{"name": "m", "weights": [1], "primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 77}]}]}]"#),
            ["mesh 0 'm'", "accessor 77"],
        ),
    ] {
        let error = file.error();
        assert!(words.iter().all(|word| error.contains(word)), "{words:?} not all in: {error}");
    }
    let with = |values: &[f32], count: usize| {
        let mut data = Data::default();
        data.floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.], 3, "VEC3").floats(values, count, "VEC3");
        data.file().with(
            "meshes",
            r#"[{"weights": [1], "primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}]}]}]"#,
        )
    };
    assert!(with(&[0.; 6], 2).error().contains("displaces 2 vertices, but there are 3"));
    assert!(with(&[0., 0., 0., f32::NAN, 0., 0., 0., 0., 0.], 3).error().contains("vertex 1"));
    let (_, report) = morphed(r#""weights": [0, 0, 1],"#, "").load();
    assert!(says(&report, "mesh 0 'm'", "weights of morph targets that it does not have"), "{report}");
    let colours = File::new().with("meshes", r#"[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0, "targets": [{"COLOR_0": 0}, {"POSITION": 0}]}]}]"#);
    assert!(says(&colours.load().1, "the file", "of 1 morph targets"));
}
