//! A scene prepared for ray tracing.

use std::sync::OnceLock;
use std::time::Instant;

use photon_core::glam::Vec3;
use photon_core::random::unit_f32;
use photon_core::{
    EnvironmentMap, Error, Features, Hit, Interface, Layers, Light, LightCone, LightGroups, Material, MediaFeatures,
    Medium, MediumStack, OwnedGridTables, Portal, Primitive, Ray, RayCaster, Requirements, Result, RoughGlassTable,
    SceneView, Shaded, SkipLimit, Solids, Spectrum, SurfaceInteraction, Wavelength, alpha, interface, memory, offset,
    radiance_scale, roughest_caustic, shadow_terminator,
};
use photon_scene::{Accel, AccelError};
use rayon::prelude::*;

use crate::caster::Checked;
use crate::cpu::Cpu;
use crate::shading::CpuShading;
use crate::stages::clear_disc;
use crate::stages::light_tree::CpuLightTree;
use crate::stretches::CpuBoundaries;

/// A scene prepared for ray tracing.
#[expect(missing_debug_implementations, reason = "holds a foreign ray caster")]
pub struct CpuScene {
    pub(crate) vertices: Vec<[Vec3; 3]>,
    /// For each triangle, the result of `offset::margin`.
    pub(crate) margins: Vec<f32>,
    /// See [`Self::largest_inradius`].
    largest_inradius: OnceLock<f32>,
    pub(crate) primitives: Vec<Primitive>,
    pub(crate) materials: Vec<Material>,
    pub(crate) lights: Vec<Light>,
    pub(crate) light_cdf: Vec<u32>,
    /// See [`Self::light_cone`].
    light_cones: Vec<Option<LightCone>>,
    /// Groups of lights that each have a shadow ray, if there are rays enough.
    pub(crate) light_groups: LightGroups,
    /// For shadow rays in a scene with many lights.
    pub(crate) light_tree: Option<CpuLightTree>,
    pub(crate) environment: Option<EnvironmentMap>,
    pub(crate) portals: Vec<Portal>,
    media: Vec<Medium>,
    pub(crate) grids: OwnedGridTables,
    /// The media in which photons from each light start, on its front and on its back; empty if the scene needs no
    /// media.
    light_media: Vec<[MediumStack; 2]>,
    pub(crate) nested: bool,
    /// Whether some refractive index depends on the wavelength.
    pub(crate) disperses: bool,
    /// Whether some medium scatters light.
    pub(crate) scatters: bool,
    /// Whether the space around solids absorbs or scatters light.
    is_ambient: bool,
    /// Vertex attributes and textures; `None` in a scene without any, and without alpha.
    shading: Option<Box<CpuShading>>,
    /// Empty in a scene without rough solids.
    pub(crate) rough_glass: RoughGlassTable,
    /// A bit for each triangle, in words of 64: whether its material has alpha. Empty in a scene without alpha.
    with_alpha: Vec<u64>,
    pub(crate) caster: Box<dyn RayCaster>,
    pub(crate) boundaries: Option<CpuBoundaries>,
    pub(crate) features: Features,
    /// The features that the scene has; a subset of `features`.
    pub(crate) present: Features,
    /// [`roughest_caustic`].
    pub(crate) roughest_caustic: f32,
    /// Build time of the ray caster, in seconds.
    pub build_seconds: f64,
}

impl CpuScene {
    /// Labels and bytes of vertex attributes, textures and grids.
    pub(crate) fn shading_memory(&self) -> Vec<(String, u64)> {
        let mut memory = self.shading.as_ref().map(|shading| shading.memory()).unwrap_or_default();
        let bytes = self.grids.bytes();
        if bytes > 0 {
            memory.push(("grids of densities".to_owned(), bytes));
        }
        memory
    }

