//! Selection along an axis, in the total order (coordinate, id).

use crate::index::layout::Item;

/// Rearranges `items` so that the `rank` lowest along `axis` come first; of equal coordinates the
/// lower id is the lower. `0 < rank < items.len()`.
pub(crate) fn select(items: &mut [Item], rank: usize, axis: usize) {
    debug_assert!(0 < rank && rank < items.len(), "a split leaves points on both sides");
    items.select_nth_unstable_by(rank, |a, b| {
        a.position[axis].total_cmp(&b.position[axis]).then(a.id.cmp(&b.id))
    });
}
