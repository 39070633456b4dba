//! Files of the supported formats, written by the tests themselves.

mod environment;
mod kinds;
mod obj;
mod obj_glossy;
mod obj_textures;
mod overrides;
mod ply;
mod portals;
mod stl;
mod support;

use photon_scene::{LoadReport, Overrides, ReportKind, load};
use std::path::Path;
use support::{Folder, message, names};

#[test]
fn files_that_are_not_there_or_not_known() {
    let folder = Folder::new("none");
    for name in ["gone.obj", "gone.ply", "gone.gltf", "gone.glb"] {
        names(&message(load(&folder.0.join(name), None)), &[name, "cannot read", "exists"]);
    }
    for name in ["scene.fbx", "scene", "scene."] {
        names(&message(load(Path::new(name), None)), &[name, ".gltf, .glb, .obj, .ply and .stl"]);
    }
    names(&message(Overrides::read(&folder.0.join("gone.toml"))), &["gone.toml", "cannot read"]);
    let upper = folder.file("LOUD.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert!(load(&upper, None).is_ok());
}

#[test]
fn only_notes_are_exact() {
    let mut report = LoadReport::default();
    report.note("a", "b");
    assert!(report.is_exact() && report.lines[0].kind == ReportKind::Note);
    report.approximated("a", "b");
    assert!(!report.is_exact());
}
