//! [`SceneBuilder`]: assembles a scene from materials, meshes, lights and cameras.

use crate::boundaries::BoundaryTables;
use crate::describe::{
    AmbientMedium, CameraDesc, LightDesc, MaterialDesc, check_density, warn_of_clamped_anisotropy,
    warn_of_clamped_indices,
};
use crate::environment::{EnvironmentDesc, Sun};
use crate::error::SceneError;
use crate::mesh::{Mesh, VertexAttributes};
use crate::portals::{self, PortalDesc};
use crate::scene::Scene;
use crate::texture::{TextureDesc, TextureId};
use crate::{camera, contact, lights, normalise, order, repeated, shading, solids, validate};
use photon_core::{EnvironmentMap, Light, LightCone, Primitive, Units, light_cdf, shown};
use std::sync::Arc;

/// Handle of a material of one [`SceneBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub(crate) u32);

/// A scene under construction.
///
/// Nothing is validated before [`SceneBuilder::build`].
///
/// ```
/// use photon_scene::{CameraDesc, MaterialDesc, SceneBuilder};
///
/// let mut scene = SceneBuilder::new();
/// let white = scene.material(MaterialDesc::lambert("white", [0.8; 3]));
/// let glowing = scene.material(MaterialDesc::emissive("area light", [0.0; 3], [10.0; 3]));
/// scene.quad("floor", [[-1., 0., 1.], [1., 0., 1.], [1., 0., -1.], [-1., 0., -1.]], white);
/// scene.quad("area light", [[-1., 2., -1.], [1., 2., -1.], [1., 2., 1.], [-1., 2., 1.]], glowing);
/// scene.camera("front", CameraDesc::look_at([0., 1., 5.], [0., 1., 0.], [0., 1., 0.], 0.7));
/// let scene = scene.build()?;
/// assert_eq!(scene.view().triangles.len(), 4);
/// # Ok::<(), photon_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SceneBuilder {
    pub(crate) materials: Vec<MaterialDesc>,
    pub(crate) textures: Vec<TextureDesc>,
    pub(crate) meshes: Vec<Mesh>,
    pub(crate) lights: Vec<(String, LightDesc)>,
    pub(crate) environment: Option<EnvironmentMap>,
    /// The sun of the environment, and how that was described.
    pub(crate) sun: Option<Sun>,
    pub(crate) environment_text: Option<String>,
    pub(crate) portals: Vec<PortalDesc>,
    /// The medium around all solids; `None` for a vacuum.
    pub(crate) medium: Option<AmbientMedium>,
    pub(crate) cameras: Vec<(String, CameraDesc)>,
}

impl SceneBuilder {
    /// An empty scene.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a material and returns the handle by which meshes refer to it.
    pub fn material(&mut self, desc: MaterialDesc) -> MaterialId {
        self.materials.push(desc);
        MaterialId(u32::try_from(self.materials.len() - 1).unwrap_or(u32::MAX))
    }

    /// Adds a texture and returns the handle by which materials refer to it.
    pub fn texture(&mut self, desc: TextureDesc) -> TextureId {
        self.textures.push(desc);
        TextureId(u32::try_from(self.textures.len() - 1).unwrap_or(u32::MAX))
    }

    /// Adds triangles: each is three indices into `positions` (user space), counter-clockwise as seen
    /// from the front.
    pub fn mesh(
        &mut self,
        name: impl Into<Arc<str>>,
        positions: Vec<[f64; 3]>,
        triangles: Vec<[u32; 3]>,
        material: MaterialId,
    ) {
        self.mesh_with(name, positions, triangles, VertexAttributes::default(), material);
    }

    /// Adds triangles whose vertices have normals, colours or texture coordinates.
    pub fn mesh_with(
        &mut self,
        name: impl Into<Arc<str>>,
        positions: Vec<[f64; 3]>,
        triangles: Vec<[u32; 3]>,
        attributes: VertexAttributes,
        material: MaterialId,
    ) {
        self.meshes.push(Mesh { name: name.into(), positions, triangles, attributes, material });
    }

