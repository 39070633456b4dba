//! The radii of the passes of a film, past and future.

use crate::radius::progressive::{inverse_radius_squared_sum, radius_squared_factor, radius_squared_sum};

/// Sums over the squared radii of passes, in units of the first. Bias is proportional to their mean, the
/// variance from photons to the mean of their reciprocals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    alpha: f64,
    scale: f64,
    passes: u32,
    sum: f64,
    inverse: f64,
}

impl Schedule {
    /// A schedule without passes, with radii that shrink by `alpha`.
    #[must_use]
    pub fn new(alpha: f64) -> Self {
        Self { alpha, scale: 1.0, passes: 0, sum: 0.0, inverse: 0.0 }
    }

    /// The schedule of the first `passes` passes.
    #[must_use]
    pub fn of(passes: u32, alpha: f64) -> Self {
        let (sum, inverse) = (radius_squared_sum(passes, alpha), inverse_radius_squared_sum(passes, alpha));
        Self { alpha, scale: 1.0, passes, sum, inverse }
    }

    /// The schedule without passes, whose next passes have the same radii.
    #[must_use]
    pub fn without_passes(self) -> Self {
        Self { passes: 0, sum: 0.0, inverse: 0.0, ..self }
    }

    /// Number of passes.
    #[must_use]
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// Adds pass `index`.
    pub fn add(&mut self, index: u32) {
        let squared = self.scale * radius_squared_factor(index, self.alpha);
        self.passes += 1;
        self.sum += squared;
        self.inverse += 1.0 / squared;
    }

    /// The schedule with squared radii multiplied by `factor`, > 0, from here on.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { scale: self.scale * factor, ..self }
    }

    /// Factors by which bias and the noise of photons change from now to `passes` passes in total.
    #[must_use]
    pub fn factors(&self, passes: u32) -> (f64, f64) {
        let then = passes.max(self.passes);
        let more = |of: fn(u32, f64) -> f64| of(then, self.alpha) - of(self.passes, self.alpha);
        let sum = self.sum + self.scale * more(radius_squared_sum);
        let inverse = self.inverse + more(inverse_radius_squared_sum) / self.scale;
        let share = f64::from(self.passes) / f64::from(then.max(1));
        (sum / self.sum * share, (inverse / self.inverse).sqrt() * share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_one_by_one_are_the_sums() {
        let mut one_by_one = Schedule::new(0.7);
        (0..20).for_each(|index| one_by_one.add(index));
        let at_once = Schedule::of(20, 0.7);
        assert_eq!(one_by_one.passes(), 20);
        assert!((one_by_one.sum / at_once.sum - 1.0).abs() < 1e-12);
        assert!((one_by_one.inverse / at_once.inverse - 1.0).abs() < 1e-12);
        assert_eq!(at_once.factors(20), (1.0, 1.0));
    }

    #[test]
    fn twice_the_area_from_here_on() {
        let (bias, noise) = Schedule::of(10, 1.0).scaled(2.0).factors(40);
        // 10 passes with 1 and 30 with 2 have a mean of 1.75; variances of 10 and 30/2 over 40².
        assert!((bias - 1.75).abs() < 1e-12, "{bias}");
        assert!((noise - (25.0_f64 / 1600.0 / 0.1).sqrt()).abs() < 1e-12, "{noise}");
    }
}
