//! Photon indices sorted by x, by y and by z: the input of kd-tree construction.

use photon_core::{Photon, PhotonFormat, Result};

use super::map_storage::grow;
use crate::constants::{LIST_SHORT, LIST_TILE};
use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::sort::{Pairs, Sort};
use crate::vulkan::Vulkan;

/// Photons per tile of a list, and per segment that a single workgroup splits completely.
pub(super) const TILE: u64 = LIST_TILE as u64;
pub(super) const SHORT: u64 = LIST_SHORT as u64;
/// Workgroup size of the kernels over lists.
pub(super) const WORKGROUP: u32 = 256;

/// The lists, double-buffered.
#[derive(Debug)]
pub(crate) struct Lists {
    sort: Sort,
    /// Sort keys of one axis; later positions of photons in lists.
    pub(super) keys: [Memory; 2],
    pub(super) lists: [Memory; 2],
    /// Which of the two buffers is current.
    pub(super) at: usize,
}

parameters! {
    struct KeysPush => INDEX_KEYS {
        photons: u64,
        keys: u64,
        count: u32,
        axis: u32,
    }
}

/// The kernel that computes keys.
pub(super) fn kernel(on: &mut Vulkan, format: PhotonFormat) -> ComputePipeline {
    super::reading(on, &shaders::INDEX_KEYS, WORKGROUP, format)
}

impl Lists {
    pub(super) fn new(on: &mut Vulkan) -> Result<Self> {
        Ok(Self {
            sort: Sort::new(on)?,
            keys: [on.memory("map: keys", 16)?, on.memory("map: keys", 16)?],
            lists: [on.memory("map: lists", 16)?, on.memory("map: lists", 16)?],
            at: 0,
        })
    }

    /// Sorts the photons along each axis. If there are four lists, the last one is in index order.
    pub(super) fn fill(
        &mut self,
        on: &mut Vulkan,
        photons: &VulkanBuffer<Photon>,
        length: u64,
        count: u64,
    ) -> Result<()> {
        for at in 0..2 {
            grow(on, &mut self.keys[at], "map: keys", 4 * length)?;
            grow(on, &mut self.lists[at], "map: lists", 4 * count * length)?;
        }
        let keys_of = kernel(on, photons.photon_format());
        let keys = [0, 1].map(|at: usize| self.keys[at].address());
        self.at = 0;
        for axis in 0..3 {
            let push =
                KeysPush { photons: photons.data_address(), keys: keys[0], count: length as u32, axis: axis as u32 };
            on.dispatch(&keys_of, &push, length.div_ceil(u64::from(WORKGROUP)))?;
            let values = [0, 1].map(|at: usize| self.lists[at].address() + 4 * length * axis);
            let pairs = Pairs { keys, values, count: length, words: 1, bits: 32, numbered: true, forget_keys: true };
            let at = self.sort.pairs(on, &pairs)?;
            debug_assert_eq!(at, 0, "four digits are an even number of passes");
        }
        if count == 4 {
            let keys = self.lists[0].address() + 4 * length * 3;
            let push = KeysPush { photons: photons.data_address(), keys, count: length as u32, axis: 3 };
            on.dispatch(&keys_of, &push, length.div_ceil(u64::from(WORKGROUP)))?;
        }
        Ok(())
    }

    /// Address of the current lists.
    pub(super) fn address(&self) -> u64 {
        self.lists[self.at].address()
    }

    /// Address of the other buffer.
    pub(super) fn other(&self) -> u64 {
        self.lists[1 - self.at].address()
    }
}
