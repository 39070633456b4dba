//! Vertex attributes and textures of a prepared scene.

use std::collections::BTreeSet;

use photon_core::texture::{ByteValues, byte_values};
use photon_core::{Features, OwnedShadingTables, SceneView, Shading};

/// A copy of [`SceneView::shading`], with the tables that decode texels.
pub(crate) struct CpuShading {
    tables: OwnedShadingTables,
    values: ByteValues,
    triangles: usize,
}

impl CpuShading {
    /// `None` for a scene without any, and without surfaces that random words decide on.
    pub(crate) fn new(view: &SceneView<'_>, present: Features) -> Option<Box<Self>> {
        if view.shading.is_empty() && !present.intersects(Features::RANDOM_SURFACES) {
            return None;
        }
        let tables = OwnedShadingTables::from(&view.shading);
        Some(Box::new(Self { tables, values: byte_values(), triangles: view.triangles.len() }))
    }

    /// Labels and bytes of what the scene has of attributes and textures. Texels are shared with the scene that the caller
    /// has, and counted once.
    pub(crate) fn memory(&self) -> Vec<(String, u64)> {
        let tables = &self.tables;
        let mut seen = BTreeSet::new();
        let images = tables.textures.iter().filter(|image| seen.insert(image.texels.as_ptr() as usize));
        let texels: usize = images.map(|image| size_of_val(&*image.texels)).sum();
        let textures = texels
            + size_of_val(&*tables.textures)
            + size_of_val(&*tables.uses)
            + size_of_val(&*tables.material_textures)
            + size_of_val(&*tables.anisotropies)
            + size_of_val(&*tables.diffuse_transmissions)
            + size_of_val(&*tables.clearcoat_normals)
            + size_of_val(&*tables.sheens)
            + size_of_val(&*tables.partial_transmissions);
        let all = [
            ("vertex normals", size_of_val(&*tables.normals)),
            ("vertex tangents", size_of_val(&*tables.tangents)),
            ("vertex colours", size_of_val(&*tables.colors)),
            ("texture coordinates", size_of_val(&*tables.uvs)),
            ("textures", textures),
        ];
        all.into_iter().filter(|(_, bytes)| *bytes > 0).map(|(label, bytes)| (label.to_owned(), bytes as u64)).collect()
    }

    /// The tables, for evaluation.
    #[inline]
    pub(crate) fn view(&self) -> Shading<'_> {
        Shading { tables: self.tables.view(), values: &self.values, triangles: self.triangles }
    }
}

#[cfg(test)]
mod tests {
    use photon_core::{Filter, OwnedShadingTables, TexelFormat, Texture, Wrap};

    use super::*;

    /// Sizes by hand: two triangles with normals (12 bytes) and two UV sets (24 bytes), and texels that two textures share.
    #[test]
    fn memory_is_that_of_attributes_and_texels() {
        let image = Texture {
            texels: [0; 16].into(),
            width: 4,
            height: 4,
            format: TexelFormat::Srgb8,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
        };
        let tables = OwnedShadingTables {
            normals: vec![[0; 3]; 2],
            uvs: vec![[[0.0; 2]; 3]; 4],
            textures: vec![image.clone(), image.clone()],
            ..OwnedShadingTables::default()
        };
        let shading = CpuShading { tables, values: byte_values(), triangles: 2 };
        let textures = 16 * 4 + 2 * size_of::<Texture>() as u64;
        let expected = [("vertex normals", 24), ("texture coordinates", 96), ("textures", textures)];
        assert_eq!(shading.memory(), expected.map(|(label, bytes)| (label.to_owned(), bytes)));
    }
}
