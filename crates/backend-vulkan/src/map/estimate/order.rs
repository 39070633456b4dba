//! The order in which queries are processed: neighbours together, since the queries of a tile share memory
//! reads.

use photon_core::{Query, Result};

use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::map::VulkanMap;
use crate::shaders;
use crate::sort::{Pairs, Sort};
use crate::vulkan::Vulkan;

parameters! {
    /// Parameters of `search/codes.comp`.
    struct CodesPush => SEARCH_CODES {
        nodes: u64,
        queries: u64,
        query_count: u64,
        codes: u64,
        count: u32,
        reserved: u32,
    }
}

/// Computes the Morton order of queries, without moving them.
#[derive(Debug)]
pub(super) struct Order {
    sort: Sort,
    keys: [Memory; 2],
    values: [Memory; 2],
    room: u64,
}

/// The kernel that computes codes.
pub(super) fn kernel(on: &mut Vulkan) -> ComputePipeline {
    on.kernel(&shaders::SEARCH_CODES, 128, &())
}

impl Order {
    /// # Errors
    /// Errors of the device.
    pub(super) fn new(on: &mut Vulkan) -> Result<Self> {
        Ok(Self {
            sort: Sort::new(on)?,
            keys: [on.memory("query codes", 4)?, on.memory("query codes", 4)?],
            values: [on.memory("query order", 4)?, on.memory("query order", 4)?],
            room: 0,
        })
    }

    /// Address of the query indices, sorted so that neighbours in `map` are together. There are as many as the
    /// capacity of `queries`; indices of unused elements come last.
    ///
    /// # Errors
    /// Errors of the device.
    pub(super) fn of(&mut self, on: &mut Vulkan, map: &VulkanMap, queries: &VulkanBuffer<Query>) -> Result<u64> {
        let count = queries.capacity();
        if count > self.room {
            for memory in self.keys.iter_mut().chain(&mut self.values) {
                *memory = on.memory("query order", count * 4)?;
            }
            self.room = count;
        }
        let push = CodesPush {
            nodes: map.nodes.address(),
            queries: queries.data_address(),
            query_count: queries.count_address(),
            codes: self.keys[0].address(),
            count: count as u32,
            reserved: 0,
        };
        let kernel = kernel(on);
        on.dispatch(&kernel, &push, count.div_ceil(128))?;
        let pairs = Pairs {
            keys: [self.keys[0].address(), self.keys[1].address()],
            values: [self.values[0].address(), self.values[1].address()],
            count,
            words: 1,
            bits: 24,
            numbered: true,
            forget_keys: true,
        };
        let at = self.sort.pairs(on, &pairs)?;
        Ok(self.values[at].address())
    }
}
