//! Vertex attributes and textures of a prepared scene.

use photon_core::texture::{ByteValues, byte_values};
use photon_core::{MaterialTextures, SceneView, Shading, ShadingTables, Texture, TextureUse};

/// Copies of the tables in [`SceneView::shading`]; texels are shared with it.
pub(crate) struct CpuShading {
    normals: Vec<[u32; 3]>,
    tangents: Vec<[u32; 3]>,
    colors: Vec<[[u32; 2]; 3]>,
    uvs: Vec<[[f32; 2]; 3]>,
    material_textures: Vec<MaterialTextures>,
    uses: Vec<TextureUse>,
    textures: Vec<Texture>,
    values: ByteValues,
    triangles: usize,
}

impl CpuShading {
    /// `None` for a scene without any.
    pub(crate) fn new(view: &SceneView<'_>) -> Option<Box<Self>> {
        let tables = &view.shading;
        if tables.is_empty() {
            return None;
        }
        Some(Box::new(Self {
            normals: tables.normals.to_vec(),
            tangents: tables.tangents.to_vec(),
            colors: tables.colors.to_vec(),
            uvs: tables.uvs.to_vec(),
            material_textures: tables.material_textures.to_vec(),
            uses: tables.uses.to_vec(),
            textures: tables.textures.to_vec(),
            values: byte_values(),
            triangles: view.triangles.len(),
        }))
    }

    /// The tables, for evaluation.
    #[inline]
    pub(crate) fn view(&self) -> Shading<'_> {
        let tables = ShadingTables {
            normals: &self.normals,
            tangents: &self.tangents,
            colors: &self.colors,
            uvs: &self.uvs,
            material_textures: &self.material_textures,
            uses: &self.uses,
            textures: &self.textures,
        };
        Shading { tables, values: &self.values, triangles: self.triangles }
    }
}
