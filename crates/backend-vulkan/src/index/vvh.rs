//! The kd-tree of the Voxel Volume Heuristic; `backend-cpu` documents where it splits. Built level by level,
//! from lists of the photons sorted along every axis and one in index order, a sample of which is counted. The
//! number of segments per level is known only on the device: the maximum number of levels is recorded, most of
//! them empty dispatches.

use photon_core::{Photon, PhotonFormat, Result, kd_tree};

use super::WIDTH;
use super::bounds::BoundsOf;
use super::lists::{Lists, SHORT, TILE, WORKGROUP};
use super::map_storage::grow;
use crate::device::buffer::VulkanBuffer;
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::vulkan::Vulkan;

const HEURISTIC_DEPTH: u64 = kd_tree::HEURISTIC_DEPTH as u64;
/// A sample of 64 photons per segment.
const PLAN_WORKGROUP: u32 = 64;
/// Bytes of a `VvhLevel`, a `VvhJobs`, a `VvhSegments`.
const LEVEL: u64 = 16;
const JOBS: u64 = 32;
const SEGMENT: u64 = 32;

/// Computes the order and the splits.
#[derive(Debug)]
pub(crate) struct Vvh {
    bounds: BoundsOf,
    lists: Lists,
    sides: ComputePipeline,
    count: ComputePipeline,
    part: ComputePipeline,
    /// Records of the levels; the last one is for short segments.
    levels: Memory,
    jobs: Memory,
    segments: [Memory; 2],
    shorts: Memory,
    tiles: Memory,
    /// One bit per photon: whether it goes to the right part.
    right: Memory,
    counts: Memory,
    /// Number of blocks in the left part of every split, in preorder.
    pub(super) splits: Memory,
}

parameters! {
    struct PlanPush => INDEX_VVH_PLAN {
        photons: u64,
        lists: u64,
        level: u64,
        segments: u64,
        next_level: u64,
        next_segments: u64,
        jobs: u64,
        tiles: u64,
        short_level: u64,
        shorts: u64,
        splits: u64,
        count: u32,
        parity: u32,
    }
}

parameters! {
    struct SidesPush => INDEX_VVH_SIDES {
        lists: u64,
        segments: u64,
        jobs: u64,
        tiles: u64,
        right: u64,
        count: u32,
        pad: u32,
    }
}

parameters! {
    struct CountPush => INDEX_VVH_COUNT {
        lists: u64,
        segments: u64,
        jobs: u64,
        tiles: u64,
        right: u64,
        counts: u64,
        count: u32,
        room: u32,
    }
}

parameters! {
    struct PartPush => INDEX_VVH_PART {
        lists: u64,
        parted: u64,
        segments: u64,
        jobs: u64,
        tiles: u64,
        counts: u64,
        count: u32,
        room: u32,
    }
}

parameters! {
    struct FinishPush => INDEX_VVH_FINISH {
        photons: u64,
        lists: u64,
        other_lists: u64,
        level: u64,
        shorts: u64,
        places: u64,
        splits: u64,
        order: u64,
        count: u32,
        pad: u32,
    }
}

/// Maximum number of levels that have segments longer than `SHORT`.
fn levels(length: u64) -> u64 {
    let halvings = length.div_ceil(SHORT).next_power_of_two().ilog2();
    if length > SHORT { HEURISTIC_DEPTH + u64::from(halvings) } else { 0 }
}

/// The kernel that plans splits.
fn plan(on: &mut Vulkan, format: PhotonFormat) -> ComputePipeline {
    super::reading(on, &shaders::INDEX_VVH_PLAN, PLAN_WORKGROUP, format)
}

/// The kernel that arranges short segments.
fn finish(on: &mut Vulkan, format: PhotonFormat) -> ComputePipeline {
    super::reading(on, &shaders::INDEX_VVH_FINISH, WORKGROUP, format)
}

/// Both kernels that read photons.
pub(super) fn kernels(on: &mut Vulkan, format: PhotonFormat) -> [ComputePipeline; 2] {
    [plan(on, format), finish(on, format)]
}

impl Vvh {
    pub(crate) fn new(on: &mut Vulkan) -> Result<Self> {
        let mut memory = |label| on.memory(label, 32);
        let (levels, jobs, shorts, tiles) =
            (memory("map: levels")?, memory("map: tiles")?, memory("map: segments")?, memory("map: tiles")?);
        let segments = [memory("map: segments")?, memory("map: segments")?];
        let (right, counts, splits) = (memory("map: sides")?, memory("map: counts")?, memory("map: splits")?);
        Ok(Self {
            bounds: BoundsOf::new(on)?,
            lists: Lists::new(on)?,
            sides: on.kernel(&shaders::INDEX_VVH_SIDES, WORKGROUP, &()),
            count: on.kernel(&shaders::INDEX_VVH_COUNT, WORKGROUP, &()),
            part: on.kernel(&shaders::INDEX_VVH_PART, WORKGROUP, &()),
            levels,
            jobs,
            segments,
            shorts,
            tiles,
            right,
            counts,
            splits,
        })
    }