    pub(crate) fn new(on: &Cpu, view: &SceneView<'_>, required: &Requirements) -> Result<Self> {
        view.validate()?;
        let present = Features::of(view);
        required.check(present)?;
        let solids = Solids::of(view);
        let media = solids.features();
        required.check_media(media)?;
        let nested = required.media.contains(MediaFeatures::NESTED);
        let light_media = if nested || required.features.contains(Features::ABSORPTION) {
            let locator = solids.locate();
            view.lights.iter().map(|light| locator.of_light(light)).collect()
        } else {
            Vec::new()
        };
        let start = Instant::now();
        let caster = match &on.make_caster {
            Some(make) => Box::new(Checked::new(make(view)?, view.triangles.len())),
            None => Box::new(accel(view.positions, view.triangles, on.threads())?) as Box<dyn RayCaster>,
        };
        let boundaries = CpuBoundaries::new(&view.boundaries, on.threads())?;
        let build_seconds = start.elapsed().as_secs_f64();
        let by_tree = present.contains(Features::LIGHT_TREE) && required.samples_lights(present);
        let vertex = |index: u32| Vec3::from(view.positions[index as usize]);
        let mut vertices = memory::with_capacity(view.triangles.len(), "triangles")?;
        let mut margins = memory::with_capacity(view.triangles.len(), "triangles")?;
        on.pool.install(|| {
            let corners = view.triangles.par_iter().map(|triangle| triangle.map(vertex));
            let both = corners.map(|corners| (corners, offset::margin(corners)));
            both.unzip_into_vecs(&mut vertices, &mut margins);
        });
        Ok(Self {
            margins,
            vertices,
            largest_inradius: OnceLock::new(),
            primitives: memory::copied(view.primitives, "triangles")?,
            materials: memory::copied(view.materials, "materials")?,
            lights: memory::copied(view.lights, "lights")?,
            light_cdf: memory::copied(view.light_cdf, "lights")?,
            light_cones: LightCone::of_lights(view),
            light_groups: LightGroups::new(view),
            light_tree: by_tree.then(|| CpuLightTree::new(view)),
            environment: view.environment.cloned(),
            portals: view.portals.to_vec(),
            media: view.media.to_vec(),
            grids: view.grids.try_into()?,
            light_media,
            nested,
            disperses: media.contains(MediaFeatures::DISPERSION),
            scatters: media.contains(MediaFeatures::SCATTERING),
            is_ambient: media.contains(MediaFeatures::AMBIENT),
            shading: CpuShading::new(view, present),
            rough_glass: RoughGlassTable::new(view)?,
            with_alpha: with_alpha(view, present),
            caster,
            boundaries,
            features: required.features,
            present,
            roughest_caustic: roughest_caustic(view),
            build_seconds,
        })
    }

    /// The cone that contains the photons of a point or spot light outside of the scene.
    #[inline]
    pub(crate) fn light_cone(&self, index: usize) -> Option<&LightCone> {
        self.light_cones.get(index).and_then(Option::as_ref)
    }

    /// Radius of the largest circle within one triangle; found when it is first asked for.
    pub(crate) fn largest_inradius(&self) -> f32 {
        *self.largest_inradius.get_or_init(|| self.vertices.iter().map(clear_disc::inradius).fold(0.0, f32::max))
    }

    /// Whether some medium scatters light, or is outside of all solids.
    pub(crate) fn fills_space(&self) -> bool {
        self.scatters || self.is_ambient || self.boundaries.is_some()
    }

    /// Whether rays are traced in batches, as the ray caster prefers; never where a random word decides what a ray meets, or
    /// in media that scatter light or are outside of solids.
    pub(crate) fn traces_batches(&self) -> bool {
        !self.fills_space() && !self.present.intersects(Features::RANDOM_SURFACES) && self.caster.prefers_batches()
    }

    /// [`Self::hit`] for each ray.
    pub(crate) fn hit_many(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.resize(rays.len(), None);
        self.caster.nearest_many(rays, hits);
    }

