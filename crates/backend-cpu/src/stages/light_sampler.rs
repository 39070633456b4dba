//! Chooses the light for a shadow ray.

use photon_core::glam::Vec3;
use photon_core::{Light, Query, light_probability, pick_light, sampling, solid_angle};

use crate::scene::CpuScene;

/// With at most this many lights, each query weights them individually; with more, they are chosen by power alone.
const MAX_LIGHTS: usize = 16;

/// The share of the probability that is spread evenly over all lights whatever their weights: if an occluded light
/// outweighs all others, these still get this much.
const DEFENSIVE_SHARE: f64 = 0.1;

/// The selection probabilities of the lights at one query.
///
/// They are proportional to the unoccluded irradiance from each light, so that a weak light close by or a narrow
/// spotlight counts by its effect at the query and not by its share of the scene's power.
pub(crate) struct LightSampler {
    /// Cumulative probabilities; `count` is 0 if lights are chosen by power alone.
    cdf: [f64; MAX_LIGHTS],
    count: usize,
}

impl LightSampler {
    pub(crate) fn at(scene: &CpuScene, query: &Query) -> Self {
        let mut light_sampler = Self { cdf: [0.0; MAX_LIGHTS], count: 0 };
        let lights = scene.lights.len();
        if !(2..=MAX_LIGHTS).contains(&lights) {
            return light_sampler;
        }
        let mut weights = [0.0_f64; MAX_LIGHTS];
        for (weight, light) in weights.iter_mut().zip(&scene.lights) {
            *weight = f64::from(weigh(scene, light, query));
        }
        let total: f64 = weights.iter().sum();
        if !(total > 0.0 && total.is_finite()) {
            return light_sampler;
        }
        let mut sum = 0.0;
        for index in 0..lights {
            sum += DEFENSIVE_SHARE / lights as f64 + (1.0 - DEFENSIVE_SHARE) * weights[index] / total;
            light_sampler.cdf[index] = sum;
        }
        light_sampler.count = lights;
        light_sampler
    }

    /// Picks a light; returns its index and probability.
    pub(crate) fn pick(&self, scene: &CpuScene, random: u32) -> (usize, f64) {
        if self.count == 0 {
            let index = pick_light(&scene.light_cdf, random);
            return (index, light_probability(&scene.light_cdf, index));
        }
        let cdf = &self.cdf[..self.count];
        // The last sum is 1 except for rounding, so normalise by it.
        let whole = cdf[self.count - 1];
        let at = f64::from(random) / 4_294_967_296.0 * whole;
        let index = cdf.partition_point(|&end| end <= at).min(self.count - 1);
        let before = if index == 0 { 0.0 } else { cdf[index - 1] };
        (index, (cdf[index] - before) / whole)
    }
}

/// Approximate unoccluded irradiance from a light, mean of RGB. 0 only if the irradiance is 0 or, to within
/// rounding, the query lies in the light's plane.
fn weigh(scene: &CpuScene, light: &Light, query: &Query) -> f32 {
    let power = light.power.iter().sum::<f32>() / 3.0;
    let normal = Vec3::from(query.normal);
    let position = Vec3::from(query.position);
    match light.kind {
        Light::DIRECTIONAL => {
            let cosine = -normal.dot(light.direction.into());
            power * cosine.max(0.0) / (std::f32::consts::PI * light.radius * light.radius)
        }
        Light::TRIANGLE => {
            let corners = scene.vertices[light.primitive as usize].map(|corner| corner - position);
            let height = -corners[0].dot(scene.primitives[light.primitive as usize].normal.into());
            let both = light.flags & Light::BOTH_SIDES != 0;
            let (height, power) = if both { (height.abs(), 0.5 * power) } else { (height, power) };
            if !(height > solid_angle::MIN_HEIGHT) {
                return 0.0;
            }
            // Radiance times solid angle. The cosine at the query varies across a nearby area light and is omitted.
            if solid_angle::is_near(corners) {
                return power * solid_angle::of(corners, height, light.area) / (std::f32::consts::PI * light.area);
            }
            let gap = (corners[0] + corners[1] + corners[2]) / 3.0;
            let squared = gap.length_squared();
            power * height / (std::f32::consts::PI * (squared * squared.sqrt()))
        }
        _ => {
            let gap = Vec3::from(light.position) - position;
            let squared = gap.length_squared();
            let direction = gap / squared.sqrt();
            let cosine = normal.dot(direction).max(0.0);
            let intensity = if light.kind == Light::SPOT {
                let off = sampling::versine(-direction, light.direction.into());
                let falloff = sampling::spot_falloff(off, light.versine_inner, light.versine_outer);
                power * falloff / sampling::spot_solid_angle(light.versine_inner, light.versine_outer) as f32
            } else {
                power / (4.0 * std::f32::consts::PI)
            };
            intensity * cosine / squared
        }
    }
}
