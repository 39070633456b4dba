//! Light of light sources that is scattered once along segments, found by shadow rays.

use photon_core::{Features, MediaFeatures};

use crate::device::ComputePipeline;
use crate::scene::SceneKind;
use crate::shaders;
use crate::vulkan::Vulkan;

specialized!(
    medium_direct_constants: MediumDirectConstants => STAGES_MEDIUM_DIRECT,
    0 features: Features, 2 weighed: u32, 3 media: MediaFeatures; default shared_groups
);

/// The kernel of [`super::direct::VulkanDirect`] for segments.
pub(crate) fn kernel(on: &mut Vulkan, scene: &SceneKind) -> ComputePipeline {
    let SceneKind { features, weighed, media, .. } = *scene;
    // Many lights are chosen by power: a light tree is for surfaces.
    let features = features.without(Features::LIGHT_TREE);
    on.kernel(&shaders::STAGES_MEDIUM_DIRECT, 128, &MediumDirectConstants { features, weighed, media })
}
