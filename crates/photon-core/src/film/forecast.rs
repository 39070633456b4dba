//! Forecasts of the error after more passes, from the error estimates so far.

mod group;

use crate::film::confidence::{ConfidenceInterval, Flags, student_975};
use crate::radius::schedule::Schedule;
use group::{Factors, Group, Relative};

/// Maximum number of pixels that a forecast uses; enough to estimate a fraction of them to within 0.01.
const SAMPLE: usize = 16_384;

/// The present error estimate, and the number of passes needed to reach a target.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Forecast {
    /// Passes so far.
    pub passes: u32,
    /// Share of all pixels that the error is of: those with an error estimate that does not have to allow for edges or few
    /// photons ([`ConfidenceInterval::reasons`] is empty or [`Flags::RARE`]).
    pub claimed: f64,
    /// Share of these whose error is within the target now.
    pub within: f64,
    /// Present relative error: the quantile of these at `share`.
    pub error: f64,
    /// The share of pixels that have to reach the target.
    pub share: f64,
    /// The target error, if there is one.
    pub target: Option<f64>,
    /// Upper bound of the number of passes needed to reach the target, including those so far, by
    /// [`ErrorModel::error_after`]. `None` if more than 2³² are needed, or there is no target.
    pub passes_needed: Option<u32>,
    /// Lower bound of the same, by [`ErrorModel::least_error_after`].
    pub passes_least: Option<u32>,
    /// Number of passes that the limits of the plan allow.
    pub passes_possible: u32,
    /// Upper bound of the error after that many passes.
    pub error_possible: f64,
    /// Lower bound of the same.
    pub error_possible_least: f64,
    /// Duration of a pass, seconds.
    pub seconds_per_pass: f64,
    /// Factor on radii from here on, besides their shrinking; 1 if they are not adapted.
    pub radius_factor: f64,
}

impl Forecast {
    /// Whether the target is reached now.
    #[must_use]
    pub fn is_reached(&self) -> bool {
        self.target.is_some_and(|target| self.error <= target)
    }

    /// Whether the target will be reached within the limits of the plan, by the upper bound.
    #[must_use]
    pub fn is_reachable(&self) -> bool {
        self.passes_needed.is_some_and(|needed| needed <= self.passes_possible)
    }

    /// Whether the target may be reached within the limits of the plan, by the lower bound.
    #[must_use]
    pub fn may_be_reached(&self) -> bool {
        self.passes_least.is_some_and(|least| least <= self.passes_possible)
    }

    /// Upper bound of the time needed to reach the target, seconds, from the first pass on.
    #[must_use]
    pub fn seconds_needed(&self) -> Option<f64> {
        self.passes_needed.map(|passes| f64::from(passes) * self.seconds_per_pass)
    }
}

/// Predicts errors from the relative errors of a sample of pixels.
#[derive(Clone, Debug)]
pub struct ErrorModel {
    /// Pixels with an error estimate that allows for nothing; with too few photons; with an edge within the disc.
    groups: [Group; 3],
    /// Mean squares over all visible pixels, flagged or not.
    mean: Parts,
    claimed: f64,
    schedule: Schedule,
    share: f64,
}

/// Squared errors, by what they depend on.
#[derive(Clone, Copy, Debug, Default)]
struct Parts {
    photons: f64,
    other: f64,
    steady: f64,
}

/// Pixels that a forecast is for: some get an error estimate only later, and when is not known well.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PixelSet {
    /// Pixels with an error estimate now.
    Claimed,
    /// Also those that only lack photons, once there are enough even with one standard error fewer than
    /// expected.
    Counted,
    /// Also those with an edge within the disc, as radii shrink.
    All,
}

/// Bound of the uncertainty that remains after the pilot.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bound {
    Lower = 0,
    Upper = 1,
}

