//! Chooses the light for a shadow ray.

use photon_core::glam::Vec3;
use photon_core::light_sampler::{LightSampler as Probabilities, weigh};

use crate::scene::CpuScene;
use crate::stages::light_tree::CpuLightTree;

/// The selection probabilities of the lights of a scene at one surface point.
pub(crate) struct LightSampler<'a> {
    probabilities: Probabilities,
    light_cdf: &'a [u32],
    /// Instead of `probabilities` if there are many lights.
    tree: Option<(&'a CpuLightTree, Vec3, Vec3)>,
}

impl<'a> LightSampler<'a> {
    /// At a surface point with this geometric normal, which faces the lit side.
    pub(crate) fn at(scene: &'a CpuScene, position: Vec3, normal: Vec3) -> Self {
        let probabilities = Probabilities::new(scene.lights.len(), weights(scene, position, normal));
        Self::new(scene, position, normal, probabilities)
    }

    /// The same for this many shadow rays from there.
    pub(crate) fn for_rays(scene: &'a CpuScene, rays: u32, position: Vec3, normal: Vec3) -> Self {
        let weights = weights(scene, position, normal);
        let probabilities = Probabilities::for_rays(scene.lights.len(), scene.light_groups, rays, weights);
        Self::new(scene, position, normal, probabilities)
    }

    fn new(scene: &'a CpuScene, position: Vec3, normal: Vec3, probabilities: Probabilities) -> Self {
        let tree = scene.light_tree.as_ref().map(|tree| (tree, position, normal));
        Self { probabilities, light_cdf: &scene.light_cdf, tree }
    }

    /// For each pair of random words, picks a light by the first, which a light tree extends by the second; returns the index
    /// and probability of each.
    pub(crate) fn pick<const N: usize>(&self, random: [[u32; 2]; N]) -> [(usize, f64); N] {
        match self.tree {
            Some((tree, position, normal)) => tree.pick(self.light_cdf, position, normal, random),
            None => random.map(|[word, _]| self.probabilities.pick(self.light_cdf, word)),
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

/// The weights of the lights.
fn weights(scene: &CpuScene, position: Vec3, normal: Vec3) -> impl Fn(usize) -> f32 {
    move |index| {
        let light = &scene.lights[index];
        let triangle = || {
            let primitive = light.primitive as usize;
            (scene.vertices[primitive], scene.primitives[primitive].normal.into())
        };
        weigh(light, triangle, position, normal)
    }
}
