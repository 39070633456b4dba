//! Radix sort by 63-bit codes: most significant digit first while segments are large, then, in cache, least
//! significant digit first. Every step is stable, so that equal codes stay in order of their ids, and the result
//! depends only on the codes.

use bytemuck::Zeroable;
use photon_core::memory::{self, OutOfMemory};
use rayon::prelude::*;

/// A code and the id of its point, packed into twelve bytes: memory traffic is most of the cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Zeroable)]
#[repr(C)]
pub(crate) struct Keyed {
    high: u32,
    low: u32,
    pub(crate) id: u32,
}

impl Keyed {
    #[inline(always)]
    pub(crate) fn new(code: u64, id: u32) -> Keyed {
        Keyed { high: (code >> 32) as u32, low: code as u32, id }
    }

    #[inline(always)]
    pub(crate) fn code(self) -> u64 {
        u64::from(self.high) << 32 | u64::from(self.low)
    }
}

/// Segments up to this long are sorted in cache.
const IN_CACHE: usize = 4096;

/// Segments up to this long are sorted by comparisons, which is faster than counting.
const COMPARED: usize = 40;

/// Segments at least this long are distributed by several threads.
const SHARED: usize = 1 << 17;

/// Label of its memory.
pub(crate) const LABEL: &str = "sorting photons";

/// Zeroed elements to be overwritten. Zeroed pages from the system are not touched here but by the threads that
/// first write to them.
pub(crate) fn zeros(count: usize) -> Result<Vec<Keyed>, OutOfMemory> {
    memory::zeroed(count, LABEL)
}

/// Sorts `keyed`, which is in ascending order of ids, by the lowest `bits` of the codes, and passes every segment
/// of the result, with the matching part of `out`, to `finish`. Equal codes always fall into the same segment.
///
/// `scratch` and `out` have the same length as `keyed`; all codes agree above `bits`.
pub(crate) fn sort<F: Fn(&[Keyed], &mut [u32]) -> Result<(), OutOfMemory> + Sync>(
    keyed: &mut [Keyed],
    scratch: &mut [Keyed],
    out: &mut [u32],
    bits: u32,
    finish: &F,
) -> Result<(), OutOfMemory> {
    if keyed.is_empty() {
        return Ok(());
    }
    if bits == 0 {
        return finish(keyed, out);
    }
    if keyed.len() <= IN_CACHE {
        return finish(in_cache(keyed, scratch, bits), out);
    }
    // About 300 per bucket if codes are spread evenly.
    let digit = (keyed.len().ilog2() - 8).min(11).min(bits);
    let rest = bits - digit;
    let buckets = 1 << digit;
    let of = |keyed: Keyed| (keyed.code() >> rest) as usize & (buckets - 1);
    let chunks = if keyed.len() >= SHARED { rayon::current_num_threads() } else { 1 };
    let chunk = keyed.len().div_ceil(chunks);
    // Each chunk is distributed within itself.
    let distribute = |keyed: &[Keyed], scratch: &mut [Keyed]| {
        let mut next = vec![0_u32; buckets];
        for &keyed in keyed {
            next[of(keyed)] += 1;
        }
        let mut sum = 0;
        for count in &mut next {
            sum += std::mem::replace(count, sum);
        }
        for &keyed in keyed {
            let at = &mut next[of(keyed)];
            scratch[*at as usize] = keyed;
            *at += 1;
        }
        next
    };
    if chunks == 1 {
        let ends = distribute(keyed, scratch);
        let tasks = cut(scratch, keyed, out, buckets, |bucket| ends[bucket] as usize - start(&ends, bucket))?;
        return for_each(tasks, |(keyed, scratch, out)| sort(keyed, scratch, out, rest, finish));
    }
    let ends: Vec<Vec<u32>> = keyed
        .par_chunks(chunk)
        .zip(scratch.par_chunks_mut(chunk))
        .map(|(keyed, scratch)| distribute(keyed, scratch))
        .collect();
    // Then every bucket collects its part of each chunk.
    let size = |bucket: usize| ends.iter().map(|ends| ends[bucket] as usize - start(ends, bucket)).sum();
    {
        let (from, mut to, mut tasks) = (&*scratch, &mut *keyed, memory::with_capacity(buckets, LABEL)?);
        for bucket in 0..buckets {
            let (own, others) = to.split_at_mut(size(bucket));
            to = others;
            tasks.push((bucket, own));
        }
        for_each(tasks, |(bucket, own)| {
            let mut at = 0;
            for (from, ends) in from.chunks(chunk).zip(&ends) {
                let share = &from[start(ends, bucket)..ends[bucket] as usize];
                own[at..at + share.len()].copy_from_slice(share);
                at += share.len();
            }
            Ok(())
        })?;
    }
    let tasks = cut(keyed, scratch, out, buckets, size)?;
    for_each(tasks, |(keyed, scratch, out)| sort(keyed, scratch, out, rest, finish))
}

/// Where a bucket begins in its chunk, given the ends of all buckets.
fn start(ends: &[u32], bucket: usize) -> usize {
    if bucket == 0 { 0 } else { ends[bucket - 1] as usize }
}