impl ErrorModel {
    /// From the confidence intervals after the passes of `schedule`; errors are quantiles at `share`;
    /// `second` is [`crate::Kernel::second_radius_noise`]. Intervals are ordered by pixel, so that the
    /// correlation of neighbours can be estimated. `None` if no pixel has an error estimate.
    ///
    /// Pixels whose interval allows for an edge or for few photons ([`ConfidenceInterval::allowed`]) count as those without
    /// one: their bounds do not fall with noise and bias, and a target would hang on the share of such pixels.
    #[must_use]
    pub fn new(intervals: &[ConfidenceInterval], schedule: Schedule, share: f64, second: f64) -> Option<Self> {
        let mean = intervals.iter().map(|interval| interval.value).sum::<f64>() / intervals.len().max(1) as f64;
        let least = 0.1 * mean.abs();
        let relative = |interval: &ConfidenceInterval| Relative::new(interval, least, second);
        // Rare light counts with the error that it has: a target would be easier without the noisiest pixels.
        let reasons = |interval: &ConfidenceInterval| interval.reasons() - Flags::RARE;
        let group = |of: &dyn Fn(Flags) -> bool| {
            let members: Vec<&ConfidenceInterval> = intervals.iter().filter(|interval| of(reasons(interval))).collect();
            let step = members.len().div_ceil(SAMPLE).max(1);
            let pixels: Vec<Relative> = members.iter().step_by(step).map(|&interval| relative(interval)).collect();
            Group::new(pixels, members.len(), f64::from(schedule.passes()) - 1.0, second)
        };
        let at_edge = |flags: Flags| EDGES.iter().any(|&edge| flags.contains(edge));
        let groups = [
            group(&|flags| flags.is_empty()),
            group(&|flags| !flags.is_empty() && !at_edge(flags)),
            group(&|flags| at_edge(flags)),
        ];
        let step = intervals.len().div_ceil(SAMPLE).max(1);
        let mut sum = intervals.iter().step_by(step).map(relative).fold(Parts::default(), |sum, pixel| Parts {
            photons: sum.photons + pixel.photons * pixel.photons,
            other: sum.other + pixel.other * pixel.other,
            steady: sum.steady + pixel.bias * pixel.bias - pixel.bias_error * pixel.bias_error,
        });
        sum.steady = sum.steady.max(0.0);
        let claimed = intervals.iter().filter(|interval| reasons(interval).is_empty()).count() as f64
            / intervals.len().max(1) as f64;
        (!groups[0].pixels.is_empty()).then_some(Self { groups, mean: sum, claimed, schedule, share })
    }

