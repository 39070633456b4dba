//! Chooses the light for a shadow ray.

use photon_core::glam::Vec3;
use photon_core::light_sampler::{LightSampler as Probabilities, weigh};

use crate::scene::CpuScene;

/// The selection probabilities of the lights of a scene at one query.
pub(crate) struct LightSampler(Probabilities);

impl LightSampler {
    /// At a surface point with this geometric normal, which faces the lit side.
    pub(crate) fn at(scene: &CpuScene, position: Vec3, normal: Vec3) -> Self {
        Self(Probabilities::new(scene.lights.len(), |index| {
            let light = &scene.lights[index];
            let triangle = || {
                let primitive = light.primitive as usize;
                (scene.vertices[primitive], scene.primitives[primitive].normal.into())
            };
            weigh(light, triangle, position, normal)
        }))
    }

    /// Picks a light; returns its index and probability.
    pub(crate) fn pick(&self, scene: &CpuScene, random: u32) -> (usize, f64) {
        self.0.pick(&scene.light_cdf, random)
    }

    /// The probability with which [`Self::pick`] returns a light.
    pub(crate) fn probability(&self, scene: &CpuScene, index: usize) -> f64 {
        self.0.probability(&scene.light_cdf, index)
    }
}
