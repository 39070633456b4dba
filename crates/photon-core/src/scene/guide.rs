//! Guide tables: where to start a search in a table of the starts of intervals (Chen and Asau 1974, "On generating random
//! variates from an empirical distribution").

/// For as many equal parts of the range of a random `u32` as there are starts: the interval in which the part begins.
///
/// `starts` begin with 0, ascend, and are at most 2¹⁶; see [`super::light_cdf`].
pub(crate) fn table(starts: &[u32]) -> Vec<u16> {
    let count = starts.len() as u64;
    let mut interval = 0;
    (0..count)
        .map(|part| {
            // The first random number of the part.
            let first = (part << 32).div_ceil(count);
            while starts.get(interval + 1).is_some_and(|&start| u64::from(start) <= first) {
                interval += 1;
            }
            interval as u16
        })
        .collect()
}

/// As [`super::pick_light`], by the guide table of `starts`: a search of one or two steps, in the mean.
#[inline]
pub(crate) fn pick(starts: &[u32], guide: &[u16], random: u32) -> usize {
    let part = ((u64::from(random) * guide.len() as u64) >> 32) as usize;
    let low = usize::from(guide[part]);
    let end = guide.get(part + 1).map_or(starts.len(), |&next| usize::from(next) + 1);
    (low + starts[low..end].partition_point(|&start| start <= random)).saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;
    use crate::scene::{light_cdf, pick_light};

    /// The same interval as by a search in all starts, for random words and for those beside all edges.
    #[test]
    fn guided_searches_find_the_same_intervals() {
        let mut numbers = SplitMix64(5);
        for count in [1, 2, 3, 7, 64, 1000, 2048] {
            for power in [0, 1, 8] {
                let powers: Vec<f64> = (0..count).map(|_| f64::from(numbers.unit()).powi(power)).collect();
                let starts = light_cdf(&powers);
                let guide = table(&starts);
                let parts = (0..count as u64).map(|part| (part << 32).div_ceil(count as u64) as u32);
                let edges = starts.iter().copied().chain(parts).flat_map(|word| [word.wrapping_sub(1), word, word | 1]);
                let random = (0..4000).map(|_| numbers.word() as u32).collect::<Vec<_>>();
                for word in edges.chain(random).chain([0, u32::MAX]) {
                    assert_eq!(pick(&starts, &guide, word), pick_light(&starts, word), "{count} {power} {word}");
                }
            }
        }
    }

    /// Most searches are among one or two starts; without a guide they would be among all.
    #[test]
    fn most_searches_are_short() {
        let powers: Vec<f64> = (0..1000).map(|i| 1.0 / f64::from(1 + i)).collect();
        let guide = table(&light_cdf(&powers));
        let mean = guide.windows(2).map(|pair| f64::from(pair[1] - pair[0]) + 1.0).sum::<f64>() / 999.0;
        assert!(mean < 2.1, "{mean}");
    }
}
