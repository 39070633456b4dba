//! The error that estimates with one kind of areas and one radius are expected to have after a given time.

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

/// A curve through values that are measured for several factors, by powers between them and beyond.
#[derive(Clone, Debug)]
struct Curve {
    /// Factor and value, both > 0, by increasing factor.
    points: Vec<[f64; 2]>,
    /// Least and greatest exponent.
    exponents: [f64; 2],
    /// The exponent below the least factor, if that is known; else that of the first two points.
    below: Option<f64>,
}

impl Curve {
    fn at(&self, factor: f64) -> f64 {
        let Some(last) = self.points.len().checked_sub(1) else { return 0.0 };
        // The piece that contains the factor, or the nearest one.
        let end = self.points.iter().position(|[at, _]| *at >= factor).unwrap_or(last).max(1).min(last);
        let [[x0, y0], [x1, y1]] = [self.points[end.saturating_sub(1)], self.points[end]];
        let exponent = if x1 > x0 { libm::log(y1 / y0) / libm::log(x1 / x0) } else { 0.0 };
        let exponent = match self.below {
            Some(below) if factor < x0 => below,
            _ => exponent.clamp(self.exponents[0], self.exponents[1]),
        };
        let (x, y) = if (factor - x0).abs() < (factor - x1).abs() { (x0, y0) } else { (x1, y1) };
        y * libm::pow(factor / x, exponent)
    }
}

/// Steps after which the number of passes in a time hardly changes.
const STEPS: usize = 8;

/// The largest squared relative bias of a pixel that counts.
const MAX_BIAS_SQUARED: f64 = 1.0;

/// The squared bias may be larger than it is measured by that many standard errors of its mean, which noise and the small number
/// of pixels leave.
const HIDDEN: f64 = 2.0;

/// Pixels of a row whose means are taken as independent: photons are in the discs of several pixels.
const CORRELATED: usize = 64;

/// The greatest factor on radii that is tried: radii per pixel grow where light is smooth, and the time of their estimates is
/// near that with this factor.
const WIDE: f64 = 2.0;

/// The seconds of estimates with radii per pixel over those with the factor [`WIDE`]: errors are estimated too, with a second
/// radius. Measuring areas takes about as long with both.
const fn cost_per_pixel(area: Area) -> f64 {
    match area {
        Area::Disc => 1.8,
        Area::Surface => 1.5,
    }
}

/// The squared error by photons with radii per pixel over that with the best shared radius, after as many passes: that of many
/// passes, and what is added until radii are found, times the number of passes.
const GAIN: f64 = 0.55;
const SEARCH: f64 = 9.0;

/// Squared relative errors of one kind of areas.
pub(super) struct Model {
    area: Area,
    /// The variance that does not depend on photons.
    others: f64,
    variance: Curve,
    bias_squared: Curve,
    /// A factor on radii, and the squared bias that may be hidden there.
    hidden: [f64; 2],
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
        reference: &[Vec<f64>; 2],
        others: f64,
        weights: &[f64],
        (photons, look): ([f64; 2], f64),
        alpha: f64,
    ) -> Self {
        // The noise of two passes is independent: that of the product has the mean 0. A visible point at the rim of a
        // surface, whose area there is a small part of the disc, may be many times too bright: one of thousands that a pixel
        // averages over.
        let [one, two] = reference;
        let product = |trial: &Trial, i: usize| (trial.passes[0][i] - one[i]) * (trial.passes[1][i] - two[i]);
        let squares = |trial: &Trial| -> Vec<f64> {
            let relative = |i: usize| (product(trial, i) * weights[i]).clamp(-MAX_BIAS_SQUARED, MAX_BIAS_SQUARED);
            (0..weights.len()).map(relative).collect()
        };
        let hidden = trials.last().map_or([1.0, 0.0], |trial| [trial.factor, HIDDEN * standard_error(&squares(trial))]);
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
            bias_squared: Curve {
                points: trials
                    .iter()
                    .filter_map(|trial| {
                        let squared = mean(&squares(trial));
                        (squared > 0.0).then_some([trial.factor, squared])
                    })
                    .collect(),
                exponents: [1.0, 4.0],
                below: None,
            },
            hidden,
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
    pub(super) fn forecast_per_pixel(&self, more: f64, factors: &[f64], seconds: f64) -> [f64; 3] {
        let pass = self.pass_per_pixel(more);
        let passes = count(seconds, pass);
        let others = self.others / f64::from(passes);
        let shared = factors.iter().map(|&factor| self.by_photons(more, factor, passes)).fold(f64::INFINITY, f64::min);
        [pass, others + (GAIN + SEARCH / f64::from(passes)) * shared, others]
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
        self.variance.at(narrow) / n + self.bias_squared.at(wide) + self.hidden_at(wide)
    }

    /// The mean of the squared radii of so many passes, over that of the first.
    fn wide(&self, passes: u32) -> f64 {
        radius_squared_sum(passes, self.alpha) / f64::from(passes)
    }

    /// Where light is smooth, bias is as the squared radius: what is hidden at the greatest radius that was tried is little
    /// at small ones.
    fn hidden_at(&self, factor: f64) -> f64 {
        let [greatest, squared] = self.hidden;
        squared * (factor / greatest).powi(4)
    }
}

