//! A radius for each pixel, from the noise and bias measured in earlier passes.
//!
//! The mean squared error of a pixel after N passes with squared radius r² is V/(N r²) + B² r⁴. It is
//! smallest where the squared noise is twice the squared bias: at a factor of (noise²/2 bias²)^(1/3) on r²
//! (Silverman 1986, section 4.3; per pixel as in Kaplanyan and Dachsbacher 2013). Both are estimated with a
//! second radius: the noise of the difference is a known fraction of the photons' noise.
//!
//! The factor of a pass depends only on earlier passes, whose photons are independent of its own: given its
//! radius, the expectation of an estimate is unchanged. A factor that depended on the photons it weights
//! would favour radii at which they happen to look smooth or bright, which would add bias.

use crate::film::Film;
use crate::film::confidence::{ErrorPixel, Flags};
use crate::parallel;
use crate::radius::progressive::{inverse_radius_squared_sum, radius_squared_sum};

/// Factors are first computed after this many passes, then whenever the number of passes has doubled.
const FIRST: u32 = 8;

/// Bounds of the factor on r², in total and for one step.
const BOUNDS: [f64; 2] = [1.0 / 16.0, 8.0];
const STEP: f64 = 2.0;

/// Noise and bias are averaged over this many pixels to each side, since the bias of a single pixel is
/// mostly noise.
const REACH: usize = 2;

/// Radius factors of the pixels of a film.
#[derive(Clone, Debug)]
pub(crate) struct Radii {
    alpha: f64,
    /// Standard deviation of the difference of two estimates, divided by that of the first.
    share: f64,
    /// Passes in the film when factors were last computed.
    then: u32,
    /// Sums of the bias and of its square at that time.
    before: Vec<[f64; 2]>,
    /// Factors on r².
    factors: Vec<f64>,
}

impl Radii {
    /// The factor 1 for all pixels.
    pub(crate) fn new(pixels: usize, alpha: f64, share: f64) -> Self {
        Self { alpha, share, then: 0, before: vec![[0.0; 2]; pixels], factors: vec![1.0; pixels] }
    }

    /// Whether factors are to be computed after this many passes.
    pub(crate) fn is_due(&self, passes: u32) -> bool {
        passes >= FIRST && passes >= 2 * self.then
    }

    /// Factors on the radius of each pixel, as bits of `f32`.
    pub(crate) fn bits(&self) -> Vec<u32> {
        self.factors.iter().map(|factor| (factor.sqrt() as f32).to_bits()).collect()
    }

    /// Updates the factors from the passes since the last update.
    pub(crate) fn learn(&mut self, film: &Film) {
        let (Some(errors), Some(interval)) = (&film.errors, film.interval()) else { return };
        let passes = film.passes - self.then;
        let sums = parallel::collect(errors.len(), |pixel| tell(&errors[pixel], self.before[pixel], passes));
        let (bias, noise) = self.outlook(film.passes);
        let (width, height) = (film.width as usize, film.height as usize);
        let steps = parallel::collect(sums.len(), |pixel| {
            let around = |[sum, square]: [f64; 2], other: usize| [sum + sums[other][0], square + sums[other][1]];
            let [bias_squared, difference] = neighbours(pixel, width, height, REACH).fold([0.0; 2], around);
            let noise_squared = difference / (self.share * self.share) * noise;
            // The square of the mean difference contains its own variance.
            let bias_squared = (bias_squared - difference).max(0.0) * bias * bias;
            let step = step(noise_squared, bias_squared);
            let edge = [Flags::OTHER_SURFACE, Flags::UNEVEN, Flags::CURVED];
            // Across an edge a second radius is a poor measure of the bias: do not increase the radius there.
            let flags = interval(pixel).reasons();
            let broken = edge.iter().any(|&flag| flags.contains(flag));
            libm::log(if broken { step.min(1.0) } else { step })
        });
        parallel::for_each_part(&mut self.factors, |first, factors| {
            for (i, factor) in factors.iter_mut().enumerate() {
                // Geometric mean over neighbours, so that the factors do not become visible in the picture.
                let around = neighbours(first + i, width, height, 1)
                    .fold((0.0, 0.0), |(sum, count), i| (sum + steps[i], count + 1.0));
                *factor = (*factor * libm::exp(around.0 / around.1)).clamp(BOUNDS[0], BOUNDS[1]);
            }
        });
        self.then = film.passes;
        self.before = errors.iter().map(|error| [error.bias, error.bias_square]).collect();
    }

