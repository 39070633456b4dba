//! Scenes from files.

mod gltf;
mod mtl;
mod obj;
mod overrides;
mod ply;
mod polygon;
mod schema;

use crate::builder::SceneBuilder;
use crate::describe::MaterialDesc;
use crate::error::SceneError;
use crate::report::LoadReport;
use crate::scene::Scene;
use std::path::Path;

pub use self::gltf::load_gltf;
pub use self::obj::load_obj;
pub use self::overrides::Overrides;
pub use self::ply::load_ply;

/// Reads a scene file, applies overrides to it, and builds it.
///
/// The kind of file is told by its extension: `.gltf`, `.glb`, `.obj` or `.ply`. Where neither the
/// file nor the overrides have a camera, one that sees everything is added and noted.
///
/// # Errors
/// A file that cannot be read or makes no sense, an extension that is not known, an override of
/// something that is not there, or whatever [`crate::SceneBuilder::build`] finds; each by its name.
pub fn load(path: &Path, overrides: Option<&Overrides>) -> Result<(Scene, LoadReport), SceneError> {
    let (builder, report) = load_builder(path, overrides)?;
    Ok((builder.build()?, report))
}

/// As [`load`], but does not build the scene: for programs that change it first, or write it elsewhere.
///
/// # Errors
/// As [`load`], without what [`crate::SceneBuilder::build`] finds.
pub fn load_builder(path: &Path, overrides: Option<&Overrides>) -> Result<(SceneBuilder, LoadReport), SceneError> {
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
    let (mut builder, mut report) = match extension.as_deref() {
        Some("gltf" | "glb") => load_gltf(path)?,
        Some("obj") => load_obj(path)?,
        Some("ply") => load_ply(path)?,
        _ => return Err(SceneError::UnknownFormat { path: path.to_owned(), supported: ".gltf, .glb, .obj and .ply" }),
    };
    if let Some(overrides) = overrides {
        overrides.apply(&mut builder, &mut report)?;
    }
    if !builder.has_camera() {
        let camera = builder.frame_camera();
        report.note(
            "the file",
            format!(
                "has no camera; one at {:?} that sees everything is used; give another in an override file",
                camera.position
            ),
        );
        builder.camera("automatic", camera);
    }
    Ok((builder, report))
}

/// The bytes of a file.
fn read(path: &Path) -> Result<Vec<u8>, SceneError> {
    let wrong = |source| SceneError::Read { path: path.to_owned(), source };
    // A file may name others; a device among them would be read without end.
    if !std::fs::metadata(path).map_err(wrong)?.is_file() {
        return Err(wrong(std::io::Error::other("it is no regular file")));
    }
    std::fs::read(path).map_err(wrong)
}

/// The text of a file of an age in which its encoding was not settled.
fn read_text(path: &Path) -> Result<String, SceneError> {
    // Only names and comments can hold anything else than ASCII, and a name stays the same wherever
    // it stands.
    Ok(match String::from_utf8(read(path)?) {
        Ok(text) => text,
        Err(other) => String::from_utf8_lossy(other.as_bytes()).into_owned(),
    })
}

/// What a mesh without a material is made of.
fn default_material() -> MaterialDesc {
    MaterialDesc::lambert("default", [0.5; 3])
}

/// What a mesh is called that its file does not name.
fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "mesh".to_owned(), |stem| stem.to_string_lossy().into_owned())
}
