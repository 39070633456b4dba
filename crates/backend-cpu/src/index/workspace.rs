//! Scratch memory for building an index.

use photon_core::memory::{self, OutOfMemory};

use crate::index::points::Item;

/// Scratch memory that [`PointIndex::build_in`] keeps from one build to the next: 32 bytes per point of the largest
/// build.
///
/// Allocators return large blocks to the system at once, and the system zeroes them again: that is a quarter of the
/// build time of a kd-tree for twenty thousand points, and a sixth for a million.
///
/// [`PointIndex::build_in`]: crate::index::PointIndex::build_in
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(crate) items: Vec<Item>,
    pub(crate) other: Vec<Item>,
}

impl Workspace {
    /// Memory held, in bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        ((self.items.capacity() + self.other.capacity()) * size_of::<Item>()) as u64
    }
}

/// The first `length` elements, grown if necessary; their contents are unspecified.
pub(crate) fn room(other: &mut Vec<Item>, length: usize) -> Result<&mut [Item], OutOfMemory> {
    if other.len() < length {
        memory::reserve(other, length - other.len(), "sorting photons")?;
        other.resize(length, Item::default());
    }
    Ok(&mut other[..length])
}
