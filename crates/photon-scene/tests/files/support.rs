//! Shared helpers of the tests of all formats.

use photon_core::Material;
use photon_scene::{Scene, SceneError};
use std::path::PathBuf;

/// A temporary folder, removed at the end.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("photon-scene-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    pub(crate) fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, content).expect("a temporary file");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // At worst the folder is left behind.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub(crate) fn message<T>(result: Result<T, SceneError>) -> String {
    result.map(drop).expect_err("a fault").to_string()
}

pub(crate) fn names(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{message}' does not say '{part}'");
    }
}

pub(crate) fn material<'a>(scene: &'a Scene, name: &str) -> &'a Material {
    let index = scene.material_names().position(|known| known == name).expect("a material of that name");
    &scene.view().materials[index]
}

/// Corners of a triangle in user space.
pub(crate) fn corners(scene: &Scene, triangle: usize) -> [[f64; 3]; 3] {
    let view = scene.view();
    view.triangles[triangle].map(|vertex| {
        let at = scene.units().point_to_user(view.positions[vertex as usize]);
        at.map(|part| (part * 1e4).round() / 1e4)
    })
}

pub(crate) const MTL: &str = "
newmtl wall
Kd 0.6 0.5 0.4
newmtl light
Kd 0 0 0
Ke 5 4 3
newmtl shiny metal
illum 3
Ks 0.9 0.8 0.7
newmtl gem
illum 7
Ni 1.7
Tf 0.9 1 0.8
newmtl pane
d 0.2
Ni 1.4
newmtl glow
Ka 20 20 20
Kd 1 1 1
newmtl rough
Kd 0.3 0.3 0.3
Ks 0.2 0.2 0.2
Ns 30
map_Kd wood grain.png
Pr 0.4
";

pub(crate) const OBJ: &str = "
# a comment
mtllib scene materials.mtl
o room
v 0 0 0
v 2 0 0 1.0
v 2 2 0
v 0 2 0
vt 0 0
vn 0 0 1
usemtl wall
f 1/1/1 2/1/1 3/1/1 4/1/1
usemtl light
f -4 -3 \\
  -2
o things
usemtl shiny metal
f 1//1 2//1 3//1
usemtl gem
f 1 2 3
usemtl pane
f 1 2 3
usemtl rough
f 1 2 3
usemtl nowhere
f 2 3 4
l 1 2
";
