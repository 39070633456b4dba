//! The bias of estimates as a function of the radius, from trials with several radii.

use super::curve::Curve;
use super::forecast::{Trial, mean};

/// The largest squared relative bias of a pixel that counts.
pub(super) const MAX_BIAS_SQUARED: f64 = 1.0;

/// The squared bias may be larger than it is measured by that many standard errors of its mean, which noise and the small number
/// of pixels leave.
pub(super) const HIDDEN: f64 = 2.0;

/// Successive pixels whose means are taken as independent: photons are in the discs of several pixels.
pub(super) const CORRELATED: usize = 64;

/// The exponent of the squared bias as a function of the radius. At edges of light it is 1: bias is of the same size in a number
/// of pixels that is as the radius. It is 3 where the slope of the light changes, and 4 where light is smooth. From twice the
/// radius to a half it was 0.2 to 2.9 in ten scenes with 512×512 pixels, 1.6 as their mean; the mean of the ratios of the bias at a
/// half to that at twice the radius is that of the exponent 1.15. Two passes of a small picture do not tell it.
pub(super) const BIAS_EXPONENT: f64 = 1.5;

/// The squared bias of one kind of areas.
pub(super) struct Bias {
    /// With the factor 1 on radii, for the kind of areas that the reference has; as the power [`BIAS_EXPONENT`] of the factor.
    common: f64,
    /// What this kind of areas adds to the squared bias.
    own: Curve,
    /// A factor on radii, and the squared bias that may be hidden there.
    hidden: [f64; 2],
}

impl Bias {
    /// From the trials of one kind of areas, by increasing factor.
    pub(super) fn new(trials: &[&Trial], reference: &Reference<'_>, weights: &[f64]) -> Self {
        let from_reference = |trial: &Trial| squares(trial, &reference.passes, weights);
        // The first trial is left out: its difference from the reference is a third of its difference from the second, by
        // construction.
        let common = reference.trials.iter().skip(1).map(|trial| [trial.factor, mean(&from_reference(trial))]);
        let added = |trial: &&Trial| {
            let mut same =
                reference.trials.iter().filter(|base| base.factor == trial.factor && base.area != trial.area);
            let more = mean(&from_reference(trial)) - mean(&from_reference(same.next()?));
            (more > 0.0).then_some([trial.factor, more])
        };
        let hidden = |trial: &&Trial| [trial.factor, HIDDEN * standard_error(&from_reference(trial))];
        Self {
            common: common_bias(common),
            own: Curve { points: trials.iter().filter_map(added).collect(), exponents: [1.0, 4.0], below: None },
            hidden: trials.last().map_or([1.0, 0.0], hidden),
        }
    }

    pub(super) fn squared(&self, factor: f64) -> f64 {
        self.common * libm::pow(factor, BIAS_EXPONENT) + self.own.at(factor)
    }

    /// What noise may hide of the squared bias. Where light is smooth, bias is as the squared radius: what is hidden at the
    /// greatest radius that was tried is little at small ones.
    pub(super) fn hidden(&self, factor: f64) -> f64 {
        let [greatest, squared] = self.hidden;
        squared * (factor / greatest).powi(4)
    }
}

/// The squared relative bias of each pixel. The noise of two passes is independent: that of the product has the mean 0. A visible
/// point at the rim of a surface, whose area there is a small part of the disc, may be many times too bright: one of
/// thousands that a pixel averages over.
fn squares(trial: &Trial, from: &[Vec<f64>; 2], weights: &[f64]) -> Vec<f64> {
    let difference = |pass: usize, i: usize| trial.passes[pass][i] - from[pass][i];
    let relative = |i: usize| difference(0, i) * difference(1, i) * weights[i];
    (0..weights.len()).map(|i| relative(i).clamp(-MAX_BIAS_SQUARED, MAX_BIAS_SQUARED)).collect()
}

/// The factor of [`BIAS_EXPONENT`]th powers of factors with the least squares of deviations from these values, at least 0.
fn common_bias(values: impl Iterator<Item = [f64; 2]>) -> f64 {
    let add = |[product, square]: [f64; 2], [factor, value]: [f64; 2]| {
        let power = libm::pow(factor, BIAS_EXPONENT);
        [product + value * power, square + power * power]
    };
    let [product, square] = values.fold([0.0; 2], add);
    if square > 0.0 { (product / square).max(0.0) } else { 0.0 }
}

/// That of the mean, from means of [`CORRELATED`] values; 0 if there are fewer than two such means.
pub(super) fn standard_error(values: &[f64]) -> f64 {
    let means: Vec<f64> = values.chunks_exact(CORRELATED).map(mean).collect();
    let whole = mean(&means);
    let squares = means.iter().map(|mean| (mean - whole).powi(2)).sum::<f64>();
    let count = means.len() as f64;
    if count < 2.0 { 0.0 } else { (squares / (count * (count - 1.0))).sqrt() }
}

/// The radiance of each pixel in two passes, without most of the bias.
pub(super) struct Reference<'a> {
    pub(super) passes: [Vec<f64>; 2],
    /// The trials with the kind of areas of the reference.
    trials: Vec<&'a Trial>,
}

/// The radiance of the first trial, which has the least bias, extrapolated to the radius 0 from the second one if that has the
/// same kind of areas, as bias grows where light is smooth: as the squared radius. Where it is as (1 − d/r)² r at a distance d < r
/// from a line, the squared bias of the second trial is then measured as 0.85 of its true value.
pub(super) fn reference(trials: &[Trial]) -> Reference<'_> {
    let Some(least) = trials.first() else { return Reference { passes: Default::default(), trials: Vec::new() } };
    let Some(next) = trials.get(1).filter(|next| next.area == least.area && next.factor > least.factor) else {
        return Reference { passes: least.passes.clone(), trials: vec![least] };
    };
    let share = 1.0 / ((next.factor / least.factor).powi(2) - 1.0);
    let passes = std::array::from_fn(|pass| {
        let both = least.passes[pass].iter().zip(&next.passes[pass]);
        both.map(|(least, next)| least + share * (least - next)).collect()
    });
    Reference { passes, trials: trials.iter().filter(|trial| trial.area == least.area).collect() }
}
