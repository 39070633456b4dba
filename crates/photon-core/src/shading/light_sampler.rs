//! Selection of the light that a shadow ray samples.
//!
//! The probabilities are proportional to the unoccluded irradiance from each light, so that a weak light close by
//! or a narrow spotlight counts by its effect at the query and not by its share of the scene's power. With several shadow
//! rays they are changed, so that the rays go to different lights ([`LightSampler::for_rays`]).

use glam::Vec3;

use crate::scene::light::Light;
use crate::scene::{light_probability, pick_light};
use crate::shading::{sampling, solid_angle};

mod groups;
pub use groups::UNSEEN_SHARE;

/// With at most this many lights, each query weights them individually; with more, by a
/// [light tree](super::light_tree).
pub const MAX_LIGHTS: usize = 16;

/// The share of the probability that is spread evenly over all lights whatever their weights: if an occluded light
/// outweighs all others, these still get this much. [`LightSampler::for_rays`] spreads it within groups.
pub const DEFENSIVE_SHARE: f64 = 0.1;

/// The selection probabilities of the lights at one query.
#[derive(Clone, Copy, Debug)]
pub struct LightSampler {
    /// Cumulative probabilities; `count` is 0 if lights are chosen by power alone.
    cdf: [f64; MAX_LIGHTS],
    count: usize,
}

