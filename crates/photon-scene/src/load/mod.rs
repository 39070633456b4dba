//! Loading of scenes from files.

pub(crate) mod budget;
mod gltf;
mod grid;
mod group;
mod image;
mod light_units;
mod missing_normals;
mod mtl;
mod nvdb;
mod obj;
mod overrides;
mod ply;
mod polygon;
mod schema;
mod starter;
mod stl;
mod text;
mod vol;
mod white;

use self::budget::Budget;
use crate::builder::SceneBuilder;
use crate::describe::MaterialDesc;
use crate::error::SceneError;
use crate::report::LoadReport;
use crate::scene::Scene;
use photon_core::FileKind;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

pub use self::budget::LoadOptions;
pub use self::gltf::load_gltf;
pub(crate) use self::image::image_header;
pub use self::image::{Image, ImageError, load_image};
pub use self::light_units::LightUnits;
pub use self::obj::load_obj;
pub use self::overrides::Overrides;
pub use self::ply::load_ply;
pub use self::stl::load_stl;

/// Reads a scene file, applies overrides to it, and builds it.
///
/// The extension determines the format: `.gltf`, `.glb`, `.obj`, `.ply` or `.stl`. If neither the
/// file nor the overrides have a camera, one that shows the whole scene is added and noted in the report.
///
/// # Errors
/// A file that cannot be read or is invalid, an unknown extension, an override of something that does
/// not exist, or the errors of [`crate::SceneBuilder::build`]; each names the object at fault.
pub fn load(path: &Path, overrides: Option<&Overrides>) -> Result<(Scene, LoadReport), SceneError> {
    let (builder, report) = load_builder(path, overrides)?;
    Ok((builder.build()?, report))
}

/// Like [`load`], but does not build the scene: for programs that modify it first, or convert it.
///
/// # Errors
/// As [`load`], without the errors of [`crate::SceneBuilder::build`].
pub fn load_builder(path: &Path, overrides: Option<&Overrides>) -> Result<(SceneBuilder, LoadReport), SceneError> {
    load_builder_with(path, overrides, &LoadOptions::default())
}

/// As [`load_builder`], with options: a limit on memory.
///
/// # Errors
/// As [`load_builder`], and [`SceneError::Memory`] for what does not fit, before it is read or decoded.
pub fn load_builder_with(
    path: &Path,
    overrides: Option<&Overrides>,
    options: &LoadOptions,
) -> Result<(SceneBuilder, LoadReport), SceneError> {
    let budget = Budget::new(options);
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
    let (mut builder, mut report) = match extension.as_deref() {
        Some("gltf" | "glb") => gltf::load_within(path, &budget)?,
        Some("obj") => obj::load_within(path, &budget)?,
        Some("ply") => ply::load_within(path, &budget)?,
        Some("stl") => stl::load_within(path, &budget)?,
        _ if path.is_dir() => return Err(SceneError::Folder { path: path.to_owned() }),
        _ => return Err(unknown_format(path, conversion(extension.as_deref()))),
    };
    if let Some(overrides) = overrides {
        overrides.apply_within(&mut builder, &mut report, &budget)?;
    }
    missing_normals::note(&builder, &mut report);
    if !builder.has_camera() {
        let camera = builder.frame_camera();
        let [x, y, z] = camera.position.map(|part| format!("{part:.3e}").parse().unwrap_or(part));
        report.note(
            "the file",
            format!(
                "has no camera; one at ({x}, {y}, {z}) that shows the whole scene is used; give another in an override file"
            ),
        );
        builder.camera("automatic", camera);
    }
    Ok((builder, report))
}

/// The error of a file whose extension is not known: by its content, if no `hint` follows from the extension.
fn unknown_format(path: &Path, hint: &'static str) -> SceneError {
    let mut start = Vec::new();
    // Opening a pipe would wait for its writer.
    let is_read = hint.is_empty()
        && path.is_file()
        && File::open(path).is_ok_and(|file| file.take(FileKind::START as u64).read_to_end(&mut start).is_ok());
    match FileKind::of(&start).filter(|_| is_read) {
        Some(kind) => SceneError::OtherKind { path: path.to_owned(), kind },
        None => SceneError::UnknownFormat { path: path.to_owned(), hint },
    }
}

/// How files of a known format of others become one that is read.
fn conversion(extension: Option<&str>) -> &'static str {
    match extension {
        Some("blend") => "; export it from Blender as glTF 2.0 (.glb)",
        Some("fbx" | "dae" | "3ds" | "x3d" | "abc") => "; import it in Blender and export glTF 2.0 (.glb)",
        Some("usd" | "usda" | "usdc" | "usdz") => {
            "; import it in Blender, or use a USD converter, and export glTF 2.0 (.glb)"
        }
        Some("exr" | "hdr" | "pic") => {
            "; it is an image: as light from all around, give it by --environment beside a scene"
        }
        Some("pbrt" | "xml") => "; scenes of other renderers are not read: export their meshes as PLY or glTF",
        _ => "",
    }
}

/// Reads the bytes of a file.
fn read(path: &Path) -> Result<Vec<u8>, SceneError> {
    let wrong = |source| SceneError::Read { path: path.to_owned(), source };
    // A scene file may refer to others; a device among them could be read without end.
    let kind = std::fs::metadata(path).map_err(wrong)?;
    if !kind.is_file() {
        let what = if kind.is_dir() { "it is a folder" } else { "it is not a regular file" };
        return Err(wrong(std::io::Error::other(what)));
    }
    std::fs::read(path).map_err(wrong)
}

/// As [`read`], if `factor` times its length fits into memory.
fn read_within(path: &Path, budget: &Budget, factor: u64) -> Result<Vec<u8>, SceneError> {
    let length = std::fs::metadata(path).map_or(0, |data| data.len());
    budget.take(length.saturating_mul(factor), || "the file".to_owned()).map_err(|shortage| shortage.in_file(path))?;
    read(path)
}

/// Material of meshes without one.
fn default_material() -> MaterialDesc {
    MaterialDesc::lambert("default", [0.5; 3])
}

/// Material of meshes without one whose vertices have colours.
fn white_material() -> MaterialDesc {
    MaterialDesc::lambert("default", [1.0; 3])
}

/// Name of a mesh that has none in the file: the file name without extension.
fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "mesh".to_owned(), |stem| stem.to_string_lossy().into_owned())
}
