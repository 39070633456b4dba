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
pub(crate) const FIRST: u32 = 8;

/// Radius factors of the pixels of a film.
#[derive(Clone, Debug)]
pub(crate) struct Radii {
    alpha: f64,
    /// Standard deviation of the difference of two estimates, divided by that of the first.
    share: f64,
    /// Passes in the film when factors were last computed.
    then: u32,
    /// The factors, unless the backend computes them.
    state: Option<PixelRadii>,
}

impl Radii {
    /// The factor 1 for all pixels.
    pub(crate) fn new(alpha: f64, share: f64) -> Self {
        Self { alpha, share, then: 0, state: None }
    }

    /// The update that is to be made after this many passes, if there is one.
    pub(crate) fn due(&self, passes: u32) -> Option<RadiusUpdate> {
        (passes >= FIRST && passes >= 2 * self.then).then(|| {
            let [bias, noise] = self.outlook(passes);
            RadiusUpdate { passes, since: passes - self.then, bias, noise: noise / (self.share * self.share) }
        })
    }

    /// Makes the update on the host; returns factors on the radius of each pixel, as bits of `f32`.
    pub(crate) fn learn(&mut self, film: &Film, update: &RadiusUpdate) -> Vec<u32> {
        let state = self.state.get_or_insert_with(|| PixelRadii::new(film.pixels.len()));
        state.learn(film, update);
        state.bits()
    }

    /// An update was made, by the host or by the backend.
    pub(crate) fn updated(&mut self, update: &RadiusUpdate) {
        self.then = update.passes;
    }

    /// Factors by which bias and squared noise change from the passes since the last update to twice as
    /// many passes as there are now, with the present factors.
    fn outlook(&self, passes: u32) -> [f64; 2] {
        let (count, all) = (f64::from(passes - self.then), f64::from(2 * passes));
        let window = |of: fn(u32, f64) -> f64| of(passes, self.alpha) - of(self.then, self.alpha);
        let whole = |of: fn(u32, f64) -> f64| of(2 * passes, self.alpha);
        let bias = whole(radius_squared_sum) / all / (window(radius_squared_sum) / count);
        let noise =
            whole(inverse_radius_squared_sum) / (all * all) / (window(inverse_radius_squared_sum) / (count * count));
        [bias, noise]
    }
}

/// An update of the radii of pixels from the passes since the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RadiusUpdate {
    /// Passes in the film, at least 8.
    pub passes: u32,
    /// Passes since the last update, at least 8.
    pub since: u32,
    /// The bias with the present factors after twice as many passes as there are now, over that of the passes since the last
    /// update.
    pub bias: f64,
    /// The squared noise of the picture after as many passes, over the squared standard error of [`ErrorPixel::bias`] in
    /// the passes since the last update.
    pub noise: f64,
}

impl RadiusUpdate {
    /// An update after `passes` passes, `since` of which are new; the other values as in the fields.
    #[must_use]
    pub const fn new(passes: u32, since: u32, [bias, noise]: [f64; 2]) -> Self {
        Self { passes, since, bias, noise }
    }
}

/// Factors on the squared radius of each pixel, computed on the host from films.
#[derive(Clone, Debug)]
pub struct PixelRadii {
    /// Sums of the bias and of its square at the last update.
    before: Vec<[f64; 2]>,
    factors: Vec<f64>,
}

impl PixelRadii {
    /// Bounds of the factor on r².
    pub const BOUNDS: [f64; 2] = [1.0 / 16.0, 8.0];

    /// The largest change of r² in one update, and the reciprocal of the least.
    pub const STEP: f64 = 2.0;

    /// Noise and bias are averaged over this many pixels to each side, since the bias of a single pixel is
    /// mostly noise.
    pub const REACH: u32 = 2;

    /// The factor 1 for all pixels.
    #[must_use]
    pub fn new(pixels: usize) -> Self {
        Self { before: vec![[0.0; 2]; pixels], factors: vec![1.0; pixels] }
    }

