//! Morton order (Morton 1966): three times 21 bits, interleaved, x highest.
//!
//! # The canonical order
//!
//! 1. Negative zeros count as zeros. For a set of points with the bounding box `[lo, hi]` whose longest side
//!    is E, a coordinate p becomes the integer ⌊(p − lo)·2^s⌋, at most 2²¹ − 1; s is the greatest for which
//!    E·2^s ≤ 2²¹. The subtraction is in `f32`; multiplying by the power of two is exact.
//! 2. Points are sorted by (code, id).
//! 3. A run of more than 16 points with equal codes whose bounding box is not a single point is a set of its own,
//!    to which rules 1 to 3 apply. This separates caustics that are smaller than a cell of the first grid.
//!
//! Each block then has sixteen consecutive points, each node sixteen consecutive blocks or nodes.

use crate::index::dispatch::{Dispatched, Isa};
use crate::index::lanes::Lanes;
use crate::index::layout::WIDTH;
use crate::index::points::Bounds;
use crate::index::radix::{self, Keyed};
use photon_core::kd_tree;
use photon_core::memory::{self, OutOfMemory};
use rayon::prelude::*;

/// Bits of the code per axis.
const BITS: i32 = kd_tree::MORTON_BITS as i32;

/// The ids of `points` in the canonical order; `bounds` is their bounding box.
pub(crate) fn order(points: &[[f32; 3]], bounds: &Bounds, isa: Isa) -> Result<Vec<u32>, OutOfMemory> {
    let grid = Grid::over(bounds);
    let mut keyed = radix::zeros(points.len())?;
    keyed.par_chunks_mut(CHUNK).zip(points.par_chunks(CHUNK)).enumerate().for_each(|(chunk, (keyed, points))| {
        isa.run(Encode { grid, points, first: (chunk * CHUNK) as u32, keyed });
    });
    let mut order = memory::zeroed(points.len(), "order of the photons")?;
    sort(points, keyed, &mut order)?;
    Ok(order)
}

/// Points per parallel task.
const CHUNK: usize = 1 << 14;

/// Computes the codes of many points, with ids from `first` on.
struct Encode<'a> {
    grid: Grid,
    points: &'a [[f32; 3]],
    first: u32,
    keyed: &'a mut [Keyed],
}

impl Dispatched for Encode<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Encode { grid, points, mut first, keyed } = self;
        let mut eights = points.chunks_exact(8);
        let mut out = keyed.chunks_exact_mut(8);
        // Eight at a time, in fixed-length loops that the compiler vectorises.
        for (points, keyed) in (&mut eights).zip(&mut out) {
            let mut codes = [0_u64; 8];
            for axis in 0..3 {
                let mut cells = [0_u32; 8];
                for lane in 0..8 {
                    cells[lane] = grid.cell(points[lane][axis], axis);
                }
                for lane in 0..8 {
                    codes[lane] |= spread_bits(cells[lane]) << (2 - axis);
                }
            }
            for lane in 0..8 {
                keyed[lane] = Keyed::new(codes[lane], first + lane as u32);
            }
            first += 8;
        }
        for (&point, keyed) in eights.remainder().iter().zip(out.into_remainder()) {
            *keyed = Keyed::new(grid.code(point), first);
            first += 1;
        }
    }
}

/// Sorts into `order`; runs of equal codes are sorted again by a finer grid.
fn sort(points: &[[f32; 3]], mut keyed: Vec<Keyed>, order: &mut [u32]) -> Result<(), OutOfMemory> {
    let mut scratch = radix::zeros(keyed.len())?;
    radix::sort(&mut keyed, &mut scratch, order, 3 * BITS as u32, &|sorted, order| {
        for (id, keyed) in order.iter_mut().zip(sorted) {
            *id = keyed.id;
        }
        // A run longer than a block covers at least two of these positions, half a block apart.
        let mut at = 0;
        while at + WIDTH / 2 < sorted.len() {
            let code = sorted[at].code();
            if sorted[at + WIDTH / 2].code() != code {
                at += WIDTH / 2;
                continue;
            }
            let mut first = at;
            while first > 0 && sorted[first - 1].code() == code {
                first -= 1;
            }
            while at < sorted.len() && sorted[at].code() == code {
                at += 1;
            }
            if at - first > WIDTH {
                refine(points, &mut order[first..at])?;
            }
        }
        Ok(())
    })
}

/// Sorts the ids of points that share a code.
fn refine(points: &[[f32; 3]], ids: &mut [u32]) -> Result<(), OutOfMemory> {
    let mut bounds = Bounds::NONE;
    for &id in &*ids {
        bounds.grow(points[id as usize]);
    }
    // The extent shrinks at least 2²⁰-fold, so the range of f32 ends the recursion after 14 levels.
    if bounds.lo != bounds.hi {
        let grid = Grid::over(&bounds);
        let keyed = ids.iter().map(|&id| Keyed::new(grid.code(points[id as usize]), id));
        sort(points, memory::collected(keyed, radix::LABEL)?, ids)?;
    }
    Ok(())
}

/// The grid that maps coordinates to integers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    lo: [f32; 3],
    /// Factor applied before the subtraction: one half if the extent would overflow, otherwise one.
    before: f32,
    /// Two powers of two, since their product may leave the range of f32.
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

    #[inline(always)]
    pub(crate) fn code(&self, position: [f32; 3]) -> u64 {
        let cell = |axis: usize| spread_bits(self.cell(position[axis], axis));
        cell(0) << 2 | cell(1) << 1 | cell(2)
    }

    #[inline(always)]
    fn cell(&self, coordinate: f32, axis: usize) -> u32 {
        let scaled = (coordinate * self.before - self.lo[axis]) * self.scale[0] * self.scale[1];
        (scaled as i32).min((1 << BITS) - 1) as u32
    }
}

/// The lowest e with `value` ≤ 2^e. `value` is finite and positive, possibly subnormal.
fn exponent_above(value: f32) -> i32 {
    let bits = f64::from(value).to_bits();
    let whole = (bits >> 52) as i32 - 1023;
    whole + i32::from(bits << 12 != 0)
}

/// 2^exponent; `exponent` must be in the range of normal numbers.
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

/// Inserts two zeros between the low 21 bits of `value`.
#[inline(always)]
fn spread_bits(value: u32) -> u64 {
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
        assert_eq!(spread_bits(value), expected);
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