/// The number of passes that fit.
fn count(seconds: f64, pass: f64) -> u32 {
    (seconds / pass.max(f64::MIN_POSITIVE)).round().clamp(1.0, 1e9) as u32
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// That of the mean, from means of [`CORRELATED`] values; 0 if there are fewer than two such means.
fn standard_error(values: &[f64]) -> f64 {
    let means: Vec<f64> = values.chunks_exact(CORRELATED).map(mean).collect();
    let whole = mean(&means);
    let squares = means.iter().map(|mean| (mean - whole).powi(2)).sum::<f64>();
    let count = means.len() as f64;
    if count < 2.0 { 0.0 } else { (squares / (count * (count - 1.0))).sqrt() }
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

/// The radiance of each pixel in two passes without most of the bias: that of the first trial, which has the least, extrapolated
/// to the radius 0 from the second one if that has the same kind of areas, as bias grows where light is smooth: as the squared
/// radius. (As the radius, which is so at edges, it would be forecast up to twice as large as it was measured.)
pub(super) fn reference(trials: &[Trial]) -> [Vec<f64>; 2] {
    let Some(least) = trials.first() else { return Default::default() };
    let Some(next) = trials.get(1).filter(|next| next.area == least.area && next.factor > least.factor) else {
        return least.passes.clone();
    };
    let share = 1.0 / ((next.factor / least.factor).powi(2) - 1.0);
    std::array::from_fn(|pass| {
        let both = least.passes[pass].iter().zip(&next.passes[pass]);
        both.map(|(least, next)| least + share * (least - next)).collect()
    })
}

/// Reciprocals of the squared radiance of each pixel, by this trial and what is not by photons, and a hundredth of its squared
/// mean.
pub(super) fn weights(trial: &Trial, others: &[f64]) -> Vec<f64> {
    let [one, two] = &trial.passes;
    let radiance: Vec<f64> = one.iter().zip(two).zip(others).map(|((a, b), c)| 0.5 * (a + b) + c).collect();
    let mean = radiance.iter().sum::<f64>() / radiance.len().max(1) as f64;
    radiance.iter().map(|value| (value * value + 0.01 * mean * mean).max(f64::MIN_POSITIVE).recip()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXELS: usize = 4096;

    /// Independent numbers with mean 0 and variance 1, from a counter.
    fn noise(stream: u64) -> impl Iterator<Item = f64> {
        (0..PIXELS as u64).map(move |i| {
            let uniform = |part: u64| {
                let mut word = (stream << 40) ^ (i << 8) ^ part;
                for _ in 0..3 {
                    word =
                        (word ^ (word >> 31)).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x1234_5678_9abc_def1);
                }
                ((word >> 11) as f64) / (1_u64 << 53) as f64
            };
            // Twelve uniform numbers have the variance 1.
            (0..12).map(uniform).sum::<f64>() - 6.0
        })
    }

    /// Pixels of 1 with a relative noise of 0.2 over the factor, and a bias of `bias` times its square.
    fn trial(area: Area, factor: f64, bias: f64, stream: u64) -> Trial {
        let pass = |stream: u64| noise(stream).map(|x| 1.0 + bias * factor * factor + 0.2 / factor * x).collect();
        Trial { area, factor, passes: [pass(2 * stream), pass(2 * stream + 1)], seconds: 0.25 * factor * factor }
    }

    #[test]
    fn curves_are_powers_between_points_and_beyond() {
        let curve = Curve {
            points: [0.5, 1.0, 2.0].map(|x: f64| [x, 3.0 * x * x]).to_vec(),
            exponents: [0.0, 4.0],
            below: None,
        };
        for factor in [0.25_f64, 0.5, 0.7, 1.0, 1.9, 2.0, 5.0] {
            assert!((curve.at(factor) / (3.0 * factor * factor) - 1.0).abs() < 1e-12, "{factor}");
        }
        let known = Curve { below: Some(1.0), ..curve.clone() };
        assert!((known.at(0.25) - 0.375).abs() < 1e-12 && (known.at(0.7) / 3.0 / 0.49 - 1.0).abs() < 1e-12);
        let flat = Curve { exponents: [-2.0, 0.0], ..curve };
        assert!((flat.at(0.25) - 0.75).abs() < 1e-12 && (flat.at(5.0) - 12.0).abs() < 1e-12, "exponents are limited");
        let one = Curve { points: vec![[1.0, 7.0]], exponents: [-2.0, 2.0], below: None };
        assert_eq!([one.at(0.5), one.at(3.0)], [7.0; 2]);
        assert_eq!(Curve { points: Vec::new(), exponents: [0.0; 2], below: None }.at(1.0), 0.0);
    }

    /// Variance and squared bias are recovered from two passes, within 4.5 standard errors, also of trials with areas of another
    /// kind than the reference.
    #[test]
    fn errors_are_those_of_noise_and_bias() {
        let factors = [0.7, 1.4, 2.0];
        let trials = |area, bias, first| {
            (first..).zip(factors).map(|(stream, factor)| trial(area, factor, bias, stream)).collect::<Vec<_>>()
        };
        let (surface, disc) = (trials(Area::Surface, 0.06, 10), trials(Area::Disc, 0.1, 20));
        let reference = reference(&surface);
        let weights = vec![1.0; PIXELS];
        let direct = [noise(90).map(|x| 0.3 * x).collect(), noise(91).map(|x| 0.3 * x).collect()];
        for (trials, bias) in [(surface, 0.06_f64), (disc, 0.1)] {
            let all: Vec<&Trial> = trials.iter().collect();
            let model = Model::new(&all, &reference, variance(&direct, &weights), &weights, ([0.25, 0.5], 0.0), 1.0);
            for factor in [1.4, 2.0] {
                let passes = 100.0;
                let seconds = 0.75 + 0.25 * factor * factor;
                let [pass, error, direct] = model.forecast(1.0, factor, passes * seconds + 1e-9);
                let error = error - model.hidden_at(factor);
                assert!((pass - seconds).abs() < 1e-12);
                // The mean of half of a squared difference has the relative standard error √(2/n).
                let z = (direct * passes / 0.09 - 1.0) / (2.0 / PIXELS as f64).sqrt();
                assert!(z.abs() < 4.5, "{direct}: z = {z}");
                let variance_of = |factor: f64| 0.04 / (factor * factor);
                let (variance, others, bias) = (variance_of(factor), 0.09_f64, bias * factor * factor);
                let expected = (variance + others) / passes + bias * bias;
                // The reference is 4/3 of the trial with the factor 0.7, less 1/3 of that with 1.4; both may be correlated
                // with the trial, which at most adds their standard deviations. Half of a squared difference has the
                // variance 2 σ⁴, the product of two differences with the variance σ² and the mean b of each σ⁴ + 2 b² σ².
                let parts = [(1.0, factor), (4.0 / 3.0, 0.7), (1.0 / 3.0, 1.4)];
                let each = parts.map(|(part, factor)| part * variance_of(factor).sqrt()).iter().sum::<f64>().powi(2);
                let product = each * each + 2.0 * bias * bias * each;
                let noise = 2.0 * (variance.powi(2) + others.powi(2)) / passes.powi(2);
                let z = (error - expected) / ((noise + product) / PIXELS as f64).sqrt();
                assert!(z.abs() < 4.5, "{factor}: {error} for {expected}, z = {z}");
            }
        }
    }

    /// What two passes without bias leave uncertain counts in full at the greatest radius and is as its fourth power: after many
    /// passes, the least radius is the best.
    #[test]
    fn bias_may_be_hidden_by_noise() {
        let trials = [0.7, 1.4, 2.0].map(|factor| trial(Area::Surface, factor, 0.0, (factor * 10.0) as u64));
        let all: Vec<&Trial> = trials.iter().collect();
        let (reference, weights) = (reference(&trials), vec![1.0; PIXELS]);
        let model = Model::new(&all, &reference, 0.0, &weights, ([0.25, 0.5], 0.0), 1.0);
        let product = |i: usize| -> f64 { (0..2).map(|pass| trials[2].passes[pass][i] - reference[pass][i]).product() };
        let products: Vec<f64> = (0..PIXELS).map(|i| product(i).clamp(-MAX_BIAS_SQUARED, MAX_BIAS_SQUARED)).collect();
        let expected = HIDDEN * standard_error(&products);
        assert!(expected > 0.0 && (model.hidden_at(2.0) / expected - 1.0).abs() < 1e-9, "{expected}");
        assert!((model.hidden_at(2.0) / model.hidden_at(1.0) - 16.0).abs() < 1e-9);
        let errors = [0.5, 0.7, 1.0, 1.4, 2.0].map(|factor| model.forecast(1.0, factor, 1e9)[1]);
        assert!(errors.is_sorted() && errors[4] >= expected, "{errors:?}");
    }

    /// The standard error of independent numbers is σ/√n, and that of numbers that are the same 64 times is 8 times as large.
    #[test]
    fn standard_errors_are_those_of_means() {
        let independent: Vec<f64> = noise(7).collect();
        let same: Vec<f64> = (0..PIXELS).map(|i| independent[i / CORRELATED]).collect();
        let root = (PIXELS as f64).sqrt();
        // From 64 means, whose spread has the relative standard error 1/√(2·63).
        for (values, expected) in [(&independent, 1.0 / root), (&same, 8.0 / root)] {
            let z = (standard_error(values) / expected - 1.0) * (2.0_f64 * 63.0).sqrt();
            assert!(z.abs() < 4.5, "{z}");
        }
        assert_eq!(standard_error(&[1.0; 64]), 0.0);
    }

    /// Variance 3 + 8/rays, and 5 + 2 rays seconds; more noise with more rays is not believed.
    #[test]
    fn more_gather_rays_have_less_noise_and_take_longer() {
        let of = |rays: u32| [3.0 + 8.0 / f64::from(rays), 5.0 + 2.0 * f64::from(rays)];
        for rays in [1, 2, 4, 16] {
            let found = with_gather_rays([(1, of(1)), (4, of(4))], rays);
            assert!(found.iter().zip(of(rays)).all(|(found, expected)| (found - expected).abs() < 1e-12), "{found:?}");
        }
        assert_eq!(with_gather_rays([(1, [1.0, 2.0]), (4, [1.5, 1.0])], 16), [1.5, 1.0]);
        assert_eq!(with_gather_rays([(1, [9.0, 1.0]), (4, [1.0, 4.0])], 16), [0.25, 16.0]);
    }

    /// Four times the paths: discs with half of the radius contain as many photons, and have a sixteenth of the squared bias.
    #[test]
    fn more_paths_make_smaller_discs() {
        let trials = [0.7, 1.4, 2.0].map(|factor| Trial {
            passes: [vec![1.0 + 0.1 * factor * factor; PIXELS], vec![1.0 + 0.1 * factor * factor; PIXELS]],
            ..trial(Area::Surface, factor, 0.0, 0)
        });
        let all: Vec<&Trial> = trials.iter().collect();
        let model = Model::new(&all, &reference(&trials), 0.0, &vec![1.0; PIXELS], ([0.25, 0.5], 0.0), 1.0);
        let ([once, coarse, _], [more, fine, _]) = (model.forecast(1.0, 1.4, 1e9), model.forecast(4.0, 1.4, 1e9));
        assert!((more - once - 3.0 * 0.5).abs() < 1e-12, "{more} {once}");
        assert!((coarse / 0.01 / 1.4_f64.powi(4) - 1.0).abs() < 1e-6 && (coarse / fine - 16.0).abs() < 1e-6, "{fine}");
    }

    /// A single point that is thirty times too bright does not decide.
    #[test]
    fn outliers_of_the_bias_are_limited() {
        let flat = [0.7, 1.4].map(|factor| Trial {
            passes: [vec![1.0; PIXELS], vec![1.0; PIXELS]],
            ..trial(Area::Surface, factor, 0.0, 0)
        });
        let [least, mut trial] = flat;
        trial.passes.iter_mut().for_each(|pass| pass[7] = 30.0);
        let trials = [least, trial];
        let all: Vec<&Trial> = trials.iter().collect();
        let model = Model::new(&all, &reference(&trials), 0.0, &vec![1.0; PIXELS], ([0.25, 0.5], 0.0), 1.0);
        // Without the limit it would be (4/3 · 29)² times as much.
        let [_, error, _] = model.forecast(1.0, 1.4, 1e9);
        // One of the means deviates, so that the standard error is the mean itself.
        assert!((error * PIXELS as f64 / MAX_BIAS_SQUARED - (1.0 + HIDDEN)).abs() < 1e-6, "{error}");
    }

    /// More passes make the larger radius worse than the smaller one: its bias remains.
    #[test]
    fn with_time_bias_matters_more() {
        let trials = [0.7, 1.4, 2.0].map(|factor| trial(Area::Surface, factor, 0.03, (factor * 10.0) as u64));
        let all: Vec<&Trial> = trials.iter().collect();
        let model = Model::new(&all, &reference(&trials), 0.0, &vec![1.0; PIXELS], ([0.25, 0.5], 0.0), 1.0);
        let error = |factor: f64, seconds: f64| model.forecast(1.0, factor, seconds)[1];
        assert!(error(2.0, 2.0) < error(0.7, 2.0) && error(2.0, 1e4) > error(0.7, 1e4));
    }

    /// With radii per pixel: the time of estimates with the greatest radius, and a part of the least error with as many passes.
    #[test]
    fn radii_per_pixel_have_fewer_passes_and_a_smaller_error_of_each() {
        let trials = [0.7, 1.4, 2.0].map(|factor| trial(Area::Surface, factor, 0.03, (factor * 10.0) as u64));
        let all: Vec<&Trial> = trials.iter().collect();
        let weights = vec![1.0; PIXELS];
        // Of the 0.25 · 2² seconds of the greatest radius, 0.1 are for camera paths.
        let model = Model::new(&all, &reference(&trials), 0.5, &weights, ([0.25, 0.5], 0.1), 1.0);
        let expected = |more: f64| 0.25 + more * 0.5 + 0.1 + 1.5 * 0.9;
        let factors = [0.5, 0.7, 1.0, 1.4, 2.0];
        for (more, passes) in [(1.0, 20.0), (4.0, 400.0)] {
            let [pass, error, others] = model.forecast_per_pixel(more, &factors, passes * expected(more));
            assert!((pass / expected(more) - 1.0).abs() < 1e-9 && (others * passes / 0.5 - 1.0).abs() < 1e-9);
            let shared = factors.map(|factor| model.by_photons(more, factor, passes as u32));
            let least = shared.into_iter().fold(f64::INFINITY, f64::min);
            let part = (error - others) / least;
            assert!((part - GAIN - SEARCH / passes).abs() < 1e-9 && least > 0.0, "{part}");
        }
    }

    #[test]
    fn dark_pixels_weigh_no_more_than_a_hundred_times_the_mean() {
        let trial = Trial { area: Area::Disc, factor: 1.0, passes: [vec![0.0, 1.0], vec![0.0, 2.0]], seconds: 1.0 };
        let weights = weights(&trial, &[0.0, 0.5]);
        assert_eq!(weights, [1.0 / 0.01, 1.0 / (4.0 + 0.01)]);
        assert!(super::weights(&Trial { passes: [vec![0.0], vec![0.0]], ..trial }, &[0.0])[0].is_finite());
    }
}
