//! Camera paths, traced to the first diffuse surface.

use photon_core::glam::Vec3;
use photon_core::random::{BLOCK_START, BLOCK_SURFACES, Domain, Sampler, unit_f32};
use photon_core::{
    Bsdf, Camera, EyeTracer, Features, FilmPixel, Layer, Lobe, Material, MediumStack, Pass, QUERIES_PER_PIXEL, Query,
    RandomKind, Ray, Result, View, octahedral, shading_normal,
};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::film::{CpuFilm, deposit};
use crate::scene::CpuScene;

/// Traces camera paths through mirrors and glass.
///
/// A path splits at its first two dielectric interfaces, so that reflections there are free of the noise of
/// choosing a lobe at random; at later interfaces it chooses.
#[derive(Debug)]
pub(crate) struct CpuEye {
    pub(crate) max_bounces: u32,
}

const SPLITS: u32 = QUERIES_PER_PIXEL.ilog2();

impl EyeTracer<Cpu> for CpuEye {
    fn trace_eye(
        &mut self,
        on: &mut Cpu,
        scene: &CpuScene,
        view: &View,
        pass: Pass,
        film: &mut CpuFilm,
        queries: &mut CpuBuffer<Query>,
    ) -> Result<()> {
        let max_splits = if scene.features.splits_camera_paths() { SPLITS } else { 0 };
        let eye = Eye { scene, view, pass, max_bounces: self.max_bounces, max_splits };
        let look = match (scene.features.intersects(Features::SHADED), scene.present.contains(Features::ALPHA)) {
            (_, true) => Eye::look::<true, true>,
            (true, false) => Eye::look::<true, false>,
            (false, false) => Eye::look::<false, false>,
        };
        let rows: Vec<Vec<Query>> = on.pool.install(|| {
            film.pending
                .par_chunks_mut(view.width as usize)
                .enumerate()
                .map(|(row, pixels)| {
                    let mut found = Vec::with_capacity(pixels.len());
                    for (column, pixel) in pixels.iter_mut().enumerate() {
                        look(&eye, column as u32, row as u32, pixel, &mut found);
                    }
                    found
                })
                .collect()
        });
        queries.clear();
        for row in rows {
            queries.append(&row);
        }
        Ok(())
    }
}

struct Eye<'a> {
    scene: &'a CpuScene,
    view: &'a View,
    pass: Pass,
    max_bounces: u32,
    max_splits: u32,
}

/// State of a camera path.
#[derive(Clone, Copy)]
struct Path {
    ray: Ray,
    /// Throughput of radiance over n², which refraction leaves unchanged.
    throughput: Vec3,
    media: MediumStack,
    surfaces: u32,
    splits: u32,
    /// Index of this path among the pixel's paths; part of the random-number key.
    branch: u32,
}

