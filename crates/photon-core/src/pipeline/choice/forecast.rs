//! The error that estimates with one kind of areas and one radius are expected to have after a given time.

use super::bias::{Bias, Reference};
use super::curve::Curve;
use crate::radius::progressive::{inverse_radius_squared_sum, radius_squared_sum};
use crate::settings::Area;

/// What one setting of the estimates gave in two passes, and what it took.
pub(super) struct Trial {
    pub(super) area: Area,
    /// Factor on the radii.
    pub(super) factor: f64,
    /// The radiance of each pixel by photons, mean of RGB, with the photons of each pass at the same visible points.
    pub(super) passes: [Vec<f64>; 2],
    /// Seconds for the pixels of a pass.
    pub(super) seconds: f64,
}

/// Steps after which the number of passes in a time hardly changes.
const STEPS: usize = 8;

/// The greatest factor on radii that is tried: radii per pixel grow where light is smooth, and the time of their estimates is
/// near that with this factor.
const WIDE: f64 = 2.0;

/// The seconds of estimates with radii per pixel over those with the factor [`WIDE`]: errors are estimated too, with a second
/// radius. Measuring areas takes about as long with both.
const fn cost_per_pixel(area: Area) -> f64 {
    match area {
        Area::Disc => 1.8,
        Area::Surface => 1.35,
    }
}

/// The squared error by photons with radii per pixel over that with the best shared radius, after as many passes n: the least of
/// these a + b/n, with numbers from measurements (docs/studies/choices.md). The less, the better.
pub(super) type Gain = &'static [[f64; 2]];

/// Where photons are aimed, or pixels have caustics.
pub(super) const GAIN_OF_CAUSTICS: Gain = &[[1.0, 0.0], [0.65, 3.0], [0.25, 38.0]];

/// Elsewhere: most light is smooth, and the search for the radius of each pixel adds noise.
pub(super) const GAIN_WITHOUT_CAUSTICS: Gain = &[[1.4, 0.0], [0.25, 150.0]];

fn part_of_shared(gain: Gain, passes: u32) -> f64 {
    gain.iter().fold(f64::INFINITY, |least, [a, b]| least.min(a + b / f64::from(passes)))
}

/// Squared relative errors of one kind of areas.
pub(super) struct Model {
    area: Area,
    /// The variance that photons do not make: that of visible points, shadow rays and gather rays.
    others: f64,
    variance: Curve,
    bias: Bias,
    seconds: Curve,
    photons: [f64; 2],
    look: f64,
    alpha: f64,
}

impl Model {
    /// From the trials of one kind of areas, by increasing factor; `reference` is the radiance that they are compared with
    /// ([`reference`]), `others` the variance that is not by photons at visible points, `photons` the seconds of a pass
    /// before these estimates, fixed ones and those that are proportional to the number of paths, and `look` the seconds for
    /// camera paths and direct light.
    pub(super) fn new(
        trials: &[&Trial],
        reference: &Reference<'_>,
        others: f64,
        weights: &[f64],
        (photons, look): ([f64; 2], f64),
        alpha: f64,
    ) -> Self {
        let positive = |of: &dyn Fn(&Trial) -> f64| {
            trials.iter().map(|trial| [trial.factor, of(trial).max(f64::MIN_POSITIVE)]).collect::<Vec<_>>()
        };
        Self {
            area: trials.first().map_or(Area::Disc, |trial| trial.area),
            others,
            // That of smooth light is as the reciprocal of the area. Few photons per disc make it uncertain, so that less
            // might be measured between two radii.
            variance: Curve {
                points: positive(&|trial| variance(&trial.passes, weights)),
                exponents: [-2.0, 0.0],
                below: Some(-2.0),
            },
            bias: Bias::new(trials, reference, weights),
            seconds: Curve { points: positive(&|trial| trial.seconds), exponents: [0.0, 2.0], below: None },
            photons,
            look,
            alpha,
        }
    }

    /// The seconds of this many passes with the present number of paths and shared radii.
    pub(super) fn seconds_of(&self, passes: u32) -> f64 {
        let passes = passes.max(1);
        f64::from(passes) * (self.photons[0] + self.photons[1] + self.seconds.at(self.wide(passes).sqrt()))
    }

    /// With `more` times the paths and a factor on radii that are derived from their density: seconds of a pass, the squared
    /// relative error after `seconds`, and the part of that error that is not by photons.
    pub(super) fn forecast(&self, more: f64, factor: f64, seconds: f64) -> [f64; 3] {
        // Passes become faster as radii shrink, which makes them more, and their radii smaller: a few steps find their number.
        let photons = self.photons[0] + more * self.photons[1];
        let mut pass = photons + self.seconds.at(factor);
        for _ in 0..STEPS {
            pass = photons + self.seconds.at(factor * self.wide(count(seconds, pass)).sqrt());
        }
        let passes = count(seconds, pass);
        let others = self.others / f64::from(passes);
        [pass, others + self.by_photons(more, factor, passes), others]
    }

