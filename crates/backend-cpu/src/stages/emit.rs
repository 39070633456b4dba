//! Photon emission from the lights.

use photon_core::glam::Vec3;
use photon_core::random::{BLOCK_LIGHT, BLOCK_START, Domain, Sampler, centred_f32, unit_f32};
use photon_core::{
    Batch, Emitter, Features, Light, PhotonRay, ProjectionDisc, ProjectionMap, Result, light_probability, offset,
    pick_light, portals, sampling,
};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::scene::CpuScene;

/// Emits photons, by [`photon_core::SceneView::light_cdf`].
#[derive(Debug)]
pub(crate) struct CpuEmitter;

impl Emitter<Cpu> for CpuEmitter {
    fn emit(&mut self, on: &mut Cpu, scene: &CpuScene, batch: &Batch, rays: &mut CpuBuffer<PhotonRay>) -> Result<()> {
        match kinds(scene) {
            (false, false) => emit::<false, false>(on, scene, batch, rays),
            (true, false) => emit::<true, false>(on, scene, batch, rays),
            (false, true) => emit::<false, true>(on, scene, batch, rays),
            (true, true) => emit::<true, true>(on, scene, batch, rays),
        }
        Ok(())
    }
}

/// Area lights whose photons differ in power.
const UNEVEN: Features = Features::TEXTURED_LIGHTS.union(Features::COATED_LIGHTS);

/// Whether the scene has such lights, and whether it has portals.
fn kinds(scene: &CpuScene) -> (bool, bool) {
    (scene.present.intersects(UNEVEN), scene.present.contains(Features::PORTALS))
}

/// Emits photons; with `TEXTURED`, the emission of some area lights is textured, or under a clearcoat; with `PORTALS`, those
/// of infinitely distant lights start through portals.
fn emit<const TEXTURED: bool, const PORTALS: bool>(
    on: &Cpu,
    scene: &CpuScene,
    batch: &Batch,
    rays: &mut CpuBuffer<PhotonRay>,
) {
    each(on, batch, Domain::Photon, rays, |sampler, path| {
        let [choice, a, b, side] = sampler.words(BLOCK_LIGHT);
        let [c, d, ..] = sampler.words(BLOCK_START);
        let index = pick_light(&scene.light_cdf, choice);
        let light = &scene.lights[index];
        // Every path carries the power of its light, within its cone, divided by the probability of choosing that light.
        let per_path =
            scene.light_cone(index).map_or(1.0, |cone| cone.share(light)) / light_probability(&scene.light_cdf, index);
        let power = light.power.map(|p| (f64::from(p) * per_path) as f32);
        let start = PhotonRay { path, power, ..PhotonRay::default() };
        let disc = || unreachable!("only aimed photons start through it");
        leave::<false, TEXTURED, PORTALS>(scene, index, [a, b], ([c, d], side), start, disc)
    });
}

/// Emits aimed photons: only through the cells of the projection map, towards specular surfaces.
#[derive(Debug)]
pub(crate) struct CpuAimedEmitter {
    projection: ProjectionMap,
}

impl CpuAimedEmitter {
    pub(crate) fn new(projection: ProjectionMap) -> Self {
        Self { projection }
    }
}

impl Emitter<Cpu> for CpuAimedEmitter {
    fn emit(&mut self, on: &mut Cpu, scene: &CpuScene, batch: &Batch, rays: &mut CpuBuffer<PhotonRay>) -> Result<()> {
        if kinds(scene).0 {
            aim::<true>(on, scene, batch, rays, &self.projection);
        } else {
            aim::<false>(on, scene, batch, rays, &self.projection);
        }
        Ok(())
    }
}

/// Emits aimed photons; `TEXTURED` as for [`emit`]. Portals do not matter: the cells say where photons start.
fn aim<const TEXTURED: bool>(
    on: &Cpu,
    scene: &CpuScene,
    batch: &Batch,
    rays: &mut CpuBuffer<PhotonRay>,
    projection: &ProjectionMap,
) {
    each(on, batch, Domain::Aimed, rays, |sampler, path| {
        let sample = projection.sample(sampler.words(BLOCK_LIGHT), sampler.words(BLOCK_START));
        let target = &projection.targets()[sample.target];
        let start = PhotonRay { path, power: target.carried, ..PhotonRay::default() };
        let index = target.light as usize;
        let disc = || projection.disc(target);
        leave::<true, TEXTURED, false>(scene, index, sample.point, (sample.direction, sample.side), start, disc)
    });
}

/// Fills `rays` with the result of `ray` for each path of the batch.
fn each(
    on: &Cpu,
    batch: &Batch,
    domain: Domain,
    rays: &mut CpuBuffer<PhotonRay>,
    ray: impl Fn(&mut Sampler, u32) -> PhotonRay + Sync,
) {
    rays.clear();
    let count = batch.paths.len();
    rays.needed = count as u64;
    let fit = count.min(rays.capacity as usize);
    rays.data.resize(fit, PhotonRay::default());
    on.pool.install(|| {
        rays.data.par_iter_mut().with_min_len(1024).enumerate().for_each(|(index, slot)| {
            let path = batch.paths.start + index as u32;
            let pass = batch.pass;
            let mut sampler = Sampler::new(pass.random, pass.seed, pass.index, domain, path);
            *slot = ray(&mut sampler, path);
        });
    });
}

