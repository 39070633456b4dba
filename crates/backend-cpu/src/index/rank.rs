//! Candidates: points found so far, each encoded as one integer, and their sorting.

use std::ops::AddAssign;

/// Squared distance in the high bits, slot in the low ones: squared distances are not negative, so their bits order
/// as integers.
pub(crate) type Key = u64;

#[inline(always)]
pub(crate) fn key(d2: f32, slot: u32) -> Key {
    u64::from(d2.to_bits()) << 32 | u64::from(slot)
}

#[inline(always)]
pub(crate) fn d2_bits(key: Key) -> u32 {
    (key >> 32) as u32
}

#[inline(always)]
pub(crate) fn slot(key: Key) -> u32 {
    key as u32
}

/// Keeps the `k` lowest of more than `k` keys in the order (d2, id), unsorted except that the greatest is last.
pub(crate) fn keep_lowest(keys: &mut Vec<Key>, k: usize, order: &[u32]) {
    debug_assert!(0 < k && k < keys.len(), "k must be positive and below the number of keys");
    let (below, &mut last, above) = keys.select_nth_unstable(k - 1);
    let tied = d2_bits(last);
    if above.iter().chain(&*below).any(|&key| d2_bits(key) == tied) {
        // The cut goes through a tie or ends with one. The selection above used slots, but ids must decide. Even if
        // the tie is kept whole, the last key must be the one with the highest id, since later points may displace
        // it.
        keys.select_nth_unstable_by_key(k - 1, |&key| (d2_bits(key), order[slot(key) as usize]));
    }
    keys.truncate(k);
}

/// Leaves in `keys`, sorted, at least the `k` lowest, possibly more, up to the end of a tie.
///
/// Fastest if squared distances are spread evenly over [0, `r2`], as those of photons on a surface are; correct in
/// any case.
pub(crate) fn sort_lowest(keys: &mut Vec<Key>, scratch: &mut Vec<Key>, k: usize, r2: f32) {
    match keys.len() {
        0..12 => keys.sort_unstable(),
        12..256 => sort_by_buckets::<u8, 256>(keys, scratch, k, r2, |counts| {
            // Prefix sums of eight byte counters at a time: each byte of the product is the sum of the factor's
            // bytes up to it.
            const ONES: u64 = 0x0101_0101_0101_0101;
            let mut before = 0_u64;
            for eight in counts.as_chunks_mut::<8>().0 {
                let sums = u64::from_le_bytes(*eight).wrapping_mul(ONES);
                *eight = (sums << 8).wrapping_add(before.wrapping_mul(ONES)).to_le_bytes();
                before += sums >> 56;
            }
        }),
        256..4096 => sort_by_buckets::<u16, 1024>(keys, scratch, k, r2, |counts| {
            let mut sum = 0;
            for count in counts {
                sum += std::mem::replace(count, sum);
            }
        }),
        _ => keys.sort_unstable(),
    }
}

/// The sort of [`sort_lowest`], with counters that can hold `keys.len()`; `sum_before` replaces each count by the
/// sum of the counts before it (exclusive prefix sum).
#[inline(always)]
fn sort_by_buckets<C: Copy + Default + From<u8> + AddAssign + Into<usize>, const BUCKETS: usize>(
    keys: &mut Vec<Key>,
    scratch: &mut Vec<Key>,
    k: usize,
    r2: f32,
    sum_before: impl Fn(&mut [C; BUCKETS]),
) {
    let scale = (BUCKETS - 1) as f32 / r2;
    if !(scale > 0.0 && scale < f32::INFINITY) {
        keys.sort_unstable();
        return;
    }
    // In this range the low bits of the sum are the integer nearest to the number added to 2²³.
    let bucket = |key: Key| ((f32::from_bits(d2_bits(key)) * scale + 8_388_608.0).to_bits() as usize) & (BUCKETS - 1);
    let mut next = [C::default(); BUCKETS];
    for &key in keys.iter() {
        next[bucket(key)] += C::from(1);
    }
    sum_before(&mut next);
    if scratch.len() < keys.len() {
        scratch.resize(keys.len(), 0);
    }
    let all = &mut scratch[..keys.len()];
    for &key in keys.iter() {
        let at = &mut next[bucket(key)];
        all[(*at).into()] = key;
        *at += C::from(1);
    }
    // Keys in buckets after the one with the k-th key are not among the k lowest.
    let end = if k < all.len() { next[bucket(all[k - 1])].into() } else { all.len() };
    let lowest = &mut all[..end];
    // Only keys within one bucket can still be out of order.
    let mut patience = 8 * lowest.len();
    for at in 1..lowest.len() {
        let key = lowest[at];
        let mut to = at;
        while to > 0 && lowest[to - 1] > key {
            lowest[to] = lowest[to - 1];
            to -= 1;
        }
        lowest[to] = key;
        if at - to > patience {
            // Overfull buckets.
            lowest.sort_unstable();
            break;
        }
        patience -= at - to;
    }
    keys.clear();
    keys.extend_from_slice(lowest);
}

/// Sorts runs of equal distances, which are in order of their slots, by ascending id.
#[inline]
pub(crate) fn settle_ties(keys: &mut [Key], order: &[u32]) {
    let mut at = 1;
    while at < keys.len() {
        if d2_bits(keys[at]) != d2_bits(keys[at - 1]) {
            at += 1;
            continue;
        }
        let first = at - 1;
        while at < keys.len() && d2_bits(keys[at]) == d2_bits(keys[first]) {
            at += 1;
        }
        keys[first..at].sort_unstable_by_key(|&key| order[slot(key) as usize]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tie that is kept whole ends with its highest id, whatever its slots are.
    #[test]
    fn the_last_kept_is_the_greatest_by_id() {
        let order = [10, 50, 20, 30, 5, 7];
        let mut keys: Vec<Key> = (0..5).map(|slot| key(1.0, slot)).collect();
        keys.push(key(2.0, 5));
        keep_lowest(&mut keys, 5, &order);
        assert_eq!(order[slot(keys[4]) as usize], 50);
        keep_lowest(&mut keys, 3, &order);
        let mut ids: Vec<u32> = keys.iter().map(|&key| order[slot(key) as usize]).collect();
        assert_eq!(ids[2], 20);
        ids.sort_unstable();
        assert_eq!(ids, [5, 10, 20]);
    }
}
