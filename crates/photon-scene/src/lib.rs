//! Scene description: building, loading, checking and normalising the input of the renderer.
//!
//! A [`SceneBuilder`] collects a scene in the user's own space and radiometric units. [`SceneBuilder::build`]
//! validates it, reports the name of any invalid object, and converts it to a [`Scene`]: the tables in
//! normalised space that backends read through [`Scene::view`].
#![deny(unsafe_code)]

mod boundaries;
mod builder;
mod builtin;
mod bvh;
mod camera;
mod color;
mod contact;
mod describe;
mod edges;
mod environment;
mod error;
#[cfg(feature = "files")]
mod extras;
mod lights;
#[cfg(feature = "files")]
mod load;
mod mesh;
mod normalise;
mod order;
#[cfg_attr(not(feature = "files"), expect(dead_code, reason = "files alone read all columns of its tables"))]
mod parameter;
mod portals;
mod repeated;
mod report;
#[cfg(feature = "files")]
mod save;
mod scene;
mod shading;
pub mod shapes;
mod similar;
mod solids;
mod summary;
mod texture;
mod validate;

pub use builder::{MaterialId, SceneBuilder};
pub use builtin::{FurnaceShape, IntegratingSphere, builtin, builtin_names, furnace, plates};
pub use bvh::{Accel, AccelError, Binary, BinaryTree, BruteForce, CompressedNode, CompressedTree};
pub use describe::{
    AlphaMode, AmbientMedium, CameraDesc, Dispersion, GridDesc, LightDesc, MaterialDesc, PhaseDesc, PhaseKeys,
    Projection, Surface, ThinLens,
};
#[cfg(feature = "files")]
pub use environment::EnvironmentName;
pub use environment::{Environment, EnvironmentDesc, EnvironmentSource, Sun};
pub use error::SceneError;
#[cfg(feature = "files")]
pub use load::{
    Image, ImageError, LightUnits, LoadOptions, Overrides, load, load_builder, load_builder_with, load_gltf,
    load_image, load_obj, load_ply, load_stl,
};
pub use mesh::VertexAttributes;
pub use report::{LoadReport, ReportKind, ReportLine};
#[cfg(feature = "files")]
pub use save::glb;
pub use scene::Scene;
pub use similar::did_you_mean;
pub use summary::summed_up;
pub use texture::{TextureDesc, TextureId, TextureRef, TexturesDesc};
