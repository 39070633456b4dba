//! A group of pixels with similar flags: their errors as measured by a pilot, corrected for chance.

use super::Bound;
use crate::film::confidence::ConfidenceInterval;

/// Number of standard errors by which averages over all pixels may be off.
const DOUBT: f64 = 2.0;

/// Errors of one pixel, as fractions of its radiance.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Relative {
    /// Noise of the photons, which depends on radii.
    pub(super) photons: f64,
    /// All other noise.
    pub(super) other: f64,
    standard_error: f64,
    /// The bias with its sign.
    signed: f64,
    pub(super) bias: f64,
    /// Lower and upper bound of the systematic part of the bias.
    steady: [f64; 2],
    pub(super) bias_error: f64,
    /// Bound of the bias of light that has no bias estimate.
    bounded: f64,
    /// Noise of the bias, corrected so that its spread over the pixels is the true one.
    random: f64,
    /// A normally distributed number: the random part of the bias in future passes.
    luck: f64,
    /// Effective number of photons.
    pub(super) photon_count: f64,
}

impl Relative {
    /// From a confidence interval; errors of pixels darker than `least` are fractions of `least`.
    pub(super) fn new(interval: &ConfidenceInterval, least: f64, second: f64) -> Self {
        let unit = interval.value.abs().max(least);
        // A pixel that is black in a black picture has no error.
        let of = |x: f64| if x > 0.0 { x / unit } else { 0.0 };
        // The bias is estimated from photons alone: its noise gives theirs.
        let photons = (interval.bias_error / second).min(interval.standard_error);
        let other = (interval.standard_error * interval.standard_error - photons * photons).max(0.0).sqrt();
        Self {
            photons: of(photons),
            other: of(other),
            standard_error: of(interval.standard_error),
            signed: of(interval.bias.abs()).copysign(interval.bias),
            bias: of(interval.bias.abs()),
            steady: [0.0; 2],
            bias_error: of(interval.bias_error),
            // Bounds at edges and for scarce photons say nothing about what is left when there are none.
            bounded: if interval.allowed.is_empty() { of(interval.bounded) } else { 0.0 },
            random: 0.0,
            luck: 0.0,
            photon_count: interval.photons,
        }
    }

    /// Half width of the interval, with this quantile of Student's distribution, without its correction for skewness.
    pub(super) fn half_width(&self, quantile: f64) -> f64 {
        quantile * self.standard_error + 2.0 * self.bias + self.bounded
    }

    /// Total noise, as measured.
    pub(super) fn noise(&self) -> f64 {
        self.standard_error
    }
}

/// Factors by which the parts of an error change.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factors {
    pub(super) bias: f64,
    pub(super) noise: f64,
    pub(super) other: f64,
    /// Of Student's distribution, after the future passes.
    pub(super) quantile: f64,
}

/// A sample of the pixels of a group.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) pixels: Vec<Relative>,
    /// Number of pixels that each pixel of the sample represents.
    weight: f64,
    /// Lower and upper bound of the factor on all noise.
    level: [f64; 2],
}

impl Group {
    /// From a sample that represents `many` pixels, measured by passes with this many degrees of freedom.
    ///
    /// Removes the part of the spread of noise and biases over the pixels that is due to chance, so that
    /// quantiles are those of the true distribution (constrained empirical Bayes, Louis 1984); and assigns
    /// each pixel a random deviate.
    pub(super) fn new(mut pixels: Vec<Relative>, many: usize, freedom: f64, second: f64) -> Self {
        // The logarithm of a variance with ν degrees of freedom has a variance of ψ′(ν/2), here to the
        // third term of its series. With few photons, m in total, the kurtosis of the Poisson distribution
        // adds 1/m.
        let half = 0.5 * freedom.max(1.0);
        let passes = 1.0 / half + 0.5 / (half * half) + 1.0 / (6.0 * half * half * half);
        let few = |pixel: &Relative| pixel.photon_count.max(1.0).recip();
        let dark = |pixel: &Relative| (pixel.photons / pixel.noise().max(f64::MIN_POSITIVE)).powi(4);
        let noise: Vec<_> = pixels.iter().map(|pixel| (pixel.noise(), passes + dark(pixel) * few(pixel))).collect();
        let biases: Vec<_> = pixels.iter().map(|pixel| (pixel.bias_error, passes + few(pixel))).collect();
        let (noise, biases) = (without_chance(&noise, freedom), without_chance(&biases, freedom));
        let (typical, independent) = typical(&pixels);
        for (index, pixel) in pixels.iter_mut().enumerate() {
            let whole = pixel.noise() * noise[index];
            pixel.random = pixel.bias_error * biases[index];
            // The bias is estimated from photons alone: its noise gives theirs.
            pixel.photons = (pixel.random / second).min(whole);
            pixel.other = (whole * whole - pixel.photons * pixel.photons).max(0.0).sqrt();
            let share = |square: f64| square / (square + pixel.bias_error.powi(2)).max(f64::MIN_POSITIVE);
            pixel.steady = typical.map(|square| share(square).sqrt() * pixel.bias);
            // Multiples of the golden ratio are evenly spread.
            pixel.luck = normal_quantile(((index as f64 + 0.5) * 0.618_033_988_749_895).fract());
        }
        let doubt = libm::exp(0.5 * DOUBT * (passes / independent).sqrt());
        let weight = many as f64 / pixels.len().max(1) as f64;
        Self { pixels, weight, level: [doubt.recip(), doubt] }
    }

