//! Precomputed irradiance at photon positions.

use photon_core::{Estimate, IrradiancePoints, Photon, PhotonFormat, Query, Result};

use crate::device::ComputePipeline;
use crate::device::buffer::VulkanBuffer;
use crate::map::VulkanMap;
use crate::shaders;
use crate::vulkan::Vulkan;

/// Invocations per workgroup; the work is bound by memory.
const GROUP: u32 = 128;

/// Precomputes irradiance at every n-th photon.
#[derive(Debug)]
pub(crate) struct VulkanIrradiance;

parameters! {
    struct PlacesPush => STAGES_IRRADIANCE_PLACES {
        positions: u64,
        queries: u64,
        first: u32,
        count: u32,
        every: u32,
        padding: u32,
    }
}

parameters! {
    struct AddPush => STAGES_IRRADIANCE {
        queries: u64,
        estimates: u64,
        points: u64,
        count: u32,
        first: u32,
        scale: f32,
        padding: u32,
    }
}

/// Kernels: that which chooses the points, and that which adds to them.
pub(crate) fn kernels(on: &mut Vulkan) -> [ComputePipeline; 2] {
    [&shaders::STAGES_IRRADIANCE_PLACES, &shaders::STAGES_IRRADIANCE].map(|module| on.kernel(module, GROUP, &()))
}

impl IrradiancePoints<Vulkan> for VulkanIrradiance {
    fn places(
        &mut self,
        on: &mut Vulkan,
        map: &VulkanMap,
        every: u32,
        queries: &mut VulkanBuffer<Query>,
    ) -> Result<()> {
        let first = on.length(queries)?;
        let room = queries.capacity() - first;
        let count = u64::from(map.length.div_ceil(every.max(1))).min(room);
        let [kernel, _] = kernels(on);
        let push = PlacesPush {
            positions: map.positions.address(),
            queries: queries.data_address(),
            first: first as u32,
            count: count as u32,
            every,
            padding: 0,
        };
        on.dispatch(&kernel, &push, count.div_ceil(u64::from(GROUP)))?;
        on.set_length(queries, first + count)
    }

    fn add(
        &mut self,
        on: &mut Vulkan,
        queries: &VulkanBuffer<Query>,
        estimates: &VulkanBuffer<Estimate>,
        paths: u64,
        first: bool,
        points: &mut VulkanBuffer<Photon>,
    ) -> Result<()> {
        let count = on.length(queries)?.min(points.capacity());
        let [_, kernel] = kernels(on);
        let push = AddPush {
            queries: queries.data_address(),
            estimates: estimates.data_address(),
            points: points.data_address(),
            count: count as u32,
            first: u32::from(first),
            scale: (1.0 / (std::f64::consts::PI * paths.max(1) as f64)) as f32,
            padding: 0,
        };
        on.dispatch(&kernel, &push, count.div_ceil(u64::from(GROUP)))?;
        on.set_length(points, count)
    }

    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Mono
    }
}
