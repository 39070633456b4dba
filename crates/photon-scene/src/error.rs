//! Errors of scenes and scene files. Each names the object at fault and how to fix it.

use std::path::PathBuf;

/// An error in a scene or its file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A property of a material is out of range.
    #[error("material '{material}': {property} is {value}, but {hint}")]
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
    /// A property of a light is out of range.
    #[error("light '{light}': {property} is {value}, but {hint}")]
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
    /// An environment has a property out of range, or an unsuitable image.
    #[error("environment '{environment}': {what}; {hint}")]
    Environment {
        /// Name of the environment: its file, or its description.
        environment: String,
        /// What is wrong.
        what: String,
        /// What would be valid.
        hint: &'static str,
    },
    /// A portal has a corner or an area out of range, or a name that nothing has.
    #[error("portal '{portal}': {what}; {hint}")]
    Portal {
        /// Name of the portal: of the material or mesh, or as it was given with the corners.
        portal: String,
        /// What is wrong.
        what: String,
        /// What would be valid.
        hint: String,
    },
    /// A property of a camera is out of range.
    #[error("camera '{camera}': {property} is {value}, but {hint}")]
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
    #[error("texture '{texture}': {what}; {hint}")]
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
        "material '{material}': its {slot} texture, number {texture}, is not one of the {textures} of this builder; use the TextureId that its own texture() returned"
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
        "mesh '{mesh}': the {slot} texture of its material '{material}' needs UV set {set}, but the mesh has {sets}; give it texture coordinates, or a material without the texture"
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
    #[error("mesh '{mesh}': its {attribute}: {what}; {hint}")]
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
    #[error("mesh '{mesh}': vertex {vertex} is {value}, but every coordinate must be a finite number")]
    Vertex {
        /// Name of the mesh.
        mesh: String,
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Its coordinates.
        value: String,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("mesh '{mesh}': triangle {triangle} refers to vertex {index}, but there are {vertices}, numbered from 0")]
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
        "mesh '{mesh}': material number {material} is not one of the {materials} of this builder; use the MaterialId that its own material() returned"
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
        "mesh '{mesh}' emits light (material '{material}') but has no area; give it triangles with area, or use a point light"
    )]
    ZeroAreaLight {
        /// Name of the mesh.
        mesh: String,
        /// Name of its material.
        material: String,
    },
    /// A scene has something that cannot be written to a file.
    #[error("{what} cannot be written; {hint}")]
    Export {
        /// What cannot be written.
        what: String,
        /// How to write the rest.
        hint: &'static str,
    },
    /// A number exceeds the range of floating point.
    #[error("{what} is {value}, beyond the range of floating point; {hint}")]
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
    /// The scene has no camera.
    #[error("the scene has no camera; add one to the file or to an override file, or use SceneBuilder::frame_camera")]
    NoCamera,
    /// There is no camera of the requested name.
    #[error("there is no camera '{name}'; the cameras are: {}", known.join(", "))]
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
    #[error("cannot read {}: {source}; check that the file exists and is readable", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The content of a file is invalid.
    #[error("{}{}: {what}; {hint}", path.display(), line.map(|line| format!(", line {line}")).unwrap_or_default())]
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
    /// A file needs more memory than [`LoadOptions::memory`](crate::LoadOptions::memory) allows.
    #[error(
        "{}: {object} needs {} of memory, but {} are left of the {} that loading may take; use smaller images or less of the scene, or allow more memory",
        path.display(), bytes_text(*needed), bytes_text(*left), bytes_text(*limit)
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
    #[error("{}: unknown scene file format; supported are .gltf, .glb, .obj and .ply{hint}", path.display())]
    UnknownFormat {
        /// Path of the file.
        path: PathBuf,
        /// How to convert it, or nothing.
        hint: &'static str,
    },
    /// A folder where a scene file is expected.
    #[error("{}: it is a folder; name the scene file in it", path.display())]
    Folder {
        /// Path of the folder.
        path: PathBuf,
    },
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
