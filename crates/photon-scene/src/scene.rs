//! A validated scene in normalised space.

use crate::boundaries::BoundaryTables;
use crate::describe::{CameraDesc, ThinLens};
use crate::error::SceneError;
use crate::{camera, similar, validate};
use photon_core::{
    Camera, EnvironmentMap, Light, Material, Medium, OwnedGridTables, OwnedShadingTables, Portal, Primitive, SceneView,
    Units,
};
use std::sync::Arc;

/// The result of [`crate::SceneBuilder::build`]: the tables that backends read, and the names and units for
/// messages and results.
///
/// Vertices lie in a box of unit size centred at the origin, vertices that no triangle uses are removed, and
/// the triangles of a mesh follow each other. Meshes and lights are in an order of their own, so that no result depends on
/// that in which they were added; [`Scene::triangle_sources`] says where triangles come from. Powers are fractions of
/// [`Units::power`].
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) primitives: Vec<Primitive>,
    pub(crate) materials: Vec<Material>,
    pub(crate) boundaries: BoundaryTables,
    pub(crate) media: Vec<Medium>,
    pub(crate) grids: OwnedGridTables,
    pub(crate) lights: Vec<Light>,
    pub(crate) light_cdf: Vec<u32>,
    pub(crate) environment: Option<EnvironmentMap>,
    pub(crate) portals: Vec<Portal>,
    pub(crate) environment_text: Option<String>,
    pub(crate) shading: OwnedShadingTables,
    pub(crate) radius: f32,
    pub(crate) units: Units,
    pub(crate) mesh_starts: Vec<u32>,
    /// Index of each mesh in the order in which meshes were added, which is that of their names.
    pub(crate) mesh_sources: Vec<u32>,
    pub(crate) mesh_names: Vec<Arc<str>>,
    pub(crate) material_names: Vec<String>,
    pub(crate) cameras: Vec<(String, CameraDesc)>,
    /// Mesh and triangle, sorted.
    pub(crate) dropped: Vec<[u32; 2]>,
    pub(crate) warnings: Vec<String>,
}