    /// An error of the ray caster since the last call, after which the pass is invalid.
    ///
    /// # Errors
    /// [`Error::Backend`].
    pub(crate) fn check_caster(&self) -> Result<()> {
        match self.caster.take_error() {
            Some(source) => Err(Error::Backend { backend: "cpu: tracing rays", source }),
            None => Ok(()),
        }
    }

    /// The nearest intersection along `ray`, with everything that shading needs.
    #[inline]
    pub(crate) fn surface(&self, ray: &Ray) -> Option<SurfaceInteraction> {
        self.hit(ray).map(|(surface, _)| surface)
    }

    /// The nearest intersection along `ray`, with the hit that it was made from.
    #[inline]
    pub(crate) fn hit(&self, ray: &Ray) -> Option<(SurfaceInteraction, Hit)> {
        let hit = self.caster.nearest(ray)?;
        Some((self.interaction(ray, &hit), hit))
    }

    /// What shading needs of a hit along `ray`.
    #[inline(always)]
    pub(crate) fn interaction(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        let (index, record) = (hit.primitive as usize, &self.primitives[hit.primitive as usize]);
        SurfaceInteraction::new(ray.direction, hit, self.vertices[index], self.margins[index], record)
    }

    /// As [`Self::hit`], of the surfaces that are there for the random word `word`, with the material that it meets; it is
    /// not asked for without `ALPHA`: [`Features::RANDOM_SURFACES`].
    #[inline]
    pub(crate) fn hit_with<const ALPHA: bool>(
        &self,
        ray: &Ray,
        word: impl FnOnce() -> u32,
    ) -> std::result::Result<Option<(SurfaceInteraction, Hit)>, SkipLimit> {
        if !ALPHA {
            return Ok(self.hit(ray));
        }
        let word = word();
        let keep = |hit: &Hit| {
            let id = hit.primitive;
            !self.has_alpha(id) || alpha::keep(self.coverage(hit), id, word)
        };
        let found = if self.with_alpha.is_empty() {
            self.caster.nearest(ray)
        } else {
            self.caster.nearest_where(ray, &keep)?
        };
        let Some(hit) = found else { return Ok(None) };
        let mut surface = self.interaction(ray, &hit);
        if let Some(shading) = &self.shading {
            let (index, material) = (surface.material, &self.materials[surface.material as usize]);
            surface.material = shading.view().met_material(&hit, index, material, word);
        }
        Ok(Some((surface, hit)))
    }

    /// Whether something is in the way of `ray`, of the surfaces that are there for the random word `word`; it is not
    /// asked for without `ALPHA`.
    #[inline]
    pub(crate) fn occluded_with<const ALPHA: bool>(&self, ray: &Ray, word: impl FnOnce() -> u32) -> bool {
        if !ALPHA || self.with_alpha.is_empty() {
            return self.caster.occluded(ray);
        }
        let word = word();
        let keep = |hit: &Hit| {
            let id = hit.primitive;
            !self.has_alpha(id) || alpha::keep(self.coverage(hit), id, word)
        };
        self.caster.occluded_where(ray, &keep).unwrap_or(true)
    }

    /// As [`Self::surface`], of the surfaces that may be there: whose coverage is not 0. Those that are partly glass are
    /// opaque, as photons are stored there that stand for all that arrive.
    #[inline]
    pub(crate) fn covered_surface<const ALPHA: bool>(&self, ray: &Ray) -> Option<SurfaceInteraction> {
        if !ALPHA {
            return self.surface(ray);
        }
        let keep = |hit: &Hit| !self.has_alpha(hit.primitive) || self.coverage(hit) > 0.0;
        let hit = self.caster.nearest_where(ray, &keep).ok().flatten()?;
        let mut surface = self.interaction(ray, &hit);
        if let Some(shading) = &self.shading {
            let (index, material) = (surface.material, &self.materials[surface.material as usize]);
            surface.material = shading.view().extent_material(&hit, index, material);
        }
        Some(surface)
    }

