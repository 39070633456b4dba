//! Exclusive prefix sums of words, in three steps: the sum of each tile, the prefix sums of these, then the
//! prefix sums within each tile. No workgroup waits for another, since Vulkan does not guarantee forward
//! progress.

use photon_core::{Error, Result};

use crate::constants::SCAN_ITEMS;
use crate::device::{ComputePipeline, Memory};
use crate::shaders;
use crate::vulkan::Vulkan;

const ITEMS: u64 = SCAN_ITEMS as u64;
/// Invocations per workgroup, of the kernels with many workgroups and of the one with a single workgroup.
const MANY: u32 = 256;
const ALONE: u32 = 512;
/// Up to this many tiles, a single workgroup is faster than three dispatches.
const MAX_TILES_ALONE: u64 = 2;

/// Computes prefix sums.
#[derive(Debug)]
pub(crate) struct Scan {
    sums: ComputePipeline,
    alone: ComputePipeline,
    tiles: ComputePipeline,
    alone_tile: u64,
    /// Sums of the tiles; grows on demand.
    scratch: Memory,
}

parameters! {
    struct SumsPush => SCAN_SUMS {
        from: u64,
        sums: u64,
        count: u32,
        pad: u32,
    }
}

parameters! {
    struct AlonePush => SCAN_ALONE {
        from: u64,
        to: u64,
        total: u64,
        count: u32,
        has_total: u32,
    }
}

parameters! {
    struct TilesPush => SCAN_TILES {
        from: u64,
        to: u64,
        sums: u64,
        count: u32,
        pad: u32,
    }
}

impl Scan {
    /// # Errors
    /// Errors of the device.
    pub(crate) fn new(on: &mut Vulkan) -> Result<Self> {
        let alone = ALONE.min(on.limits().max_workgroup);
        Ok(Self {
            sums: on.kernel(&shaders::SCAN_SUMS, MANY.min(alone), &()),
            alone: on.kernel(&shaders::SCAN_ALONE, alone, &()),
            tiles: on.kernel(&shaders::SCAN_TILES, MANY.min(alone), &()),
            alone_tile: u64::from(alone) * ITEMS,
            scratch: on.memory("scan", 4096)?,
        })
    }

    /// Computes the exclusive prefix sums of the `n` words at address `input`, modulo 2³², and stores them at
    /// address `output`; stores the sum of all words at address `total` unless that is 0. `output` may equal
    /// `input`.
    ///
    /// # Errors
    /// [`Error::InvalidInput`] for more than 2³¹ words; errors of the device.
    pub(crate) fn exclusive(&mut self, on: &mut Vulkan, input: u64, output: u64, n: u64, total: u64) -> Result<()> {
        if n > 1 << 31 {
            let why = "prefix sums are limited to 2^31 words: process fewer at a time".to_owned();
            return Err(Error::InvalidInput { what: "length", index: n, why });
        }
        let count = n as u32;
        let alone = |from: u64, to: u64, count: u32, total: u64| {
            // An unused address is never dereferenced, but must not be null.
            let has_total = u32::from(total != 0);
            AlonePush { from, to, total: if total == 0 { to } else { total }, count, has_total }
        };
        if n <= self.alone_tile * MAX_TILES_ALONE {
            if n == 0 && total == 0 {
                return Ok(());
            }
            return on.dispatch(&self.alone, &alone(input, output, count, total), 1);
        }
        let tiles = n.div_ceil(u64::from(self.tiles.workgroup) * ITEMS);
        if self.scratch.bytes() < 4 * tiles {
            self.scratch = on.memory("scan", (4 * tiles).next_power_of_two())?;
        }
        let sums = self.scratch.address();
        on.dispatch(&self.sums, &SumsPush { from: input, sums, count, pad: 0 }, tiles)?;
        on.dispatch(&self.alone, &alone(sums, sums, tiles as u32, total), 1)?;
        on.dispatch(&self.tiles, &TilesPush { from: input, to: output, sums, count, pad: 0 }, tiles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that `sums` and `total` are the exclusive prefix sums of `words`.
    fn check(words: &[u32], sums: &[u32], total: u32) -> std::result::Result<(), String> {
        let mut sum = 0_u32;
        for (at, (&word, &found)) in words.iter().zip(sums).enumerate() {
            if found != sum {
                return Err(format!("{found} instead of {sum} at {at} of {}", words.len()));
            }
            sum = sum.wrapping_add(word);
        }
        if total == sum { Ok(()) } else { Err(format!("{total} instead of {sum} in all of {}", words.len())) }
    }

    #[test]
    fn sums_of_any_length_in_place_and_out_of_it() {
        let Some(mut on) = Vulkan::for_tests() else { return };
        let mut scan = Scan::new(&mut on).unwrap();
        let total = on.memory("total", 16).unwrap();
        for n in [0_usize, 1, 2, 31, 255, 4095, 4096, 4097, 8192, 16_384, 16_385, 70_001, 1_000_003] {
            let words: Vec<u32> = (0..n as u32).map(|i| i.wrapping_mul(2_654_435_761) >> 7 | (i & 1) << 31).collect();
            let from = on.memory("from", 4 * n as u64).unwrap();
            let to = on.memory("to", 4 * n as u64).unwrap();
            for in_place in [false, true] {
                let to = if in_place { &from } else { &to };
                on.write(&from, 0, bytemuck::cast_slice(&words)).unwrap();
                on.fill_words(&total, 0, 16, 77).unwrap();
                scan.exclusive(&mut on, from.address(), to.address(), n as u64, total.address()).unwrap();
                let (mut sums, mut sum) = (vec![0_u32; n], [0_u32; 2]);
                on.read(to, 0, bytemuck::cast_slice_mut(&mut sums)).unwrap();
                on.read(&total, 0, bytemuck::cast_slice_mut(&mut sum)).unwrap();
                check(&words, &sums, sum[0]).unwrap();
                assert_eq!(sum[1], 77, "the word after the total was overwritten");
                scan.exclusive(&mut on, from.address(), to.address(), n as u64, 0).unwrap();
            }
        }
        assert!(scan.exclusive(&mut on, 0, 0, 1 << 32, 0).is_err());
    }

    #[test]
    fn wrong_sums_are_noticed() {
        assert!(check(&[1, 2, 3], &[0, 1, 3], 6).is_ok());
        assert!(check(&[1, 2, 3], &[0, 1, 4], 6).is_err());
        assert!(check(&[1, 2, 3], &[0, 1, 3], 7).is_err());
    }
}
