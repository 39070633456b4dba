//! Fraction of each estimate's disc that lies on the surface.

use photon_core::area::SPOKES;
use photon_core::{AreaProbe, EstimateBuffers, EstimateParams, Features, Pass, Query, Result};

use crate::device::ComputePipeline;
use crate::device::buffer::VulkanBuffer;
use crate::scene::{SceneKind, VulkanScene};
use crate::shaders;
use crate::vulkan::Vulkan;

/// Invocations per workgroup: one for each spoke of its queries.
const GROUP: u32 = 128;
/// Maximum number of rays per query, rounded up.
const RAYS: u64 = 64;

/// Traces short rays around each query.
#[derive(Debug)]
pub(crate) struct VulkanArea;

parameters! {
    struct Push => STAGES_AREA {
        scene: u64,
        queries: u64,
        count: u64,
        estimates: u64,
        error_moments: u64,
        seed: u64,
        pass: u32,
        start: u32,
        min_cosine: f32,
        max_plane_distance: f32,
    }
}

specialized!(
    area_constants: AreaConstants => STAGES_AREA,
    0 features: Features, 2 kernel: u32, 3 flat: bool, 4 second: bool, 5 reflections: bool; default shared_groups
);

/// The kernel, with or without the moments of errors.
pub(crate) fn kernel(on: &mut Vulkan, scene: &SceneKind, gather: &EstimateParams, moments: bool) -> ComputePipeline {
    let constants = AreaConstants {
        features: scene.features,
        kernel: gather.kernel.number(),
        flat: gather.is_flat(),
        second: moments,
        reflections: gather.reflection,
    };
    on.kernel(&shaders::STAGES_AREA, GROUP, &constants)
}

impl AreaProbe<Vulkan> for VulkanArea {
    fn correct(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        pass: Pass,
        queries: &VulkanBuffer<Query>,
        gather: &EstimateParams,
        buffers: EstimateBuffers<'_, Vulkan>,
    ) -> Result<()> {
        let EstimateBuffers { estimates, error_moments } = buffers;
        let kernel = kernel(on, &scene.kind, gather, error_moments.is_some());
        // The number of queries is not needed on the host: dispatch for the full capacity.
        let capacity = queries.capacity().min(estimates.capacity());
        let capacity = error_moments.as_ref().map_or(capacity, |error_moments| capacity.min(error_moments.capacity()));
        let chunk = (on.dispatch_limits.shadow_rays / RAYS).max(1).next_multiple_of(u64::from(GROUP));
        for start in (0..capacity).step_by(chunk as usize) {
            let push = Push {
                scene: scene.address(),
                queries: queries.data_address(),
                count: queries.count_address(),
                estimates: estimates.data_address(),
                error_moments: error_moments.as_ref().map_or(0, |error_moments| error_moments.data_address()),
                seed: pass.seed,
                pass: pass.index,
                start: start as u32,
                min_cosine: gather.min_normal_cosine,
                max_plane_distance: gather.max_plane_distance,
            };
            let invocations = chunk.min(capacity - start) * u64::from(SPOKES);
            on.dispatch(&kernel, &push, invocations.div_ceil(u64::from(GROUP)))?;
        }
        Ok(())
    }
}
