//! Camera paths, traced to the first diffuse surface.

use std::sync::atomic::{AtomicU64, Ordering};

use photon_core::glam::Vec3;
use photon_core::light_sampler::light_of_triangle;
use photon_core::memory;
use photon_core::random::{BLOCK_LIGHT_SIDES, BLOCK_START, BLOCK_SURFACES, Domain, Sampler, evenly_spread, unit_f32};
use photon_core::{
    EyeBuffers, EyeTracer, Features, FilmPixel, Hit, Layer, Layers, Light, Lobe, Material, MediumStack,
    NEGLIGIBLE_THROUGHPUT, Pass, QUERIES_PER_PIXEL, Query, RandomKind, Ray, Result, Scattering, SkipLimit,
    SurfaceInteraction, Vertex, View, Wavelength, anisotropy, gloss_caustics, most_total_reflections, octahedral,
    russian_roulette, sampling, shading_normal, shadow_terminator,
};
use rayon::prelude::*;

use crate::cpu::Cpu;
use crate::film::{CpuFilm, deposit};
use crate::scene::CpuScene;
use crate::stages::eye_glossy::{GlossyPoint, Leaves, Reflection};
use crate::stages::eye_rough_glass::RoughPoint;
use crate::stages::eye_segments::{self, End};
use crate::stages::{camera_ray, eye_batch};

/// Traces camera paths through mirrors and glass.
///
/// A path splits at the first two surfaces that have two lobes: at dielectric interfaces into reflection and transmission,
/// at glossy surfaces into reflection and base. At later ones it chooses a lobe at random.
#[derive(Debug)]
pub(crate) struct CpuEye {
    pub(crate) max_bounces: u32,
    /// Whether camera rays that hit nothing do not see the environment.
    pub(crate) hides_background: bool,
    /// Whether paths leave queries for reflections, instead of all else: [`photon_core::GlossCaustics`].
    pub(crate) reflections: bool,
    /// [`photon_core::segments_per_pixel`].
    pub(crate) most_segments: u32,
    /// [`photon_core::Requirements::terminator_offset`].
    pub(crate) terminator_offset: bool,
    /// [`photon_core::Requirements::caustic_roughness`].
    pub(crate) caustic_roughness: Option<f32>,
    /// [`EyeTracer::truncated`].
    pub(crate) truncated: u64,
}

/// Parameters of kernels. Paths leave queries at visible points.
pub(crate) const POINTS: u8 = 0;
/// For the reflection of glossy surfaces, and add nothing to the film.
pub(crate) const REFLECTIONS: u8 = 1;
/// At visible points, and segments in media that scatter light.
const POINTS_AND_SEGMENTS: u8 = 2;

/// Label of the memory for the queries of a row.
pub(crate) const QUERIES: &str = "camera paths";

const SPLITS: u32 = QUERIES_PER_PIXEL.ilog2();

impl EyeTracer<Cpu> for CpuEye {
    fn trace_eye(
        &mut self,
        on: &mut Cpu,
        scene: &CpuScene,
        view: &View,
        pass: Pass,
        film: &mut CpuFilm,
        EyeBuffers { queries, mut segments }: EyeBuffers<'_, Cpu>,
    ) -> Result<()> {
        let max_splits = if scene.features.splits_camera_paths() { SPLITS } else { 0 };
        let reflections = self.reflections;
        let eye = Eye {
            scene,
            view,
            pass,
            max_bounces: self.max_bounces,
            hides_background: self.hides_background,
            max_splits,
            terminator_offset: self.terminator_offset,
            caustic_roughness: self.caustic_roughness.filter(|&least| least <= scene.roughest_caustic),
            most_segments: self.most_segments,
            truncated: AtomicU64::new(0),
        };
        let has_lens = view.camera.features().contains(Features::THIN_LENS);
        let is_shaded = scene.features.intersects(Features::SHADED) || scene.disperses;
        let look = match (is_shaded, scene.present.intersects(Features::RANDOM_SURFACES), has_lens) {
            (_, _, true) if reflections => Eye::look::<true, true, true, REFLECTIONS>,
            (_, _, false) if reflections => Eye::look::<true, true, false, REFLECTIONS>,
            kind if segments.is_some() => Eye::look_of_kind::<POINTS_AND_SEGMENTS>(kind),
            kind => Eye::look_of_kind::<POINTS>(kind),
        };
        let in_batches = scene.traces_batches();
        let mut rows: Vec<Result<Found>> = memory::with_capacity(view.height as usize, QUERIES)?;
        on.pool.install(|| {
            let all = film.pending.par_chunks_mut(view.width as usize).with_max_len(1).enumerate();
            let traced = all.map(|(row, pixels)| {
                on.stop.check()?;
                let mut found = Found { queries: memory::with_capacity(pixels.len(), QUERIES)?, segments: Vec::new() };
                if in_batches {
                    eye_batch::trace_row(&eye, row as u32, (has_lens, reflections), pixels, &mut found)?;
                    return Ok(found);
                }
                for (column, pixel) in pixels.iter_mut().enumerate() {
                    memory::reserve_doubling(&mut found.queries, QUERIES_PER_PIXEL as usize, QUERIES)?;
                    if segments.is_some() {
                        memory::reserve_doubling(&mut found.segments, QUERIES_PER_PIXEL as usize, QUERIES)?;
                    }
                    look(&eye, column as u32, row as u32, pixel, &mut found);
                }
                Ok(found)
            });
            traced.collect_into_vec(&mut rows);
        });
        // Further samples of a pass go on counting.
        self.truncated = eye.truncated.into_inner() + if pass.sample == 0 { 0 } else { self.truncated };
        queries.clear();
        segments.iter_mut().for_each(|segments| segments.clear());
        for row in rows {
            let row = row?;
            queries.append(&row.queries);
            segments.iter_mut().for_each(|segments| segments.append(&row.segments));
        }
        scene.check_caster()
    }

