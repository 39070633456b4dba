//! What more passes will bring, from what those so far have told.

use crate::errors::{Claim, student_975};
use crate::progressive::{inverse_radius_squared_sum, radius_squared_sum};

/// Pixels that a forecast looks at; so many tell a share to a hundredth.
const SAMPLE: usize = 16_384;

/// What is claimed now, and by how many passes a target should be reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Passes so far.
    pub passes: u32,
    /// Share of all pixels of which something is claimed.
    pub claimed: f64,
    /// Share of these whose claim is within the target now.
    pub within: f64,
    /// The relative error that the demanded share of these is within now.
    pub error: f64,
    /// Which share.
    pub share: f64,
    /// What is to be reached, if anything.
    pub target: Option<f64>,
    /// Passes after which the target should be reached, those so far included; `None` if 2³² are too
    /// few, or there is no target.
    pub passes_needed: Option<u32>,
    /// Passes that the limits of the plan allow.
    pub passes_possible: u32,
    /// The error that these should come to.
    pub error_possible: f64,
    /// Seconds that a pass takes.
    pub seconds_per_pass: f64,
}

impl Forecast {
    /// Whether the target is reached now.
    #[must_use]
    pub fn is_reached(&self) -> bool {
        self.target.is_some_and(|target| self.error <= target)
    }

    /// Whether it should be, within the limits of the plan.
    #[must_use]
    pub fn is_reachable(&self) -> bool {
        self.passes_needed.is_some_and(|needed| needed <= self.passes_possible)
    }

    /// Seconds that this takes, from the first pass on.
    #[must_use]
    pub fn seconds_needed(&self) -> Option<f64> {
        self.passes_needed.map(|passes| f64::from(passes) * self.seconds_per_pass)
    }
}

/// Claims of a sample of pixels, over what they are measured by.
#[derive(Clone, Debug)]
pub struct Prospect {
    pixels: Vec<Relative>,
    claimed: f64,
    passes: u32,
    alpha: f64,
    share: f64,
}

/// Of one pixel, in fractions of its radiance.
#[derive(Clone, Copy, Debug)]
struct Relative {
    noise: f64,
    bias: f64,
    /// What of the bias is no noise of its own.
    steady: f64,
    bias_error: f64,
}

impl Prospect {
    /// From the claims after `passes` passes with radii that shrink by `alpha`, of which a `share` is
    /// looked at. `None` if nothing is claimed of any pixel.
    #[must_use]
    pub fn new(claims: &[Claim], passes: u32, alpha: f64, share: f64) -> Option<Self> {
        let mean = claims.iter().map(|claim| claim.value).sum::<f64>() / claims.len().max(1) as f64;
        let least = 0.1 * mean.abs();
        let standing: Vec<&Claim> = claims.iter().filter(|claim| claim.flags.is_empty()).collect();
        let step = standing.len().div_ceil(SAMPLE).max(1);
        let relative = |claim: &&Claim| {
            let unit = claim.value.abs().max(least);
            // A pixel that is black in a black picture is as good as it gets.
            let of = |x: f64| if x > 0.0 { x / unit } else { 0.0 };
            let steady = (claim.bias * claim.bias - claim.bias_error * claim.bias_error).max(0.0).sqrt();
            Relative {
                noise: of(claim.standard_error),
                bias: of(claim.bias.abs()),
                steady: of(steady),
                bias_error: of(claim.bias_error),
            }
        };
        let pixels: Vec<Relative> = standing.iter().step_by(step).map(relative).collect();
        let claimed = standing.len() as f64 / claims.len().max(1) as f64;
        (!pixels.is_empty()).then_some(Self { pixels, claimed, passes, alpha, share })
    }

    /// The relative error that the share of pixels is within now.
    #[must_use]
    pub fn error(&self) -> f64 {
        let t = student_975(f64::from(self.passes) - 1.0);
        self.at_share(|pixel| t * pixel.noise + 2.0 * pixel.bias)
    }

    /// The same after `passes` passes in all.
    ///
    /// Noise goes down with the passes and up with the squares of their radii, bias goes down with
    /// these: at α = 2/3 both fall as the cube root of the passes, so that a target of ε takes ε⁻³. What
    /// is known of the bias is partly noise, which is told apart by its own standard error.
    #[must_use]
    pub fn error_after(&self, passes: u32) -> f64 {
        let (now, then) = (f64::from(self.passes), f64::from(passes.max(1)));
        let mean = |count: u32, n: f64| radius_squared_sum(count, self.alpha) / n;
        let variance = |count: u32, n: f64| inverse_radius_squared_sum(count, self.alpha) / (n * n);
        let bias = mean(passes.max(1), then) / mean(self.passes, now);
        let noise = (variance(passes.max(1), then) / variance(self.passes, now)).sqrt();
        let t = student_975(then - 1.0);
        self.at_share(|pixel| {
            let steady = pixel.steady * bias;
            let random = pixel.bias_error * noise;
            t * pixel.noise * noise + 2.0 * steady.hypot(random)
        })
    }

