//! Memory that building needs besides the index itself.

use crate::index::points::Item;

/// What [`PointIndex::build_in`] keeps from one build to the next, 32 bytes per point of the largest.
///
/// Allocators give large blocks back at once, and the system clears them anew: of the time that a kd-tree
/// takes to build, that is a quarter for twenty thousand points and a sixth for a million.
///
/// [`PointIndex::build_in`]: crate::index::PointIndex::build_in
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(crate) items: Vec<Item>,
    pub(crate) other: Vec<Item>,
}

impl Workspace {
    /// Bytes that it holds.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        ((self.items.capacity() + self.other.capacity()) * size_of::<Item>()) as u64
    }
}

/// The first `length` of what there is, which may be anything.
pub(crate) fn room(other: &mut Vec<Item>, length: usize) -> &mut [Item] {
    if other.len() < length {
        other.resize(length, Item::default());
    }
    &mut other[..length]
}
