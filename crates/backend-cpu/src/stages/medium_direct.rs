//! Light of light sources that is scattered once along segments, found by shadow rays.

use photon_core::equiangular::{Equiangular, exponential, exponential_density};
use photon_core::glam::Vec3;
use photon_core::light_sampler::LightSampler;
use photon_core::random::{BLOCK_SEGMENTS, Domain, Sampler, unit_f32};
use photon_core::{
    DirectLight, Features, Layer, Light, Pass, Query, RandomKind, Ray, Result, Segment, offset, phase, sampling,
};

use crate::cpu::{Cpu, CpuBuffer};
use crate::film::{CpuFilm, deposit};
use crate::scene::CpuScene;
use crate::stages::light_sample::intensity;
use crate::stretches::Stretch;

/// Traces shadow rays from places on segments to points on the lights.
#[derive(Debug)]
pub(crate) struct CpuMediumDirect;

impl DirectLight<Cpu> for CpuMediumDirect {
    fn light(
        &mut self,
        on: &mut Cpu,
        scene: &CpuScene,
        pass: Pass,
        segments: &CpuBuffer<Query>,
        shadow_rays: u32,
        film: &mut CpuFilm,
    ) -> Result<()> {
        on.pool.install(|| {
            film.for_queries(
                segments.as_slice(),
                || Ok(()),
                |(), _, query, pixel, _| {
                    let radiance = scattered(scene, pass, query, shadow_rays);
                    deposit(pixel, Layer::Direct, query.throughput, radiance);
                },
            )
        })?;
        scene.check_caster()
    }
}

/// Radiance at the start of a segment: the mean over `rays` shadow rays.
fn scattered(scene: &CpuScene, pass: Pass, query: &Query, rays: u32) -> [f64; 3] {
    let segment = Segment::of(query);
    let mut sampler =
        Sampler::new(RandomKind::Counter, pass.seed, pass.index, Domain::Segment, query.path).of_sample(pass.sample);
    let lights = LightSampler::new(scene.lights.len(), |index| weight(scene, &scene.lights[index], &segment));
    let mut sum = [0.0; 3];
    for number in 0..rays {
        let [choice, u, v, place] = sampler.words(number);
        let (index, share) = lights.pick(&scene.light_cdf, choice);
        // Each ray has its own part of the segment.
        let place = (number as f32 + unit_f32(place)) / rays as f32;
        let alpha = || sampler.words(BLOCK_SEGMENTS + number)[1];
        let found = from_light(scene, &segment, &scene.lights[index], ([u, v], place), alpha);
        for c in 0..3 {
            sum[c] += f64::from(found[c]) / share;
        }
    }
    sum.map(|sum| sum / f64::from(rays))
}

/// Power of a light over the squared distance of the segment from its middle. Light from infinity reaches no medium: solids are
/// in its way, and nothing passes a medium without bounds.
fn weight(scene: &CpuScene, light: &Light, segment: &Segment) -> f32 {
    let middle = match light.kind {
        Light::DIRECTIONAL | Light::ENVIRONMENT => return 0.0,
        Light::TRIANGLE => {
            let [a, b, c] = scene.vertices[light.primitive as usize];
            (a + b + c) / 3.0
        }
        _ => Vec3::from(light.position),
    };
    let gap = middle - segment.origin;
    let nearest = segment.direction * gap.dot(segment.direction).clamp(0.0, segment.length);
    light.power.iter().sum::<f32>() / (gap - nearest).length_squared().max(1e-6)
}

/// Radiance by way of a place on the segment and a point on `light`, over the density of both.
fn from_light(
    scene: &CpuScene,
    segment: &Segment,
    light: &Light,
    (point, place): ([u32; 2], f32),
    alpha: impl FnOnce() -> u32,
) -> Vec3 {
    let Some(Emitter { at, normal, barycentric }) = Emitter::sample(scene, light, point) else { return Vec3::ZERO };
    let (index, medium) = scene.medium(segment.media);
    let extinction = medium.extinction();
    let mean = extinction.element_sum() / 3.0;
    let angles = Equiangular::new(segment.origin, segment.direction, segment.length, at);
    // One half by the angle seen from the light, one half by the transmittance (balance heuristic).
    let distance = if place < 0.5 {
        angles.sample(2.0 * place).min(segment.length)
    } else {
        exponential(mean, segment.length, 2.0 * place - 1.0)
    };
    let density = 0.5 * (angles.density(distance) + exponential_density(mean, segment.length, distance));
    let from = segment.origin + segment.direction * distance;
    let front = if light.flags & Light::BOTH_SIDES != 0 && normal.dot(from - at) < 0.0 { -normal } else { normal };
    let to = if light.kind == Light::TRIANGLE { offset::off_surface(at, front) } else { at };
    let gap = to - from;
    let squared = gap.length_squared();
    if !(squared > 0.0) {
        return Vec3::ZERO;
    }
    let far = squared.sqrt();
    let ray = Ray { origin: from, direction: gap / far, t_max: far };
    let intensity = intensity::<true>(scene, light, (front, barycentric), ray.direction);
    if intensity == Vec3::ZERO {
        return Vec3::ZERO;
    }
    let is_hidden = if scene.present.intersects(Features::RANDOM_SURFACES) {
        scene.occluded_with::<true>(&ray, alpha)
    } else {
        scene.occluded_with::<false>(&ray, || 0)
    };
    if is_hidden {
        return Vec3::ZERO;
    }
    let phase = phase::value(medium.anisotropy, ray.direction.dot(segment.direction));
    let seen = Ray { origin: segment.origin, direction: segment.direction, t_max: distance };
    let part = Stretch { from: 0.0, to: distance, medium: index };
    let passes = scene.stretch_transmittance(&seen, &part) * scene.transmittance(&ray, far, segment.media);
    intensity * Vec3::from(medium.scattering) * passes * (phase / (squared * density))
}

/// A point on a light.
struct Emitter {
    at: Vec3,
    normal: Vec3,
    barycentric: (f32, f32),
}

impl Emitter {
    /// Evenly over the area; `None` for light from infinity.
    fn sample(scene: &CpuScene, light: &Light, [u, v]: [u32; 2]) -> Option<Self> {
        match light.kind {
            Light::DIRECTIONAL | Light::ENVIRONMENT => None,
            Light::TRIANGLE => {
                let (b, c) = sampling::triangle(unit_f32(u), unit_f32(v));
                let primitive = light.primitive as usize;
                let at = offset::barycentric(scene.vertices[primitive], b, c);
                Some(Self { at, normal: scene.primitives[primitive].normal.into(), barycentric: (b, c) })
            }
            _ => Some(Self { at: light.position.into(), normal: Vec3::ZERO, barycentric: (0.0, 0.0) }),
        }
    }
}