    /// Factors on the radius of each pixel, as bits of `f32`: what [`crate::TransportBackend::scale_radii`] takes.
    #[must_use]
    pub fn bits(&self) -> Vec<u32> {
        self.factors.iter().map(|factor| (factor.sqrt() as f32).to_bits()).collect()
    }

    /// Updates the factors. Nothing changes without error statistics of as many pixels.
    pub fn learn(&mut self, film: &Film, update: &RadiusUpdate) {
        let (Some(errors), Some(interval)) = (&film.errors, film.interval()) else { return };
        if errors.len() != self.factors.len() {
            return;
        }
        let sums = parallel::collect(errors.len(), |pixel| tell(&errors[pixel], self.before[pixel], update.since));
        let (width, height) = (film.width as usize, film.height as usize);
        let steps = parallel::collect(sums.len(), |pixel| {
            let around = |[sum, square]: [f64; 2], other: usize| [sum + sums[other][0], square + sums[other][1]];
            let [bias_squared, difference] =
                neighbours(pixel, width, height, PixelRadii::REACH as usize).fold([0.0; 2], around);
            // The square of the mean difference contains its own variance.
            let bias_squared = (bias_squared - difference).max(0.0) * update.bias * update.bias;
            let step = step(difference * update.noise, bias_squared);
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
                *factor =
                    (*factor * libm::exp(around.0 / around.1)).clamp(PixelRadii::BOUNDS[0], PixelRadii::BOUNDS[1]);
            }
        });
        self.before = errors.iter().map(|error| [error.bias, error.bias_square]).collect();
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
    if noise_squared > 0.0 {
        libm::cbrt(noise_squared / (2.0 * bias_squared)).clamp(1.0 / PixelRadii::STEP, PixelRadii::STEP)
    } else {
        1.0
    }
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

    /// Factors on r² after the update that is due.
    fn learned(radii: &mut Radii, passes: u32, bias: f64, deviation: f64) -> Vec<f64> {
        let update = radii.due(passes).unwrap();
        let bits = radii.learn(&film(passes, bias, deviation), &update);
        radii.updated(&update);
        bits.into_iter().map(|bits| f64::from(f32::from_bits(bits)).powi(2)).collect()
    }

    #[test]
    fn factors_lead_to_where_the_error_is_least() {
        // Differences with deviation 1/2 in each of 8 passes: the noise² after 16 passes is 1/16.
        for (bias, expected) in [
            (0.2, (1.0_f64 / 16.0 / (2.0 * 0.04 - 2.0 * 0.25 / 7.0)).cbrt()),
            (0.0, PixelRadii::STEP),
            (9.0, 1.0 / PixelRadii::STEP),
        ] {
            let mut radii = Radii::new(1.0, 0.5);
            assert_eq!(radii.due(7), None);
            let factors = learned(&mut radii, 8, bias, 0.5);
            assert!(radii.due(15).is_none() && radii.due(16).is_some());
            for &factor in &factors {
                // 7 degrees of freedom instead of 8.
                assert!(
                    (factor / expected.clamp(1.0 / PixelRadii::STEP, PixelRadii::STEP) - 1.0).abs() < 0.06,
                    "{bias}: {factor} {expected}"
                );
            }
        }
    }

    #[test]
    fn what_is_still_comes_out_still() {
        let mut radii = Radii::new(2.0 / 3.0, 0.5);
        assert_eq!(learned(&mut radii, 8, 0.0, 0.0), [1.0; 64]);
        let mut last = Vec::new();
        for passes in [16, 32, 64, 128, 256] {
            last = learned(&mut radii, passes, 0.0, 1.0);
        }
        assert!(last.iter().all(|&factor| (factor - PixelRadii::BOUNDS[1]).abs() < 1e-6), "{last:?}");
    }
}