    fn truncated(&mut self, _on: &mut Cpu) -> Result<u64> {
        Ok(self.truncated)
    }
}

/// Queries and segments that the paths of a row have left.
pub(crate) struct Found {
    pub(crate) queries: Vec<Query>,
    pub(crate) segments: Vec<Query>,
}

pub(crate) struct Eye<'a> {
    pub(crate) scene: &'a CpuScene,
    pub(crate) view: &'a View,
    pub(super) pass: Pass,
    max_bounces: u32,
    hides_background: bool,
    pub(crate) max_splits: u32,
    terminator_offset: bool,
    /// Reflections at least this rough show caustics of all lights from photons; `None`: none does.
    caustic_roughness: Option<f32>,
    /// Maximum number of segments of a pixel.
    pub(super) most_segments: u32,
    truncated: AtomicU64,
}

/// State of a camera path.
#[derive(Clone, Copy)]
pub(crate) struct Path {
    pub(crate) ray: Ray,
    /// Throughput of radiance over n², which refraction leaves unchanged.
    pub(crate) throughput: Vec3,
    pub(crate) media: MediumStack,
    pub(crate) wavelength: Wavelength,
    pub(crate) surfaces: u32,
    /// Number of total reflections.
    total: u32,
    pub(crate) splits: u32,
    /// Index of this path among the pixel's paths; part of the random-number key.
    pub(crate) branch: u32,
    /// Normal of the surface at which the ray starts, on either side; the direction of the ray at the camera. Only for
    /// segments.
    pub(super) start: Vec3,
    /// The glossy surface or rough glass that it left last.
    pub(crate) reflected: Reflection,
}

/// [`Eye::look`] with its parameters.
type Look<'a> = fn(&Eye<'a>, u32, u32, &mut FilmPixel, &mut Found);