type Task<'a> = (&'a mut [Keyed], &'a mut [Keyed], &'a mut [u32]);

/// Splits three slices of equal length into pieces of the given sizes; empty pieces are left out.
fn cut<'a>(
    mut a: &'a mut [Keyed],
    mut b: &'a mut [Keyed],
    mut c: &'a mut [u32],
    buckets: usize,
    size: impl Fn(usize) -> usize,
) -> Result<Vec<Task<'a>>, OutOfMemory> {
    let mut tasks = memory::with_capacity(buckets, LABEL)?;
    for bucket in 0..buckets {
        let size = size(bucket);
        if size == 0 {
            continue;
        }
        let (a_own, a_rest) = a.split_at_mut(size);
        let (b_own, b_rest) = b.split_at_mut(size);
        let (c_own, c_rest) = c.split_at_mut(size);
        (a, b, c) = (a_rest, b_rest, c_rest);
        tasks.push((a_own, b_own, c_own));
    }
    Ok(tasks)
}

/// Runs the tasks in parallel if there is more than one thread.
fn for_each<T: Send>(
    tasks: Vec<T>,
    work: impl Fn(T) -> Result<(), OutOfMemory> + Sync + Send,
) -> Result<(), OutOfMemory> {
    if rayon::current_num_threads() > 1 {
        tasks.into_par_iter().try_for_each(work)
    } else {
        tasks.into_iter().try_for_each(work)
    }
}

/// Sorts a short segment by the lowest `bits` of its codes; returns the slice that holds the result.
fn in_cache<'a>(keyed: &'a mut [Keyed], scratch: &'a mut [Keyed], bits: u32) -> &'a [Keyed] {
    if keyed.len() <= COMPARED {
        sort_few(keyed);
        return keyed;
    }
    // Eight bits per pass, with as many passes as separate nearly all of so few codes.
    let passes = bits.div_ceil(8).min(if keyed.len() <= 256 { 2 } else { 3 });
    let rest = bits.saturating_sub(8 * passes);
    let (mut from, mut to) = (keyed, scratch);
    for pass in 0..passes {
        let digit = |keyed: Keyed| (keyed.code() >> (rest + 8 * pass)) as usize & 0xff;
        let mut next = [0_u32; 256];
        for &keyed in from.iter() {
            next[digit(keyed)] += 1;
        }
        if next[digit(from[0])] as usize == from.len() {
            continue;
        }
        let mut sum = 0;
        for count in &mut next {
            sum += std::mem::replace(count, sum);
        }
        for &keyed in from.iter() {
            let at = &mut next[digit(keyed)];
            to[*at as usize] = keyed;
            *at += 1;
        }
        std::mem::swap(&mut from, &mut to);
    }
    if rest > 0 {
        // Sort runs that are equal in those digits by the rest.
        let (mut at, length) = (1, from.len());
        while at < length {
            if from[at].code() >> rest != from[at - 1].code() >> rest {
                at += 1;
                continue;
            }
            let first = at - 1;
            while at < length && from[at].code() >> rest == from[first].code() >> rest {
                at += 1;
            }
            if at - first <= COMPARED {
                sort_few(&mut from[first..at]);
            } else {
                // Rare enough that the extra copy does not matter.
                let sorted = in_cache(&mut from[first..at], &mut to[first..at], rest).to_vec();
                from[first..at].copy_from_slice(&sorted);
            }
        }
    }
    from
}

/// Insertion sort, which is stable.
fn sort_few(keyed: &mut [Keyed]) {
    for at in 1..keyed.len() {
        let own = keyed[at];
        let mut to = at;
        while to > 0 && keyed[to - 1].code() > own.code() {
            keyed[to] = keyed[to - 1];
            to -= 1;
        }
        keyed[to] = own;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_come_out_sorted_whatever_their_number_spread_and_threads() {
        let mut state = 5_u64;
        let mut word = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state ^ state >> 29
        };
        let all = (1 << 63) - 1;
        for (count, mask) in [
            (0, all),
            (1, all),
            (39, all),
            (500, all),
            (500, 3),
            (3000, 0xff_ffff_0000),
            (3000, 0x7ff),
            (5000, 0),
            (5000, 1 << 62 | 1),
            (9000, 0xffff),
            (300_000, all),
            (300_000, 0xff0),
            (300_000, 0xffff_ffff),
        ] {
            let keyed: Vec<Keyed> = (0..count).map(|id| Keyed::new(word() & mask, id)).collect();
            let mut expected = keyed.clone();
            expected.sort_by_key(|k| k.code());
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
                let (mut a, mut b, mut out) =
                    (keyed.clone(), vec![Keyed::default(); keyed.len()], vec![0; keyed.len()]);
                let sorted = pool.install(|| {
                    sort(&mut a, &mut b, &mut out, 63, &|sorted, out| {
                        for (id, keyed) in out.iter_mut().zip(sorted) {
                            *id = keyed.id;
                        }
                        Ok(())
                    })
                });
                assert_eq!(sorted, Ok(()));
                assert!(out.iter().copied().eq(expected.iter().map(|k| k.id)), "{count} {mask:x} {threads}");
            }
        }
    }
}
