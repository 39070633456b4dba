//! glTF files on disk: with external buffers, unusual names, missing or truncated files.
#![allow(clippy::unwrap_used, reason = "a test that unwraps fails with the place and the error")]

use std::fs;
use std::path::{Path, PathBuf};

use photon_scene::{Scene, SceneError, load_gltf};

/// A temporary folder for one test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("photon-gltf-{}-{name}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Each test has a folder of its own; a leftover one does no harm.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Two triangles that make a square of side 2, 3 above the origin, facing down, radiance 5.
fn area_light(uri: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}},
        "buffers": [{{"byteLength": 54, "uri": "{uri}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 6}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
                      {{"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"}}],
        "materials": [{{"name": "glow", "emissiveFactor": [1, 1, 1],
            "pbrMetallicRoughness": {{"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}},
            "extensions": {{"KHR_materials_emissive_strength": {{"emissiveStrength": 5}}}}}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}}]}}],
        "cameras": [{{"name": "below", "type": "perspective", "perspective": {{"yfov": 1, "znear": 0.1}}}}],
        "nodes": [{{"name": "light", "mesh": 0, "translation": [0, 3, 0]}}, {{"camera": 0, "translation": [0, 0, 4]}}],
        "scenes": [{{"nodes": [0, 1]}}]}}"#
    )
}

fn square() -> Vec<u8> {
    let corners = [[-1_f32, 0., -1.], [1., 0., -1.], [1., 0., 1.], [-1., 0., 1.]];
    let mut bytes: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0, 2, 3]);
    bytes
}

fn build(path: &Path) -> Scene {
    let (builder, _) = load_gltf(path).unwrap();
    builder.build().unwrap()
}

#[test]
fn an_area_light_has_the_power_of_its_area() {
    let folder = Folder::new("light");
    folder.write("square.bin", square());
    let scene = build(&folder.write("light.gltf", area_light("square.bin")));
    // π · radiance · area, for an area light that emits from one side.
    let expected = std::f64::consts::PI * 5.0 * 4.0;
    assert!((scene.units().power / expected - 1.0).abs() < 1e-12, "{:?}", scene.units());
    assert_eq!(scene.view().lights.len(), 2);
    assert!(scene.view().primitives.iter().all(|primitive| primitive.normal == [0., -1., 0.]));
    assert_eq!(scene.units().center, [0., 3., 0.]);
    assert_eq!(scene.camera_names().collect::<Vec<_>>(), ["below"]);
    assert_eq!(scene.mesh_of_triangle(0), "light");
    let camera = scene.camera(None, 64, 64).unwrap();
    assert_eq!(camera.forward, [0., 0., -1.]);
}

#[test]
fn names_may_be_escaped_or_not_and_lie_in_folders() {
    let folder = Folder::new("names");
    fs::create_dir_all(folder.0.join("data")).unwrap();
    for (file, uri) in
        [("a b.bin", "a%20b.bin"), ("a b.bin", "a b.bin"), ("100%.bin", "100%.bin"), ("data/c.bin", "data/c.bin")]
    {
        folder.write(file, square());
        let scene = build(&folder.write("light.gltf", area_light(uri)));
        assert_eq!(scene.view().triangles.len(), 2, "{uri}");
    }
}

#[test]
fn missing_and_cut_files_are_named() {
    let folder = Folder::new("missing");
    let error = load_gltf(&folder.0.join("none.gltf")).unwrap_err();
    assert!(matches!(&error, SceneError::Read { path, .. } if path.ends_with("none.gltf")), "{error}");
    assert!(matches!(load_gltf(&folder.0), Err(SceneError::Read { .. })));

    let path = folder.write("light.gltf", area_light("square.bin"));
    let error = load_gltf(&path).unwrap_err().to_string();
    assert!(error.contains("light.gltf") && error.contains("buffer 0") && error.contains("square.bin"), "{error}");

    folder.write("square.bin", &square()[..40]);
    let error = load_gltf(&path).unwrap_err().to_string();
    assert!(error.contains("needs 54 bytes") && error.contains("square.bin has 40"), "{error}");

    let path = folder.write("cut.gltf", &area_light("square.bin")[..200]);
    let error = load_gltf(&path).unwrap_err();
    assert!(matches!(error, SceneError::Content { line: Some(_), .. }), "{error}");
}
