//! What more passes will bring, from what those so far have told.

use crate::errors::{Claim, Flags, LEAST_PHOTONS, student_975};
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
    /// Passes after which the target should be reached at the latest, those so far included: with all
    /// pixels that may come to be claimed, whose errors are larger than those of others. `None` if 2³² are too
    /// few, or there is no target.
    pub passes_needed: Option<u32>,
    /// And at the earliest: of those pixels alone of which something is claimed now.
    pub passes_least: Option<u32>,
    /// Passes that the limits of the plan allow.
    pub passes_possible: u32,
    /// The error that these should come to, at most.
    pub error_possible: f64,
    /// And at least.
    pub error_possible_least: f64,
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

    /// Whether it should be, within the limits of the plan, at the latest.
    #[must_use]
    pub fn is_reachable(&self) -> bool {
        self.passes_needed.is_some_and(|needed| needed <= self.passes_possible)
    }

    /// Whether it may be, at the earliest.
    #[must_use]
    pub fn may_be_reached(&self) -> bool {
        self.passes_least.is_some_and(|least| least <= self.passes_possible)
    }

    /// Seconds that this takes at the latest, from the first pass on.
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
    /// Of which nothing is claimed yet.
    waiting: Vec<Relative>,
    /// How many pixels one of the former stands for, and one of the latter.
    weights: [f64; 2],
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
    /// Photons told by.
    told_by: f64,
    /// Whether another surface, or the end of the light, lies within reach.
    at_edge: bool,
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
                told_by: claim.photons,
                at_edge: EDGES.iter().any(|&edge| claim.flags.contains(edge)),
            }
        };
        let step = |count: usize| count.div_ceil(SAMPLE).max(1);
        let sample = |claims: &[&Claim]| {
            let mut pixels: Vec<Relative> =
                claims.iter().step_by(step(claims.len())).map(|&claim| relative(claim)).collect();
            pool(&mut pixels, f64::from(schedule.passes()) - 1.0);
            let weight = claims.len() as f64 / pixels.len().max(1) as f64;
            (pixels, weight)
        };
        let (pixels, weight) = sample(&standing);
        let flagged: Vec<&Claim> = claims.iter().filter(|claim| !claim.flags.is_empty()).collect();
        let (waiting, other) = sample(&flagged);
        let all: Vec<Relative> = claims.iter().step_by(step(claims.len())).map(relative).collect();
        let mut sum = all.iter().fold(Parts::default(), |sum, pixel| Parts {
            photons: sum.photons + pixel.photons * pixel.photons,
            other: sum.other + pixel.other * pixel.other,
            steady: sum.steady + pixel.bias * pixel.bias - pixel.bias_error * pixel.bias_error,
        });
        sum.steady = sum.steady.max(0.0);
        let claimed = standing.len() as f64 / claims.len().max(1) as f64;
        let weights = [weight, other];
        (!pixels.is_empty()).then_some(Self { pixels, waiting, weights, mean: sum, claimed, schedule, share })
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
    ///
    /// Pixels of which nothing is claimed yet join in, with the errors that they have: those with an edge
    /// within reach as the radius shrinks, since edges are lines, along which pixels are as many as the radius
    /// is long; those with few photons when these are enough.
    #[must_use]
    pub fn error_after(&self, passes: u32) -> f64 {
        self.after(passes, true).max(self.after(passes, false))
    }

    /// The same of the pixels alone of which something is claimed now, or of all that join in if these fare
    /// better: at least that.
    #[must_use]
    pub fn least_error_after(&self, passes: u32) -> f64 {
        self.after(passes, true).min(self.after(passes, false))
    }

    fn after(&self, passes: u32, joined: bool) -> f64 {
        let (bias, noise) = self.schedule.factors(passes);
        let then = f64::from(passes.max(self.schedule.passes()));
        let more = then / f64::from(self.schedule.passes().max(1));
        let other = more.recip().sqrt();
        let t = student_975(then - 1.0);
        let error = |pixel: &Relative| {
            let random = pixel.bias_error * pixel.pooled * noise * pixel.luck;
            t * pixel.pooled * (pixel.photons * noise).hypot(pixel.other * other)
                + 2.0 * (pixel.steady * bias + random).abs()
        };
        let joins = |pixel: &Relative| {
            let enough = pixel.told_by * more * bias >= LEAST_PHOTONS;
            let free = if pixel.at_edge { 1.0 - bias.min(1.0).sqrt() } else { 1.0 };
            if enough && joined { self.weights[1] * free } else { 0.0 }
        };
        let now = self.pixels.iter().map(|pixel| (error(pixel), self.weights[0]));
        let later = self.waiting.iter().map(|pixel| (error(pixel), joins(pixel)));
        quantile(now.chain(later).filter(|(_, weight)| *weight > 0.0).collect(), self.share)
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
            passes_needed: target.and_then(|target| self.passes_until(target, Self::error_after)),
            passes_least: target.and_then(|target| self.passes_until(target, Self::least_error_after)),
            passes_possible,
            error_possible: self.error_after(passes_possible),
            error_possible_least: self.least_error_after(passes_possible),
            seconds_per_pass,
            radius_factor: 1.0,
        }
    }

    /// Passes after which that error should be within the target.
    pub(crate) fn passes_until(&self, target: f64, error_after: impl Fn(&Self, u32) -> f64) -> Option<u32> {
        let (mut low, mut high) = (self.schedule.passes(), u32::MAX - 1);
        if self.error() <= target {
            return Some(low);
        }
        if error_after(self, high) > target {
            return None;
        }
        // Halving intervals of the logarithm, since nobody knows the order of magnitude.
        while high - low > 1 && f64::from(high) > f64::from(low) * 1.005 {
            let middle = ((f64::from(low) * f64::from(high)).sqrt() as u32).clamp(low + 1, high - 1);
            if error_after(self, middle) <= target {
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

/// Why a pixel that is flagged has to wait for smaller radii.
const EDGES: [Flags; 3] = [Flags::OTHER_SURFACE, Flags::UNEVEN, Flags::CURVED];

/// The least number that a share of the weight of all is at most.
fn quantile(mut weighted: Vec<(f64, f64)>, share: f64) -> f64 {
    weighted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = weighted.iter().map(|(_, weight)| weight).sum();
    let mut sum = 0.0;
    let found = weighted.iter().find(|(_, weight)| {
        sum += weight;
        sum >= share * all * (1.0 - 1e-12)
    });
    found.or(weighted.last()).map_or(0.0, |(number, _)| *number)
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
mod tests;
