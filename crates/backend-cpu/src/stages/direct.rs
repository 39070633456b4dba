//! Direct lighting by next-event estimation.

use photon_core::glam::Vec3;
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::solid_angle::{self, Seen};
use photon_core::{
    DirectLight, Features, Layer, Light, MediumStack, Pass, Query, RandomKind, Ray, Result, octahedral, offset,
    sampling, shading_normal,
};

use crate::cpu::{Cpu, CpuBuffer};
use crate::film::{CpuFilm, deposit};
use crate::scene::CpuScene;
use crate::stages::light_sampler::LightSampler;

/// Traces shadow rays to points on the lights.
#[derive(Debug)]
pub(crate) struct CpuDirect;

impl DirectLight<Cpu> for CpuDirect {
    fn light(
        &mut self,
        on: &mut Cpu,
        scene: &CpuScene,
        pass: Pass,
        queries: &CpuBuffer<Query>,
        shadow_rays: u32,
        film: &mut CpuFilm,
    ) -> Result<()> {
        let irradiance = match scene.present.intersects(SHADED) {
            true => irradiance::<true>,
            false => irradiance::<false>,
        };
        on.pool.install(|| {
            film.for_queries(
                queries.as_slice(),
                || (),
                |(), _, query, pixel, _| {
                    let irradiance = irradiance(scene, pass, query, shadow_rays);
                    deposit(pixel, Layer::Direct, query.throughput, irradiance);
                },
            );
        });
        Ok(())
    }
}

/// What shadow rays need a kernel of their own for.
const SHADED: Features = Features::SHADING_NORMALS.union(Features::TEXTURED_LIGHTS);

/// Direct irradiance: the mean over `rays` shadow rays.
fn irradiance<const SHADED: bool>(scene: &CpuScene, pass: Pass, query: &Query, rays: u32) -> [f64; 3] {
    let mut sampler = Sampler::new(RandomKind::Counter, pass.seed, pass.index, Domain::Shadow, query.path);
    let light_sampler = LightSampler::at(scene, query.position.into(), query.normal.into());
    let mut sum = [0.0; 3];
    for ray in 0..rays {
        let [choice, u, v, low] = sampler.words(ray);
        // Each ray samples its own stratum of the lights.
        let choice = (((u64::from(ray) << 32) | u64::from(choice)) / u64::from(rays)) as u32;
        let (index, share) = light_sampler.pick([choice, low]);
        let sample = sample::<SHADED>(scene, &scene.lights[index], query, u, v);
        let Some((value, ray)) = sample else { continue };
        if !scene.caster.occluded(&ray) {
            // The segment is unoccluded, so all of it lies in the query's medium.
            let value = value * scene.attenuation(MediumStack::from_bits(query.media), ray.t_max);
            for c in 0..3 {
                sum[c] += f64::from(value[c]) / share;
            }
        }
    }
    sum.map(|s| s / f64::from(rays))
}