impl Scene {
    /// The tables, borrowed.
    #[must_use]
    pub fn view(&self) -> SceneView<'_> {
        SceneView {
            positions: &self.positions,
            triangles: &self.triangles,
            primitives: &self.primitives,
            materials: &self.materials,
            boundaries: self.boundaries.view(),
            media: &self.media,
            grids: self.grids.view(),
            lights: &self.lights,
            light_cdf: &self.light_cdf,
            environment: self.environment.as_ref(),
            portals: &self.portals,
            shading: self.shading.view(),
            radius: self.radius,
            units: self.units,
        }
    }

    /// Digest of all that passes depend on, cameras excluded: [`SceneView::digest`]. Names do not count.
    #[must_use]
    pub fn digest(&self) -> u128 {
        self.view().digest()
    }

    /// The camera of the given name, or the first one, for a picture of `width` by `height` pixels.
    ///
    /// The vertical field of view is kept; the horizontal one follows from the picture's aspect ratio.
    ///
    /// # Errors
    /// No camera at all, none of that name (the message lists those that exist), a picture without
    /// pixels, or a camera beyond the range of f32 in units of the scene.
    pub fn camera(&self, name: Option<&str>, width: u32, height: u32) -> Result<Camera, SceneError> {
        let (name, desc) = self.named_camera(name)?;
        camera::resolve(name, desc, self.units, width, height)
    }

    /// As [`Scene::camera`], with another lens in place of that of the camera.
    ///
    /// # Errors
    /// Those of [`Scene::camera`]; a lens with a number out of range, or for an orthographic camera.
    pub fn camera_with_lens(
        &self,
        name: Option<&str>,
        lens: ThinLens,
        width: u32,
        height: u32,
    ) -> Result<Camera, SceneError> {
        let (name, desc) = self.named_camera(name)?;
        let desc = desc.clone().with_lens(lens);
        validate::named_camera(name, &desc)?;
        camera::resolve(name, &desc, self.units, width, height)
    }

    fn named_camera(&self, name: Option<&str>) -> Result<(&str, &CameraDesc), SceneError> {
        let wanted = |(known, _): &&(String, CameraDesc)| name.is_none_or(|name| name == known);
        match (self.cameras.iter().find(wanted), name) {
            (Some((name, desc)), _) => Ok((name, desc)),
            (None, Some(name)) if !self.cameras.is_empty() => {
                // The middle of a long list is left out.
                let mut known: Vec<&str> = self.camera_names().collect();
                similar::sort(name, &mut known);
                let known = known.into_iter().map(str::to_owned).collect();
                Err(SceneError::UnknownCamera { name: name.to_owned(), known })
            }
            (None, _) => Err(SceneError::NoCamera),
        }
    }

    /// Names of the cameras, in the order in which they were added.
    pub fn camera_names(&self) -> impl Iterator<Item = &str> {
        self.cameras.iter().map(|(name, _)| name.as_str())
    }

    /// Conversion back to user space and watts.
    #[must_use]
    pub fn units(&self) -> Units {
        self.units
    }

    /// The description of the environment ([`crate::EnvironmentDesc`]), for headers of files; `None` without one, or with
    /// one that was set as a map.
    #[must_use]
    pub fn environment_text(&self) -> Option<&str> {
        self.environment_text.as_deref()
    }

    /// Names of the materials, by index. Materials of `view()` beyond these are the glass of partly transmitting ones.
    pub fn material_names(&self) -> impl Iterator<Item = &str> {
        self.material_names.iter().map(String::as_str)
    }

    /// Name of the mesh that a triangle belongs to; empty if there is no such triangle.
    #[must_use]
    pub fn mesh_of_triangle(&self, primitive: u32) -> &str {
        if primitive as usize >= self.triangles.len() {
            return "";
        }
        // Meshes without remaining triangles start at the same index as the next mesh: the last one is right.
        let after = self.mesh_starts.partition_point(|&start| start <= primitive);
        let source = after.checked_sub(1).and_then(|mesh| self.mesh_sources.get(mesh));
        source.and_then(|&source| self.mesh_names.get(source as usize)).map_or("", AsRef::as_ref)
    }

    /// Number of triangles that were left out: those without area, faces within one medium, and those that repeat others.
    #[must_use]
    pub fn dropped_triangles(&self) -> u64 {
        self.dropped.len() as u64
    }

    /// For each triangle of [`Self::view`], the triangle that it was in the description: the index of its mesh, in the order
    /// in which meshes were added, and its index within the mesh.
    pub fn triangle_sources(&self) -> impl Iterator<Item = (u32, u32)> {
        let mut dropped = self.dropped.iter().peekable();
        let ends = self.mesh_starts.iter().skip(1).copied().chain([self.triangles.len() as u32]);
        self.mesh_starts.iter().zip(ends).zip(0..).zip(&self.mesh_sources).flat_map(
            move |(((&start, end), mesh), &source)| {
                let mut kept = Vec::with_capacity((end - start) as usize);
                let mut next = 0;
                while kept.len() < (end - start) as usize {
                    match dropped.next_if(|&&at| at <= [mesh, next]) {
                        Some(&at) => next += u32::from(at == [mesh, next]),
                        None => {
                            kept.push((source, next));
                            next += 1;
                        }
                    }
                }
                kept
            },
        )
    }

    /// Names of the meshes, in the order in which they were added.
    pub fn mesh_names(&self) -> impl Iterator<Item = &str> {
        self.mesh_names.iter().map(AsRef::as_ref)
    }

    /// Warnings: problems that do not prevent rendering.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

#[cfg(test)]
mod tests {
    use crate::{MaterialDesc, SceneBuilder};

    #[test]
    fn triangles_know_what_they_were_in_the_description() {
        let mut scene = SceneBuilder::new();
        let white = scene.material(MaterialDesc::lambert("white", [0.5; 3]));
        let air = scene.material(MaterialDesc::thin("air", 1.0));
        let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
        let (flat, good, other) = ([0, 0, 1], [0, 1, 2], [1, 3, 2]);
        scene.mesh("a", corners.clone(), vec![flat, good, flat, flat, other, flat], white);
        scene.mesh("invisible", corners.clone(), vec![good], air);
        scene.mesh("none", corners.clone(), vec![flat, flat], white);
        let above = corners.iter().map(|&[x, y, z]| [x, y, z + 0.5]).collect();
        scene.mesh("b", above, vec![good, flat, other], white);
        let scene = scene.build().unwrap();
        let sources: Vec<_> = scene.triangle_sources().collect();
        assert_eq!(sources, [(0, 1), (0, 4), (3, 0), (3, 2)]);
        assert_eq!((scene.dropped_triangles(), sources.len()), (7, scene.view().triangles.len()));
        for (primitive, (mesh, _)) in sources.into_iter().enumerate() {
            assert_eq!(scene.mesh_names().nth(mesh as usize), Some(scene.mesh_of_triangle(primitive as u32)));
        }
    }
}
