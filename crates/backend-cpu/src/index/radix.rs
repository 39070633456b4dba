//! Sorting by Morton code.

use crate::index::layout::Item;
use crate::index::morton::Grid;
use rayon::prelude::*;

/// The items in order of (code, id).
pub(crate) fn sort(items: &[Item], grid: Grid) -> Vec<Item> {
    let mut keys: Vec<(u64, u32, u32)> =
        items.iter().enumerate().map(|(at, item)| (grid.code(item.position), item.id, at as u32)).collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|(_, _, at)| items[at as usize]).collect()
}
