//! Memory of maps, and growing buffers.

use photon_core::{PhotonFormat, Result};

use crate::device::Memory;
use crate::vulkan::Vulkan;

/// The buffers of a map; see [`crate::VulkanMap`].
#[derive(Debug)]
pub(crate) struct MapStorage {
    pub(crate) positions: Memory,
    pub(crate) power: Memory,
    pub(crate) ids: Memory,
    pub(crate) nodes: Memory,
    pub(crate) totals: Memory,
}

impl MapStorage {
    /// Buffers for no photons.
    pub(crate) fn new(on: &mut Vulkan) -> Result<Self> {
        Ok(Self {
            positions: on.memory("map: positions", 16)?,
            power: on.memory("map: power", 16)?,
            ids: on.memory("map: ids", 16)?,
            nodes: on.memory("map: nodes", 32)?,
            totals: on.memory("map: totals", 16)?,
        })
    }

    /// Grows the buffers for the given numbers of photons (in the given format) and nodes.
    pub(crate) fn grow(
        &mut self,
        on: &mut Vulkan,
        photons: u64,
        nodes: u64,
        photon_format: PhotonFormat,
    ) -> Result<()> {
        grow(on, &mut self.positions, "map: positions", 16 * photons)?;
        grow(on, &mut self.power, "map: power", photon_format.flux_bytes() * photons)?;
        grow(on, &mut self.ids, "map: ids", 4 * photons)?;
        grow(on, &mut self.nodes, "map: nodes", 32 * nodes)?;
        grow(on, &mut self.totals, "map: totals", 4 * nodes)
    }

    /// Total size in bytes.
    pub(crate) fn bytes(&self) -> u64 {
        [&self.positions, &self.power, &self.ids, &self.nodes, &self.totals].iter().map(|memory| memory.bytes()).sum()
    }
}

/// Makes a buffer large enough; its content is lost. Allocates an eighth more than requested, since the number
/// of photons varies from pass to pass.
pub(crate) fn grow(on: &mut Vulkan, memory: &mut Memory, label: &str, bytes: u64) -> Result<()> {
    if memory.bytes() < bytes {
        *memory = match on.memory(label, bytes + bytes / 8) {
            Err(_) => on.memory(label, bytes)?,
            larger => larger?,
        };
    }
    Ok(())
}
