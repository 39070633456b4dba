//! Stable least-significant-digit radix sort of key-value pairs, eight bits per pass: count the digits of each
//! tile, compute the prefix sums of the counts, then sort each tile and scatter it to its destination (Satish,
//! Harris, Garland 2009, *Designing Efficient Sorting Algorithms for Manycore GPUs*). No workgroup waits for
//! another.

use photon_core::{Error, Result};

use crate::constants::{SORT_DIGITS, SORT_ITEMS, SORT_SUBGROUPS};
use crate::device::{ComputePipeline, Fault, Memory};
use crate::shaders;
use crate::vulkan::Vulkan;

const ITEMS: u64 = SORT_ITEMS as u64;
const DIGITS: u64 = SORT_DIGITS as u64;

/// Up to this many tiles, one invocation that adds the counts in turn is faster than the scan of a workgroup, which needs
/// barriers. These take much longer by software drivers, whose subgroups are narrow.
const FEW: u64 = 8;
const FEW_BY_SOFTWARE: u64 = 64;

/// Sorts pairs of a key of one or two words, the lower word first, and a value of one word.
#[derive(Debug)]
pub(crate) struct Sort {
    /// For keys of one and of two words.
    count: [ComputePipeline; 2],
    offsets: ComputePipeline,
    scatter: [ComputePipeline; 2],
    /// Size of a workgroup.
    size: u64,
    /// Elements of a tile.
    tile: u64,
    /// Up to so many tiles, an invocation sums the counts of a digit alone.
    few: u64,
    /// Totals by digit, then counts by digit and tile; grows on demand.
    scratch: Memory,
}

/// The pairs to sort, in double buffers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pairs {
    /// Addresses of the keys, and of a buffer of the same size.
    pub(crate) keys: [u64; 2],
    /// Addresses of the values, and of a buffer of the same size.
    pub(crate) values: [u64; 2],
    /// Number of pairs.
    pub(crate) count: u64,
    /// Words per key, 1 or 2.
    pub(crate) words: u32,
    /// Number of low bits of the keys to sort by, rounded up to whole digits of eight bits.
    pub(crate) bits: u32,
    /// Whether the values are the indices of the elements, which are then not read.
    pub(crate) numbered: bool,
    /// Whether the sorted keys are not needed.
    pub(crate) forget_keys: bool,
}

parameters! {
    struct CountPush => SORT_COUNT {
        keys: u64,
        counts: u64,
        count: u32,
        tiles: u32,
        shift: u32,
        pad: u32,
    }
}

parameters! {
    struct OffsetsPush => SORT_OFFSETS {
        counts: u64,
        totals: u64,
        tiles: u32,
        alone: u32,
    }
}

parameters! {
    struct ScatterPush => SORT_SCATTER {
        keys: u64,
        values: u64,
        sorted_keys: u64,
        sorted_values: u64,
        counts: u64,
        totals: u64,
        count: u32,
        tiles: u32,
        shift: u32,
        flags: u32,
    }
}

specialized!(key_constants: KeyConstants => SORT_COUNT SORT_SCATTER, 2 key_words: u32);

/// Size of the workgroups that sort tiles: at most eight subgroups and 256 invocations, to limit shared memory.
///
/// # Errors
/// The device does not support workgroups of that size.
pub(crate) fn workgroup(on: &Vulkan) -> Result<u32> {
    let limits = on.limits();
    let size = (SORT_SUBGROUPS * limits.subgroup_size).min(256);
    if size > limits.max_workgroup {
        let why = format!("{}: sorting needs workgroups of {size} invocations, which are not supported", limits.name);
        return Err(Fault::Other(why).into());
    }
    Ok(size)
}

impl Sort {
    /// # Errors
    /// Errors of the device.
    pub(crate) fn new(on: &mut Vulkan) -> Result<Self> {
        let size = workgroup(on)?;
        let both =
            |on: &mut Vulkan, module| [1, 2].map(|key_words| on.kernel(module, size, &KeyConstants { key_words }));
        Ok(Self {
            count: both(on, &shaders::SORT_COUNT),
            offsets: on.kernel(&shaders::SORT_OFFSETS, size, &()),
            scatter: both(on, &shaders::SORT_SCATTER),
            size: size.into(),
            tile: u64::from(size) * ITEMS,
            few: if on.limits().is_software() { FEW_BY_SOFTWARE } else { FEW },
            scratch: on.memory("sort", 4096)?,
        })
    }

