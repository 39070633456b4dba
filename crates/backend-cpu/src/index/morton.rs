//! The order of Morton codes (Morton 1966): three times 21 bits, interleaved, x highest.
//!
//! # The canonical order
//!
//! 1. Negative zeros count as zeros. Over a set of points with the box `[lo, hi]` whose longest side
//!    is E, a coordinate p becomes the integer ⌊(p − lo)·2^s⌋, at most 2²¹ − 1; s is the greatest for which
//!    E·2^s ≤ 2²¹. The subtraction is in `f32`; the power of two loses nothing.
//! 2. Points are in order of (code, id).
//! 3. A run of more than 16 points with one code whose box is not a single point is a set of its own: rules 1
//!    to 3 arrange it. That is what keeps caustics apart that are smaller than a cell of the first grid.
//!
//! Blocks are then sixteen consecutive points each, nodes sixteen consecutive blocks or nodes.

use crate::index::layout::{Bounds, Item, WIDTH};
use crate::index::radix;
use rayon::prelude::*;

/// Bits of the code per axis.
const BITS: i32 = 21;

/// Brings `items` into the canonical order.
pub(crate) fn arrange(items: &mut Vec<Item>) {
    let bounds = bounds_of(items);
    let grid = Grid::over(&bounds);
    *items = radix::sort(items, grid);
    refine(items, grid);
}

fn bounds_of(items: &[Item]) -> Bounds {
    let parts: Vec<Bounds> = items.par_chunks(1 << 14).map(Bounds::around).collect();
    let mut all = Bounds::NONE;
    for part in &parts {
        all.join(part);
    }
    all
}

/// Arranges anew every long run of equal codes in `items`, which are sorted by `grid`.
fn refine(items: &mut [Item], grid: Grid) {
    // A list instead of recursion; every level shortens the extent by 2²⁰ at least, so that the range of
    // f32 is exhausted after 14 levels.
    let mut sets = vec![(0, items.len(), grid)];
    while let Some((start, end, grid)) = sets.pop() {
        let mut first = start;
        while first < end {
            let code = grid.code(items[first].position);
            // A run of more than a block reaches the point one block on: elsewhere, one look suffices.
            let probe = first + WIDTH;
            if probe >= end || grid.code(items[probe].position) != code {
                first += 1;
                while first < end && first < probe && grid.code(items[first].position) == code {
                    first += 1;
                }
                continue;
            }
            let mut last = probe + 1;
            while last < end && grid.code(items[last].position) == code {
                last += 1;
            }
            let run = &mut items[first..last];
            let bounds = bounds_of(run);
            if bounds.lo != bounds.hi {
                let finer = Grid::over(&bounds);
                let sorted = radix::sort(run, finer);
                run.copy_from_slice(&sorted);
                sets.push((first, last, finer));
            }
            first = last;
        }
    }
}

/// How coordinates become integers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    lo: [f32; 3],
    /// Applied before the subtraction: one half where the extent would overflow, else one.
    before: f32,
    /// Two powers of two, as the product may leave the range of f32.
    scale: [f32; 2],
}

impl Grid {
    pub(crate) fn over(bounds: &Bounds) -> Grid {
        let (_, full) = bounds.longest();
        let before = if full == f32::INFINITY { 0.5 } else { 1.0 };
        let lo = bounds.lo.map(|c| c * before);
        let (_, extent) = Bounds { lo, hi: bounds.hi.map(|c| c * before) }.longest();
        let exponent = if extent > 0.0 { BITS - exponent_above(extent) } else { 0 };
        let half = exponent / 2;
        Grid { lo, before, scale: [power_of_two(half), power_of_two(exponent - half)] }
    }

    #[inline]
    pub(crate) fn code(&self, position: [f32; 3]) -> u64 {
        let cell = |axis: usize| {
            let scaled = (position[axis] * self.before - self.lo[axis]) * self.scale[0] * self.scale[1];
            (scaled as u32).min((1 << BITS) - 1)
        };
        spread(cell(0)) << 2 | spread(cell(1)) << 1 | spread(cell(2))
    }
}

/// The lowest e with `value` ≤ 2^e, for finite positive values, subnormal ones included.
fn exponent_above(value: f32) -> i32 {
    let bits = f64::from(value).to_bits();
    let whole = (bits >> 52) as i32 - 1023;
    whole + i32::from(bits << 12 != 0)
}

/// 2^exponent, `exponent` in the range of normal numbers.
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

/// Puts two zeros between the low 21 bits of `value`.
#[inline]
fn spread(value: u32) -> u64 {
    let mut v = u64::from(value);
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_interleaved() {
        let mut expected = 0_u64;
        let value = 0x0015_a5c3_u32 & ((1 << BITS) - 1);
        for bit in 0..BITS {
            expected |= u64::from(value >> bit & 1) << (3 * bit);
        }
        assert_eq!(spread(value), expected);
    }

    #[test]
    fn exponents_bound_their_values() {
        for value in [1.0_f32, 1.5, 2.0, 1e-45, 1e-40, f32::MIN_POSITIVE, f32::MAX, 3.0e-20] {
            let e = exponent_above(value);
            assert!(f64::from(value) <= 2_f64.powi(e) && f64::from(value) > 2_f64.powi(e - 1), "{value}");
        }
    }

    #[test]
    fn the_grid_spans_the_box_at_any_scale() {
        for extent in [1e-45_f32, 1e-30, 1.0, 1e30, f32::MAX] {
            for lo in [0.0, -extent] {
                let grid = Grid::over(&Bounds { lo: [lo; 3], hi: [extent; 3] });
                assert_eq!(grid.code([lo; 3]), 0);
                assert!(grid.code([extent; 3]) >= 7 << 60, "{extent} {lo}: {:x}", grid.code([extent; 3]));
            }
        }
    }
}
