//! Photons arranged for search, on the device.

use photon_core::{IndexKind, Photon};

use crate::buffer::VulkanBuffer;
use crate::device::Memory;

/// A photon map.
#[derive(Debug)]
pub struct VulkanMap {
    pub(crate) kind: IndexKind,
    /// In the order in which they were stored.
    pub(crate) photons: VulkanBuffer<Photon>,
    /// Photons in the map.
    pub(crate) length: u32,
    /// A `vec4` per slot: position, and the bits of the packed normal.
    pub(crate) positions: Memory,
    /// A `vec4` per slot: power, and the bits of the packed direction.
    pub(crate) power: Memory,
    /// A word per slot: index into `photons`.
    pub(crate) ids: Memory,
    /// `BoxNode`s: lower corner, first child or slot, upper corner, count; bit 31 of the count marks a
    /// leaf. The root is node 0.
    pub(crate) nodes: Memory,
    /// A word per node: photons below it.
    pub(crate) totals: Memory,
    /// Nodes.
    pub(crate) node_count: u32,
}