impl Eye<'_> {
    /// Traces the paths of a pixel. `SHADED`: surfaces have textures or shading normals; `ALPHA`: alpha.
    fn look<const SHADED: bool, const ALPHA: bool>(
        &self,
        x: u32,
        y: u32,
        pixel: &mut FilmPixel,
        queries: &mut Vec<Query>,
    ) {
        let number = y * self.view.width + x;
        let sampler = |branch: u32| {
            let key = number * QUERIES_PER_PIXEL + branch;
            Sampler::new(RandomKind::Counter, self.pass.seed, self.pass.index, Domain::Eye, key)
        };
        let [a, b, ..] = sampler(0).words(BLOCK_START);
        let across = 2.0 * (x as f32 + unit_f32(a)) / self.view.width as f32 - 1.0;
        let down = 2.0 * (y as f32 + unit_f32(b)) / self.view.height as f32 - 1.0;
        let first = Path {
            ray: camera_ray(&self.view.camera, across, -down),
            throughput: Vec3::ONE,
            media: MediumStack::from_bits(self.view.camera.media),
            surfaces: 0,
            splits: 0,
            branch: 0,
        };
        let mut waiting = [first; QUERIES_PER_PIXEL as usize];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let mut path = waiting[count];
            while let Some(branch) = self.step::<SHADED, ALPHA>(&mut path, number, pixel, queries, &sampler) {
                if let Some(branch) = branch {
                    waiting[count] = branch;
                    count += 1;
                }
            }
        }
    }

    /// Traces the path to its next surface. Returns `None` when the path has ended, `Some(Some(other))` when it has
    /// split.
    fn step<const SHADED: bool, const ALPHA: bool>(
        &self,
        path: &mut Path,
        number: u32,
        pixel: &mut FilmPixel,
        queries: &mut Vec<Query>,
        sampler: &impl Fn(u32) -> Sampler,
    ) -> Option<Option<Path>> {
        let layer = || sampler(path.branch).words(BLOCK_SURFACES + path.surfaces)[3];
        let Some((mut surface, hit)) = self.scene.hit_with::<ALPHA>(&path.ray, layer).ok()? else {
            if let Some(environment) = &self.scene.environment {
                let camera = MediumStack::from_bits(self.view.camera.media);
                let throughput = path.throughput * self.scene.radiance_scale(camera, path.media);
                let radiance = environment.radiance(path.ray.direction);
                deposit(pixel, Layer::Emission, throughput.into(), radiance.to_array().map(f64::from));
            }
            return None;
        };
        let mut material = &self.scene.materials[surface.material as usize];
        let evaluated = if SHADED { Some(self.scene.shade(&surface, &hit)) } else { None };
        let mut normal = surface.normal;
        if let Some(evaluated) = &evaluated {
            (material, normal) = (&evaluated.material, evaluated.normal);
            if !material.is_diffuse() {
                normal = shading_normal::bend(normal, -path.ray.direction);
                surface = surface.with_cosine_to(normal, path.ray.direction);
            }
        }
        if path.surfaces == 0 {
            pixel.hits += 1;
            pixel.depth += f64::from(surface.t);
            for axis in 0..3 {
                pixel.normal[axis] += f64::from(normal[axis]);
                pixel.albedo[axis] += f64::from(material.albedo[axis]);
            }
        }
        let interface = self.scene.interface(&surface, path.media);
        path.throughput *= self.scene.attenuation(interface.before, surface.t);
        // Factor from the radiance that leaves the surface to its contribution at the camera.
        let seen = || {
            let camera = MediumStack::from_bits(self.view.camera.media);
            path.throughput * self.scene.radiance_scale(camera, interface.before)
        };
        if material.is_emissive() && (surface.front || material.flags & Material::EMITS_BOTH_SIDES != 0) {
            deposit(pixel, Layer::Emission, seen().into(), material.emission.map(f64::from));
        }
        let bsdf = Bsdf::new(self.scene.features, material, surface.cosine, &interface);
        if material.is_diffuse() {
            let throughput = bsdf.diffuse_throughput(seen());
            if throughput != Vec3::ZERO {
                queries.push(Query {
                    // Moved off edges: beside an edge, rounding may put the point behind the adjacent wall, outside
                    // its shadow.
                    position: surface.start.into(),
                    radius: 1.0,
                    normal: surface.normal.into(),
                    pixel: number,
                    throughput: throughput.into(),
                    media: interface.before.bits(),
                    wo: octahedral::pack(-path.ray.direction),
                    path: number * QUERIES_PER_PIXEL + path.branch,
                    shading_normal: if SHADED { octahedral::pack(normal) } else { 0 },
                    reserved: 0,
                });
            }
            return None;
        }
        path.surfaces += 1;
        if path.surfaces >= self.max_bounces {
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

/// The ray through a point of the image; both coordinates are in `[-1, 1]`.
fn camera_ray(camera: &Camera, x: f32, y: f32) -> Ray {
    let offset = Vec3::from(camera.right) * x + Vec3::from(camera.up) * y;
    let (origin, forward) = (Vec3::from(camera.origin), Vec3::from(camera.forward));
    let (origin, direction) = if camera.kind == Camera::ORTHOGRAPHIC {
        (origin + offset, forward)
    } else {
        (origin, (forward + offset).normalize_or(forward))
    };
    Ray { origin, direction, t_max: f32::INFINITY }
}
