//! The meshes of a builder.

use crate::builder::MaterialId;

/// Triangles that share a name and a material, user space.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    pub(crate) name: String,
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) material: MaterialId,
}
