//! Path statistics by fate, summed on the device.

use photon_core::{Fate, FluxSum, MapKind, PerMap, Tally};

/// Counters summed on the device: one for each fate, one for surfaces hit, one for each map, and one for paths
/// nested in too many solids.
const COUNTERS: usize = Fate::COUNT + 2 + MapKind::COUNT;

/// Words summed on the device: two for each counter; then fluxes of three channels of three words each, one for
/// each fate and one for the emitted flux.
pub(crate) const WORDS: usize = 2 * COUNTERS + 9 * (Fate::COUNT + 1);

/// Converts these words into the tally of `emitted` paths.
pub(crate) fn tally(words: &[u32; WORDS], emitted: u64) -> Tally {
    let counter = |i: usize| u64::from(words[2 * i]) | u64::from(words[2 * i + 1]) << 32;
    let flux = |i: usize| {
        FluxSum::from_units(std::array::from_fn(|c| {
            let at = 2 * COUNTERS + 3 * (3 * i + c);
            // Two's complement of 96 bits.
            let low = i128::from(words[at]) | i128::from(words[at + 1]) << 32;
            low | i128::from(words[at + 2] as i32) << 64
        }))
    };
    Tally {
        emitted,
        absorbed: counter(0),
        escaped: counter(1),
        truncated: counter(2),
        dropped: counter(3),
        terminated: counter(4),
        surfaces: counter(Fate::COUNT),
        stored: PerMap::from_fn(|kind| counter(Fate::COUNT + 1 + kind as usize)),
        too_deep: counter(Fate::COUNT + 1 + MapKind::COUNT),
        flux_emitted: flux(0),
        flux_absorbed: flux(1),
        flux_escaped: flux(2),
        flux_truncated: flux(3),
        flux_dropped: flux(4),
        flux_terminated: flux(5),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_whole_numbers_of_96_bits() {
        let mut words = [0; WORDS];
        words[0] = 5;
        words[1] = 1;
        // Minus one, in the first channel of the emitted flux.
        let flux = 2 * COUNTERS;
        words[flux..flux + 3].fill(u32::MAX);
        let tally = tally(&words, 9);
        assert_eq!((tally.emitted, tally.absorbed), (9, (1 << 32) + 5));
        assert_eq!(tally.flux_emitted, FluxSum::from_units([-1, 0, 0]));
        assert!(!tally.balances());
    }
}
