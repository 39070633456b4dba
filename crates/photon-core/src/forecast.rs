//! What more passes will bring, from what those so far have told.

use crate::errors::{Claim, student_975};
use crate::schedule::Schedule;

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
    /// What radii are multiplied by from here on, beside their shrinking; 1 where they are left alone.
    pub radius_factor: f64,
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
    /// Of which something is claimed.
    pixels: Vec<Relative>,
    /// Mean squares over all pixels that were seen, flagged or not.
    mean: Parts,
    claimed: f64,
    schedule: Schedule,
    share: f64,
}

/// Of one pixel, in fractions of its radiance.
#[derive(Clone, Copy, Debug, Default)]
struct Relative {
    /// Noise of the photons, which depends on radii.
    photons: f64,
    /// All other noise.
    other: f64,
    bias: f64,
    /// What of the bias is no noise of its own.
    steady: f64,
    bias_error: f64,
    /// What noise has to be multiplied by to be spread over the pixels as the truth is.
    pooled: f64,
    /// A number of a normal distribution: the luck of the bias in passes to come.
    luck: f64,
}

impl Relative {
    fn noise(&self) -> f64 {
        self.photons.hypot(self.other)
    }
}

/// Squares of errors, by what they depend on.
#[derive(Clone, Copy, Debug, Default)]
struct Parts {
    photons: f64,
    other: f64,
    steady: f64,
}

impl Prospect {
    /// From the claims after the passes of a schedule, of which a `share` is looked at; `second` is
    /// [`crate::Kernel::second_radius_noise`]. `None` if nothing is claimed of any pixel.
    #[must_use]
    pub fn new(claims: &[Claim], schedule: Schedule, share: f64, second: f64) -> Option<Self> {
        let mean = claims.iter().map(|claim| claim.value).sum::<f64>() / claims.len().max(1) as f64;
        let least = 0.1 * mean.abs();
        let standing: Vec<&Claim> = claims.iter().filter(|claim| claim.flags.is_empty()).collect();
        let relative = |claim: &Claim| {
            let unit = claim.value.abs().max(least);
            // A pixel that is black in a black picture is as good as it gets.
            let of = |x: f64| if x > 0.0 { x / unit } else { 0.0 };
            let steady = (claim.bias * claim.bias - claim.bias_error * claim.bias_error).max(0.0).sqrt();
            // The bias is told by photons alone: its noise tells theirs.
            let photons = (claim.bias_error / second).min(claim.standard_error);
            let other = (claim.standard_error * claim.standard_error - photons * photons).max(0.0).sqrt();
            Relative {
                photons: of(photons),
                other: of(other),
                bias: of(claim.bias.abs()),
                steady: of(steady),
                bias_error: of(claim.bias_error),
                pooled: 1.0,
                luck: 0.0,
            }
        };
        let step = |count: usize| count.div_ceil(SAMPLE).max(1);
        let mut pixels: Vec<Relative> =
            standing.iter().step_by(step(standing.len())).map(|&claim| relative(claim)).collect();
        pool(&mut pixels, f64::from(schedule.passes()) - 1.0);
        let all: Vec<Relative> = claims.iter().step_by(step(claims.len())).map(relative).collect();
        let mut sum = all.iter().fold(Parts::default(), |sum, pixel| Parts {
            photons: sum.photons + pixel.photons * pixel.photons,
            other: sum.other + pixel.other * pixel.other,
            steady: sum.steady + pixel.bias * pixel.bias - pixel.bias_error * pixel.bias_error,
        });
        sum.steady = sum.steady.max(0.0);
        let claimed = standing.len() as f64 / claims.len().max(1) as f64;
        (!pixels.is_empty()).then_some(Self { pixels, mean: sum, claimed, schedule, share })
    }