    /// Grows the buffers; `room` is the maximum number of tiles at a time.
    fn grow(&mut self, on: &mut Vulkan, length: u64, room: u64) -> Result<()> {
        let levels = levels(length);
        let segments = length.div_ceil(SHORT + 1);
        grow(on, &mut self.levels, "map: levels", LEVEL * (levels + 2))?;
        grow(on, &mut self.jobs, "map: tiles", JOBS * levels)?;
        for memory in &mut self.segments {
            grow(on, memory, "map: segments", SEGMENT * segments)?;
        }
        grow(on, &mut self.shorts, "map: segments", 16 * length.div_ceil(WIDTH))?;
        grow(on, &mut self.tiles, "map: tiles", 8 * room)?;
        grow(on, &mut self.right, "map: sides", 4 * length.div_ceil(32))?;
        grow(on, &mut self.counts, "map: counts", 4 * 4 * room)?;
        grow(on, &mut self.splits, "map: splits", 4 * length.div_ceil(WIDTH))
    }

    /// Address of the photon indices in slot order; also stores the splits.
    pub(crate) fn order(&mut self, on: &mut Vulkan, photons: &VulkanBuffer<Photon>, length: u64) -> Result<u64> {
        // The last tile of each segment may be nearly empty.
        let room = length / TILE + length.div_ceil(SHORT + 1) + 1;
        self.grow(on, length, room)?;
        self.bounds.find(on, photons, length)?;
        self.lists.fill(on, photons, length, 4)?;

        let count = levels(length);
        let whole = length > SHORT;
        let mut records = vec![[0_u32, 1, 1, 0]; count as usize + 2];
        // Levels 0 to `count`, then the short segments.
        records[if whole { 0 } else { count as usize + 1 }] = [1, 1, 1, 1];
        on.write(&self.levels, 0, bytemuck::cast_slice(&records))?;
        on.write(&self.jobs, 0, bytemuck::cast_slice(&vec![[0_u32, 1, 1, 0, 0, 4, 1, 0]; count as usize]))?;
        let root = [0, length as u32, 0, 0];
        on.write(if whole { &self.segments[0] } else { &self.shorts }, 0, bytemuck::bytes_of(&root))?;
        for level in 0..count {
            self.level(on, photons, length, level, room)?;
        }
        let order = self.lists.keys[1].address();
        let push = FinishPush {
            photons: photons.data_address(),
            lists: self.lists.lists[0].address(),
            other_lists: self.lists.lists[1].address(),
            level: self.levels.address() + LEVEL * (count + 1),
            shorts: self.shorts.address(),
            places: self.lists.keys[0].address(),
            splits: self.splits.address(),
            order,
            count: length as u32,
            pad: 0,
        };
        let finish = self::finish(on, photons.photon_format());
        on.dispatch_indirect(&finish, &push, &self.levels, LEVEL * (count + 1))?;
        Ok(order)
    }

    /// Splits the segments of a level.
    fn level(
        &mut self,
        on: &mut Vulkan,
        photons: &VulkanBuffer<Photon>,
        length: u64,
        level: u64,
        room: u64,
    ) -> Result<()> {
        let (lists, parted) = (self.lists.address(), self.lists.other());
        let [segments, next_segments] = [level, level + 1].map(|level| self.segments[level as usize % 2].address());
        let at = |level: u64| self.levels.address() + LEVEL * level;
        let (jobs, tiles) = (self.jobs.address() + JOBS * level, self.tiles.address());
        let (right, counts) = (self.right.address(), self.counts.address());
        let (count, room) = (length as u32, room as u32);
        let push = PlanPush {
            photons: photons.data_address(),
            lists,
            level: at(level),
            segments,
            next_level: at(level + 1),
            next_segments,
            jobs,
            tiles,
            short_level: at(levels(length) + 1),
            shorts: self.shorts.address(),
            splits: self.splits.address(),
            count,
            parity: (1 - self.lists.at as u32) << 31,
        };
        let plan = self::plan(on, photons.photon_format());
        on.dispatch_indirect(&plan, &push, &self.levels, LEVEL * level)?;
        on.fill_words(&self.right, 0, 4 * length.div_ceil(32), 0)?;
        let push = SidesPush { lists, segments, jobs, tiles, right, count, pad: 0 };
        on.dispatch_indirect(&self.sides, &push, &self.jobs, JOBS * level)?;
        let push = CountPush { lists, segments, jobs, tiles, right, counts, count, room };
        on.dispatch_indirect(&self.count, &push, &self.jobs, JOBS * level + 16)?;
        let push = PartPush { lists, parted, segments, jobs, tiles, counts, count, room };
        on.dispatch_indirect(&self.part, &push, &self.jobs, JOBS * level + 16)?;
        self.lists.at = 1 - self.lists.at;
        Ok(())
    }
}
