//! Candidates: points found so far, as one integer each, and their ranking.

/// Squared distance above, slot below: as squared distances are not negative, integers order as they do.
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

/// Keeps the `k` lowest of more than `k` keys in the order (d2, id), unsorted but for the last,
/// which is the greatest.
pub(crate) fn keep_lowest(keys: &mut Vec<Key>, k: usize, order: &[u32]) {
    debug_assert!(0 < k && k < keys.len(), "there is something to drop");
    let (_, &mut last, above) = keys.select_nth_unstable(k - 1);
    let tied = d2_bits(last);
    if above.iter().any(|&key| d2_bits(key) == tied) {
        // The cut goes through a tie, which slots decided: ids must.
        keys.select_nth_unstable_by_key(k - 1, |&key| (d2_bits(key), order[slot(key) as usize]));
    }
    keys.truncate(k);
}

/// Below this many keys per bucket the sort by buckets beats one by comparisons.
const CROWDED: usize = 24;

/// Sorts keys whose squared distances spread evenly over [0, `r2`], as those of photons on a surface do.
/// Others come out sorted as well, only later.
pub(crate) fn sort(keys: &mut Vec<Key>, scratch: &mut Vec<Key>, r2: f32) {
    const BUCKETS: usize = 256;
    let scale = BUCKETS as f32 / r2;
    if keys.len() < 24 || keys.len() > 1024 || !(scale > 0.0 && scale < f32::INFINITY) {
        keys.sort_unstable();
        return;
    }
    let bucket = |key: Key| ((f32::from_bits(d2_bits(key)) * scale) as usize).min(BUCKETS - 1);
    let mut start = [0_u16; BUCKETS];
    for &key in keys.iter() {
        start[bucket(key)] += 1;
    }
    let (mut sum, mut crowd) = (0, 0);
    for count in &mut start {
        let own = *count;
        crowd = crowd.max(own);
        *count = sum;
        sum += own;
    }
    if usize::from(crowd) > CROWDED {
        keys.sort_unstable();
        return;
    }
    scratch.clear();
    scratch.resize(keys.len(), 0);
    for &key in keys.iter() {
        let at = &mut start[bucket(key)];
        scratch[usize::from(*at)] = key;
        *at += 1;
    }
    std::mem::swap(keys, scratch);
    // Only neighbours in one bucket can still be out of order.
    for at in 1..keys.len() {
        let key = keys[at];
        let mut to = at;
        while to > 0 && keys[to - 1] > key {
            keys[to] = keys[to - 1];
            to -= 1;
        }
        keys[to] = key;
    }
}

/// Puts the ids of equal distances, which stand sorted by slot, in ascending order.
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
