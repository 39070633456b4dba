//! Photons arranged for search, on the device.

pub(crate) mod estimate;

use photon_core::{Error, IndexKind, Photon, PhotonFormat, Result};

use crate::device::Memory;
use crate::device::buffer::VulkanBuffer;
use crate::vulkan::Vulkan;

/// A photon map.
#[derive(Debug)]
pub struct VulkanMap {
    pub(crate) kind: IndexKind,
    /// In the order in which they were stored. Where its count stands, words 2 and 3 are the
    /// complements of the numbers of the first photon whose power, and position, is not finite, or 0.
    pub(crate) photons: VulkanBuffer<Photon>,
    /// Photons in the map.
    pub(crate) length: u32,
    /// A `vec4` per slot: position, and the bits of the packed normal.
    pub(crate) positions: Memory,
    /// Per slot what is kept besides: power, and the bits of the packed direction; power; or a `float`.
    pub(crate) power: Memory,
    /// A word per slot: index into `photons`.
    pub(crate) ids: Memory,
    /// `BoxNode`s: lower corner, first child or slot, upper corner, count; bit 31 of the count marks a
    /// leaf. The root is node 0.
    pub(crate) nodes: Memory,
    /// A word per node: photons below it.
    pub(crate) totals: Memory,
    /// Nodes; of a [`IndexKind::Vvh`] map as many as there may be at most.
    pub(crate) node_count: u32,
}

impl VulkanMap {
    /// How the photons are arranged.
    #[must_use]
    pub fn kind(&self) -> IndexKind {
        self.kind
    }

    /// How much it keeps of a photon.
    #[must_use]
    pub fn photon_format(&self) -> PhotonFormat {
        self.photons.photon_format()
    }

    /// Photons in the map.
    #[must_use]
    pub fn length(&self) -> u32 {
        self.length
    }

    /// Whether the map was built from finite photons: submits everything and waits. Building does not
    /// wait to find that out; a map of others is as safe to ask, but its answers mean nothing.
    ///
    /// # Errors
    /// [`Error::InvalidInput`] names the first photon that is not finite.
    pub(crate) fn check(&self, on: &mut Vulkan) -> Result<()> {
        let mut words = [0_u32; 2];
        on.read(&self.photons.count, 8, bytemuck::cast_slice_mut(&mut words))?;
        let (word, name) = if words[0] != 0 { (words[0], "power") } else { (words[1], "position") };
        if word == 0 {
            return Ok(());
        }
        let index = u64::from(!word);
        let [position, power] = self.photons.offsets(index);
        let mut value = [0.0_f32; 3];
        if words[0] == 0 {
            on.read(&self.photons.data, position, bytemuck::bytes_of_mut(&mut value))?;
        } else if self.photon_format() == PhotonFormat::Mono {
            on.read(&self.photons.data, power, bytemuck::bytes_of_mut(&mut value[0]))?;
            value = [value[0]; 3];
        } else {
            on.read(&self.photons.data, power, bytemuck::bytes_of_mut(&mut value))?;
        }
        Err(Error::InvalidInput { what: "photon", index, why: format!("{name} {value:?} is not finite") })
    }
}