    /// Adds a quadrilateral as two triangles; corners counter-clockwise as seen from the front.
    pub fn quad(&mut self, name: impl Into<Arc<str>>, corners: [[f64; 3]; 4], material: MaterialId) {
        self.mesh(name, corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]], material);
    }

    /// Adds a point, spot or directional light.
    pub fn light(&mut self, name: impl Into<String>, desc: LightDesc) {
        self.lights.push((name.into(), desc));
    }

    /// Sets the light from infinitely far away, radiance in W/(m²·sr); replaces one that was set before. A black map is
    /// none.
    pub fn environment(&mut self, map: EnvironmentMap) {
        self.environment = (map.mean_radiance() != [0.0; 3]).then_some(map);
        (self.sun, self.environment_text) = (None, None);
    }

    /// As [`Self::environment`], from a description; its sun, if it has one, replaces that of an earlier description.
    ///
    /// # Errors
    /// As [`EnvironmentDesc::bake`].
    pub fn environment_from(&mut self, desc: &EnvironmentDesc) -> Result<(), SceneError> {
        let baked = desc.bake()?;
        self.environment(baked.map);
        self.sun = baked.sun;
        self.environment_text = Some(desc.to_string());
        Ok(())
    }

    /// Sets the sun: a light from infinitely far away, of constant radiance within a disc, which cameras see. Replaces that
    /// of an environment, and is replaced by those that are set later.
    pub fn sun(&mut self, sun: Sun) {
        self.sun = Some(sun);
    }

    /// Sets the medium around all solids; replaces one that was set before.
    pub fn medium(&mut self, medium: AmbientMedium) {
        self.medium = Some(medium);
    }

    /// Adds a portal: triangles in user space that fill an opening, such as a window, through which light from infinitely
    /// far away enters. They are no surfaces. Photons of the environment and of directional lights start through portals
    /// more often than elsewhere; wherever portals are, they change no expectation, only noise: [`photon_core::portals`].
    /// All portals together have at most [`photon_core::Portal::MAX`] triangles.
    pub fn portal(&mut self, name: impl Into<String>, triangles: Vec<[[f64; 3]; 3]>) {
        self.portals.push(PortalDesc::Triangles(name.into(), triangles));
    }

    /// As [`Self::portal`]: the triangles of all meshes that have this name, or a material of this name, such as those of
    /// window panes or curtains. They remain surfaces.
    pub fn portal_named(&mut self, name: impl Into<String>) {
        self.portals.push(PortalDesc::Named(name.into()));
    }

    /// Adds a camera; the first one is the default.
    pub fn camera(&mut self, name: impl Into<String>, desc: CameraDesc) {
        self.cameras.push((name.into(), desc));
    }

    /// The materials added so far, for modification.
    pub fn materials_mut(&mut self) -> &mut [MaterialDesc] {
        &mut self.materials
    }

    /// A material that was added before, for modification; `None` for one of another builder.
    #[must_use]
    pub fn material_mut(&mut self, id: MaterialId) -> Option<&mut MaterialDesc> {
        self.materials.get_mut(id.0 as usize)
    }

    /// Whether the scene has a camera.
    #[must_use]
    pub fn has_camera(&self) -> bool {
        !self.cameras.is_empty()
    }

    /// Whether anything emits light: a mesh with an emissive material, or a light.
    #[must_use]
    pub fn has_light(&self) -> bool {
        let emits = |mesh: &Mesh| self.materials.get(mesh.material.0 as usize).is_some_and(MaterialDesc::is_emissive);
        !self.lights.is_empty() || self.environment.is_some() || self.sun.is_some() || self.meshes.iter().any(emits)
    }

    /// Bounding box of the triangles in user space: lower and upper corner. `None` without triangles.
    #[must_use]
    pub fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        normalise::bounds(&self.meshes)
    }

    /// A camera that shows the whole scene: a room, whose surfaces face inwards, through its open side; other scenes with y
    /// upwards, obliquely from above, or from the front (+z) if they are flat along z.
    #[must_use]
    pub fn frame_camera(&self) -> CameraDesc {
        let bounds = self.bounds();
        camera::framing(bounds, bounds.and_then(|bounds| camera::open_side(self.meshes.iter(), bounds)))
    }

    /// Adds [`EnvironmentDesc::gradient`] if there are triangles and nothing emits light ([`Self::has_light`]), so that
    /// a model by itself can be seen; a black environment that was described is kept. Returns whether it did. Through a medium
    /// without bounds no environment shines: rendering says so.
    ///
    /// # Errors
    /// As [`Self::environment_from`].
    pub fn light_if_dark(&mut self) -> Result<bool, SceneError> {
        let is_dark = !self.has_light() && self.environment_text.is_none() && self.bounds().is_some();
        if is_dark {
            self.environment_from(&EnvironmentDesc::gradient())?;
        }
        Ok(is_dark)
    }

    /// Validates everything and converts it to normalised space.
    ///
    /// Triangles without area, those that light passes unchanged, and those that repeat others are dropped and counted. A scene without
    /// triangles, or without any light, is not an error here.
    ///
    /// # Errors
    /// [`SceneError`] for any value out of range; it names the material, mesh, light or camera.
    pub fn build(mut self) -> Result<Scene, SceneError> {
        validate::check(&self)?;
        for mesh in &mut self.meshes {
            let material = &mut self.materials[mesh.material.0 as usize];
            if material.is_boundary() {
                (mesh.attributes, material.textures) = Default::default();
            }
        }
        let mesh_names = self.meshes.iter().map(|mesh| Arc::clone(&mesh.name)).collect();
        let mesh_sources = order::sort_meshes(&mut self.meshes, &self.materials, &self.textures);
        shading::fold(&mut self.materials, &self.textures);
        shading::fold_alpha(&mut self.materials, &self.textures, &self.meshes);
        let frame = normalise::Frame::new(&self.meshes, &self.lights)?;
        let source =
            shading::Source { meshes: &self.meshes, materials: &self.materials, textures: &self.textures, frame };
        let mut geometry = normalise::geometry(&self.meshes, &self.materials, frame, source.is_shaded())?;
        let mut warnings = Vec::new();
        frame.warn(&mut warnings);
        solids::warn(&geometry, &self.materials, &mut warnings);
        check_density(&self.materials, self.medium.as_ref(), frame.scale)?;
        warn_of_clamped_indices(&self.materials, &mut warnings);
        warn_of_clamped_anisotropy(&self.materials, self.medium.as_ref(), &mut warnings);
        let touching = contact::Source {
            meshes: &self.meshes,
            materials: &self.materials,
            is_shaded: source.is_shaded(),
            scale: frame.scale,
        };
        contact::separate(touching, &mut geometry, &mut warnings);
        let repeated = repeated::remove(&mut geometry, &self.materials);
        if repeated > 0 {
            warnings.push(format!(
                "{repeated} triangles repeat others exactly, which rays meet instead, and were left out"
            ));
        }
        let ambient = self.medium.as_ref();
        let mut boundaries = BoundaryTables::new(&self.meshes, &self.materials, ambient, frame, &mut warnings);
        let radiances = shading::Radiances::new(source, &geometry);
        let lit = lights::table(
            lights::Sources { lights: &self.lights, sun: self.sun.as_ref(), environment: self.environment.as_ref() },
            &self.materials,
            &geometry,
            (frame, geometry.radius.max(boundaries.radius)),
            radiances,
            &mut warnings,
        )?;
        let ambient = ambient.filter(|medium| medium.bounds.is_none());
        let (mut materials, media, grids) =
            lights::materials(&self.materials, (ambient, &mut boundaries), &geometry, &lit, frame)?;
        let portals = portals::table(&self, frame, geometry.radius)?;
        let shading = shading::tables(source, &geometry, &mut materials, &mut warnings);
        let units = Units { center: frame.center.to_array(), scale: frame.scale, power: lit.power };
        warn_of_radiance(units, &mut warnings);
        if geometry.triangles.is_empty() && boundaries.view().is_empty() {
            warnings.push("the scene has no triangles, so that there is nothing to see".to_owned());
        }
        if geometry.invisible > 0 {
            warnings.push(format!(
                "{} triangles of an ior of 1, or of an alpha of 0, bound nothing and were left out",
                geometry.invisible
            ));
        }
        let flat = geometry.dropped.len() - geometry.removed;
        if flat > 0 {
            warnings.push(format!("{flat} triangles without area were dropped"));
        }
        let is_infinite = |light: &Light| matches!(light.kind, Light::DIRECTIONAL | Light::ENVIRONMENT);
        if !portals.is_empty() && !lit.lights.iter().any(is_infinite) {
            warnings.push("portals have no effect, since no light is infinitely far away".to_owned());
        }

        let radius = lit.lights.iter().map(|light| normalise::length(light.position)).fold(geometry.radius, f64::max);
        let mut scene = Scene {
            environment: self.environment.filter(|_| lit.shows_environment()).map(|map| map.scaled(lit.per_power())),
            environment_text: self.environment_text,
            portals,
            light_cdf: Vec::new(),
            units,
            shading,
            radius: normalise::round_up(radius),
            // In the same memory.
            primitives: geometry
                .primitives
                .into_iter()
                .map(|(normal, material)| Primitive { normal, material })
                .collect(),
            positions: geometry.positions,
            triangles: geometry.triangles,
            mesh_starts: geometry.mesh_starts,
            mesh_sources,
            mesh_names,
            material_names: self.materials.into_iter().map(|material| material.name).collect(),
            materials,
            boundaries,
            media,
            grids,
            lights: lit.lights,
            cameras: self.cameras,
            dropped: geometry.dropped,
            warnings: warnings.iter().map(|warning| shown(warning).into_owned()).collect(),
        };
        // Shares of paths follow the power that arrives.
        let arriving = LightCone::arriving(&scene.view());
        let weights: Vec<f64> = lit.means.iter().zip(arriving).map(|(mean, arriving)| mean * arriving).collect();
        scene.light_cdf = light_cdf(&weights);
        Ok(scene)
    }
}

/// Warns if radiances are outside the range of f32 pictures; the film, in f64, can represent them.
fn warn_of_radiance(units: Units, warnings: &mut Vec<String>) {
    let radiance = units.radiance_to_user();
    if !(1e-32..=1e32).contains(&radiance) {
        warnings.push(format!(
            "radiances of about {radiance:.0e} W/(m²·sr) are beyond the 32 bits of a picture; use another unit of \
             length or of power"
        ));
    }
}
