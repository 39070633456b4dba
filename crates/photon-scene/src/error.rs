//! Errors of scenes and scene files. Each names the object at fault and how to fix it; names and text of files pass through
//! [`shown`].

use photon_core::{FileKind, shown};
use std::path::{Path, PathBuf};

/// An error in a scene or its file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A property of a material is out of range.
    #[error("material '{}': {property} is {}, but {hint}", shown(material), shown(value))]
    Material {
        /// Name of the material.
        material: String,
        /// Name of the property.
        property: &'static str,
        /// Its value.
        value: String,
        /// The valid range.
        hint: &'static str,
    },
    /// A material is given a kind or a parameter that does not exist, or another number of numbers.
    #[error("material '{}': {}; {}", shown(material), shown(what), shown(hint))]
    Parameter {
        /// Name of the material.
        material: String,
        /// The fault.
        what: String,
        /// The remedy.
        hint: String,
    },
    /// A property of a light is out of range.
    #[error("light '{}': {property} is {}, but {hint}", shown(light), shown(value))]
    Light {
        /// Name of the light.
        light: String,
        /// Name of the property.
        property: &'static str,
        /// Its value.
        value: String,
        /// The valid range.
        hint: &'static str,
    },
    /// A property of the ambient medium is out of range.
    #[error("the ambient medium: {property} is {}, but {hint}", shown(value))]
    Medium {
        /// Name of the property.
        property: &'static str,
        /// Its value.
        value: String,
        /// The valid range.
        hint: &'static str,
    },
    /// Keys of a phase function do not belong together, or one is unknown.
    #[error("{}; {hint}", shown(what))]
    Phase {
        /// The keys.
        what: String,
        /// What would be valid.
        hint: &'static str,
    },
    /// An environment has a property out of range, or an unsuitable image.
    #[error("environment '{}': {}; {hint}", shown(environment), shown(what))]
    Environment {
        /// Name of the environment: its file, or its description.
        environment: String,
        /// What is wrong.
        what: String,
        /// What would be valid.
        hint: &'static str,
    },
    /// A portal has a corner or an area out of range, or a name that nothing has.
    #[error("portal '{}': {}; {}", shown(portal), shown(what), shown(hint))]
    Portal {
        /// Name of the portal: of the material or mesh, or as it was given with the corners.
        portal: String,
        /// What is wrong.
        what: String,
        /// What would be valid.
        hint: String,
    },
    /// A property of a camera is out of range.
    #[error("camera '{}': {property} is {}, but {hint}", shown(camera), shown(value))]
    Camera {
        /// Name of the camera.
        camera: String,
        /// Name of the property.
        property: &'static str,
        /// Its value.
        value: String,
        /// The valid range.
        hint: &'static str,
    },
    /// A texture has an invalid size or texel.
    #[error("texture '{}': {}; {hint}", shown(texture), shown(what))]
    Texture {
        /// Name of the texture.
        texture: String,
        /// What is wrong.
        what: String,
        /// What would be valid.
        hint: &'static str,
    },
    /// A material uses a texture of another builder.
    #[error(
        "material '{}': its {slot} texture, number {texture}, is not one of the {textures} of this builder; use the TextureId that its own texture() returned",
        shown(material)
    )]
    TextureId {
        /// Name of the material.
        material: String,
        /// The use: `base_color`, `emission` or `normal`.
        slot: &'static str,
        /// The texture number.
        texture: u32,
        /// Number of textures of this builder.
        textures: usize,
    },
    /// A mesh does not have the texture coordinates that a texture needs.
    #[error(
        "mesh '{}': the {slot} texture of its material '{}' needs UV set {set}, but the mesh has {sets}; give it texture coordinates, or a material without the texture",
        shown(mesh),
        shown(material)
    )]
    UvSet {
        /// Name of the mesh.
        mesh: String,
        /// Name of its material.
        material: String,
        /// The use: `base_color`, `emission` or `normal`.
        slot: &'static str,
        /// The UV set.
        set: u32,
        /// Number of UV sets of the mesh.
        sets: usize,
    },
    /// A list of vertex attributes is of the wrong length, or has an invalid entry.
    #[error("mesh '{}': its {attribute}: {}; {hint}", shown(mesh), shown(what))]
    Attribute {
        /// Name of the mesh.
        mesh: String,
        /// The list: `normals`, `tangents`, `colors` or `UV set 0`.
        attribute: String,
        /// What is wrong.
        what: String,
        /// What would be valid.
        hint: &'static str,
    },
    /// A vertex of a triangle with a coordinate that is not finite.
    #[error("mesh '{}': vertex {vertex} is {value}, but every coordinate must be a finite number", shown(mesh))]
    Vertex {
        /// Name of the mesh.
        mesh: String,
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Its coordinates.
        value: String,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error(
        "mesh '{}': triangle {triangle} refers to vertex {index}, but there are {vertices}, numbered from 0",
        shown(mesh)
    )]
    Index {
        /// Name of the mesh.
        mesh: String,
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The vertex index it holds.
        index: u32,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// A mesh uses a material of another builder.
    #[error(
        "mesh '{}': material number {material} is not one of the {materials} of this builder; use the MaterialId that its own material() returned",
        shown(mesh)
    )]
    MaterialId {
        /// Name of the mesh.
        mesh: String,
        /// The material number.
        material: u32,
        /// Number of materials of this builder.
        materials: usize,
    },
    /// An area light has zero area.
    #[error(
        "mesh '{}' emits light (material '{}') but has no area; give it triangles with area, or use a point light",
        shown(mesh),
        shown(material)
    )]
    ZeroAreaLight {
        /// Name of the mesh.
        mesh: String,
        /// Name of its material.
        material: String,
    },
    /// A scene has something that cannot be written to a file.
    #[error("{} cannot be written; {hint}", shown(what))]
    Export {
        /// What cannot be written.
        what: String,
        /// How to write the rest.
        hint: &'static str,
    },
    /// A number exceeds the range of floating point.
    #[error("{} is {value}, beyond the range of floating point; {hint}", shown(what))]
    Extreme {
        /// The quantity that exceeds the range.
        what: String,
        /// Its value.
        value: String,
        /// How to fix it.
        hint: &'static str,
    },
    /// More items than 32-bit indices can address.
    #[error("{count} {what} are more than 32-bit indices can address; split the scene")]
    TooMany {
        /// Kind of item.
        what: &'static str,
        /// Number of items.
        count: usize,
    },
    /// Memory is exhausted.
    #[error(transparent)]
    OutOfMemory(#[from] photon_core::memory::OutOfMemory),
    /// The scene has no camera.
    #[error("the scene has no camera; add one to the file or to an override file, or use SceneBuilder::frame_camera")]
    NoCamera,
    /// There is no camera of the requested name.
    #[error("there is no camera '{}'; the cameras are: {}", shown(name), shown(&known.join(", ")))]
    UnknownCamera {
        /// The requested name.
        name: String,
        /// Names of the cameras that exist.
        known: Vec<String>,
    },
    /// A picture without pixels, or with more than 32-bit indices can address.
    #[error(
        "a picture of {width}x{height} pixels cannot be made; each side must be at least 1, and their product below 2^32"
    )]
    PictureSize {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// A file cannot be read at all.
    #[error("cannot read {}: {source}; check that the file exists and is readable", name_of(path))]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The content of a file is invalid.
    #[error(
        "{}{}: {}; {}",
        name_of(path), line.map(|line| format!(", line {line}")).unwrap_or_default(), shown(what), shown(hint)
    )]
    Content {
        /// Path of the file.
        path: PathBuf,
        /// Line number, from 1, if known.
        line: Option<u64>,
        /// What is wrong.
        what: String,
        /// What would be valid.
        hint: String,
    },
    /// A file is of another kind than the one that is read.
    #[error("{}: it {kind}", name_of(path))]
    OtherKind {
        /// Path of the file.
        path: PathBuf,
        /// The kind that it is of, with the remedy.
        kind: FileKind,
    },
    /// A file needs more memory than [`LoadOptions::memory`](crate::LoadOptions::memory) allows.
    #[error(
        "{}: {} needs {} of memory, but {} are left of the {} that loading may take; use smaller images or less of the scene, or allow more memory",
        name_of(path), shown(object), bytes_text(*needed), bytes_text(*left), bytes_text(*limit)
    )]
    Memory {
        /// Path of the file.
        path: PathBuf,
        /// What needs it: the texture and its material, with its size, or another part of the file.
        object: String,
        /// Bytes that it needs.
        needed: u64,
        /// Bytes that are left for it.
        left: u64,
        /// The limit, in bytes.
        limit: u64,
    },
    /// No loader supports this file format.
    #[error("{}: unknown scene file format; supported are .gltf, .glb, .obj, .ply and .stl{hint}", name_of(path))]
    UnknownFormat {
        /// Path of the file.
        path: PathBuf,
        /// How to convert it, or nothing.
        hint: &'static str,
    },
    /// A folder where a scene file is expected.
    #[error("{}: it is a folder; name the scene file in it", name_of(path))]
    Folder {
        /// Path of the folder.
        path: PathBuf,
    },
}

/// A path for messages.
pub(crate) fn name_of(path: &Path) -> String {
    shown(&path.display().to_string()).into_owned()
}

/// A number of bytes for people.
pub(crate) fn bytes_text(bytes: u64) -> String {
    const UNITS: [(u64, &str); 3] = [(1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
    let unit = UNITS.into_iter().find(|(unit, _)| bytes >= *unit);
    unit.map_or_else(|| format!("{bytes} bytes"), |(unit, name)| format!("{:.1} {name}", bytes as f64 / unit as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_readable() {
        assert_eq!([1023, 1024, 3 << 19, 5 << 30].map(bytes_text), ["1023 bytes", "1.0 KiB", "1.5 MiB", "5.0 GiB"]);
    }
}