    /// The same with radii of each pixel, as a part of what the best of the `factors` would give with as many passes.
    pub(super) fn forecast_per_pixel(&self, more: f64, factors: &[f64], seconds: f64, gain: Gain) -> [f64; 3] {
        let pass = self.pass_per_pixel(more);
        let passes = count(seconds, pass);
        let others = self.others / f64::from(passes);
        let shared = factors.iter().map(|&factor| self.by_photons(more, factor, passes)).fold(f64::INFINITY, f64::min);
        [pass, others + part_of_shared(gain, passes) * shared, others]
    }

    fn pass_per_pixel(&self, more: f64) -> f64 {
        let estimate = (self.seconds.at(WIDE) - self.look).max(0.0);
        self.photons[0] + more * self.photons[1] + self.look + cost_per_pixel(self.area) * estimate
    }

    /// The squared error by photons after so many passes.
    fn by_photons(&self, more: f64, factor: f64, passes: u32) -> f64 {
        // Radii shrink: bias is proportional to the mean of their squares, variance to that of their reciprocals.
        let n = f64::from(passes);
        let narrow = n / inverse_radius_squared_sum(passes, self.alpha);
        // Discs of derived radii contain as many photons of more paths, and are smaller.
        let (narrow, wide) = (factor * narrow.sqrt(), factor * (self.wide(passes) / more).sqrt());
        self.variance.at(narrow) / n + self.bias.squared(wide) + self.bias.hidden(wide)
    }

    /// The mean of the squared radii of so many passes, over that of the first.
    fn wide(&self, passes: u32) -> f64 {
        radius_squared_sum(passes, self.alpha) / f64::from(passes)
    }
}

/// The number of passes that fit.
fn count(seconds: f64, pass: f64) -> u32 {
    (seconds / pass.max(f64::MIN_POSITIVE)).round().clamp(1.0, 1e9) as u32
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn weighted_mean(weights: &[f64], of: impl Fn(usize) -> f64) -> f64 {
    weights.iter().enumerate().map(|(i, weight)| of(i) * weight).sum::<f64>() / weights.len().max(1) as f64
}

/// The variance of one pass: half of the squared difference of two.
pub(super) fn variance([one, two]: &[Vec<f64>; 2], weights: &[f64]) -> f64 {
    weighted_mean(weights, |i| 0.5 * (one[i] - two[i]).powi(2))
}

/// The variance and the seconds with `rays` gather rays, from those with two other numbers of rays. A part of the variance
/// is as the reciprocal of their number, as if rays were independent (they are stratified by height), and a part of the time
/// as their number.
pub(super) fn with_gather_rays(tried: [(u32, [f64; 2]); 2], rays: u32) -> [f64; 2] {
    let [(few, [noisy, fast]), (many, [quiet, slow])] = tried.map(|(rays, found)| (f64::from(rays), found));
    let rays = f64::from(rays);
    let of_rays = ((noisy - quiet) / (few.recip() - many.recip())).max(0.0).min(quiet * many);
    let second = ((slow - fast) / (many - few)).max(0.0);
    [quiet + of_rays * (rays.recip() - many.recip()), (slow + second * (rays - many)).max(0.0)]
}

/// Reciprocals of the squared radiance of each pixel, by a pass of this trial and what is not by photons, and a hundredth of its
/// squared mean: the mean of those of the two passes. The reciprocal of the mean radiance would depend on the noise of both, and
/// so would take their noise for bias.
pub(super) fn weights(trial: &Trial, others: &[f64]) -> Vec<f64> {
    let [one, two] = [0, 1].map(|pass| reciprocals(&added(&trial.passes[pass], others)));
    one.iter().zip(&two).map(|(a, b)| 0.5 * (a + b)).collect()
}

/// Those of the mean radiance of two passes with visible points of their own: at an edge, that of one pass may be dark.
pub(super) fn weights_of_mean([one, two]: &[Vec<f64>; 2]) -> Vec<f64> {
    reciprocals(&added(one, two).iter().map(|sum| 0.5 * sum).collect::<Vec<_>>())
}

pub(super) fn added(one: &[f64], two: &[f64]) -> Vec<f64> {
    one.iter().zip(two).map(|(a, b)| a + b).collect()
}

fn reciprocals(radiance: &[f64]) -> Vec<f64> {
    let least = 0.01 * mean(radiance).powi(2);
    radiance.iter().map(|value| (value * value + least).max(f64::MIN_POSITIVE).recip()).collect()
}

#[cfg(test)]
mod tests;
