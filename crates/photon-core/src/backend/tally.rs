//! Counts and flux of photon paths, exact, so that conservation of energy can be checked.

use crate::requirements::map_kind::PerMap;

/// How a photon path ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fate {
    /// Absorbed by a surface.
    Absorbed,
    /// It left the scene.
    Escaped,
    /// It reached the maximum path length.
    Truncated,
    /// A number was no longer finite; the path was given up.
    Dropped,
    /// An aimed path met something diffuse, or a path in a medium without bounds was thinned out far from the scene; other
    /// paths stand for the rest of it.
    Terminated,
}

impl Fate {
    /// How many there are.
    pub const COUNT: usize = Self::Terminated as usize + 1;

    /// A path with more power than this in a channel is dropped, since only numerical failure explains it: a path
    /// starts with about 1, or less.
    pub const MAX_POWER: f32 = 1_048_576.0;
}

/// A sum of flux, exact: in integers, so that the order of summation does not matter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FluxSum([i128; 3]);

/// Flux of one path, in the units of [`FluxSum`]: 2⁻⁴⁰ of the scene's total power.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FixedFlux([i64; 3]);

impl FixedFlux {
    /// One over the unit.
    pub const ONE: f32 = (1_u64 << 40) as f32;

    /// Rounds towards zero; saturates beyond ±2²², and NaN becomes 0.
    #[inline]
    #[must_use]
    pub fn new(flux: [f32; 3]) -> Self {
        Self(flux.map(|f| (f * Self::ONE) as i64))
    }

    /// The flux that remains after `other` is subtracted.
    #[inline]
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        Self(std::array::from_fn(|c| self.0[c] - other.0[c]))
    }
}

impl FluxSum {
    /// A sum in units of 2⁻⁴⁰ of the scene's total power, as computed by a backend with integers of its
    /// own.
    #[must_use]
    pub fn from_units(units: [i128; 3]) -> Self {
        Self(units)
    }

    /// Adds the flux of one path.
    #[inline]
    pub fn add(&mut self, flux: FixedFlux) {
        for (sum, f) in self.0.iter_mut().zip(flux.0) {
            *sum += i128::from(f);
        }
    }

    /// The sum in these units.
    #[must_use]
    pub fn units(&self) -> [i128; 3] {
        self.0
    }

    /// Adds another sum.
    pub fn merge(&mut self, other: &Self) {
        for (sum, f) in self.0.iter_mut().zip(other.0) {
            *sum = sum.saturating_add(f);
        }
    }

    /// The sum, in units of the scene's total power times the number of paths.
    #[must_use]
    pub fn value(&self) -> [f64; 3] {
        self.0.map(|f| f as f64 / f64::from(FixedFlux::ONE))
    }
}

/// Counts and flux, of one pass or of many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
// Exhaustive: a backend must fill in every count.
pub struct Tally {
    /// Paths emitted.
    pub emitted: u64,
    /// Paths that were absorbed by a surface.
    pub absorbed: u64,
    /// Paths that left the scene.
    pub escaped: u64,
    /// Paths that reached the maximum path length.
    pub truncated: u64,
    /// Paths given up because a number was not finite.
    pub dropped: u64,
    /// Aimed paths that met something diffuse, and paths that were thinned out: [`crate::flight::thinned`]. Other paths account
    /// for the light from there on.
    pub terminated: u64,
    /// Surfaces met.
    pub surfaces: u64,
    /// Paths that were inside more than four solids at once, of which the fifth was ignored.
    pub too_deep: u64,
    /// Photons stored in each map.
    pub stored: PerMap<u64>,
    /// Flux emitted by the lights, without that of [`crate::LightCone`] which leaves past the scene.
    pub flux_emitted: FluxSum,
    /// Flux absorbed by surfaces and solids, with what thinned paths lose less what those that stand for them gain: 0 in the mean.
    pub flux_absorbed: FluxSum,
    /// Flux that left the scene.
    pub flux_escaped: FluxSum,
    /// Flux of paths that were truncated.
    pub flux_truncated: FluxSum,
    /// Flux of paths that were dropped, as last known to be finite.
    pub flux_dropped: FluxSum,
    /// Flux of aimed paths at the diffuse surface where they ended.
    pub flux_terminated: FluxSum,
}