    /// Where matters stand, for passes of so many seconds of which so many are possible.
    #[must_use]
    pub fn forecast(&self, target: Option<f64>, seconds_per_pass: f64, passes_possible: u32) -> Forecast {
        let t = student_975(f64::from(self.passes) - 1.0);
        let good = |pixel: &&Relative| target.is_some_and(|target| t * pixel.noise + 2.0 * pixel.bias <= target);
        Forecast {
            passes: self.passes,
            claimed: self.claimed,
            within: self.pixels.iter().filter(good).count() as f64 / self.pixels.len() as f64,
            error: self.error(),
            share: self.share,
            target,
            passes_needed: target.and_then(|target| self.passes_needed(target)),
            passes_possible,
            error_possible: self.error_after(passes_possible),
            seconds_per_pass,
        }
    }

    fn passes_needed(&self, target: f64) -> Option<u32> {
        let (mut low, mut high) = (self.passes, u32::MAX - 1);
        if self.error() <= target {
            return Some(low);
        }
        if self.error_after(high) > target {
            return None;
        }
        // Halving intervals of the logarithm, since nobody knows the order of magnitude.
        while high - low > 1 && f64::from(high) > f64::from(low) * 1.005 {
            let middle = ((f64::from(low) * f64::from(high)).sqrt() as u32).clamp(low + 1, high - 1);
            if self.error_after(middle) <= target {
                high = middle
            } else {
                low = middle
            };
        }
        Some(high)
    }

    /// The quantile at the share.
    fn at_share(&self, error: impl Fn(&Relative) -> f64) -> f64 {
        let mut errors: Vec<f64> = self.pixels.iter().map(error).collect();
        let index = ((self.share * errors.len() as f64).ceil() as usize).clamp(1, errors.len()) - 1;
        *errors.select_nth_unstable_by(index, f64::total_cmp).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::errors::Flags;

    fn claims(noise: f64, bias: f64, bias_error: f64) -> Vec<Claim> {
        let claim = Claim {
            value: 2.0,
            standard_error: 2.0 * noise,
            bias: 2.0 * bias,
            bias_error: 2.0 * bias_error,
            half_width: 1.0,
            flags: Flags::default(),
        };
        let mut claims = vec![claim; 90];
        claims.extend(vec![Claim { flags: Flags::UNEVEN, half_width: f64::INFINITY, ..claim }; 10]);
        claims
    }

    #[test]
    fn errors_fall_as_the_cube_root_of_passes() {
        let prospect = Prospect::new(&claims(0.1, 0.05, 0.0), 1000, 2.0 / 3.0, 0.95).unwrap();
        assert!((prospect.error() - (student_975(999.0) * 0.1 + 0.1)).abs() < 1e-12);
        assert!((prospect.error_after(1000) / prospect.error() - 1.0).abs() < 1e-9);
        let half = f64::from(prospect.passes_needed(prospect.error() / 2.0).unwrap());
        assert!((half / 8000.0 - 1.0).abs() < 0.1, "{half}");
        assert!((prospect.forecast(None, 1.0, 9).claimed - 0.9).abs() < 1e-12);
    }

    #[test]
    fn noise_alone_at_a_fixed_radius_falls_as_the_square_root() {
        let prospect = Prospect::new(&claims(0.1, 0.05, 0.05), 1000, 1.0, 0.95).unwrap();
        let half = f64::from(prospect.passes_needed(prospect.error() / 2.0).unwrap());
        assert!((half / 4000.0 - 1.0).abs() < 0.02, "{half}");
        // A bias that stays is a floor.
        let floor = Prospect::new(&claims(0.1, 0.05, 0.0), 1000, 1.0, 0.95).unwrap();
        assert_eq!(floor.passes_needed(0.09), None);
        assert_eq!(floor.passes_needed(10.0), Some(1000));
    }

    #[test]
    fn nothing_claimed_is_nothing_foretold() {
        let none: Vec<Claim> = claims(0.1, 0.0, 0.0).iter().map(|c| Claim { flags: Flags::FEW_PASSES, ..*c }).collect();
        assert!(Prospect::new(&none, 7, 1.0, 0.5).is_none() && Prospect::new(&[], 7, 1.0, 0.5).is_none());
    }
}
