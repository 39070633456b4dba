//! Photon maps on the device.

pub(crate) mod estimate;

use photon_core::{Error, IndexKind, Photon, PhotonFormat, Result};

use crate::device::Memory;
use crate::device::buffer::VulkanBuffer;
use crate::vulkan::Vulkan;

/// A photon map.
#[derive(Debug)]
pub struct VulkanMap {
    pub(crate) kind: IndexKind,
    /// In the order in which they were stored. Words 2 and 3 of the buffer's count are the bitwise complements
    /// of the index of the first photon with non-finite power and with non-finite position, or 0 if there is
    /// none.
    pub(crate) photons: VulkanBuffer<Photon>,
    /// Number of photons in the map.
    pub(crate) length: u32,
    /// A `vec4` per slot: position, and the bits of the packed normal.
    pub(crate) positions: Memory,
    /// The rest of the photon per slot, depending on the format: power, and the bits of the packed direction;
    /// or power; or a `float`.
    pub(crate) power: Memory,
    /// A word per slot: the index into `photons`.
    pub(crate) ids: Memory,
    /// `BoxNode`s: lower corner, first child or slot, upper corner, count; bit 31 of the count marks a leaf.
    /// The root is node 0.
    pub(crate) nodes: Memory,
    /// A word per node: the number of photons in its subtree.
    pub(crate) totals: Memory,
    /// Number of nodes; for an [`IndexKind::Vvh`] map an upper bound.
    pub(crate) node_count: u32,
}

impl VulkanMap {
    /// The index structure of the map.
    #[must_use]
    pub fn kind(&self) -> IndexKind {
        self.kind
    }

    /// Which parts of a photon the map stores.
    #[must_use]
    pub fn photon_format(&self) -> PhotonFormat {
        self.photons.photon_format()
    }

    /// Number of photons in the map.
    #[must_use]
    pub fn length(&self) -> u32 {
        self.length
    }

    /// Checks that the map was built from finite photons: submits everything and waits. Building does not wait
    /// to find that out; searching a map with non-finite photons is safe, but the results are meaningless.
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