    /// Sorts the pairs stably. Returns 0 or 1: which of the two buffers holds the result. With no bits to sort
    /// by, the pairs stay in buffer 0, and indices as values are not written.
    ///
    /// # Errors
    /// [`Error::InvalidInput`] for more than 2³¹ pairs; errors of the device.
    pub(crate) fn pairs(&mut self, on: &mut Vulkan, pairs: &Pairs) -> Result<usize> {
        debug_assert!(matches!(pairs.words, 1 | 2) && pairs.bits <= 32 * pairs.words, "keys have one word or two");
        if pairs.count > 1 << 31 {
            let why = "sorting is limited to 2^31 pairs: sort fewer at a time".to_owned();
            return Err(Error::InvalidInput { what: "length", index: pairs.count, why });
        }
        let tiles = pairs.count.div_ceil(self.tile);
        let bytes = 4 * DIGITS * (tiles + 1);
        if self.scratch.bytes() < bytes {
            self.scratch = on.memory("sort", bytes.next_power_of_two())?;
        }
        let (totals, counts) = (self.scratch.address(), self.scratch.address() + 4 * DIGITS);
        let (count, tiles_word) = (pairs.count as u32, tiles as u32);
        let kernel = pairs.words as usize - 1;
        let passes = pairs.bits.div_ceil(8);
        let alone = tiles <= self.few;
        let mut at = 0;
        for pass in 0..passes {
            let (from, to, shift) = (at, 1 - at, 8 * pass);
            let keys = pairs.keys[from];
            let push = CountPush { keys, counts, count, tiles: tiles_word, shift, pad: 0 };
            on.dispatch(&self.count[kernel], &push, tiles)?;
            let push = OffsetsPush { counts, totals, tiles: tiles_word, alone: alone.into() };
            on.dispatch(&self.offsets, &push, if alone { DIGITS.div_ceil(self.size) } else { DIGITS })?;
            let numbered = pairs.numbered && pass == 0;
            let forget = pairs.forget_keys && pass + 1 == passes;
            let push = ScatterPush {
                keys,
                values: pairs.values[from],
                sorted_keys: pairs.keys[to],
                sorted_values: pairs.values[to],
                counts,
                totals,
                count,
                tiles: tiles_word,
                shift,
                flags: u32::from(numbered) | u32::from(forget) << 1,
            };
            on.dispatch(&self.scatter[kernel], &push, tiles)?;
            at = to;
        }
        Ok(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sorts on the device and returns keys and values.
    fn sorted(on: &mut Vulkan, sort: &mut Sort, keys: &[u64], words: u32, bits: u32) -> (Vec<u64>, Vec<u32>) {
        let n = keys.len() as u64;
        let bytes = 4 * n * u64::from(words);
        let of_keys = [on.memory("keys", bytes).unwrap(), on.memory("keys", bytes).unwrap()];
        let of_values = [on.memory("values", 4 * n).unwrap(), on.memory("values", 4 * n).unwrap()];
        let low: Vec<u32> = keys.iter().map(|&key| key as u32).collect();
        let data = if words == 1 { bytemuck::cast_slice(&low) } else { bytemuck::cast_slice(keys) };
        on.write(&of_keys[0], 0, data).unwrap();
        let pairs = Pairs {
            keys: [0, 1].map(|i: usize| of_keys[i].address()),
            values: [0, 1].map(|i: usize| of_values[i].address()),
            count: n,
            words,
            bits,
            numbered: true,
            forget_keys: false,
        };
        let at = sort.pairs(on, &pairs).unwrap();
        let mut values = vec![0_u32; keys.len()];
        on.read(&of_values[at], 0, bytemuck::cast_slice_mut(&mut values)).unwrap();
        let keys = if words == 1 {
            let mut found = low;
            on.read(&of_keys[at], 0, bytemuck::cast_slice_mut(&mut found)).unwrap();
            found.iter().map(|&key| u64::from(key)).collect()
        } else {
            let mut found = keys.to_vec();
            on.read(&of_keys[at], 0, bytemuck::cast_slice_mut(&mut found)).unwrap();
            found
        };
        (keys, values)
    }

    /// Checks that `found` holds the indices of `keys` in stable order of their lowest `bits`, in whole digits,
    /// and the keys in that order.
    fn check(keys: &[u64], bits: u32, found: &(Vec<u64>, Vec<u32>)) -> std::result::Result<(), String> {
        let mask = u64::MAX >> (64 - bits.next_multiple_of(8));
        let mut expected: Vec<u32> = (0..keys.len() as u32).collect();
        expected.sort_by_key(|&at| keys[at as usize] & mask);
        if let Some(at) = (0..keys.len()).find(|&at| found.1[at] != expected[at]) {
            return Err(format!("{} instead of {} at {at} of {}", found.1[at], expected[at], keys.len()));
        }
        if let Some(at) = (0..keys.len()).find(|&at| found.0[at] != keys[expected[at] as usize]) {
            return Err(format!("key {:x} at {at}", found.0[at]));
        }
        Ok(())
    }

    #[test]
    fn like_the_standard_library() {
        let Some(mut on) = Vulkan::for_tests() else { return };
        let mut sort = Sort::new(&mut on).unwrap();
        let mut state = 7_u64;
        let mut word = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state ^ state >> 31
        };
        let (tile, few) = (sort.tile as usize, sort.few as usize);
        for n in [0, 1, 2, 33, tile - 1, tile, tile + 1, 5 * tile + 17, few * tile, few * tile + 1, 100_000] {
            for (words, bits) in [(1, 1), (1, 8), (1, 13), (1, 32), (2, 31), (2, 40), (2, 63), (2, 64)] {
                let mask = if words == 1 { u64::from(u32::MAX) } else { u64::MAX };
                let keys: Vec<u64> = (0..n).map(|_| word() & mask).collect();
                let found = sorted(&mut on, &mut sort, &keys, words, bits);
                check(&keys, bits, &found).unwrap();
            }
        }
    }

    #[test]
    fn patterns() {
        let Some(mut on) = Vulkan::for_tests() else { return };
        let mut sort = Sort::new(&mut on).unwrap();
        let n = 30_000_u64;
        let patterns: [&dyn Fn(u64) -> u64; 7] = [
            &|_| 0,
            &|_| u64::MAX,
            &|i| i,
            &|i| n - i,
            &|i| (i % 2) << 63,
            &|i| if i == n / 2 { 0 } else { 0xff << 24 },
            &|i| (i / 1000).wrapping_mul(0x0123_4567_89ab_cdef),
        ];
        for (number, pattern) in patterns.iter().enumerate() {
            let keys: Vec<u64> = (0..n).map(pattern).collect();
            // By workgroups, and by single invocations.
            for few in [0, u64::MAX] {
                sort.few = few;
                let found = sorted(&mut on, &mut sort, &keys, 2, 64);
                check(&keys, 64, &found).unwrap_or_else(|why| panic!("pattern {number}, {few}: {why}"));
            }
        }
    }

    #[test]
    fn values_that_are_not_numbers_come_along_and_keys_may_be_forgotten() {
        let Some(mut on) = Vulkan::for_tests() else { return };
        let mut sort = Sort::new(&mut on).unwrap();
        let n = 5000_u32;
        let keys: Vec<u32> = (0..n).map(|i| i.wrapping_mul(0x9e37_79b1)).collect();
        let values: Vec<u32> = keys.iter().map(|key| !key).collect();
        let memory = [0; 4].map(|_| on.memory("pairs", 4 * u64::from(n)).unwrap());
        on.write(&memory[0], 0, bytemuck::cast_slice(&keys)).unwrap();
        on.write(&memory[2], 0, bytemuck::cast_slice(&values)).unwrap();
        let [a, b, c, d] = [0, 1, 2, 3].map(|i: usize| memory[i].address());
        let count = u64::from(n);
        let pairs =
            Pairs { keys: [a, b], values: [c, d], count, words: 1, bits: 32, numbered: false, forget_keys: true };
        let at = sort.pairs(&mut on, &pairs).unwrap();
        let mut found = values.clone();
        on.read(&memory[2 + at], 0, bytemuck::cast_slice_mut(&mut found)).unwrap();
        let mut expected = keys;
        expected.sort_unstable();
        assert!(found.iter().map(|value| !value).eq(expected));
    }

    #[test]
    fn disorder_is_noticed() {
        let keys = [3, 1, 2, 1];
        assert!(check(&keys, 8, &(vec![1, 1, 2, 3], vec![1, 3, 2, 0])).is_ok());
        assert!(check(&keys, 8, &(vec![1, 1, 2, 3], vec![3, 1, 2, 0])).is_err(), "not stable");
        assert!(check(&keys, 8, &(vec![1, 1, 2, 2], vec![1, 3, 2, 0])).is_err(), "a wrong key");
    }
}
