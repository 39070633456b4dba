//! The meshes of a builder.

use std::sync::Arc;

use crate::builder::MaterialId;

/// What the vertices of a mesh have beside their positions. Each list is empty, or has one entry for each vertex.
/// [`Default`] has none.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct VertexAttributes {
    /// Normals, of any length, towards the front. One that is zero, not finite, or behind its triangle is replaced by
    /// the geometric normal.
    pub normals: Vec<[f64; 3]>,
    /// Tangents for normal maps, in the direction of increasing u, of any length, and the sign of the bitangent
    /// `sign · normal × tangent`. If there are none, `MikkTSpace` computes them from the normals and UVs.
    pub tangents: Vec<[f64; 4]>,
    /// Colours, linear RGB and alpha, which multiply the albedo, reflectance or tint; clamped to `[0, 1]`. Alpha
    /// multiplies that of the material, unless it is [`crate::AlphaMode::Opaque`].
    pub colors: Vec<[f64; 4]>,
    /// UV sets: texture coordinates.
    pub uvs: Vec<Vec<[f64; 2]>>,
}

impl VertexAttributes {
    /// The same with these [`Self::normals`].
    #[must_use]
    pub fn with_normals(self, normals: Vec<[f64; 3]>) -> Self {
        Self { normals, ..self }
    }

    /// The same with these [`Self::tangents`].
    #[must_use]
    pub fn with_tangents(self, tangents: Vec<[f64; 4]>) -> Self {
        Self { tangents, ..self }
    }

    /// The same with these [`Self::colors`].
    #[must_use]
    pub fn with_colors(self, colors: Vec<[f64; 4]>) -> Self {
        Self { colors, ..self }
    }

    /// The same with these [`Self::uvs`]: one list for each UV set.
    #[must_use]
    pub fn with_uvs(self, uvs: Vec<Vec<[f64; 2]>>) -> Self {
        Self { uvs, ..self }
    }

    /// Whether there are none at all.
    pub(crate) fn is_empty(&self) -> bool {
        self.normals.is_empty() && self.tangents.is_empty() && self.colors.is_empty() && self.uvs.is_empty()
    }
}

/// Triangles that share a name and a material, user space.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    /// Shared, since a file may give many meshes one long name.
    pub(crate) name: Arc<str>,
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) attributes: VertexAttributes,
    pub(crate) material: MaterialId,
}
