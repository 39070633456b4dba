//! Estimates from the nearest photon of each query.

use photon_core::{Estimate, EstimateParams, PhotonFormat, Query, Result};

use crate::device::ComputePipeline;
use crate::device::buffer::VulkanBuffer;
use crate::map::VulkanMap;
use crate::shaders;
use crate::vulkan::Vulkan;

/// Invocations per workgroup.
const GROUP: u32 = 64;
/// Maximum number of queries per dispatch.
const PORTION: u64 = 1 << 20;

parameters! {
    /// Parameters of `search/nearest_photon.comp`.
    struct Push => SEARCH_NEAREST_PHOTON {
        nodes: u64,
        positions: u64,
        power: u64,
        ids: u64,
        queries: u64,
        query_count: u64,
        results: u64,
        result_count: u64,
        order: u64,
        points: u32,
        first: u32,
        capacity: u32,
        radius: f32,
        min_cosine: f32,
        padding: u32,
    }
}

specialized!(
    nearest_photon_constants: NearestPhotonConstants => SEARCH_NEAREST_PHOTON, 2 ordered: bool, 3 format: PhotonFormat
);

/// The kernel; `ordered`: whether queries are processed in an order of their own.
pub(super) fn kernel(on: &mut Vulkan, format: PhotonFormat, ordered: bool) -> ComputePipeline {
    on.kernel(&shaders::SEARCH_NEAREST_PHOTON, GROUP, &NearestPhotonConstants { ordered, format })
}

/// Evaluates all queries; `order` is the address of the order to process them in, or 0.
pub(super) fn ask(
    on: &mut Vulkan,
    map: &VulkanMap,
    queries: &VulkanBuffer<Query>,
    gather: &EstimateParams,
    order: u64,
    estimates: &VulkanBuffer<Estimate>,
) -> Result<()> {
    let kernel = kernel(on, map.photon_format(), order != 0);
    let mut push = Push {
        nodes: map.nodes.address(),
        positions: map.positions.address(),
        power: map.power.address(),
        ids: map.ids.address(),
        queries: queries.data_address(),
        query_count: queries.count_address(),
        results: estimates.data_address(),
        result_count: estimates.count_address(),
        order,
        // An empty map must not be traversed.
        points: if map.node_count == 0 { 0 } else { map.length },
        first: 0,
        capacity: estimates.capacity().min(u64::from(u32::MAX)) as u32,
        radius: gather.radius_scale,
        min_cosine: gather.min_normal_cosine,
        padding: 0,
    };
    // Even without queries, a count must be written.
    let capacity = queries.capacity().max(1);
    on.unordered(|on| {
        (0..capacity).step_by(PORTION as usize).try_for_each(|first| {
            push.first = first as u32;
            on.dispatch(&kernel, &push, PORTION.min(capacity - first).div_ceil(u64::from(GROUP)))
        })
    })
}