    /// Predicted errors, each with the number of pixels that it stands for.
    pub(super) fn errors(&self, factors: &Factors, bound: Bound) -> impl Iterator<Item = (f64, f64)> {
        let level = self.level[bound as usize];
        self.pixels.iter().map(move |pixel| {
            let noise = libm::hypot(pixel.photons * factors.noise, pixel.other * factors.other);
            let random = level * pixel.random * factors.noise * pixel.luck;
            let steady = pixel.steady[bound as usize] * factors.bias;
            // Edges leave the disc as it shrinks, but when is not known.
            let bounded = if bound == Bound::Upper { pixel.bounded } else { pixel.bounded * factors.bias };
            (factors.quantile * level * noise + 2.0 * (steady + random).abs() + bounded, self.weight)
        })
    }
}

/// Factors on standard errors that give them the true spread; each is paired with the variance of the
/// logarithm of its square that is due to chance. On average, chance makes these logarithms too low by 1/ν.
fn without_chance(errors: &[(f64, f64)], freedom: f64) -> Vec<f64> {
    let log = |error: f64| 2.0 * libm::log(error);
    let known = |error: f64| error > 0.0 && error.is_finite();
    let logs: Vec<_> = errors.iter().filter(|(error, _)| known(*error)).map(|&(error, by)| (log(error), by)).collect();
    if logs.len() < 2 {
        return vec![1.0; errors.len()];
    }
    let count = logs.len() as f64;
    let mean = logs.iter().map(|(log, _)| log).sum::<f64>() / count;
    let truth = (logs.iter().map(|(log, by)| (log - mean).powi(2) - by).sum::<f64>() / count).max(0.0);
    let factor = |error: f64, by: f64| {
        let kept = (truth / (truth + by).max(f64::MIN_POSITIVE)).sqrt();
        libm::exp(0.5 * ((kept - 1.0) * (log(error) - mean) + freedom.max(1.0).recip()))
    };
    errors.iter().map(|&(error, by)| if known(error) { factor(error, by) } else { 1.0 }).collect()
}

/// Lower and upper bound of the mean squared bias, and the effective number of independent pixels.
///
/// Squares of measured biases are too large by their variance, on average. Neighbours share some photons:
/// if their biases correlate by ρ, whether by chance or not, squares of normal numbers correlate by ρ²; if
/// this falls as ρ² to the power of the distance, along rows and columns, the number of independent pixels
/// is smaller by ((1 − ρ²)/(1 + ρ²))².
fn typical(pixels: &[Relative]) -> ([f64; 2], f64) {
    let count = pixels.len().max(1) as f64;
    let excess = |pixel: &Relative| pixel.bias.powi(2) - pixel.bias_error.powi(2);
    let mean = pixels.iter().map(excess).sum::<f64>() / count;
    let variance = pixels.iter().map(|pixel| (excess(pixel) - mean).powi(2)).sum::<f64>() / count;
    let whole = pixels.iter().map(|pixel| pixel.bias.powi(2)).sum::<f64>();
    let shared: f64 = pixels.windows(2).map(|pair| pair[0].signed * pair[1].signed).sum();
    let square = (shared / whole.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0).powi(2);
    let independent = (count * ((1.0 - square) / (1.0 + square)).powi(2)).max(1.0);
    let doubt = DOUBT * (variance / independent).sqrt();
    ([(mean - doubt).max(0.0), (mean + doubt).max(0.0)], independent)
}

/// Quantile of the standard normal distribution, within 4.5·10⁻⁴ (Hastings 1955; Abramowitz and Stegun
/// 26.2.23).
pub(super) fn normal_quantile(p: f64) -> f64 {
    let tail = p.min(1.0 - p).max(1e-12);
    let t = (-2.0 * libm::log(tail)).sqrt();
    let above = (0.010_328 * t + 0.802_853) * t + 2.515_517;
    let below = ((0.001_308 * t + 0.189_269) * t + 1.432_788) * t + 1.0;
    (t - above / below).copysign(p - 0.5)
}
