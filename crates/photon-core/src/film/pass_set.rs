//! Which passes a film contains.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::error::{Error, Result};

/// A set of passes, each identified by seed and index.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PassSet {
    /// By seed: ranges that are not empty, sorted, and neither overlap nor touch.
    seeds: BTreeMap<u64, Vec<Range<u32>>>,
}

impl PassSet {
    /// The passes of one seed in a range; none if it is empty.
    #[must_use]
    pub fn of(seed: u64, passes: Range<u32>) -> Self {
        let seeds = if passes.is_empty() { BTreeMap::new() } else { BTreeMap::from([(seed, vec![passes])]) };
        Self { seeds }
    }

    /// Adds the passes of `other`.
    ///
    /// # Errors
    /// [`Error::PassTwice`] if both contain a pass; the set is unchanged then.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        if let Some((seed, passes)) = self.overlap(other) {
            return Err(Error::PassTwice { seed, passes });
        }
        for (&seed, ranges) in &other.seeds {
            let all = self.seeds.entry(seed).or_default();
            all.extend(ranges.iter().cloned());
            all.sort_by_key(|range| range.start);
            all.dedup_by(|next, range| {
                let touches = range.end == next.start;
                if touches {
                    range.end = next.end;
                }
                touches
            });
        }
        Ok(())
    }

    /// The first passes that are in both sets: seed and range.
    #[must_use]
    pub fn overlap(&self, other: &Self) -> Option<(u64, Range<u32>)> {
        other.ranges().find_map(|(seed, theirs)| {
            let ours = self.seeds.get(&seed)?;
            let common = |ours: &Range<u32>| ours.start.max(theirs.start)..ours.end.min(theirs.end);
            ours.iter().map(common).find(|common| !common.is_empty()).map(|common| (seed, common))
        })
    }

    /// The ranges, sorted by seed and first pass; ranges of one seed do not touch each other.
    pub fn ranges(&self) -> impl Iterator<Item = (u64, Range<u32>)> {
        self.seeds.iter().flat_map(|(&seed, ranges)| ranges.iter().map(move |range| (seed, range.clone())))
    }

    /// Number of passes.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.ranges().map(|(_, range)| u64::from(range.end - range.start)).sum()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.seeds.is_empty()
    }
}

/// Such as `0..8, 12..16`, with the seed if it is not 0.
impl std::fmt::Display for PassSet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (index, (seed, range)) in self.ranges().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{}..{}", range.start, range.end)?;
            if seed != 0 {
                write!(f, " of seed {seed}")?;
            }
        }
        if self.is_empty() { f.write_str("none") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_joined_and_sorted() {
        let mut set = PassSet::default();
        assert!(set.is_empty() && set.to_string() == "none");
        for (seed, passes) in [(0, 8..12), (0, 0..4), (5, 3..4), (0, 4..8), (0, 20..20), (0, 14..16)] {
            set.merge(&PassSet::of(seed, passes)).unwrap();
        }
        assert_eq!(set.to_string(), "0..12, 14..16, 3..4 of seed 5");
        assert_eq!(set.count(), 15);
    }

    #[test]
    fn no_pass_counts_twice() {
        let mut set = PassSet::of(1, 4..8);
        set.merge(&PassSet::of(1, 10..12)).unwrap();
        let before = set.clone();
        for (passes, common) in [(0..5, 4..5), (7..11, 7..8), (11..30, 11..12), (5..6, 5..6), (0..99, 4..8)] {
            let error = set.merge(&PassSet::of(1, passes)).unwrap_err();
            assert!(matches!(&error, Error::PassTwice { seed: 1, passes } if *passes == common), "{error}");
            assert_eq!(set, before);
        }
        set.merge(&PassSet::of(2, 0..99)).unwrap();
        set.merge(&PassSet::of(1, 8..10)).unwrap();
        assert_eq!(set.overlap(&PassSet::of(1, 0..4)), None);
    }
}
