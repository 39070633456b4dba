//! Vertex attributes and textures of a prepared scene.

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

    /// The tables, for evaluation.
    #[inline]
    pub(crate) fn view(&self) -> Shading<'_> {
        Shading { tables: self.tables.view(), values: &self.values, triangles: self.triangles }
    }
}
