//! Scenes: what the renderer is given.
//!
//! A [`SceneBuilder`] collects what a user describes, in the user's own space and radiometric units;
//! [`SceneBuilder::build`] checks it, names whatever is wrong, and turns it into a [`Scene`]: the
//! tables in normalised space that backends read through [`Scene::view`].
#![deny(unsafe_code)]

mod builder;
mod builtin;
mod bvh;
mod camera;
mod describe;
mod edges;
mod error;
#[cfg(feature = "files")]
mod extras;
mod lights;
#[cfg(feature = "files")]
mod load;
mod mesh;
mod normalise;
mod report;
#[cfg(feature = "files")]
mod save;
mod scene;
pub mod shapes;
mod solids;
mod validate;

pub use builder::{MaterialId, SceneBuilder};
pub use builtin::{FurnaceShape, IntegratingSphere, builtin, builtin_names, furnace, plates};
pub use bvh::{Accel, AccelError, Binary, BinaryTree, BruteForce, CompressedNode, CompressedTree};
pub use describe::{CameraDesc, LightDesc, MaterialDesc, Projection, Surface};
pub use error::SceneError;
#[cfg(feature = "files")]
pub use load::{Overrides, load, load_builder, load_gltf, load_obj, load_ply};
pub use report::{LoadReport, ReportKind, ReportLine};
#[cfg(feature = "files")]
pub use save::glb;
pub use scene::Scene;