impl LightSampler {
    /// Probabilities from the weight of each of `lights` lights, as [`weigh`] returns it. Lights are chosen by
    /// power alone if there is one light or more than [`MAX_LIGHTS`], or if the sum of the weights is not positive
    /// and finite.
    #[inline]
    #[must_use]
    pub fn new(lights: usize, weight: impl Fn(usize) -> f32) -> Self {
        let mut light_sampler = Self { cdf: [0.0; MAX_LIGHTS], count: 0 };
        if !(2..=MAX_LIGHTS).contains(&lights) {
            return light_sampler;
        }
        let mut weights = [0.0_f64; MAX_LIGHTS];
        for (index, place) in weights[..lights].iter_mut().enumerate() {
            *place = f64::from(weight(index));
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

    /// Cumulative probabilities of the lights, up to rounding 1 at the last; empty if lights are chosen by power
    /// alone.
    #[must_use]
    pub fn cdf(&self) -> &[f64] {
        &self.cdf[..self.count]
    }

    /// Picks a light by a random word; returns its index and probability. `light_cdf` is
    /// [`crate::SceneView::light_cdf`].
    #[inline]
    #[must_use]
    pub fn pick(&self, light_cdf: &[u32], random: u32) -> (usize, f64) {
        if self.count == 0 {
            let index = pick_light(light_cdf, random);
            return (index, light_probability(light_cdf, index));
        }
        let cdf = &self.cdf[..self.count];
        // The last sum is 1 except for rounding, so normalise by it.
        let whole = cdf[self.count - 1];
        let at = f64::from(random) / 4_294_967_296.0 * whole;
        let index = cdf.partition_point(|&end| end <= at).min(self.count - 1);
        let before = if index == 0 { 0.0 } else { cdf[index - 1] };
        (index, (cdf[index] - before) / whole)
    }

    /// The probability with which [`LightSampler::pick`] returns `index` for a uniform random word: equal to the one
    /// that it returns with that light.
    #[inline]
    #[must_use]
    pub fn probability(&self, light_cdf: &[u32], index: usize) -> f64 {
        if self.count == 0 {
            return light_probability(light_cdf, index);
        }
        let cdf = &self.cdf[..self.count];
        let before = if index == 0 { 0.0 } else { cdf[index - 1] };
        (cdf[index] - before) / cdf[self.count - 1]
    }
}

/// The light that belongs to a triangle: the index in `lights` of the one of kind [`Light::TRIANGLE`] with this
/// `primitive`, or `None` if the triangle is no light.
///
/// A binary search, which needs triangles to come first, in the order of their indices; [`crate::SceneView::validate`]
/// checks that they do.
#[inline]
#[must_use]
pub fn light_of_triangle(lights: &[Light], primitive: u32) -> Option<usize> {
    let before = |light: &Light| light.kind == Light::TRIANGLE && light.primitive < primitive;
    let index = lights.partition_point(before);
    let light = lights.get(index)?;
    (light.kind == Light::TRIANGLE && light.primitive == primitive).then_some(index)
}

/// Approximate unoccluded irradiance from a light at `position` on a surface with this normal, mean of RGB. 0 only if
/// the irradiance is 0 or, to within rounding, the position lies in the light's plane or the light below the horizon.
///
/// `triangle` returns the corners and the normal of an area light.
#[inline]
#[must_use]
pub fn weigh(light: &Light, triangle: impl FnOnce() -> ([Vec3; 3], Vec3), position: Vec3, normal: Vec3) -> f32 {
    let power = light.power.iter().sum::<f32>() / 3.0;
    match light.kind {
        Light::DIRECTIONAL => {
            let cosine = -normal.dot(light.direction.into());
            let sine = (light.versine_outer * (2.0 - light.versine_outer)).max(0.0).sqrt();
            // A part of the disc of a sun may be above the horizon though its centre is below.
            let risen = if cosine >= sine {
                cosine
            } else if cosine > -sine {
                (cosine + sine) * (cosine + sine) / (4.0 * sine)
            } else {
                0.0
            };
            power * risen / (std::f32::consts::PI * light.radius * light.radius)
        }
        // As if the mean radiance arrived from a hemisphere.
        Light::ENVIRONMENT => power / (4.0 * std::f32::consts::PI * light.radius * light.radius),
        Light::TRIANGLE => {
            let (corners, facing) = triangle();
            let corners = corners.map(|corner| corner - position);
            let height = -corners[0].dot(facing);
            let both = light.flags & Light::BOTH_SIDES != 0;
            let (height, power) = if both { (height.abs(), 0.5 * power) } else { (height, power) };
            if !(height > solid_angle::MIN_HEIGHT) {
                return 0.0;
            }
            // Radiance times solid angle and the mean cosine of the corners: 0 only if all of them are below the horizon.
            let above = corners.map(|corner| normal.dot(corner).max(0.0));
            if solid_angle::is_near(corners) {
                let lengths = corners.map(|corner| corner.length().max(f32::MIN_POSITIVE));
                let cosine = (above[0] / lengths[0] + above[1] / lengths[1] + above[2] / lengths[2]) / 3.0;
                let solid_angle = solid_angle::of(corners, height, light.area);
                return power * (solid_angle * cosine) / (std::f32::consts::PI * light.area);
            }
            // Far away, all corners are about as far as the centroid.
            let gap = (corners[0] + corners[1] + corners[2]) / 3.0;
            let squared = gap.length_squared();
            let mean = (above[0] + above[1] + above[2]) / 3.0;
            power * (height * mean) / (std::f32::consts::PI * (squared * squared))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A light is picked in proportion to its weight, and one without weight by its part of the defensive share.
    #[test]
    fn probabilities_follow_the_weights() {
        let sampler = LightSampler::new(3, |index| [1.0, 0.0, 3.0][index]);
        let at = |share: f64| sampler.pick(&[], (share * 4_294_967_296.0) as u32);
        for (share, light, probability) in
            [(0.0, 0, 0.225), (0.25, 0, 0.225), (0.27, 1, 0.0), (0.3, 2, 0.675), (0.999, 2, 0.675)]
        {
            let (picked, found) = at(share);
            let expected = DEFENSIVE_SHARE / 3.0 + probability;
            assert!(picked == light && (found - expected).abs() < 1e-12, "{share}: {picked} with {found}");
        }
        assert!((sampler.cdf()[2] - 1.0).abs() < 1e-12);
    }

    /// The probability of a light is the one with which it is picked, to the bit, and the probabilities add up to 1.
    #[test]
    fn probability_is_that_of_picking() {
        let powers = [0.1, 4.0, 1e-9, 0.7, 2.0];
        let cdf = crate::scene::light_cdf(&powers);
        let weighted = LightSampler::new(powers.len(), |index| [0.3, 0.0, 2.0, 1e-5, 7.0][index]);
        let by_power = LightSampler::new(powers.len(), |_| 0.0);
        for (sampler, counted) in [(weighted, powers.len()), (by_power, 0)] {
            assert_eq!(sampler.cdf().len(), counted);
            let mut picked = [false; 5];
            for step in 0..100_000_u32 {
                let (index, found) = sampler.pick(&cdf, step * 42_949);
                assert_eq!(found, sampler.probability(&cdf, index));
                picked[index] = true;
            }
            assert_eq!(picked, [true; 5]);
            let sum: f64 = (0..powers.len()).map(|index| sampler.probability(&cdf, index)).sum();
            assert!((sum - 1.0).abs() < 1e-14, "{sum}");
        }
    }

    #[test]
    fn lights_are_found_by_triangle() {
        let triangle = |primitive| Light { kind: Light::TRIANGLE, primitive, ..Light::default() };
        let other = |kind| Light { kind, primitive: u32::MAX, ..Light::default() };
        let others = [other(Light::POINT), other(Light::DIRECTIONAL), other(Light::SPOT), other(Light::ENVIRONMENT)];
        for count in 0..5_u32 {
            let lights: Vec<Light> = (0..count).map(|k| triangle(2 + 3 * k)).chain(others).collect();
            for primitive in (0..20).chain([u32::MAX]) {
                let expected = (0..count).find(|k| 2 + 3 * k == primitive).map(|k| k as usize);
                assert_eq!(light_of_triangle(&lights, primitive), expected, "{count} lights, triangle {primitive}");
            }
        }
    }

    #[test]
    fn without_usable_weights_power_decides() {
        let cdf = [0, 1 << 30];
        let many = LightSampler::new(MAX_LIGHTS + 1, |_| 1.0);
        for sampler in [many, LightSampler::new(1, |_| 1.0), LightSampler::new(2, |_| 0.0)] {
            assert!(sampler.cdf().is_empty());
            assert_eq!(sampler.pick(&cdf, u32::MAX), (1, 0.75));
        }
        for weight in [f32::INFINITY, f32::NAN] {
            assert!(LightSampler::new(2, |_| weight).cdf().is_empty());
        }
    }

    /// The weight of a sun is that of the part of its disc above the horizon, about: all of it, half with its centre on the
    /// horizon, a little below, nothing beyond its radius.
    #[test]
    fn a_setting_sun_has_a_weight() {
        let radius = 0.02_f32;
        let versine_outer = 1.0 - radius.cos();
        let weight = |elevation: f32, versine_outer: f32| {
            let direction = [-elevation.cos(), 0.0, -elevation.sin()];
            let kind = Light::DIRECTIONAL;
            let light = Light { kind, power: [1.0; 3], direction, radius: 1.0, versine_outer, ..Light::default() };
            weigh(&light, || unreachable!("a sun has no triangle"), Vec3::ZERO, Vec3::Z) * std::f32::consts::PI
        };
        for (elevation, expected) in [(0.5_f32, 0.5_f32.sin()), (radius, radius), (0.0, 0.25 * radius)] {
            assert!((weight(elevation, versine_outer) - expected).abs() < 2e-3 * radius, "{elevation}");
        }
        assert!(weight(-0.9 * radius, versine_outer) > 0.0);
        assert_eq!(weight(-1.1 * radius, versine_outer), 0.0);
        assert_eq!(weight(-0.5 * radius, 0.0), 0.0, "parallel light");
    }

    /// Far from all lights, the weight is the irradiance of a point source.
    #[test]
    fn a_point_light_weighs_its_irradiance() {
        let light = Light { kind: Light::POINT, power: [3.0; 3], position: [0.0, 0.0, 2.0], ..Light::default() };
        let triangle = || unreachable!("a point light has no triangle");
        let weight = weigh(&light, triangle, Vec3::ZERO, Vec3::Z);
        assert!((weight - 3.0 / (16.0 * std::f32::consts::PI)).abs() < 1e-6);
        assert_eq!(weigh(&light, triangle, Vec3::ZERO, -Vec3::Z), 0.0);
    }
}