impl<'a> Eye<'a> {
    /// [`Self::look`] for scenes with shading, alpha, and a lens or not.
    fn look_of_kind<const QUERIES: u8>(kind: (bool, bool, bool)) -> Look<'a> {
        match kind {
            (_, true, true) => Self::look::<true, true, true, QUERIES>,
            (_, true, false) => Self::look::<true, true, false, QUERIES>,
            (true, false, true) => Self::look::<true, false, true, QUERIES>,
            (true, false, false) => Self::look::<true, false, false, QUERIES>,
            (false, false, true) => Self::look::<false, false, true, QUERIES>,
            (false, false, false) => Self::look::<false, false, false, QUERIES>,
        }
    }

    /// Traces the paths of a pixel. `SHADED`: surfaces have textures or shading normals; `ALPHA`: alpha; `LENS`: the
    /// camera has a lens; `QUERIES`: what paths leave.
    fn look<const SHADED: bool, const ALPHA: bool, const LENS: bool, const QUERIES: u8>(
        &self,
        x: u32,
        y: u32,
        pixel: &mut FilmPixel,
        found: &mut Found,
    ) {
        let number = y * self.view.width + x;
        let sampler = |branch: u32| self.sampler(number, branch);
        let mut waiting = [self.first::<LENS>(x, y); QUERIES_PER_PIXEL as usize];
        let mut count = 1;
        let before = found.segments.len();
        while count > 0 {
            count -= 1;
            let mut path = waiting[count];
            while let Some(branch) =
                self.step::<SHADED, ALPHA, QUERIES>(&mut path, None, number, pixel, found, &sampler)
            {
                if let Some(branch) = branch {
                    waiting[count] = branch;
                    count += 1;
                }
            }
        }
        if QUERIES == POINTS_AND_SEGMENTS {
            eye_segments::limit(self, number, &mut found.segments, before);
        }
    }

    /// Whether a path that is to go on ends: it has met as many surfaces as it may, or is trapped, which is counted if light is
    /// missing; or by Russian roulette, since it is dark.
    pub(super) fn ends(&self, path: &mut Path, sampler: &impl Fn(u32) -> Sampler) -> bool {
        let is_dark = path.throughput.max_element() < NEGLIGIBLE_THROUGHPUT;
        if path.surfaces >= self.max_bounces || path.total > most_total_reflections(self.max_bounces) {
            self.truncated.fetch_add(u64::from(!is_dark), Ordering::Relaxed);
            return true;
        }
        if !is_dark {
            return false;
        }
        let [_, word, ..] = sampler(path.branch).words(BLOCK_LIGHT_SIDES + path.surfaces);
        let factor = russian_roulette(path.throughput, word);
        path.throughput *= factor.unwrap_or(0.0);
        factor.is_none()
    }

    /// The random numbers of a path of pixel `number`.
    pub(super) fn sampler(&self, number: u32, branch: u32) -> Sampler {
        let key = number * QUERIES_PER_PIXEL + branch;
        Sampler::new(RandomKind::Counter, self.pass.seed, self.pass.index, Domain::Eye, key).of_sample(self.pass.sample)
    }

    /// The first path of a pixel. `LENS`: the camera has a lens.
    pub(super) fn first<const LENS: bool>(&self, x: u32, y: u32) -> Path {
        let own = self.sampler(y * self.view.width + x, 0);
        let [[_, _, c, d], [a, b, ..]] = [own, own.of_first_sample()].map(|mut sampler| sampler.words(BLOCK_START));
        // Points of further samples follow that of the first.
        let [a, b] = evenly_spread([a, b], self.pass.sample);
        let camera = &self.view.camera;
        let across = 2.0 * (x as f32 + unit_f32(a)) / self.view.width as f32 - 1.0;
        let down = 2.0 * (y as f32 + unit_f32(b)) / self.view.height as f32 - 1.0;
        let ray = if LENS {
            camera_ray::through_lens(camera, across, -down, [c, d])
        } else {
            camera_ray::through_pinhole(camera, across, -down)
        };
        Path {
            ray,
            throughput: Vec3::ONE,
            media: MediumStack::from_bits(self.view.camera.media),
            wavelength: Wavelength::NONE,
            surfaces: 0,
            total: 0,
            splits: 0,
            branch: 0,
            start: ray.direction,
            reflected: Reflection::default(),
        }
    }

    /// Traces the path to its next surface; `known` is what its ray hits, if that is known. Returns `None` when the path has
    /// ended, `Some(Some(other))` when it has split.
    pub(super) fn step<const SHADED: bool, const ALPHA: bool, const QUERIES: u8>(
        &self,
        path: &mut Path,
        known: Option<Option<Hit>>,
        number: u32,
        pixel: &mut FilmPixel,
        Found { queries, segments }: &mut Found,
        sampler: &impl Fn(u32) -> Sampler,
    ) -> Option<Option<Path>> {
        let has_points = QUERIES != REFLECTIONS;
        // Transmittance up to the end.
        let mut passed = |path: &Path, media: MediumStack, end: End| match QUERIES {
            POINTS_AND_SEGMENTS => eye_segments::leave(self, path, media, end, number, segments),
            _ => self.scene.attenuation(&path.ray, end.distance, media),
        };
        let layer = || sampler(path.branch).words(BLOCK_SURFACES + path.surfaces)[3];
        let found = match known {
            Some(hit) => hit.map(|hit| (self.scene.interaction(&path.ray, &hit), hit)),
            None => match self.scene.hit_with::<ALPHA>(&path.ray, layer) {
                Ok(found) => found,
                Err(SkipLimit) => {
                    self.truncated.fetch_add(1, Ordering::Relaxed);
                    return None;
                }
            },
        };
        let Some((mut surface, hit)) = found else {
            let end = End { distance: f32::INFINITY, normal: path.ray.direction };
            let passed = passed(path, path.media, end);
            let is_hidden = self.hides_background && path.surfaces == 0;
            if self.scene.boundaries.is_some() {
                path.throughput *= passed;
            }
            if let Some(environment) = self.scene.environment.as_ref().filter(|_| !is_hidden && has_points) {
                let camera = MediumStack::from_bits(self.view.camera.media);
                let throughput = path.throughput * self.scene.radiance_scale(camera, path.media, path.wavelength);
                let mut radiance = environment.radiance(path.ray.direction);
                if SHADED && path.reflected.weighs_lights() {
                    let light = self.scene.lights.iter().rposition(|light| light.kind == Light::ENVIRONMENT);
                    radiance *= self.share(path, light, || environment.pdf(path.ray.direction));
                }
                deposit(pixel, Layer::Emission, throughput.into(), radiance.to_array().map(f64::from));
            }
            // Shadow rays and photons find the sun for paths with glossy surfaces.
            if self.scene.features.contains(Features::SUN)
                && !is_hidden
                && has_points
                && path.reflected.pdf == 0.0
                && let Some(sun) = self.scene.lights.iter().rfind(|light| light.is_sun())
                && sampling::versine(path.ray.direction, -Vec3::from(sun.direction)) <= sun.versine_outer
            {
                let camera = MediumStack::from_bits(self.view.camera.media);
                let throughput = path.throughput * self.scene.radiance_scale(camera, path.media, path.wavelength);
                deposit(pixel, Layer::Emission, throughput.into(), sun.sun_radiance().to_array().map(f64::from));
            }
            return None;
        };
        let mut material = &self.scene.materials[surface.material as usize];
        let evaluated = if SHADED { Some(self.scene.shade(&surface, &hit)) } else { None };
        let (mut normal, mut layers) = (surface.normal, Layers::NONE);
        if let Some(evaluated) = &evaluated {
            (material, normal, layers) = (&evaluated.material, evaluated.normal, evaluated.layers);
            if material.is_specular() {
                normal = shading_normal::bend(normal, -path.ray.direction);
                surface = surface.with_cosine_to(normal, path.ray.direction);
            }
        }
        if path.surfaces == 0 && has_points {
            pixel.hits += 1;
            pixel.depth += f64::from(surface.t);
            for axis in 0..3 {
                pixel.normal[axis] += f64::from(normal[axis]);
                pixel.albedo[axis] += f64::from(material.albedo[axis]);
            }
        }
        let mut interface = self.scene.interface(&surface, path.media);
        let end = End { distance: surface.t, normal: -surface.normal };
        path.throughput *= passed(path, interface.before, end);
        if QUERIES == POINTS_AND_SEGMENTS {
            path.start = surface.normal;
        }
        if SHADED && self.scene.disperses {
            let word = || sampler(path.branch).wavelength(0);
            self.scene.disperse(&mut interface, &mut path.wavelength, &mut path.throughput, word);
        }
        // Factor from the radiance that leaves the surface to its contribution at the camera.
        let seen = || {
            let camera = MediumStack::from_bits(self.view.camera.media);
            path.throughput * self.scene.radiance_scale(camera, interface.before, path.wavelength)
        };
        let emits = material.is_emissive() && has_points;
        if emits && (surface.front || material.flags & Material::EMITS_BOTH_SIDES != 0) {
            let mut throughput = seen();
            if SHADED && self.scene.present.contains(Features::COATED_LIGHTS) {
                throughput *= self.scene.emission_through(hit.primitive, (hit.u, hit.v), -path.ray.direction);
            }
            if SHADED && path.reflected.weighs_lights() {
                let light = light_of_triangle(&self.scene.lights, hit.primitive);
                throughput *= self.share(path, light, || self.pdf_of_light(path, light, surface.t));
            }
            deposit(pixel, Layer::Emission, throughput.into(), material.emission.map(f64::from));
        }
        // Where rays to lights start, and paths that are weighed against them.
        let (mut lit, mut offset) = (surface, Vec3::ZERO);
        if SHADED && self.terminator_offset && material.samples_lights() {
            let layer = || sampler(path.branch).words(BLOCK_SURFACES + path.surfaces)[3];
            offset = self.scene.shadow_offset::<ALPHA>(&surface, &hit, layer);
            if offset != Vec3::ZERO {
                lit = SurfaceInteraction { start: surface.start + offset, normal, ..surface };
            }
        }
        let offset_or_wo = if QUERIES == REFLECTIONS {
            octahedral::pack(-path.ray.direction)
        } else {
            shadow_terminator::pack(offset)
        };
        let query = |throughput: Vec3, branch: u32, [media, coat]: [u32; 2]| Query {
            // Moved off edges: beside an edge, rounding may put the point behind the adjacent wall, outside
            // its shadow.
            position: surface.start.into(),
            radius: 1.0,
            normal: surface.normal.into(),
            pixel: number,
            throughput: throughput.into(),
            media,
            offset_or_wo,
            path: number * QUERIES_PER_PIXEL + branch,
            shading_normal: if SHADED { octahedral::pack(normal) } else { 0 },
            coat,
        };
        let wo = -path.ray.direction;
        let vertex = Vertex {
            material,
            layers: &layers,
            wo,
            cosine: surface.cosine,
            interface: &interface,
            carries_light: false,
        };
        let rules = if SHADED { self.scene.features } else { self.scene.features.difference(Features::FOLLOWED) };
        let bsdf = match Scattering::at(rules, &self.scene.rough_glass, &vertex) {
            Scattering::Glossy(glossy) => {
                let shows_all =
                    self.caustic_roughness.map(|least| gloss_caustics::narrowest(material, &layers) >= least);
                let media = interface.before;
                let at =
                    GlossyPoint { surface: &lit, normal, media, glossy: &glossy, shows_all: shows_all == Some(true) };
                let leaves = if QUERIES == REFLECTIONS {
                    // Relative to the normal as the query has it.
                    let packed = || anisotropy::pack(&layers, octahedral::unpack(octahedral::pack(normal)));
                    let anisotropy = self.scene.present.contains(Features::ANISOTROPY).then(packed);
                    // Without lights that have photons for every reflection, others need no query.
                    let only_all = !self.scene.present.intersects(Features::DELTA_LIGHTS);
                    if shows_all == Some(false) && only_all {
                        Leaves::none()
                    } else {
                        Leaves::reflection(material, &layers, &glossy, seen(), anisotropy)
                    }
                } else {
                    self.light_reflection::<ALPHA>(path, &at, seen(), pixel, sampler);
                    Leaves::base(&at, seen())
                };
                let query = |throughput: Vec3, branch: u32, words: [u32; 2]| {
                    let made = query(throughput, branch, words);
                    let offset_or_wo = match shows_all {
                        Some(all) if QUERIES == REFLECTIONS => gloss_caustics::with_mark(made.offset_or_wo, all),
                        _ => made.offset_or_wo,
                    };
                    Query { offset_or_wo, ..made }
                };
                return self.reflect(path, &at, &leaves, queries, query, sampler);
            }
            Scattering::RoughGlass(glass) => {
                let at = RoughPoint { surface: &surface, lit: &lit, normal, interface: &interface, glass: &glass };
                if has_points {
                    self.light_through::<ALPHA>(path, &at, pixel, sampler);
                }
                return self.scatter(path, &at, sampler).then_some(None);
            }
            Scattering::Simple(bsdf) => bsdf,
        };
        if material.is_diffuse() {
            let throughput = bsdf.diffuse_throughput(seen());
            if throughput != Vec3::ZERO && has_points {
                queries.push(query(throughput, path.branch, [interface.before.bits(), 0]));
            }
            return None;
        }
        path.surfaces += 1;
        path.total += u32::from(bsdf.is_total());
        if self.ends(path, sampler) {
            return None;
        }
        let go_on = |lobe: Lobe| {
            let mut direction = bsdf.direction(lobe, path.ray.direction, normal, 0.0, 0.0);
            if SHADED {
                direction = shading_normal::on_side_of(lobe, direction, surface.normal);
            }
            let media = if lobe == Lobe::SpecularTransmission { interface.transmitted } else { path.media };
            Path {
                ray: surface.spawn(lobe, direction),
                throughput: path.throughput * bsdf.weight(lobe),
                media,
                reflected: path.reflected.before_specular(),
                ..*path
            }
        };
        let lobe = match bsdf.split() {
            None => bsdf.choose(0.0),
            Some(reflectance) if reflectance > 0.0 && reflectance < 1.0 && path.splits < self.max_splits => {
                let [reflected, passed] = [Lobe::SpecularReflection, Lobe::SpecularTransmission].map(go_on);
                let (bit, splits) = (1 << path.splits, path.splits + 1);
                *path = Path { throughput: passed.throughput * (1.0 - reflectance), splits, ..passed };
                let branch = path.branch | bit;
                return Some(Some(Path {
                    throughput: reflected.throughput * reflectance,
                    splits,
                    branch,
                    ..reflected
                }));
            }
            Some(_) => {
                let [choice, ..] = sampler(path.branch).words(BLOCK_SURFACES + path.surfaces);
                bsdf.choose(unit_f32(choice))
            }
        };
        *path = go_on(lobe);
        Some(None)
    }
}
