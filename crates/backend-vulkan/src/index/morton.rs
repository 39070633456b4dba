//! Morton-code order; `backend-cpu` documents it. Codes of 63 bits are sorted by their lower words, then by
//! their higher ones, which are not moved until then. Runs of more photons than fit in a leaf that share a code
//! are sorted by finer grids, round by round: where there are none, as is nearly always the case, the rounds
//! are empty dispatches.

use photon_core::{Photon, PhotonFormat, Result};

use super::WIDTH;
use super::bounds::BoundsOf;
use super::map_storage::grow;
use super::oversized_runs;
use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::sort::{self, Pairs, Sort};
use crate::vulkan::Vulkan;

const WORKGROUP: u32 = 256;
/// The remaining extent shrinks at least 2²⁰-fold per round, and `f32` spans 2²⁷⁷.
pub(super) const ROUNDS: u64 = 14;
/// Bytes of a `Round`.
const ROUND: u64 = 16;

/// Computes the order.
#[derive(Debug)]
pub(crate) struct Morton {
    pub(super) bounds: BoundsOf,
    pub(super) gather: ComputePipeline,
    long_runs: ComputePipeline,
    sort: Sort,
    /// Two words per photon each: the keys being sorted, and both words of the codes.
    keys: Memory,
    words: Memory,
    ids: [Memory; 2],
    pub(super) rounds: Memory,
    pub(super) runs: [Memory; 2],
}

parameters! {
    struct CodesPush => INDEX_CODES {
        photons: u64,
        state: u64,
        keys: u64,
        low: u64,
        high: u64,
        count: u32,
        pad: u32,
    }
}

parameters! {
    pub(super) struct GatherPush => INDEX_PERMUTE {
        pub(super) words: u64,
        pub(super) order: u64,
        pub(super) gathered: u64,
        pub(super) count: u32,
        pub(super) pad: u32,
    }
}

parameters! {
    struct LongRunsPush => INDEX_LONG_RUNS {
        order: u64,
        sorted_high: u64,
        low: u64,
        round: u64,
        runs: u64,
        count: u32,
        pad: u32,
    }
}

parameters! {
    struct RefinePush => INDEX_REFINE {
        photons: u64,
        ids: u64,
        other_ids: u64,
        codes: u64,
        other_codes: u64,
        round: u64,
        runs: u64,
        next_round: u64,
        next_runs: u64,
    }
}

fn workgroup(on: &Vulkan) -> u32 {
    WORKGROUP.min(on.limits().max_workgroup)
}

/// Kernels: that which computes codes, and that which sorts runs.
///
/// # Errors
/// The device does not support workgroups of that size.
pub(super) fn kernels(on: &mut Vulkan, format: PhotonFormat) -> Result<[ComputePipeline; 2]> {
    let (size, tile) = (workgroup(on), sort::workgroup(on)?);
    Ok([
        super::reading(on, &shaders::INDEX_CODES, size, format),
        super::reading(on, &shaders::INDEX_REFINE, tile, format),
    ])
}

impl Morton {
    pub(crate) fn new(on: &mut Vulkan) -> Result<Self> {
        let size = workgroup(on);
        let two =
            |on: &mut Vulkan, label| -> Result<[Memory; 2]> { Ok([on.memory(label, 16)?, on.memory(label, 16)?]) };
        Ok(Self {
            bounds: BoundsOf::new(on)?,
            gather: on.kernel(&shaders::INDEX_PERMUTE, size, &()),
            long_runs: on.kernel(&shaders::INDEX_LONG_RUNS, size, &()),
            sort: Sort::new(on)?,
            keys: on.memory("map: keys", 16)?,
            words: on.memory("map: codes", 16)?,
            ids: two(on, "map: order")?,
            rounds: on.memory("map: rounds", ROUND * (ROUNDS + 1))?,
            runs: two(on, "map: runs")?,
        })
    }

    /// Address of the photon indices in slot order.
    pub(crate) fn order(&mut self, on: &mut Vulkan, photons: &VulkanBuffer<Photon>, length: u64) -> Result<u64> {
        self.order_at(on, photons, length, 0)
    }

    /// The same for an oversized run of photons, at the given nesting depth.
    pub(super) fn order_at(
        &mut self,
        on: &mut Vulkan,
        photons: &VulkanBuffer<Photon>,
        length: u64,
        depth: u64,
    ) -> Result<u64> {
        grow(on, &mut self.keys, "map: keys", 8 * length)?;
        grow(on, &mut self.words, "map: codes", 8 * length)?;
        for at in 0..2 {
            grow(on, &mut self.ids[at], "map: order", 4 * length)?;
            grow(on, &mut self.runs[at], "map: runs", 8 * (length / (WIDTH + 1) + 1))?;
        }
        self.bounds.find(on, photons, length)?;
        let halves = |memory: &Memory| [memory.address(), memory.address() + 4 * length];
        let (keys, [low, high]) = (halves(&self.keys), halves(&self.words));
        let mut values = [0, 1].map(|at: usize| self.ids[at].address());
        let (data, count) = (photons.data_address(), length as u32);
        let groups = |kernel: &ComputePipeline| length.div_ceil(u64::from(kernel.workgroup));
        let state = self.bounds.state.address();
        let push = CodesPush { photons: data, state, keys: keys[0], low, high, count, pad: 0 };
        let [codes, refine] = kernels(on, photons.photon_format())?;
        on.dispatch(&codes, &push, groups(&codes))?;
        let pairs = Pairs { keys, values, count: length, words: 1, bits: 32, numbered: true, forget_keys: true };
        if self.sort.pairs(on, &pairs)? == 1 {
            values.swap(0, 1);
        }
        let push = GatherPush { words: high, order: values[0], gathered: keys[0], count, pad: 0 };
        on.dispatch(&self.gather, &push, groups(&self.gather))?;
        let pairs = Pairs { values, bits: 31, numbered: false, forget_keys: false, ..pairs };
        let at = self.sort.pairs(on, &pairs)?;
        let (order, sorted_high) = (values[at], keys[at]);

        let none = [[0_u32, 1, 1, 0]; ROUNDS as usize + 1];
        on.write(&self.rounds, 0, bytemuck::cast_slice(&none))?;
        let round = |number: u64| self.rounds.address() + ROUND * number;
        let runs = |number: u64| self.runs[(number % 2) as usize].address();
        let push = LongRunsPush { order, sorted_high, low, round: round(0), runs: runs(0), count, pad: 0 };
        on.dispatch(&self.long_runs, &push, groups(&self.long_runs))?;
        if oversized_runs::worth_a_look(on, length, depth) {
            let here = usize::from(self.ids[0].address() != order);
            self.oversized_runs(on, photons, &self.ids[here], depth)?;
        }
        for number in 0..ROUNDS {
            let push = RefinePush {
                photons: data,
                ids: order,
                other_ids: values[1 - at],
                codes: self.keys.address(),
                other_codes: self.words.address(),
                round: round(number),
                runs: runs(number),
                next_round: round(number + 1),
                next_runs: runs(number + 1),
            };
            on.dispatch_indirect(&refine, &push, &self.rounds, ROUND * number)?;
        }
        Ok(order)
    }
}