    /// Factors by which bias and squared noise change from the passes since the last update to twice as
    /// many passes as there are now, with the present factors.
    fn outlook(&self, passes: u32) -> (f64, f64) {
        let (count, all) = (f64::from(passes - self.then), f64::from(2 * passes));
        let window = |of: fn(u32, f64) -> f64| of(passes, self.alpha) - of(self.then, self.alpha);
        let whole = |of: fn(u32, f64) -> f64| of(2 * passes, self.alpha);
        let bias = whole(radius_squared_sum) / all / (window(radius_squared_sum) / count);
        let noise =
            whole(inverse_radius_squared_sum) / (all * all) / (window(inverse_radius_squared_sum) / (count * count));
        (bias, noise)
    }
}

/// The squared mean of the bias over the passes since `before`, and the variance of that mean.
fn tell(now: &ErrorPixel, before: [f64; 2], passes: u32) -> [f64; 2] {
    let n = f64::from(passes);
    let (sum, square) = (now.bias - before[0], now.bias_square - before[1]);
    let variance = ((square - sum * sum / n) / (n * (n - 1.0))).max(0.0);
    [(sum / n).powi(2), variance]
}

/// The factor on r² that minimises the error, within bounds; 1 where no photon was found.
fn step(noise_squared: f64, bias_squared: f64) -> f64 {
    if noise_squared > 0.0 { libm::cbrt(noise_squared / (2.0 * bias_squared)).clamp(1.0 / STEP, STEP) } else { 1.0 }
}

/// A pixel and its neighbours.
fn neighbours(pixel: usize, width: usize, height: usize, reach: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (pixel % width, pixel / width);
    let rows = y.saturating_sub(reach)..(y + reach + 1).min(height);
    rows.flat_map(move |row| {
        (x.saturating_sub(reach)..(x + reach + 1).min(width)).map(move |column| row * width + column)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::confidence::PhotonMoments;
    use crate::requirements::map_kind::{MapKind, PerMap};
    use crate::scene::units::Units;

    /// A film of 8 × 8 pixels with bias `bias`, and standard deviation `deviation` of the bias between
    /// passes.
    fn film(passes: u32, bias: f64, deviation: f64) -> Film {
        let mut film = Film::new(8, 8, Units::default()).unwrap();
        let even = PhotonMoments { power: 100.0, power_squared: 100.0, ..PhotonMoments::default() };
        let mut errors = vec![ErrorPixel::default(); 64];
        for pass in 0..passes {
            for (i, error) in errors.iter_mut().enumerate() {
                let sign = if (pass + i as u32).is_multiple_of(2) { 1.0 } else { -1.0 };
                let bias = bias + sign * deviation;
                let photon_moments =
                    PerMap::from_fn(|kind| if kind == MapKind::Global { even } else { PhotonMoments::default() });
                error.end_pass(&ErrorPixel { bias, narrow: 0.5 * bias, photon_moments, ..ErrorPixel::default() });
            }
        }
        film.passes = passes;
        film.errors = Some(errors);
        film
    }

    #[test]
    fn factors_lead_to_where_the_error_is_least() {
        // Differences with deviation 1/2 in each of 8 passes: the noise² after 16 passes is 1/16.
        for (bias, expected) in
            [(0.2, (1.0_f64 / 16.0 / (2.0 * 0.04 - 2.0 * 0.25 / 7.0)).cbrt()), (0.0, STEP), (9.0, 1.0 / STEP)]
        {
            let mut radii = Radii::new(64, 1.0, 0.5);
            assert!(!radii.is_due(7) && radii.is_due(8));
            radii.learn(&film(8, bias, 0.5));
            assert!(!radii.is_due(15) && radii.is_due(16));
            for &factor in &radii.factors {
                // 7 degrees of freedom instead of 8.
                assert!((factor / expected.clamp(1.0 / STEP, STEP) - 1.0).abs() < 0.06, "{bias}: {factor} {expected}");
            }
        }
    }

    #[test]
    fn what_is_still_comes_out_still() {
        let mut radii = Radii::new(64, 2.0 / 3.0, 0.5);
        radii.learn(&film(8, 0.0, 0.0));
        assert!(radii.factors.iter().all(|&factor| factor == 1.0));
        for passes in [16, 32, 64, 128, 256] {
            radii.learn(&film(passes, 0.0, 1.0));
        }
        assert!(radii.factors.iter().all(|&factor| (factor - BOUNDS[1]).abs() < 1e-9));
        assert_eq!(f32::from_bits(radii.bits()[5]), 8.0_f32.sqrt());
    }
}
