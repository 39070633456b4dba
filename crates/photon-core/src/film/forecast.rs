//! What more passes will bring, from what those so far have told.

mod group;

use crate::film::confidence::{ConfidenceInterval, Flags, MIN_PHOTONS, student_975};
use crate::radius::schedule::Schedule;
use group::{Factors, Group, Relative};

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
    /// Passes after which the target should be reached at the latest, those so far included, by
    /// [`ErrorModel::error_after`]. `None` if 2³² are too few, or there is no target.
    pub passes_needed: Option<u32>,
    /// And at the earliest, by [`ErrorModel::least_error_after`].
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
pub struct ErrorModel {
    /// Of which something is claimed; of which too few photons are known; that have an edge within reach.
    groups: [Group; 3],
    /// Mean squares over all pixels that were seen, flagged or not.
    mean: Parts,
    claimed: f64,
    schedule: Schedule,
    share: f64,
}

/// Squares of errors, by what they depend on.
#[derive(Clone, Copy, Debug, Default)]
struct Parts {
    photons: f64,
    other: f64,
    steady: f64,
}

/// Which pixels a forecast is of: some come to be claimed later on, but when is not known well.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PixelSet {
    /// Those of which something is claimed now.
    Claimed,
    /// And those that only lack photons, as soon as these are enough even if a standard error fewer come.
    Counted,
    /// And those with an edge within reach, as radii shrink.
    All,
}

/// Which end of what a pilot leaves open.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bound {
    Lower = 0,
    Upper = 1,
}

impl ErrorModel {
    /// From the claims after the passes of a schedule, of which a `share` is looked at; `second` is
    /// [`crate::Kernel::second_radius_noise`]. Claims are in the order of their pixels, so that it is seen how far
    /// neighbours share their luck. `None` if nothing is claimed of any pixel.
    #[must_use]
    pub fn new(intervals: &[ConfidenceInterval], schedule: Schedule, share: f64, second: f64) -> Option<Self> {
        let mean = intervals.iter().map(|interval| interval.value).sum::<f64>() / intervals.len().max(1) as f64;
        let least = 0.1 * mean.abs();
        let relative = |interval: &ConfidenceInterval| Relative::new(interval, least, second);
        let group = |of: &dyn Fn(Flags) -> bool| {
            let members: Vec<&ConfidenceInterval> = intervals.iter().filter(|interval| of(interval.flags)).collect();
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
        let claimed = intervals.iter().filter(|interval| interval.flags.is_empty()).count() as f64
            / intervals.len().max(1) as f64;
        (!groups[0].pixels.is_empty()).then_some(Self { groups, mean: sum, claimed, schedule, share })
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
        let scales = (-4..=2).map(|half| libm::exp2(0.5 * f64::from(half)));
        scales.min_by(|&a, &b| error(a).total_cmp(&error(b))).unwrap_or(1.0)
    }

    /// The relative error that the share of pixels is within now.
    #[must_use]
    pub fn error(&self) -> f64 {
        let t = student_975(f64::from(self.schedule.passes()) - 1.0);
        self.at_share(|pixel| t * pixel.noise() + 2.0 * pixel.bias)
    }

    /// The same after `passes` passes in all, at most.
    ///
    /// The noise of photons goes down with the passes and up as their radii shrink, bias goes down with
    /// these: at α = 2/3 both fall as the cube root of the passes, so that a target of ε takes ε⁻³. What
    /// is known of noise and bias is itself uncertain: the worst pixels of now are partly unlucky ones, and
    /// others will be. Both are spread over the pixels as they should be without that, and how much there is of
    /// either altogether is as large as it may be by two standard errors.
    ///
    /// Bias falls as r² where light is smooth. Beside a line where its slope changes, as at the end of a penumbra, it
    /// falls as r, and pixels within reach of the line do so too: the mean square over all falls as r³. So does what is
    /// foretold here of pixels without an edge; at least it is r⁴.
    ///
    /// Pixels of which nothing is claimed yet join in, with the errors that they have: those with few photons
    /// when these are enough, those with an edge within reach as the radius shrinks, since edges are
    /// lines, along which pixels are as many as the radius is long. Of those that are claimed, with few photons, and all,
    /// the set whose error is the largest counts.
    #[must_use]
    pub fn error_after(&self, passes: u32) -> f64 {
        self.bounds(passes, Bound::Upper).fold(0.0, f64::max)
    }

    /// The same, at least: with noise and bias as small as they may be, of the set of pixels whose error is
    /// the smallest.
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
            // As r^(3/2), of which see `error_after`; `bias` goes as r².
            bias: if bound == Bound::Upper { libm::pow(bias, 0.75).max(bias) } else { bias },
            noise,
            other: more.recip().sqrt(),
            quantile: student_975(then - 1.0),
        };
        let freed = Factors { bias, ..factors };
        let [claimed, few, edge] = &self.groups;
        // Those that were found may have been luck, by their root.
        let luck = if set == PixelSet::Counted { 1.0 } else { 0.0 };
        let enough =
            |pixel: &Relative| (pixel.photon_count - luck * pixel.photon_count.sqrt()) * more * bias >= MIN_PHOTONS;
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

    /// Where matters stand, for passes of so many seconds of which so many are possible.
    #[must_use]
    pub fn forecast(&self, target: Option<f64>, seconds_per_pass: f64, passes_possible: u32) -> Forecast {
        let t = student_975(f64::from(self.schedule.passes()) - 1.0);
        let good = |pixel: &&Relative| target.is_some_and(|target| t * pixel.noise() + 2.0 * pixel.bias <= target);
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

    /// Passes after which that error should be within the target for the first time.
    pub(crate) fn passes_until(&self, target: f64, error_after: impl Fn(&Self, u32) -> f64) -> Option<u32> {
        const MAX_PASSES: u32 = u32::MAX - 1;
        let (mut low, mut high) = (self.schedule.passes(), self.schedule.passes());
        if self.error() <= target {
            return Some(low);
        }
        // In doublings, since nobody knows the order of magnitude, and pixels that join in may raise it again.
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

#[cfg(test)]
mod tests;
