//! Chooses the light for a shadow ray.

use photon_core::glam::Vec3;
use photon_core::light_sampler::{LightSampler as Probabilities, weigh};
use photon_core::light_tree::LightTree;

use crate::scene::CpuScene;

/// The selection probabilities of the lights of a scene at one surface point.
pub(crate) struct LightSampler<'a> {
    probabilities: Probabilities,
    light_cdf: &'a [u32],
    /// Instead of `probabilities` if there are many lights.
    tree: Option<(&'a LightTree, Vec3, Vec3)>,
}

impl<'a> LightSampler<'a> {
    /// At a surface point with this geometric normal, which faces the lit side.
    pub(crate) fn at(scene: &'a CpuScene, position: Vec3, normal: Vec3) -> Self {
        let probabilities = Probabilities::new(scene.lights.len(), |index| {
            let light = &scene.lights[index];
            let triangle = || {
                let primitive = light.primitive as usize;
                (scene.vertices[primitive], scene.primitives[primitive].normal.into())
            };
            weigh(light, triangle, position, normal)
        });
        let tree = scene.light_tree.as_ref().map(|tree| (tree, position, normal));
        Self { probabilities, light_cdf: &scene.light_cdf, tree }
    }

    /// Picks a light by a random word, which a light tree extends by a second one; returns its index and probability.
    pub(crate) fn pick(&self, random: [u32; 2]) -> (usize, f64) {
        match self.tree {
            Some((tree, position, normal)) => tree.pick(self.light_cdf, position, normal, random),
            None => self.probabilities.pick(self.light_cdf, random[0]),
        }
    }

    /// The probability with which a light is picked.
    pub(crate) fn probability(&self, index: usize) -> f64 {
        match self.tree {
            Some((tree, position, normal)) => tree.probability(self.light_cdf, position, normal, index),
            None => self.probabilities.probability(self.light_cdf, index),
        }
    }
}
