//! Files that are not what their extensions say.

use std::path::Path;

use photon_scene::{EnvironmentDesc, GridDesc, LoadOptions, LoadReport, Overrides, SceneError, load, load_image};

use crate::support::{Folder, message, names};

const LFS: &[u8] = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a214614ab2935\nsize 12345\n";
const HTML: &[u8] = b"\n<!DOCTYPE html>\n<html lang=\"en\"><head><title>mesh.glb at main</title>\n";
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01";
const ZIP: &[u8] = b"PK\x03\x04\x14\0\0\0\x08\0";

const TRIANGLE: &str = r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "buffers": [{"byteLength": 36, URI}]}"#;
const DATA: &str = r#""uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA""#;

/// A reader of a file, without its result.
type Reader = fn(&Path) -> Result<(), SceneError>;

fn scene(path: &Path) -> Result<(), SceneError> {
    load(path, None).map(drop)
}

fn grid(path: &Path) -> Result<(), SceneError> {
    GridDesc::read(path, &LoadOptions::default()).map(drop)
}

fn environment(path: &Path) -> Result<(), SceneError> {
    EnvironmentDesc::read(path, &mut LoadReport::default()).map(drop)
}

/// Every reader names what it was given, and the remedy.
#[test]
fn other_kinds_of_files_are_named() {
    let folder = Folder::new("kinds");
    let readers: [(&[&str], Reader); 3] = [
        (&["obj", "glb", "gltf", "ply"], scene),
        (&["vol", "nvdb"], grid),
        (&["exr", "hdr", "png", "jpg"], environment),
    ];
    let kinds: [(&[u8], &[&str]); 6] = [
        (b"", &["it is empty", "download"]),
        (LFS, &["it is a Git LFS pointer", "`git lfs pull`"]),
        (HTML, &["it is an HTML page", "the file itself"]),
        (ZIP, &["it is a ZIP archive", "unpack it"]),
        (b"404: Not Found", &["a server's message", "check the address"]),
        (b"Kaydara FBX Binary  \0", &["it is an FBX file", "Blender", ".glb"]),
    ];
    for (extensions, read) in readers {
        for extension in extensions {
            for (bytes, parts) in kinds {
                let path = folder.file(&format!("a.{extension}"), bytes);
                let error = read(&path).expect_err(extension);
                assert!(matches!(error, SceneError::OtherKind { .. }), "{error:?}");
                names(&error.to_string(), &[&[&*format!("a.{extension}")], parts].concat());
            }
        }
    }
    for (extensions, read) in &readers[..2] {
        for extension in *extensions {
            let path = folder.file(&format!("picture.{extension}"), PNG);
            names(&message(read(&path)), &["it is a PNG picture", "a texture"]);
        }
    }
    // Those that the library reads by another name.
    for (name, bytes) in [("a.obj", &b"glTF\x02\0\0\0"[..]), ("a.ply", b"{}"), ("a.glb", b"ply\nformat ascii 1.0\n")] {
        names(&message(scene(&folder.file(name, bytes))), &[name, "extension"]);
    }
    names(&message(scene(&folder.file("a.obj", b"VOL\x03"))), &["a grid of densities", "override"]);
    // Under a name that says nothing.
    for (name, bytes, part) in
        [("a.txt", &b"glTF\x02\0\0\0"[..], "it is a GLB; give it the extension"), ("a.zip", ZIP, "unpack it")]
    {
        names(&message(scene(&folder.file(name, bytes))), &[name, part]);
    }
    names(&message(scene(&folder.file("a.usdz", ZIP))), &["a.usdz: unknown scene file format", "USD converter"]);
    names(&message(scene(&folder.file("a.txt", b"words"))), &["a.txt: unknown scene file format"]);
    names(&message(load_image(&folder.file("a.exr", b"glTF\x02\0\0\0"))), &["it is a GLB"]);
    names(&message(Overrides::read(&folder.file("a.toml", HTML))), &["a.toml", "an HTML page"]);
    // An empty override file changes nothing.
    assert!(Overrides::read(&folder.file("b.toml", b"")).is_ok());
}

/// A GLB may be called .gltf, and the reverse.
#[test]
fn both_kinds_of_gltf_load_under_either_name() {
    let folder = Folder::new("kinds-gltf");
    let json = TRIANGLE.replace("URI", DATA);
    let padded = format!("{json:width$}", width = json.len().next_multiple_of(4));
    let length = padded.len() as u32;
    let parts = [b"glTF\x02\0\0\0".to_vec(), (length + 20).to_le_bytes().into(), length.to_le_bytes().into()];
    let glb = [parts.concat(), b"JSON".to_vec(), padded.into_bytes()].concat();
    for (name, bytes, text) in [
        ("a.gltf", json.as_bytes(), None),
        ("a.glb", &glb, None),
        ("b.glb", json.as_bytes(), Some("is a glTF file of JSON in spite of its extension")),
        ("b.gltf", &glb, Some("is a GLB in spite of its extension")),
    ] {
        let (scene, report) = load(&folder.file(name, bytes), None).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(scene.view().triangles.len(), 1, "{name}");
        let found = report.to_string();
        assert_eq!(found.contains("in spite of"), text.is_some(), "{found}");
        assert!(found.contains(text.unwrap_or_default()) && report.is_exact(), "{found}");
    }
}

/// Repositories with Git LFS keep the text of a .gltf, but not its buffers and images.
#[test]
fn parts_of_a_scene_are_named_too() {
    let folder = Folder::new("kinds-parts");
    folder.file("a.bin", LFS);
    let json = TRIANGLE.replace("URI", r#""uri": "a.bin""#).replace("36", "3600");
    names(
        &message(load(&folder.file("a.gltf", json), None)),
        &["buffer 0", "the file a.bin, which is a Git LFS pointer", "git lfs pull"],
    );
    folder.file("a.png", LFS);
    folder.file("a.mtl", "newmtl m\nmap_Kd a.png\n");
    let obj = folder.file("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
    let (_, report) = load(&obj, None).expect("a scene without its image");
    names(&report.to_string(), &["a.png", "is a Git LFS pointer; fetch the file with `git lfs pull`"]);
    folder.file("a.mtl", LFS);
    names(&message(load(&obj, None)), &["a.mtl", "Git LFS pointer"]);
}
