//! Light of light sources that is scattered once along segments, found by shadow rays.

use photon_core::equiangular::{Equiangular, exponential, exponential_density};
use photon_core::flight;
use photon_core::glam::Vec3;
use photon_core::light_sampler::LightSampler;
use photon_core::phase::Phase;
use photon_core::random::{BLOCK_SEGMENTS, Domain, Sampler, evenly_spread, unit_f32};
use photon_core::{
    Columns, DirectLight, Features, Layer, Light, Pass, Query, RandomKind, Ray, Result, Segment, offset, spot_part,
};

use crate::cpu::{Cpu, CpuBuffer};
use crate::film::{CpuFilm, deposit};
use crate::scene::CpuScene;
use crate::stages::light_sample::{Target, intensity, sample_far};

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
        film.for_queries(
            on,
            segments.as_slice(),
            || Ok(()),
            |(), _, query, pixel, _| {
                let radiance = scattered(scene, pass, query, shadow_rays);
                deposit(pixel, Layer::Direct, query.throughput, radiance);
            },
        )?;
        scene.check_caster()
    }
}

/// Radiance at the start of a segment: the mean over `rays` shadow rays.
fn scattered(scene: &CpuScene, pass: Pass, query: &Query, rays: u32) -> [f64; 3] {
    let segment = Segment::of(query);
    let mut sampler =
        Sampler::new(RandomKind::Counter, pass.seed, pass.index, Domain::Segment, query.path).of_sample(pass.sample);
    let lights = LightSampler::new(scene.lights.len(), |index| weight(scene, &scene.lights[index], &segment));
    let (medium, _) = scene.medium(segment.media);
    let columns = scene.columns(&segment, medium);
    if columns.as_ref().is_some_and(|columns| !(columns.total() > 0.0)) {
        return [0.0; 3];
    }
    let mut sum = [0.0; 3];
    let first = sampler.words(0);
    for number in 0..rays {
        let [choice, _, _, place] = if number == 0 { first } else { sampler.words(number) };
        let (index, share) = lights.pick(&scene.light_cdf, choice);
        // Each ray has its own part of the segment.
        let place = (number as f32 + unit_f32(place)) / rays as f32;
        let alpha = || sampler.words(BLOCK_SEGMENTS + number)[1];
        let choice = Choice { point: evenly_spread([first[1], first[2]], number), place };
        let found = from_light(scene, (&segment, columns.as_ref()), &scene.lights[index], &choice, alpha);
        for c in 0..3 {
            sum[c] += f64::from(found[c]) / share;
        }
    }
    sum.map(|sum| sum / f64::from(rays))
}

/// Power of a light over the squared distance of the segment from its middle; of light from infinity, what gives the same
/// irradiance.
fn weight(scene: &CpuScene, light: &Light, segment: &Segment) -> f32 {
    let middle = match light.kind {
        Light::DIRECTIONAL | Light::ENVIRONMENT => {
            return 4.0 * light.power.iter().sum::<f32>() / (light.radius * light.radius);
        }
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

/// Distances along a segment between which a light may reach it; `None` if it does not.
fn lit_part(light: &Light, segment: &Segment) -> Option<[f32; 2]> {
    if light.kind != Light::SPOT {
        return Some([0.0, segment.length]);
    }
    let cone = [light.position, light.direction].map(Vec3::from);
    spot_part::part([segment.origin, segment.direction], segment.length, cone, light.versine_outer)
}

/// Random numbers of a shadow ray.
struct Choice {
    /// For the point on the light.
    point: [u32; 2],
    /// For the place on the segment, in [0, 1).
    place: f32,
}

/// A place on a segment: the column up to there, and the density relative to the largest.
struct Place {
    column: f32,
    local: f32,
}

impl Place {
    fn new(columns: Option<&Columns<'_>>, distance: f32) -> Self {
        let (column, local) =
            columns.map_or((distance, 1.0), |columns| (columns.to(distance), columns.density(distance)));
        Self { column, local }
    }
}

/// Radiance at the start of a segment by way of a place on it and a point on `light`, over the density of both.
fn from_light(
    scene: &CpuScene,
    (segment, columns): (&Segment, Option<&Columns<'_>>),
    light: &Light,
    choice: &Choice,
    alpha: impl FnOnce() -> u32,
) -> Vec3 {
    let place = choice.place;
    let (_, medium) = scene.medium(segment.media);
    let mean = medium.extinction().element_sum() / 3.0;
    // Places in the cone of a spot light alone, from `first` to `last`.
    let Some([first, last]) = lit_part(light, segment) else { return Vec3::ZERO };
    let before = if first > 0.0 { Place::new(columns, first).column } else { 0.0 };
    let behind = if last < segment.length { Some(Place::new(columns, last).column) } else { None };
    let whole = behind.unwrap_or_else(|| columns.map_or(segment.length, Columns::total)) - before;
    if !(whole > 0.0) {
        return Vec3::ZERO;
    }
    let by_column = |u: f32| {
        let column = before + exponential(mean, whole, u);
        columns.map_or(column, |columns| columns.place(column))
    };
    let start = segment.origin + segment.direction * first;
    let near = Target::evenly(scene, light, choice.point)
        .map(|target| (Equiangular::new(start, segment.direction, last - first, target.to), target));
    // One half by the angle seen from the light, one half by the transmittance (balance heuristic); by the latter alone for light
    // from infinity.
    let distance = match &near {
        Some((angles, _)) if place < 0.5 => (first + angles.sample(2.0 * place)).min(last),
        Some(_) => by_column(2.0 * place - 1.0),
        None => by_column(place),
    };
    let Place { column, local } = Place::new(columns, distance);
    if !(local > 0.0) {
        return Vec3::ZERO;
    }
    let density = exponential_density(mean, whole, (column - before).max(0.0));
    let from = segment.origin + segment.direction * distance;
    let (ray, arrives) = match near {
        Some((angles, mut target)) => {
            let density = 0.5 * (angles.density(distance - first) + local * density);
            if light.flags & Light::BOTH_SIDES != 0 && target.front.dot(from - target.to) < 0.0 {
                target.front = -target.front;
            }
            if light.kind == Light::TRIANGLE {
                target.to = offset::off_surface(target.to, target.front);
            }
            let gap = target.to - from;
            let squared = gap.length_squared();
            if !(squared > 0.0) {
                return Vec3::ZERO;
            }
            let far = squared.sqrt();
            let ray = Ray { origin: from, direction: gap / far, t_max: far };
            let intensity = intensity::<true>(scene, light, &target, ray.direction);
            (ray, intensity * (local / (squared * density)))
        }
        None => {
            let Some(found) = sample_far(scene, light, from, choice.point) else { return Vec3::ZERO };
            // The local density is that of places too.
            let arrives = found.times(1.0) / density;
            (found.ray, arrives)
        }
    };
    if arrives == Vec3::ZERO {
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
    let phase = Phase::of(medium).value(ray.direction, segment.direction);
    let passes = flight::transmittance(medium, column) * scene.transmittance(&ray, ray.t_max, segment.media);
    arrives * Vec3::from(medium.scattering) * passes * phase
}