/// Samples a point on a light. Returns the unoccluded irradiance divided by the density of that point, and the
/// shadow ray to test. `None` if the light is on the far side of the surface.
fn sample<const SHADED: bool>(scene: &CpuScene, light: &Light, query: &Query, u: u32, v: u32) -> Option<(Vec3, Ray)> {
    let normal = Vec3::from(query.normal);
    let from = offset::off_surface(query.position.into(), normal);
    let mut power = Vec3::from(light.power);
    // Cosine to the shading normal; 0 or below on the far side of the surface.
    let cosine_of = |direction: Vec3| {
        if SHADED && scene.present.contains(Features::SHADING_NORMALS) {
            shading_normal::cosine(direction, normal, octahedral::unpack(query.shading_normal))
        } else {
            normal.dot(direction)
        }
    };
    if light.kind == Light::DIRECTIONAL {
        let direction = -Vec3::from(light.direction);
        let cosine = cosine_of(direction);
        let area = std::f32::consts::PI * light.radius * light.radius;
        let ray = Ray { origin: from, direction, t_max: f32::INFINITY };
        return (cosine > 0.0).then(|| (power * (cosine / area), ray));
    }
    if let (Light::ENVIRONMENT, Some(environment)) = (light.kind, &scene.environment) {
        let found = environment.sample([u, v]);
        let cosine = cosine_of(found.direction);
        let ray = Ray { origin: from, direction: found.direction, t_max: f32::INFINITY };
        return (cosine > 0.0).then(|| (found.weight * cosine, ray));
    }
    let (u, v) = (unit_f32(u), unit_f32(v));
    let Target { to, front, solid_angle, at: (b, c) } = if light.kind == Light::TRIANGLE {
        at_area_light(scene, light, from, u, v)?
    } else {
        Target { to: Vec3::from(light.position), front: Vec3::ZERO, solid_angle: 0.0, at: (0.0, 0.0) }
    };
    if SHADED && light.kind == Light::TRIANGLE && scene.present.contains(Features::TEXTURED_LIGHTS) {
        power *= scene.emission_ratio(light, b, c);
    }
    let gap = to - from;
    let squared = gap.length_squared();
    let distance = squared.sqrt();
    let direction = gap / distance;
    let cosine = cosine_of(direction);
    if !(cosine > 0.0) {
        return None;
    }
    let ray = Ray { origin: from, direction, t_max: distance };
    // A two-sided light emits half its power on each side; only the side facing the query counts.
    let sides = if light.flags & Light::BOTH_SIDES != 0 { 0.5 } else { 1.0 };
    if solid_angle > 0.0 {
        // Radiance is power / (π · area).
        let per_power = solid_angle * std::f32::consts::FRAC_1_PI / light.area;
        return Some((power * sides * (per_power * cosine), ray));
    }
    // Radiant intensity towards the query.
    let intensity = match light.kind {
        Light::POINT => power * (0.25 * std::f32::consts::FRAC_1_PI),
        Light::SPOT => {
            let off = sampling::versine(-direction, light.direction.into());
            let falloff = sampling::spot_falloff(off, light.versine_inner, light.versine_outer);
            power * (falloff / sampling::spot_solid_angle(light.versine_inner, light.versine_outer) as f32)
        }
        // The light's whole power, as if emitted from this point with a Lambertian cosine.
        _ => power * sides * (-direction.dot(front) * std::f32::consts::FRAC_1_PI).max(0.0),
    };
    if intensity == Vec3::ZERO {
        return None;
    }
    Some((intensity * (cosine / squared), ray))
}

/// The point on a light that a shadow ray goes to.
struct Target {
    to: Vec3,
    /// Normal of an area light on the side where the ray arrives.
    front: Vec3,
    /// Solid angle of the whole area light if the point is uniform in solid angle; 0 if it is uniform in area.
    solid_angle: f32,
    /// Its barycentric coordinates on the triangle of an area light.
    at: (f32, f32),
}

/// Samples a point of a triangle, on an emitting side that faces the query; `None` if there is none.
fn at_area_light(scene: &CpuScene, light: &Light, from: Vec3, u: f32, v: f32) -> Option<Target> {
    let primitive = light.primitive as usize;
    let vertices = scene.vertices[primitive];
    let mut front = Vec3::from(scene.primitives[primitive].normal);
    if light.flags & Light::BOTH_SIDES != 0 && front.dot(from - vertices[0]) < 0.0 {
        front = -front;
    }
    // Seen from as far behind the query as the ray's end is offset above the light.
    let eye = offset::off_surface(from, -front);
    let corners = vertices.map(|vertex| vertex - eye);
    let height = -front.dot(corners[0]);
    let near = solid_angle::is_near(corners);
    if !(height > if near { solid_angle::MIN_HEIGHT } else { 0.0 }) {
        return None;
    }
    let seen = if near { solid_angle::sample(corners, height, light.area, u, v) } else { None };
    let ((b, c), solid_angle) = match seen {
        Some(Seen { b, c, solid_angle }) => ((b, c), solid_angle),
        None => (sampling::triangle(u, v), 0.0),
    };
    let to = offset::off_surface(offset::barycentric(vertices, b, c), front);
    Some(Target { to, front, solid_angle, at: (b, c) })
}
