//! The left-balanced kd-tree; `backend-cpu` documents the order. Built level by level, all segments at once,
//! from lists of the photons sorted along every axis; segments of 1024 photons are split completely by one
//! workgroup each.

use photon_core::{Photon, PhotonFormat, Result};

use super::WIDTH;
use super::bounds::BoundsOf;
use super::lists::{Lists, SHORT, TILE, WORKGROUP};
use super::map_storage::grow;
use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::vulkan::Vulkan;

/// Computes the order.
#[derive(Debug)]
pub(crate) struct Median {
    bounds: BoundsOf,
    lists: Lists,
    count: ComputePipeline,
    part: ComputePipeline,
    /// One bit per photon: whether it goes to the right part.
    right: Memory,
    counts: Memory,
}

parameters! {
    struct SidesPush => INDEX_MEDIAN_SIDES {
        photons: u64,
        lists: u64,
        right: u64,
        count: u32,
        size: u32,
    }
}

parameters! {
    struct CountPush => INDEX_MEDIAN_COUNT {
        lists: u64,
        right: u64,
        counts: u64,
        count: u32,
        tiles: u32,
    }
}

parameters! {
    struct PartPush => INDEX_MEDIAN_PART {
        lists: u64,
        parted: u64,
        counts: u64,
        count: u32,
        tiles: u32,
        size: u32,
        pad: u32,
    }
}

parameters! {
    struct FinishPush => INDEX_MEDIAN_FINISH {
        photons: u64,
        lists: u64,
        places: u64,
        order: u64,
        count: u32,
        pad: u32,
    }
}

/// Kernels: that which divides segments, and that which arranges short ones.
pub(super) fn kernels(on: &mut Vulkan, format: PhotonFormat) -> [ComputePipeline; 2] {
    [&shaders::INDEX_MEDIAN_SIDES, &shaders::INDEX_MEDIAN_FINISH]
        .map(|module| super::reading(on, module, WORKGROUP, format))
}

impl Median {
    pub(crate) fn new(on: &mut Vulkan) -> Result<Self> {
        Ok(Self {
            bounds: BoundsOf::new(on)?,
            lists: Lists::new(on)?,
            count: on.kernel(&shaders::INDEX_MEDIAN_COUNT, WORKGROUP, &()),
            part: on.kernel(&shaders::INDEX_MEDIAN_PART, WORKGROUP, &()),
            right: on.memory("map: sides", 16)?,
            counts: on.memory("map: counts", 16)?,
        })
    }

    /// Address of the photon indices in slot order.
    pub(crate) fn order(&mut self, on: &mut Vulkan, photons: &VulkanBuffer<Photon>, length: u64) -> Result<u64> {
        let tiles = length.div_ceil(TILE);
        let sides_bytes = 4 * length.div_ceil(32);
        grow(on, &mut self.right, "map: sides", sides_bytes)?;
        grow(on, &mut self.counts, "map: counts", 4 * 3 * tiles)?;
        self.bounds.find(on, photons, length)?;
        self.lists.fill(on, photons, length, 3)?;

        let [sides, finish] = kernels(on, photons.photon_format());
        let (data, count) = (photons.data_address(), length as u32);
        let (right, counts, tiles_word) = (self.right.address(), self.counts.address(), tiles as u32);
        // A segment of more than 16·2^j photons has a left part of exactly this size, which is constant per
        // level.
        let mut size = length.next_power_of_two().max(WIDTH);
        while size > SHORT {
            let lists = self.lists.address();
            let size_word = size as u32;
            on.fill_words(&self.right, 0, sides_bytes, 0)?;
            on.dispatch(&sides, &SidesPush { photons: data, lists, right, count, size: size_word }, tiles)?;
            on.dispatch(&self.count, &CountPush { lists, right, counts, count, tiles: tiles_word }, 3 * tiles)?;
            let parted = self.lists.other();
            let push = PartPush { lists, parted, counts, count, tiles: tiles_word, size: size_word, pad: 0 };
            on.dispatch(&self.part, &push, 3 * tiles)?;
            self.lists.at = 1 - self.lists.at;
            size /= 2;
        }
        let order = self.lists.other();
        let places = self.lists.keys[0].address();
        let push = FinishPush { photons: data, lists: self.lists.address(), places, order, count, pad: 0 };
        on.dispatch(&finish, &push, length.div_ceil(SHORT))?;
        Ok(order)
    }
}