    #[inline]
    fn has_alpha(&self, triangle: u32) -> bool {
        self.with_alpha.get(triangle as usize / 64).is_some_and(|bits| bits >> (triangle % 64) & 1 == 1)
    }

    /// The probability with which the surface at `hit` is there.
    pub(crate) fn coverage(&self, hit: &Hit) -> f32 {
        let Some(shading) = &self.shading else { return 1.0 };
        let material = &self.materials[self.primitives[hit.primitive as usize].material as usize];
        shading.view().coverage(hit, material)
    }

    /// The probability with which paths meet the opaque material of the surface at `hit`.
    pub(crate) fn met_share(&self, hit: &Hit) -> f32 {
        let Some(shading) = &self.shading else { return 1.0 };
        let material = &self.materials[self.primitives[hit.primitive as usize].material as usize];
        shading.view().coverage(hit, material) * (1.0 - shading.view().glass_share(hit, material))
    }

    /// Material and shading normal of `surface` at `hit`.
    #[inline]
    pub(crate) fn shade_matte(&self, surface: &SurfaceInteraction, hit: &Hit) -> Shaded {
        let material = &self.materials[surface.material as usize];
        match &self.shading {
            Some(shading) => shading.view().shade_matte(surface, hit, material),
            None => Shaded { material: *material, normal: surface.normal, layers: Layers::NONE },
        }
    }

    /// Material and normal at `hit`.
    #[inline]
    pub(crate) fn shade(&self, surface: &SurfaceInteraction, hit: &Hit) -> Shaded {
        let material = &self.materials[surface.material as usize];
        match &self.shading {
            Some(shading) => shading.view().shade(surface, hit, material),
            None => Shaded { material: *material, normal: surface.normal, layers: Layers::NONE },
        }
    }

    /// The vector from a visible point to where shadow rays start, 0 if it has no vertex normals: see
    /// [`shadow_terminator`]. 0 as well if something is in between, for the random word `word`.
    #[inline]
    pub(crate) fn shadow_offset<const ALPHA: bool>(
        &self,
        surface: &SurfaceInteraction,
        hit: &Hit,
        word: impl FnOnce() -> u32,
    ) -> Vec3 {
        let Some(normals) = self.shading.as_ref().and_then(|shading| shading.view().vertex_normals(hit)) else {
            return Vec3::ZERO;
        };
        let (vertices, weights) = (self.vertices[hit.primitive as usize], [1.0 - hit.u - hit.v, hit.u, hit.v]);
        let offset = shadow_terminator::offset(vertices, normals, weights, surface.start, surface.normal);
        if offset == Vec3::ZERO
            || self.occluded_with::<ALPHA>(&shadow_terminator::probe(surface.start, surface.normal, offset), word)
        {
            return Vec3::ZERO;
        }
        offset
    }

    /// Ratio of the radiance that a triangle emits at barycentric coordinates (u, v) to its mean, where `light` is its
    /// record; 0 in a channel that it does not emit.
    #[inline]
    pub(crate) fn emission_ratio(&self, light: &Light, u: f32, v: f32) -> Vec3 {
        let Some(shading) = &self.shading else { return Vec3::ONE };
        let material = &self.materials[self.primitives[light.primitive as usize].material as usize];
        shading.view().emission_ratio(light, (u, v), material)
    }

    /// What a clearcoat lets through of the light that a triangle emits at barycentric coordinates (u, v) in `direction`.
    #[inline]
    pub(crate) fn emission_through(&self, primitive: u32, at: (f32, f32), direction: Vec3) -> f32 {
        let Some(shading) = &self.shading else { return 1.0 };
        let Primitive { normal, material } = self.primitives[primitive as usize];
        let material = &self.materials[material as usize];
        shading.view().emission_through(primitive as usize, at, material, normal.into(), direction)
    }

