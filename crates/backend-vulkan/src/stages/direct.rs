//! Direct light by next-event estimation.

use photon_core::random::Domain;
use photon_core::{DirectLight, Features, MediaFeatures, Pass, Query, Result};

use crate::device::ComputePipeline;
use crate::device::buffer::VulkanBuffer;
use crate::film::samples::SampleLight;
use crate::film::{self, VulkanFilm};
use crate::scene::{SceneKind, VulkanScene};
use crate::shaders;
use crate::vulkan::Vulkan;

/// Invocations per workgroup.
const GROUP: u32 = 128;

/// Shadow rays to points on the lights.
#[derive(Debug)]
pub(crate) struct VulkanDirect {
    /// The kernel for a scene.
    pub(crate) kernel: fn(&mut Vulkan, &SceneKind) -> ComputePipeline,
    /// That of its random numbers.
    pub(crate) domain: Domain,
}

parameters! {
    struct Push => STAGES_DIRECT STAGES_MEDIUM_DIRECT {
        scene: u64,
        queries: u64,
        count: u64,
        values: u64,
        seed: u64,
        pass: u32,
        domain: u32,
        rays: u32,
        start: u32,
        start_ray: u32,
        end_ray: u32,
        pixels: u32,
        padding: u32,
    }
}

specialized!(
    direct_constants: DirectConstants => STAGES_DIRECT,
    0 features: Features, 2 weighed: u32, 3 media: MediaFeatures, 4 groups: u32; default shared_groups
);

/// The kernel for visible points.
pub(crate) fn kernel(on: &mut Vulkan, scene: &SceneKind) -> ComputePipeline {
    let SceneKind { features, weighed, media, light_groups, .. } = *scene;
    on.kernel(
        &shaders::STAGES_DIRECT,
        GROUP,
        &DirectConstants { features, weighed, media, groups: light_groups.starts() },
    )
}

impl DirectLight<Vulkan> for VulkanDirect {
    fn light(
        &mut self,
        on: &mut Vulkan,
        scene: &VulkanScene,
        pass: Pass,
        queries: &VulkanBuffer<Query>,
        shadow_rays: u32,
        film: &mut VulkanFilm,
    ) -> Result<()> {
        if shadow_rays == 0 {
            return Ok(());
        }
        let kernel = (self.kernel)(on, &scene.kind);
        // The number of queries is not needed on the host: dispatch for the full capacity.
        let capacity = queries.capacity();
        let rounds = shadow_rays.min(on.dispatch_limits.shadow_rays_of_query);
        let chunk = (on.dispatch_limits.shadow_rays / u64::from(rounds)).max(1).next_multiple_of(u64::from(GROUP));
        let values = film.values_address(on, capacity)?;
        for start in (0..capacity).step_by(chunk as usize) {
            for start_ray in (0..shadow_rays).step_by(rounds as usize) {
                let push = Push {
                    scene: scene.address(),
                    queries: queries.data_address(),
                    count: queries.count_address(),
                    values,
                    seed: pass.seed,
                    pass: pass.index,
                    domain: self.domain as u32 | pass.sample << 16,
                    rays: shadow_rays,
                    start: start as u32,
                    start_ray,
                    end_ray: start_ray.saturating_add(rounds).min(shadow_rays),
                    pixels: film.pixels() as u32,
                    padding: 0,
                };
                on.dispatch(&kernel, &push, chunk.min(capacity - start).div_ceil(u64::from(GROUP)))?;
            }
        }
        let light = if self.domain == Domain::Segment { SampleLight::Segments } else { SampleLight::Surfaces };
        let places = film.places(on, light, pass.samples)?;
        film::accumulate_values(on, film, places, queries, pass.samples)
    }
}