    /// With squared radii times `factor` from here on.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { schedule: self.schedule.scaled(factor), ..self }
    }

    /// The factor on squared radii from here on by which the mean squared error should be least after
    /// `passes` passes in all: between 1/4 and 2, in steps of √2. Farther up, a bias that grows as the
    /// square is no safe bet.
    #[must_use]
    pub fn best_scale(&self, passes: u32) -> f64 {
        let error = |scale: f64| {
            let (bias, noise) = self.schedule.scaled(scale).factors(passes);
            self.mean.photons * noise * noise + self.mean.steady * bias * bias
        };
        let scales = (-4..=2).map(|half| 2.0_f64.powf(0.5 * f64::from(half)));
        scales.min_by(|&a, &b| error(a).total_cmp(&error(b))).unwrap_or(1.0)
    }

    /// The relative error that the share of pixels is within now.
    #[must_use]
    pub fn error(&self) -> f64 {
        let t = student_975(f64::from(self.schedule.passes()) - 1.0);
        self.at_share(|pixel| t * pixel.noise() + 2.0 * pixel.bias)
    }

    /// The same after `passes` passes in all.
    ///
    /// The noise of photons goes down with the passes and up as their radii shrink, bias goes down with
    /// these: at α = 2/3 both fall as the cube root of the passes, so that a target of ε takes ε⁻³. What
    /// is known of noise and bias is itself uncertain: the worst pixels of now are partly unlucky ones, and
    /// others will be. Both are spread over the pixels as they should be without that.
    #[must_use]
    pub fn error_after(&self, passes: u32) -> f64 {
        let (bias, noise) = self.schedule.factors(passes);
        let then = f64::from(passes.max(self.schedule.passes()));
        let other = (f64::from(self.schedule.passes()) / then).sqrt();
        let t = student_975(then - 1.0);
        self.at_share(|pixel| {
            let random = pixel.bias_error * pixel.pooled * noise * pixel.luck;
            t * pixel.pooled * (pixel.photons * noise).hypot(pixel.other * other)
                + 2.0 * (pixel.steady * bias + random).abs()
        })
    }

    /// Where matters stand, for passes of so many seconds of which so many are possible.
    #[must_use]
    pub fn forecast(&self, target: Option<f64>, seconds_per_pass: f64, passes_possible: u32) -> Forecast {
        let t = student_975(f64::from(self.schedule.passes()) - 1.0);
        let good = |pixel: &&Relative| target.is_some_and(|target| t * pixel.noise() + 2.0 * pixel.bias <= target);
        Forecast {
            passes: self.schedule.passes(),
            claimed: self.claimed,
            within: self.pixels.iter().filter(good).count() as f64 / self.pixels.len() as f64,
            error: self.error(),
            share: self.share,
            target,
            passes_needed: target.and_then(|target| self.passes_needed(target)),
            passes_possible,
            error_possible: self.error_after(passes_possible),
            seconds_per_pass,
            radius_factor: 1.0,
        }
    }

    /// Passes after which the error should be within the target.
    pub(crate) fn passes_needed(&self, target: f64) -> Option<u32> {
        let (mut low, mut high) = (self.schedule.passes(), u32::MAX - 1);
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

/// Takes from noise and biases of pixels what is chance in them, told from passes with so many degrees of
/// freedom, so that their spread over the pixels, of which quantiles are asked, is that of the truth
/// (constrained empirical Bayes, Louis 1984); and gives each pixel its luck.
fn pool(pixels: &mut [Relative], freedom: f64) {
    let known = pixels.iter().map(Relative::noise).filter(|noise| *noise > 0.0 && noise.is_finite());
    let logs: Vec<f64> = known.map(|noise| 2.0 * noise.ln()).collect();
    let count = logs.len().max(1) as f64;
    let mean = logs.iter().sum::<f64>() / count;
    let spread = logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / count;
    // The logarithm of a variance from ν degrees of freedom has a variance of ψ′(ν/2), here to its third
    // term, and lies 1/ν too low on average.
    let half = 0.5 * freedom.max(1.0);
    let chance = 1.0 / half + 0.5 / (half * half) + 1.0 / (6.0 * half * half * half);
    let kept = (1.0 - chance / spread.max(f64::MIN_POSITIVE)).max(0.0).sqrt();
    let square = |x: f64| x * x;
    let biases = pixels.iter().map(|pixel| square(pixel.bias) - square(pixel.bias_error)).sum::<f64>();
    let typical = (biases / pixels.len().max(1) as f64).max(0.0);
    for (index, pixel) in pixels.iter_mut().enumerate() {
        let noise = pixel.noise();
        if noise > 0.0 && noise.is_finite() && logs.len() > 1 {
            let log = mean + 1.0 / freedom.max(1.0) + kept * (2.0 * noise.ln() - mean);
            pixel.pooled = (0.5 * log).exp() / noise;
        }
        let share = typical / (typical + square(pixel.bias_error)).max(f64::MIN_POSITIVE);
        pixel.steady = pixel.steady.min(share.sqrt() * pixel.bias);
        // Multiples of the golden ratio leave no gaps.
        pixel.luck = normal_quantile(((index as f64 + 0.5) * 0.618_033_988_749_895).fract());
    }
}

/// Of the standard normal distribution, within 4.5·10⁻⁴ (Hastings 1955; Abramowitz and Stegun 26.2.23).
fn normal_quantile(p: f64) -> f64 {
    let tail = p.min(1.0 - p).max(1e-12);
    let t = (-2.0 * tail.ln()).sqrt();
    let above = (0.010_328 * t + 0.802_853) * t + 2.515_517;
    let below = ((0.001_308 * t + 0.189_269) * t + 1.432_788) * t + 1.0;
    (t - above / below).copysign(p - 0.5)
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

    fn told(claims: &[Claim], passes: u32, alpha: f64) -> Option<Prospect> {
        Prospect::new(claims, Schedule::of(passes, alpha), 0.95, 0.5)
    }

    #[test]
    fn radii_go_to_where_noise_and_bias_balance() {
        let best = |bias: f64, noise: f64| told(&claims(noise, bias, 0.5 * noise), 8, 1.0).unwrap().best_scale(10_000);
        // Nothing but noise wants all that may be had, a bias that dwarfs it the least.
        assert_eq!((best(0.05, 0.1), best(1.0, 0.01)), (2.0, 0.25));
        // Squares of noise fall by 1250/c; what is left of the bias has a square of 0.0032 c². They balance
        // at c³ = 1/1250/(2·0.0032) = 1/8.
        assert!((best(0.2532_f64.sqrt(), 1.0) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn errors_fall_as_the_cube_root_of_passes() {
        let prospect = told(&claims(0.1, 0.1, 0.05), 1000, 2.0 / 3.0).unwrap();
        assert!((prospect.error() - (student_975(999.0) * 0.1 + 0.2)).abs() < 1e-12);
        let half = f64::from(prospect.passes_needed(prospect.error_after(1000) / 2.0).unwrap());
        assert!((half / 8000.0 - 1.0).abs() < 0.1, "{half}");
        assert!((prospect.forecast(None, 1.0, 9).claimed - 0.9).abs() < 1e-12);
    }

    #[test]
    fn noise_alone_at_a_fixed_radius_falls_as_the_square_root() {
        let prospect = told(&claims(0.1, 0.05, 0.05), 1000, 1.0).unwrap();
        let half = f64::from(prospect.passes_needed(prospect.error_after(1000) / 2.0).unwrap());
        assert!((half / 4000.0 - 1.0).abs() < 0.02, "{half}");
        // A bias that stays is a floor.
        let floor = told(&claims(0.1, 0.05, 0.0), 1000, 1.0).unwrap();
        assert_eq!(floor.passes_needed(0.09), None);
        assert_eq!(floor.passes_needed(10.0), Some(1000));
    }

    /// Pixels that are alike, of which 8 passes tell different noise and biases by chance: 95 % of them come
    /// to be within 1.96 standard errors for the noise, and twice 1.96 of half as much for the bias.
    #[test]
    fn luck_of_the_pilot_is_not_foretold() {
        let normal = |index: usize| normal_quantile((index as f64 * 0.754_877_666_246_693 + 0.3).fract());
        let told_by_chance = |pixel: usize| {
            let draws: Vec<f64> = (0..8).map(|i| normal(pixel * 9 + i + 1)).collect();
            let mean = draws.iter().sum::<f64>() / 8.0;
            let spread = (draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 7.0).sqrt();
            Claim {
                value: 1.0,
                standard_error: 0.1 * spread,
                bias: 0.05 * normal(pixel * 9 + 9),
                bias_error: 0.05 * spread,
                half_width: 1.0,
                flags: Flags::default(),
            }
        };
        let claims: Vec<Claim> = (0..4000).map(told_by_chance).collect();
        let prospect = told(&claims, 8, 1.0).unwrap();
        let ratio = prospect.error_after(800) / (2.0 * student_975(799.0) * 0.01);
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
        // Each pixel by itself, the unlucky ones foretell a bias that is not there.
        let alone = claims.iter().map(|c| 2.0 * (c.bias * c.bias - c.bias_error * c.bias_error).max(0.0).sqrt());
        let mut alone: Vec<f64> = alone.collect();
        alone.sort_by(f64::total_cmp);
        assert!(alone[3800] > 3.0 * prospect.error_after(800), "{}", alone[3800]);
    }

    #[test]
    fn quantiles_of_the_normal_distribution() {
        for (p, z) in [(0.5, 0.0), (0.975, 1.959_964), (0.025, -1.959_964), (0.999, 3.090_232)] {
            assert!((normal_quantile(p) - z).abs() < 5e-4, "{p}: {}", normal_quantile(p));
        }
    }

    #[test]
    fn nothing_claimed_is_nothing_foretold() {
        let none: Vec<Claim> = claims(0.1, 0.0, 0.0).iter().map(|c| Claim { flags: Flags::FEW_PASSES, ..*c }).collect();
        assert!(told(&none, 7, 1.0).is_none() && told(&[], 7, 1.0).is_none());
    }
}
