//! The light tree of photon-core, compiled for the processor's instruction set.

use photon_core::SceneView;
use photon_core::glam::Vec3;
use photon_core::light_tree::LightTree;

use crate::index::dispatch::{Dispatched, Isa};
use crate::index::lanes::Lanes;

/// A light tree, and the instruction set for its descents; all instruction sets have equal results.
pub(crate) struct CpuLightTree {
    tree: LightTree,
    isa: Isa,
}

impl CpuLightTree {
    pub(crate) fn new(view: &SceneView<'_>) -> Self {
        Self { tree: LightTree::new(view), isa: Isa::detect() }
    }

    /// [`LightTree::pick_several`].
    pub(crate) fn pick<const N: usize>(
        &self,
        light_cdf: &[u32],
        position: Vec3,
        normal: Vec3,
        random: [[u32; 2]; N],
    ) -> [(usize, f64); N] {
        self.isa.run(Pick { tree: &self.tree, light_cdf, position, normal, random })
    }

    /// [`LightTree::probability`].
    pub(crate) fn probability(&self, light_cdf: &[u32], position: Vec3, normal: Vec3, index: usize) -> f64 {
        self.isa.run(Probability { tree: &self.tree, light_cdf, position, normal, index })
    }
}

struct Pick<'a, const N: usize> {
    tree: &'a LightTree,
    light_cdf: &'a [u32],
    position: Vec3,
    normal: Vec3,
    random: [[u32; 2]; N],
}

impl<const N: usize> Dispatched for Pick<'_, N> {
    type Output = [(usize, f64); N];

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> [(usize, f64); N] {
        self.tree.pick_several(self.light_cdf, self.position, self.normal, self.random)
    }
}

struct Probability<'a> {
    tree: &'a LightTree,
    light_cdf: &'a [u32],
    position: Vec3,
    normal: Vec3,
    index: usize,
}

impl Dispatched for Probability<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> f64 {
        self.tree.probability(self.light_cdf, self.position, self.normal, self.index)
    }
}

#[cfg(test)]
mod tests {
    use photon_core::random::SplitMix64;
    use photon_core::{EnvironmentMap, sampling};
    use photon_scene::LightDesc;

    use super::*;

    /// On every instruction set of this processor, the same lights and the same bits of their probabilities as by
    /// photon-core, for points, spots, triangles and lights at infinity.
    #[test]
    fn instruction_sets_agree() {
        let mut lit_by_a_sun = photon_scene::builtin("many-lights").unwrap();
        let (direction, irradiance) = ([0.3, -1.0, 0.2], [1.0; 3]);
        lit_by_a_sun.light("sun", LightDesc::Directional { direction, irradiance });
        lit_by_a_sun.environment(EnvironmentMap::new(4, &[[0.2; 3]; 8], 0.0).unwrap());
        for scene in [lit_by_a_sun, photon_scene::builtin("furnace").unwrap()] {
            let scene = scene.build().unwrap();
            let view = scene.view();
            let expected = LightTree::new(&view);
            let trees: Vec<_> =
                Isa::all().into_iter().map(|isa| CpuLightTree { tree: expected.clone(), isa }).collect();
            let mut random = SplitMix64(7);
            let mut unit = || random.unit();
            for _ in 0..2000 {
                let position = Vec3::new(unit(), unit(), unit()) - 0.5;
                let normal = sampling::uniform_sphere(unit(), unit());
                let words =
                    [[unit(), unit()], [unit(), unit()]].map(|pair| pair.map(|part| (part * 4_294_967_296.0) as u32));
                let picked = words.map(|words| expected.pick(view.light_cdf, position, normal, words));
                let (light, probability) = picked[0];
                for tree in &trees {
                    let isa = tree.isa;
                    assert_eq!(tree.pick(view.light_cdf, position, normal, words), picked, "{isa:?}");
                    assert_eq!(tree.pick(view.light_cdf, position, normal, [words[1]]), [picked[1]], "{isa:?}");
                    assert_eq!(tree.probability(view.light_cdf, position, normal, light), probability, "{isa:?}");
                }
            }
        }
    }
}
