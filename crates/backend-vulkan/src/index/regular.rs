//! Slots and regular trees: sixteen consecutive slots per leaf, sixteen consecutive nodes per parent, level by
//! level, each level contiguous, the root first.

use photon_core::{Photon, PhotonFormat, Result};

use super::WIDTH;
use super::map_storage::MapStorage;
use crate::device::ComputePipeline;
use crate::device::buffer::VulkanBuffer;
use crate::shaders;
use crate::vulkan::Vulkan;

const WORKGROUP: u32 = 256;

/// Copies photons into their slots and computes the bounding boxes of nodes.
#[derive(Debug)]
pub(crate) struct Regular {
    parents: ComputePipeline,
}

parameters! {
    struct ArrangePush => INDEX_ARRANGE {
        photons: u64,
        order: u64,
        positions: u64,
        power: u64,
        ids: u64,
        nodes: u64,
        totals: u64,
        count: u32,
        capacity: u32,
    }
}

parameters! {
    struct ParentsPush => INDEX_PARENTS {
        nodes: u64,
        totals: u64,
        first: u32,
        count: u32,
        first_below: u32,
        count_below: u32,
    }
}

/// Photons, their order, and the storage to fill.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ordered<'a> {
    pub(crate) photons: &'a VulkanBuffer<Photon>,
    /// Number of photons.
    pub(crate) length: u64,
    /// Address of the photon indices in slot order.
    pub(crate) order: u64,
    pub(crate) storage: &'a MapStorage,
}

fn workgroup(on: &Vulkan) -> u32 {
    WORKGROUP.min(on.limits().max_workgroup)
}

/// The kernel that fills slots.
pub(super) fn kernel(on: &mut Vulkan, format: PhotonFormat) -> ComputePipeline {
    super::reading(on, &shaders::INDEX_ARRANGE, workgroup(on), format)
}

impl Regular {
    pub(crate) fn new(on: &mut Vulkan) -> Self {
        Self { parents: on.kernel(&shaders::INDEX_PARENTS, workgroup(on), &()) }
    }

    /// Number of nodes per level, leaves first.
    fn levels(photons: u64) -> Vec<u64> {
        let mut levels = vec![photons.div_ceil(WIDTH)];
        while let Some(&below) = levels.last().filter(|&&below| below > 1) {
            levels.push(below.div_ceil(WIDTH));
        }
        levels
    }

    /// Total number of nodes for the given number of photons.
    pub(crate) fn nodes(photons: u64) -> u64 {
        Self::levels(photons).iter().sum()
    }

    /// Fills the slots, and the leaves and their photon counts, at the two addresses `leaves`.
    pub(crate) fn slots(&self, on: &mut Vulkan, ordered: Ordered<'_>, leaves: [u64; 2]) -> Result<()> {
        let Ordered { photons, length, order, storage } = ordered;
        let push = ArrangePush {
            photons: photons.data_address(),
            order,
            positions: storage.positions.address(),
            power: storage.power.address(),
            ids: storage.ids.address(),
            nodes: leaves[0],
            totals: leaves[1],
            count: length as u32,
            capacity: photons.capacity() as u32,
        };
        let arrange = kernel(on, photons.photon_format());
        on.dispatch(&arrange, &push, length.div_ceil(u64::from(arrange.workgroup)))
    }

    /// Fills the slots and all nodes.
    pub(crate) fn arrange(&self, on: &mut Vulkan, ordered: Ordered<'_>) -> Result<()> {
        let Ordered { length, storage, .. } = ordered;
        let levels = Self::levels(length);
        // First node of a level: the levels above it come first.
        let first = |level: usize| levels[level + 1..].iter().sum::<u64>() as u32;
        let leaves = u64::from(first(0));
        let leaves = [storage.nodes.address() + 32 * leaves, storage.totals.address() + 4 * leaves];
        self.slots(on, ordered, leaves)?;
        for level in 1..levels.len() {
            let push = ParentsPush {
                nodes: storage.nodes.address(),
                totals: storage.totals.address(),
                first: first(level),
                count: levels[level] as u32,
                first_below: first(level - 1),
                count_below: levels[level - 1] as u32,
            };
            on.dispatch(&self.parents, &push, levels[level].div_ceil(u64::from(self.parents.workgroup)))?;
        }
        Ok(())
    }
}