impl Tally {
    /// Ends a path that carries `flux`.
    #[inline]
    pub fn end(&mut self, fate: Fate, flux: FixedFlux) {
        let (count, sum) = match fate {
            Fate::Absorbed => (&mut self.absorbed, &mut self.flux_absorbed),
            Fate::Escaped => (&mut self.escaped, &mut self.flux_escaped),
            Fate::Truncated => (&mut self.truncated, &mut self.flux_truncated),
            Fate::Dropped => (&mut self.dropped, &mut self.flux_dropped),
            Fate::Terminated => (&mut self.terminated, &mut self.flux_terminated),
        };
        *count += 1;
        sum.add(flux);
    }

    /// Adds another tally. Sums beyond what the integers hold, which only a forged file can have, stay at the largest one.
    pub fn merge(&mut self, other: &Self) {
        self.emitted = self.emitted.saturating_add(other.emitted);
        self.absorbed = self.absorbed.saturating_add(other.absorbed);
        self.escaped = self.escaped.saturating_add(other.escaped);
        self.truncated = self.truncated.saturating_add(other.truncated);
        self.dropped = self.dropped.saturating_add(other.dropped);
        self.terminated = self.terminated.saturating_add(other.terminated);
        self.surfaces = self.surfaces.saturating_add(other.surfaces);
        self.too_deep = self.too_deep.saturating_add(other.too_deep);
        for (kind, stored) in self.stored.iter_mut() {
            *stored = stored.saturating_add(other.stored[kind]);
        }
        self.flux_emitted.merge(&other.flux_emitted);
        self.flux_absorbed.merge(&other.flux_absorbed);
        self.flux_escaped.merge(&other.flux_escaped);
        self.flux_truncated.merge(&other.flux_truncated);
        self.flux_dropped.merge(&other.flux_dropped);
        self.flux_terminated.merge(&other.flux_terminated);
    }

    /// Whether emitted = absorbed + escaped + truncated + dropped + terminated, in number and in flux,
    /// exactly.
    #[must_use]
    pub fn balances(&self) -> bool {
        let mut ended = self.flux_absorbed;
        ended.merge(&self.flux_escaped);
        ended.merge(&self.flux_truncated);
        ended.merge(&self.flux_dropped);
        ended.merge(&self.flux_terminated);
        // Counts of a damaged film may add up to more than u64 holds.
        let paths = [self.absorbed, self.escaped, self.truncated, self.dropped, self.terminated];
        u128::from(self.emitted) == paths.into_iter().map(u128::from).sum() && ended == self.flux_emitted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_does_not_matter_and_nothing_is_lost() {
        let mut forth = FluxSum::default();
        let mut back = FluxSum::default();
        for i in 0..10_000 {
            forth.add(FixedFlux::new([1e-8, i as f32, 0.1]));
            back.add(FixedFlux::new([1e-8, (9_999 - i) as f32, 0.1]));
        }
        assert_eq!(forth, back);
        // N1: relative error of one rounding to 2⁻⁴⁰ at 1e-8.
        assert!((forth.value()[0] / 1e-4 - 1.0).abs() < 1e-4);
    }

    #[test]
    fn balance_of_any_counts_is_told() {
        let tally = Tally { absorbed: u64::MAX, escaped: 1, ..Tally::default() };
        assert!(!tally.balances());
    }

    #[test]
    fn balance_notices_what_is_missing() {
        let one = FixedFlux::new([1.0; 3]);
        let mut tally = Tally { emitted: 1, ..Tally::default() };
        tally.flux_emitted.add(one);
        assert!(!tally.balances());
        tally.end(Fate::Escaped, one);
        assert!(tally.balances());
        tally.flux_absorbed.add(FixedFlux([1, 0, 0]));
        assert!(!tally.balances());
    }
}
