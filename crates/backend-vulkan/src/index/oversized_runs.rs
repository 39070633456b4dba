//! Runs of one Morton code that are too long for one workgroup: each is treated as a point set of its own, as
//! the canonical order defines, and is sorted by the whole device.
//!
//! Only the host can start that, so it has to wait for the runs to be known. It waits only where they could be
//! long: a million photons in a cell of 2⁻²¹ of the scene would keep one workgroup busy for tens of
//! milliseconds, and a software device would silently end its loops.

use photon_core::{Photon, Result};

use super::morton::{GatherPush, Morton, ROUNDS};
use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::vulkan::Vulkan;

/// Longer runs are oversized. A workgroup of a software device reaches its limit on loop iterations with runs
/// of about twice this length.
pub(super) const OVERSIZED: u32 = 1 << 16;
/// From this number of photons on, the cost of a wait is negligible.
const WORTH_WAITING: u64 = 1 << 20;

parameters! {
    struct PickPush => INDEX_PICK {
        photons: u64,
        ids: u64,
        picked: u64,
        count: u32,
        capacity: u32,
    }
}

/// Whether it is worthwhile to check this number of photons for oversized runs.
pub(super) fn worth_a_look(on: &Vulkan, length: u64, depth: u64) -> bool {
    let large = length >= WORTH_WAITING || on.limits().is_software();
    large && length > u64::from(OVERSIZED) && depth < ROUNDS
}

impl Morton {
    /// Sorts the oversized runs of round 0 and removes them from its list; `order` contains the runs.
    pub(super) fn oversized_runs(
        &self,
        on: &mut Vulkan,
        photons: &VulkanBuffer<Photon>,
        order: &Memory,
        depth: u64,
    ) -> Result<()> {
        let mut round = [0_u32; 4];
        on.read(&self.rounds, 0, bytemuck::cast_slice_mut(&mut round))?;
        let mut runs = vec![[0_u32; 2]; round[3] as usize];
        on.read(&self.runs[0], 0, bytemuck::cast_slice_mut(&mut runs))?;
        let (oversized_runs, others): (Vec<_>, Vec<_>) = runs.into_iter().partition(|[_, length]| *length > OVERSIZED);
        if oversized_runs.is_empty() {
            return Ok(());
        }
        let groups = round[0].min(others.len() as u32);
        on.write(&self.runs[0], 0, bytemuck::cast_slice(&others))?;
        on.write(&self.rounds, 0, bytemuck::bytes_of(&[groups, 1, 1, others.len() as u32]))?;
        for [first, length] in oversized_runs {
            self.giant(on, photons, order, [u64::from(first), u64::from(length)], depth)?;
        }
        Ok(())
    }

    fn giant(
        &self,
        on: &mut Vulkan,
        photons: &VulkanBuffer<Photon>,
        order: &Memory,
        [first, length]: [u64; 2],
        depth: u64,
    ) -> Result<()> {
        let picked = VulkanBuffer::<Photon>::new(on, "photons of one code", length)?;
        let pick = super::reading(on, &shaders::INDEX_PICK, self.gather.workgroup, photons.photon_format());
        let groups = |kernel: &ComputePipeline| length.div_ceil(u64::from(kernel.workgroup));
        let (ids, count) = (order.address() + 4 * first, length as u32);
        let capacity = photons.capacity() as u32;
        let push = PickPush { photons: photons.data_address(), ids, picked: picked.data_address(), count, capacity };
        on.dispatch(&pick, &push, groups(&pick))?;
        let mut finer = Self::new(on)?;
        finer.bounds.find(on, &picked, length)?;
        let mut sides = [[0_u32; 3]; 2];
        on.read(&finer.bounds.state, 0, bytemuck::cast_slice_mut(&mut sides))?;
        // Coincident photons stay in index order.
        if sides[0] == sides[1] {
            return Ok(());
        }
        let places = finer.order_at(on, &picked, length, depth + 1)?;
        let arranged = on.memory("map: order", 4 * length)?;
        let push = GatherPush { words: ids, order: places, gathered: arranged.address(), count, pad: 0 };
        on.dispatch(&self.gather, &push, groups(&self.gather))?;
        on.copy(&arranged, 0, order, 4 * first, 4 * length)
    }
}
