//! The bounding box of all photons, and whether they are finite.

use photon_core::{Photon, PhotonFormat, Result};

use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::vulkan::Vulkan;

/// Workgroups that share all photons.
const GROUPS: u64 = 1024;
const WORKGROUP: u32 = 256;

/// Computes the bounding box.
#[derive(Debug)]
pub(crate) struct BoundsOf {
    /// The twin of `MapState`.
    pub(crate) state: Memory,
}

parameters! {
    struct BoundsPush => INDEX_BOUNDS {
        photons: u64,
        state: u64,
        photon_count: u64,
        count: u32,
        stride: u32,
    }
}

/// The kernel.
pub(super) fn kernel(on: &mut Vulkan, format: PhotonFormat) -> ComputePipeline {
    let workgroup = WORKGROUP.min(on.limits().max_workgroup);
    super::reading(on, &shaders::INDEX_BOUNDS, workgroup, format)
}

impl BoundsOf {
    pub(crate) fn new(on: &mut Vulkan) -> Result<Self> {
        Ok(Self { state: on.memory("map: box", 32)? })
    }

    /// Stores the bounding box in `state`, and marks non-finite photons in the photons' count.
    pub(crate) fn find(&self, on: &mut Vulkan, photons: &VulkanBuffer<Photon>, length: u64) -> Result<()> {
        let none = [u32::MAX, u32::MAX, u32::MAX, 0, 0, 0, 0, 0];
        on.write(&self.state, 0, bytemuck::cast_slice(&none))?;
        let kernel = kernel(on, photons.photon_format());
        let size = u64::from(kernel.workgroup);
        let groups = length.div_ceil(size).min(GROUPS);
        let push = BoundsPush {
            photons: photons.data_address(),
            state: self.state.address(),
            photon_count: photons.count_address(),
            count: length as u32,
            stride: (groups * size) as u32,
        };
        on.dispatch(&kernel, &push, groups)
    }
}