/// The start of an aimed photon through a point of a disc, given for one of radius 1 around the origin: from as far away from
/// the scene's centre as photons that are not aimed.
fn before(disc: &ProjectionDisc, at: Vec3, direction: Vec3, radius: f32) -> Vec3 {
    let away = radius + disc.centre.dot(direction);
    disc.centre + at * disc.radius - direction * away
}

/// Samples the origin and direction of a photon that leaves light `index`; its path and its power, which is that of
/// the light's mean radiance or greatest intensity, are those of `start`. With `AIMED`, those of infinitely distant lights
/// start through `disc`.
#[inline]
fn leave<const AIMED: bool, const TEXTURED: bool, const PORTALS: bool>(
    scene: &CpuScene,
    index: usize,
    point: [u32; 2],
    (direction, side): ([u32; 2], u32),
    start: PhotonRay,
    disc: impl Fn() -> ProjectionDisc,
) -> PhotonRay {
    let ([a, b], [c, d]) = (point.map(unit_f32), direction.map(unit_f32));
    let [height, _] = direction;
    let light = &scene.lights[index];
    let position = Vec3::from(light.position);
    let along = Vec3::from(light.direction);
    let mut back = false;
    let mut power = start.power;
    let (origin, direction) = match (light.kind, scene.light_cone(index)) {
        (Light::POINT | Light::SPOT, Some(cone)) => {
            let (direction, intensity) = cone.sample(light, c, d);
            power = power.map(|p| p * intensity);
            (position, direction)
        }
        (Light::POINT, None) => (position, sampling::uniform_sphere(centred_f32(height), d)),
        (Light::SPOT, None) => {
            let versine = sampling::spot_versine(light.versine_inner, light.versine_outer, c);
            (position, sampling::about(along, versine, d))
        }
        (Light::ENVIRONMENT, _) => {
            let Some(environment) = &scene.environment else { return start };
            let found = environment.sample(direction);
            let direction = -found.direction;
            // The power of the record is that of the mean radiance.
            let reciprocal = Vec3::from(power).max_element() / Vec3::from(light.power).max_element();
            let area = std::f32::consts::PI * light.radius * light.radius;
            power = (found.weight * (area * reciprocal)).to_array();
            if PORTALS {
                let line = portals::sample(&scene.portals, direction, side, [a, b], light.radius);
                power = power.map(|p| p * line.factor);
                (line.across - direction * light.radius, direction)
            } else {
                let (x, y) = sampling::disc(a, b);
                let (tangent, bitangent) = sampling::basis(direction);
                if AIMED {
                    (before(&disc(), tangent * x + bitangent * y, direction, light.radius), direction)
                } else {
                    ((tangent * x + bitangent * y - direction) * light.radius, direction)
                }
            }
        }
        (Light::DIRECTIONAL, _) if PORTALS => {
            let (direction, away) = if light.is_sun() {
                (sampling::about(along, sampling::sun_versine(light.versine_outer, c), d), 2.0 * light.radius)
            } else {
                (along, light.radius)
            };
            let line = portals::sample(&scene.portals, direction, side, [a, b], light.radius);
            // Points of a sun's disc are uniform across its axis, not across the photon's direction.
            let factor = if light.is_sun() { line.factor / direction.dot(along) } else { line.factor };
            power = power.map(|p| p * factor);
            (line.across - direction * away, direction)
        }
        (Light::DIRECTIONAL, _) => {
            let (x, y) = sampling::disc(a, b);
            let (tangent, bitangent) = sampling::basis(along);
            if light.is_sun() {
                // Through the disc in the plane of the scene's centre, from twice its radius away.
                let direction = sampling::about(along, sampling::sun_versine(light.versine_outer, c), d);
                if AIMED {
                    (before(&disc(), tangent * x + bitangent * y, direction, 2.0 * light.radius), direction)
                } else {
                    ((tangent * x + bitangent * y - direction * 2.0) * light.radius, direction)
                }
            } else if AIMED {
                (before(&disc(), tangent * x + bitangent * y, along, light.radius), along)
            } else {
                ((tangent * x + bitangent * y - along) * light.radius, along)
            }
        }
        _ => {
            let primitive = light.primitive as usize;
            let (u, v) = sampling::triangle(a, b);
            let point = offset::within(scene.vertices[primitive], scene.margins[primitive], u, v);
            if TEXTURED && scene.present.contains(Features::TEXTURED_LIGHTS) {
                power = (Vec3::from(power) * scene.emission_ratio(light, u, v)).to_array();
            }
            let front = Vec3::from(scene.primitives[primitive].normal);
            back = light.flags & Light::BOTH_SIDES != 0 && side >> 31 == 1;
            let normal = if back { -front } else { front };
            let direction = sampling::cosine_hemisphere(normal, c, d);
            if TEXTURED && scene.present.contains(Features::COATED_LIGHTS) {
                power = (Vec3::from(power) * scene.emission_through(light.primitive, (u, v), direction)).to_array();
            }
            (offset::off_surface(point, normal), direction)
        }
    };
    PhotonRay {
        origin: origin.into(),
        direction: direction.into(),
        light: index as u32,
        media: scene.light_media(index, back).bits(),
        power,
        ..start
    }
}
