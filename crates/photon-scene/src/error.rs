//! What can be wrong with a scene, each naming its culprit and its mend.

use std::path::PathBuf;

/// What can be wrong with a scene or its file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A number of a material is out of its range.
    #[error("material '{material}': {property} is {value}, but {hint}")]
    Material {
        /// Its name.
        material: String,
        /// Which of its numbers.
        property: &'static str,
        /// What it is.
        value: String,
        /// What it may be.
        hint: &'static str,
    },
    /// A number of a light is out of its range.
    #[error("light '{light}': {property} is {value}, but {hint}")]
    Light {
        /// Its name.
        light: String,
        /// Which of its numbers.
        property: &'static str,
        /// What it is.
        value: String,
        /// What it may be.
        hint: &'static str,
    },
    /// A number of a camera is out of its range.
    #[error("camera '{camera}': {property} is {value}, but {hint}")]
    Camera {
        /// Its name.
        camera: String,
        /// Which of its numbers.
        property: &'static str,
        /// What it is.
        value: String,
        /// What it may be.
        hint: &'static str,
    },
    /// A vertex that is nowhere.
    #[error("mesh '{mesh}': vertex {vertex} is {value}, but every coordinate must be a finite number")]
    Vertex {
        /// Name of the mesh.
        mesh: String,
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Its coordinates.
        value: String,
    },
    /// A triangle that names a vertex which is not there.
    #[error("mesh '{mesh}': triangle {triangle} refers to vertex {index}, but there are {vertices}, numbered from 0")]
    Index {
        /// Name of the mesh.
        mesh: String,
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The index it holds.
        index: u32,
        /// How many vertices the mesh has.
        vertices: usize,
    },
    /// A mesh whose material is of another builder.
    #[error(
        "mesh '{mesh}': material number {material} is not one of the {materials} of this builder; use the MaterialId that its own material() returned"
    )]
    MaterialId {
        /// Name of the mesh.
        mesh: String,
        /// The number.
        material: u32,
        /// How many there are.
        materials: usize,
    },
    /// An area light without area.
    #[error(
        "mesh '{mesh}' emits light (material '{material}') but has no area; give it triangles with area, or use a point light"
    )]
    ZeroAreaLight {
        /// Name of the mesh.
        mesh: String,
        /// Name of its material.
        material: String,
    },
    /// Numbers that leave the range of floating point.
    #[error("{what} is {value}, beyond what can be computed with; {hint}")]
    Extreme {
        /// What leaves it.
        what: String,
        /// How far.
        value: String,
        /// What to change.
        hint: &'static str,
    },
    /// More of something than can be numbered.
    #[error("{count} {what} are more than can be numbered with 32 bits; split the scene")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many.
        count: usize,
    },
    /// No camera to look through.
    #[error("the scene has no camera; add one to the file or to an override file, or use SceneBuilder::frame_camera")]
    NoCamera,
    /// A camera that is not there.
    #[error("there is no camera '{name}'; there are: {}", known.join(", "))]
    UnknownCamera {
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// A picture without pixels, or with more than can be numbered.
    #[error(
        "a picture of {width}x{height} pixels cannot be made; each side must be at least 1, and their product below 2^32"
    )]
    PictureSize {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A file that cannot be read at all.
    #[error("cannot read {}: {source}; check that the file exists and may be read", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A file whose content makes no sense.
    #[error("{}{}: {what}; {hint}", path.display(), line.map(|line| format!(", line {line}")).unwrap_or_default())]
    Content {
        /// Which file.
        path: PathBuf,
        /// Where in it, from 1, where that is known.
        line: Option<u64>,
        /// What is wrong.
        what: String,
        /// What would be right.
        hint: String,
    },
    /// A kind of file that no loader reads.
    #[error("{}: unknown kind of scene file; supported are {supported}", path.display())]
    UnknownFormat {
        /// Which file.
        path: PathBuf,
        /// What can be read.
        supported: &'static str,
    },
}