    /// The interface that a path in `media` meets at `surface`: the media on its two sides.
    #[inline]
    pub(crate) fn interface(&self, surface: &SurfaceInteraction, media: MediumStack) -> Interface {
        self.interface_by(surface, media, self.nested)
    }

    /// As [`Self::interface`], for callers that already know whether solids are nested.
    #[inline(always)]
    pub(crate) fn interface_by(&self, surface: &SurfaceInteraction, media: MediumStack, nested: bool) -> Interface {
        let material = &self.materials[surface.material as usize];
        interface(&self.media, material, surface.front, media, nested)
    }

    /// Makes `interface` that of the wavelength of a path, if refraction depends on it there. A path without one draws it by
    /// a random word, which divides its power, or the throughput of a camera path.
    #[inline]
    pub(crate) fn disperse(
        &self,
        interface: &mut Interface,
        wavelength: &mut Wavelength,
        power: &mut Vec3,
        word: impl FnOnce() -> u32,
    ) {
        if !interface.is_dispersive(&self.media) {
            return;
        }
        if !wavelength.is_drawn() {
            *wavelength = Spectrum::get().draw(power, unit_f32(word()));
        }
        *interface = interface.at_wavelength(&self.media, *wavelength);
    }

    /// Index of the medium that applies in `media`, and the medium.
    #[inline]
    pub(crate) fn medium(&self, media: MediumStack) -> (u32, &Medium) {
        let index = media.current(&self.media);
        (index, &self.media[index as usize])
    }

    /// The medium with this index.
    #[inline]
    pub(crate) fn medium_at(&self, index: u32) -> &Medium {
        &self.media[index as usize]
    }

    /// The table of media.
    #[inline]
    pub(crate) fn media(&self) -> &[Medium] {
        &self.media
    }

    /// Index of the medium of the solids in `media`.
    #[inline]
    pub(crate) fn solid(&self, media: MediumStack) -> u32 {
        let current = media.current(&self.media);
        // A segment has the solid below the medium that applies.
        if self.media[current as usize].is_matched() { media.leave(current).current(&self.media) } else { current }
    }

    /// Whether rays that start in `media` may cross a medium that absorbs or scatters light.
    #[inline]
    pub(crate) fn may_attenuate(&self, media: MediumStack) -> bool {
        media != MediumStack::VACUUM || self.is_ambient || self.boundaries.is_some()
    }

    /// [`radiance_scale`] with the media of the scene.
    #[inline]
    pub(crate) fn radiance_scale(&self, from: MediumStack, at: MediumStack, wavelength: Wavelength) -> f32 {
        radiance_scale(&self.media, from, at, wavelength)
    }

    /// The media in which photons from a light start, on its front or on its back.
    #[inline]
    pub(crate) fn light_media(&self, light: usize, back: bool) -> MediumStack {
        self.light_media.get(light).map_or(MediumStack::VACUUM, |sides| sides[usize::from(back)])
    }
}

/// A tree over triangles.
pub(crate) fn accel(positions: &[[f32; 3]], triangles: &[[u32; 3]], threads: usize) -> Result<Accel> {
    Accel::build_by(positions, triangles, threads).map_err(|error| match error {
        AccelError::OutOfMemory(refused) => refused.into(),
        other => Error::Backend { backend: "cpu: building the BVH", source: Box::new(other) },
    })
}

/// [`CpuScene::with_alpha`].
fn with_alpha(view: &SceneView<'_>, present: Features) -> Vec<u64> {
    if !present.contains(Features::ALPHA) {
        return Vec::new();
    }
    let bit = |primitive: &Primitive| u64::from(view.materials[primitive.material as usize].has_alpha());
    let word = |part: &[Primitive]| part.iter().rev().fold(0, |bits, primitive| bits << 1 | bit(primitive));
    view.primitives.chunks(64).map(word).collect()
}
