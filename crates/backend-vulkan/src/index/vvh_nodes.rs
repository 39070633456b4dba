//! The nodes of the VVH tree, built from its splits: top-down level by level, then boxes bottom-up.

use photon_core::{Result, kd_tree};

use super::WIDTH;
use super::map_storage::grow;
use super::regular::{Ordered, Regular};
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::vulkan::Vulkan;

const WORKGROUP: u32 = 64;
/// Bytes of a `VvhDepth`, of a `VvhNodes`.
const DEPTH: u64 = 32;
const PENDING: u64 = 32;

/// Builds nodes.
#[derive(Debug)]
pub(crate) struct VvhNodes {
    collapse: ComputePipeline,
    boxes: ComputePipeline,
    depths: Memory,
    pending: Memory,
    /// Leaves by block, and their photon counts.
    leaves: Memory,
    totals: Memory,
}

parameters! {
    struct CollapsePush => INDEX_VVH_COLLAPSE {
        depth: u64,
        next_depth: u64,
        pending: u64,
        splits: u64,
        leaves: u64,
        nodes: u64,
        totals: u64,
    }
}

parameters! {
    struct BoxesPush => INDEX_VVH_BOXES {
        depth: u64,
        pending: u64,
        nodes: u64,
        totals: u64,
    }
}

impl VvhNodes {
    pub(crate) fn new(on: &mut Vulkan) -> Result<Self> {
        Ok(Self {
            collapse: on.kernel(&shaders::INDEX_VVH_COLLAPSE, WORKGROUP, &()),
            boxes: on.kernel(&shaders::INDEX_VVH_BOXES, WORKGROUP, &()),
            depths: on.memory("map: levels", 32)?,
            pending: on.memory("map: pending nodes", 32)?,
            leaves: on.memory("map: leaves", 32)?,
            totals: on.memory("map: totals", 32)?,
        })
    }

    /// Maximum number of nodes for the given number of photons: one leaf per block, and at least two children
    /// per node.
    pub(crate) fn nodes(photons: u64) -> u64 {
        (2 * photons.div_ceil(WIDTH)).saturating_sub(1)
    }

    /// Fills the slots and all nodes.
    pub(crate) fn arrange(
        &mut self,
        on: &mut Vulkan,
        regular: &Regular,
        ordered: Ordered<'_>,
        splits: u64,
    ) -> Result<()> {
        let Ordered { length, storage, .. } = ordered;
        let blocks = length.div_ceil(WIDTH);
        if blocks == 0 {
            return Ok(());
        }
        let levels = u64::from(kd_tree::HEURISTIC_DEPTH) + u64::from(blocks.next_power_of_two().ilog2()) + 1;
        grow(on, &mut self.depths, "map: levels", DEPTH * (levels + 1))?;
        grow(on, &mut self.pending, "map: pending nodes", PENDING * blocks)?;
        grow(on, &mut self.leaves, "map: leaves", 32 * blocks)?;
        grow(on, &mut self.totals, "map: totals", 4 * blocks)?;
        regular.slots(on, ordered, [self.leaves.address(), self.totals.address()])?;

        let mut depths = vec![[0_u32, 1, 1, 0, 0, 0, 0, 0]; levels as usize + 1];
        depths[0] = [1, 1, 1, 1, 0, 0, 0, 0];
        on.write(&self.depths, 0, bytemuck::cast_slice(&depths))?;
        // Index, first block, number of blocks, first split, first descendant.
        let root = [0, 0, blocks as u32, 0, 1, 0, 0, 0];
        on.write(&self.pending, 0, bytemuck::bytes_of(&root))?;
        let (nodes, totals, pending) = (storage.nodes.address(), storage.totals.address(), self.pending.address());
        let depth = |level: u64| self.depths.address() + DEPTH * level;
        for level in 0..levels {
            let push = CollapsePush {
                depth: depth(level),
                next_depth: depth(level + 1),
                pending,
                splits,
                leaves: self.leaves.address(),
                nodes,
                totals,
            };
            on.dispatch_indirect(&self.collapse, &push, &self.depths, DEPTH * level)?;
        }
        for level in (0..levels).rev() {
            let push = BoxesPush { depth: depth(level), pending, nodes, totals };
            on.dispatch_indirect(&self.boxes, &push, &self.depths, DEPTH * level)?;
        }
        Ok(())
    }
}