    /// The model with squared radii multiplied by `factor` from here on.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { schedule: self.schedule.scaled(factor), ..self }
    }

    /// The factor on squared radii from here on that minimises the predicted mean squared error after
    /// `passes` passes in total: between 1/4 and 2, in steps of √2. Larger factors are not considered,
    /// since they rely on bias growing as r².
    #[must_use]
    pub fn best_scale(&self, passes: u32) -> f64 {
        let error = |scale: f64| {
            let (bias, noise) = self.schedule.scaled(scale).factors(passes);
            self.mean.photons * noise * noise + self.mean.steady * bias * bias
        };
        let scales = (-4..=2).map(|half| libm::exp2(0.5 * f64::from(half)));
        scales.min_by(|&a, &b| error(a).total_cmp(&error(b))).unwrap_or(1.0)
    }

    /// The present relative error: its quantile at the share of pixels.
    #[must_use]
    pub fn error(&self) -> f64 {
        let t = student_975(f64::from(self.schedule.passes()) - 1.0);
        self.at_share(|pixel| pixel.half_width(t))
    }

    /// Upper bound of the relative error after `passes` passes in total.
    ///
    /// The noise of photons decreases with the passes and increases as radii shrink, while bias decreases:
    /// at α = 2/3 both fall as the cube root of the number of passes, so that an error of ε takes about ε⁻³
    /// passes. The measured noise and bias are uncertain: some of the pixels that are worst now are so by
    /// chance, and others will be later. Therefore the spread of both over the pixels is corrected for chance, and
    /// their overall level is raised by two standard errors.
    ///
    /// Bias falls as r² where light is smooth. Near a line where its slope changes, as at the end of a
    /// penumbra, it falls as r, and the number of pixels within reach of the line falls as r too: the mean
    /// square over all falls as r³. This is assumed here for pixels without an edge; the lower bound
    /// assumes r⁴.
    ///
    /// Pixels that have no error estimate yet are included later, with the errors that they have: those
    /// with few photons once there are enough, those with an edge within the disc as the radius shrinks,
    /// since edges are lines, and the number of pixels near them is proportional to the radius. Of the
    /// three sets (with estimate; also those with few photons; all), the one with the largest error counts.
    #[must_use]
    pub fn error_after(&self, passes: u32) -> f64 {
        self.bounds(passes, Bound::Upper).fold(0.0, f64::max)
    }

    /// Lower bound of the same: with noise and bias two standard errors lower, of the set of pixels whose
    /// error is the smallest.
    #[must_use]
    pub fn least_error_after(&self, passes: u32) -> f64 {
        self.bounds(passes, Bound::Lower).fold(f64::INFINITY, f64::min)
    }

    fn bounds(&self, passes: u32, bound: Bound) -> impl Iterator<Item = f64> {
        [PixelSet::Claimed, PixelSet::Counted, PixelSet::All].into_iter().map(move |set| self.after(passes, set, bound))
    }

    fn after(&self, passes: u32, set: PixelSet, bound: Bound) -> f64 {
        let (bias, noise) = self.schedule.factors(passes);
        let then = f64::from(passes.max(self.schedule.passes()));
        let more = then / f64::from(self.schedule.passes().max(1));
        let factors = Factors {
            // Proportional to r^(3/2), as explained at `error_after`; `bias` is proportional to r².
            bias: if bound == Bound::Upper { libm::pow(bias, 0.75).max(bias) } else { bias },
            noise,
            other: more.recip().sqrt(),
            quantile: student_975(then - 1.0),
        };
        let freed = Factors { bias, ..factors };
        let [claimed, few, edge] = &self.groups;
        // The photon count found so far may be too high by its standard error, its square root.
        let luck = if set == PixelSet::Counted { 1.0 } else { 0.0 };
        let enough = |pixel: &Relative| {
            (pixel.photon_count - luck * pixel.photon_count.sqrt()) * more * bias >= ConfidenceInterval::MIN_PHOTONS
        };
        let (few_free, edge_free) = match set {
            PixelSet::Claimed => (0.0, 0.0),
            PixelSet::Counted => (1.0, 0.0),
            PixelSet::All => (1.0, 1.0 - bias.min(1.0).sqrt()),
        };
        let mut errors: Vec<(f64, f64)> = claimed.errors(&factors, bound).collect();
        let joining = [(few, few_free, &factors), (edge, edge_free, &freed)];
        for (group, free, factors) in joining.into_iter().filter(|(_, free, _)| *free > 0.0) {
            let joining = group.pixels.iter().zip(group.errors(factors, bound)).filter(|(pixel, _)| enough(pixel));
            errors.extend(joining.map(|(_, (error, weight))| (error, weight * free)));
        }
        quantile(errors, self.share)
    }

    /// The forecast for passes of this duration, of which so many are possible.
    #[must_use]
    pub fn forecast(&self, target: Option<f64>, seconds_per_pass: f64, passes_possible: u32) -> Forecast {
        let t = student_975(f64::from(self.schedule.passes()) - 1.0);
        let good = |pixel: &&Relative| target.is_some_and(|target| pixel.half_width(t) <= target);
        Forecast {
            passes: self.schedule.passes(),
            claimed: self.claimed,
            within: self.groups[0].pixels.iter().filter(good).count() as f64 / self.groups[0].pixels.len() as f64,
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

    /// The smallest number of passes after which that error is within the target.
    pub(crate) fn passes_until(&self, target: f64, error_after: impl Fn(&Self, u32) -> f64) -> Option<u32> {
        const MAX_PASSES: u32 = u32::MAX - 1;
        let (mut low, mut high) = (self.schedule.passes(), self.schedule.passes());
        if self.error() <= target {
            return Some(low);
        }
        // By doubling, since the order of magnitude is unknown, and newly included pixels may raise the
        // error again.
        while error_after(self, high) > target {
            if high == MAX_PASSES {
                return None;
            }
            (low, high) = (high, high.max(1).saturating_mul(2).min(MAX_PASSES));
        }
        while high.saturating_sub(low) > 1 && f64::from(high) > f64::from(low) * 1.005 {
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
        let mut errors: Vec<f64> = self.groups[0].pixels.iter().map(error).collect();
        let index = ((self.share * errors.len() as f64).ceil() as usize).clamp(1, errors.len()) - 1;
        *errors.select_nth_unstable_by(index, f64::total_cmp).1
    }
}

/// Flags of pixels that get an error estimate only with smaller radii.
const EDGES: [Flags; 3] = [Flags::OTHER_SURFACE, Flags::UNEVEN, Flags::CURVED];

/// The quantile at `share` of weighted numbers.
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

#[cfg(test)]
mod tests;
