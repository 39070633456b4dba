//! Confidence intervals of pixels: noise from the variance over passes, bias from a second radius, and
//! flags where neither is reliable.
//!
//! Stores sums, like the film, so that passes may be rendered anywhere and added. A variance from a sum of
//! squares in f64 loses its precision only where the standard deviation of a pass is below 10⁻⁷ of the
//! pixel.

mod moments;
mod widths;

use bitflags::bitflags;
use bytemuck::Zeroable;

use crate::film::{Film, FilmPixel, Layer};
use crate::parallel;
use crate::requirements::map_kind::{MapKind, PerMap};
use crate::scene::layout::{ErrorMoments, Estimate, Query};
pub use moments::PhotonMoments;
pub use widths::student_975;
use widths::{noise_width, skew};

#[cfg(test)]
mod tests;

/// Error statistics of a pixel, summed over passes. Normalised units, mean of RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Zeroable)]
#[non_exhaustive]
pub struct ErrorPixel {
    /// Radiance estimated with twice the area, minus that of the picture: estimates the bias of a pass.
    pub bias: f64,
    /// Sum over passes of its square.
    pub bias_square: f64,
    /// Radiance of the picture, minus that estimated with half the area: half the bias.
    pub narrow: f64,
    /// Sum over passes of its square.
    pub narrow_square: f64,
    /// Distribution of the photons of each map around the pixel's queries.
    pub photon_moments: PerMap<PhotonMoments>,
}

impl ErrorPixel {
    /// Adds the error statistics of one query for one map, to those of a single pass.
    pub fn deposit(&mut self, kind: MapKind, query: &Query, estimate: &Estimate, moments: &ErrorMoments, paths: u64) {
        if moments.photons == 0 || paths == 0 {
            return;
        }
        let area = std::f64::consts::PI * f64::from(estimate.radius_squared) * paths as f64;
        let (bias, narrow) = moments.biases(estimate);
        for c in 0..3 {
            let weight = f64::from(query.throughput[c]) / (3.0 * area);
            self.bias += weight * bias[c];
            self.narrow += weight * narrow[c];
        }
        let weight = query.throughput.iter().map(|&w| f64::from(w)).sum::<f64>() / 3.0;
        let map_moments = &mut self.photon_moments[kind];
        map_moments.power += weight * f64::from(moments.power);
        map_moments.power_squared += weight * weight * f64::from(moments.power_squared);
        for axis in 0..2 {
            map_moments.slope[axis] += weight * f64::from(moments.slope[axis]);
            map_moments.quadrupole[axis] += weight * f64::from(moments.quadrupole[axis]);
        }
        map_moments.stray += weight * f64::from(moments.stray);
    }

    /// Adds the error statistics of one query from the hits of its final-gather rays: irradiance estimated
    /// with twice the area minus that of the picture, that of the picture minus the one estimated with half
    /// the area, and power and squared power of the photons. The distribution of these photons is not
    /// recorded.
    pub fn deposit_gathered(&mut self, query: &Query, bias: [f64; 3], narrow: [f64; 3], powers: [f64; 2]) {
        for c in 0..3 {
            let weight = f64::from(query.throughput[c]) / 3.0;
            self.bias += weight * bias[c];
            self.narrow += weight * narrow[c];
        }
        let weight = query.throughput.iter().map(|&w| f64::from(w)).sum::<f64>() / 3.0;
        let map_moments = &mut self.photon_moments[MapKind::Global];
        map_moments.power += weight * powers[0];
        map_moments.power_squared += weight * weight * powers[1];
    }

    /// Whether any photons were found.
    fn is_known(&self) -> bool {
        self.photon_moments.values().any(|map_moments| map_moments.power > 0.0)
    }

    /// The light of a map in a pixel, a sum over passes. A map without photons gave none of its layer, which is of shadow rays
    /// then.
    fn light(&self, pixel: &FilmPixel, kind: MapKind) -> f64 {
        let is_read = self.photon_moments[kind].power > 0.0;
        if is_read { pixel.layers[kind.layer() as usize].iter().sum::<f64>() / 3.0 } else { 0.0 }
    }

    /// Bound of the error of the `light` of a map of which few photons were found, a sum over passes: the light of as many
    /// photons as may have been expected, each with the mean `per_photon` of the picture, or the bound for any light.
    ///
    /// The expected number of which k were found is at most k + 1.4 √k + 3.7: the upper end of its 95 % interval is 3.7, 5.6,
    /// 8.8 and 14.4 for k = 0, 1, 3 and 7.
    fn missed(&self, pixel: &FilmPixel, kind: MapKind, light: f64, per_photon: f64) -> f64 {
        let photons = self.photon_moments[kind].photons();
        let most = photons + 1.4 * photons.sqrt() + 3.7;
        (most * per_photon * albedo(pixel) - light).max(BOUND * light)
    }

    /// Adds the statistics of a finished pass.
    pub fn end_pass(&mut self, pass: &Self) {
        self.bias += pass.bias;
        self.bias_square += pass.bias * pass.bias;
        self.narrow += pass.narrow;
        self.narrow_square += pass.narrow * pass.narrow;
        self.photon_moments.iter_mut().for_each(|(kind, sum)| sum.add(&pass.photon_moments[kind]));
    }

    /// Adds the passes of `other`.
    pub fn add(&mut self, other: &Self) {
        self.bias += other.bias;
        self.bias_square += other.bias_square;
        self.narrow += other.narrow;
        self.narrow_square += other.narrow_square;
        self.photon_moments.iter_mut().for_each(|(kind, sum)| sum.add(&other.photon_moments[kind]));
    }
}

bitflags! {
    /// Reasons why a pixel has no error estimate ([`ConfidenceInterval::flags`]), or one that allows for them by a bound
    /// ([`ConfidenceInterval::allowed`]).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct Flags: u32 {
        /// Fewer than 8 passes: too few to estimate a variance.
        const FEW_PASSES = 1;
        /// Fewer than 32 photons in total.
        const FEW_PHOTONS = 1 << 1;
        /// The disc of the estimate extends over an edge to another surface.
        const OTHER_SURFACE = 1 << 2;
        /// Light has an edge within the disc: a shadow boundary, a fold of a caustic, the end of a surface.
        const UNEVEN = 1 << 3;
        /// A smaller radius gives another bias, by more than a factor of 2.
        const CURVED = 1 << 4;
        /// A few bright passes make up the value: effectively fewer than 4 passes, `(Σx)²/Σx²` for values x of passes. Their
        /// spread does not tell how bright and how frequent such passes are. Not set together with `FEW_PASSES`.
        const RARE = 1 << 5;
    }
}

/// Confidence interval of one pixel, W/(m²·sr), mean of RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: callers may write their own for `ErrorModel::new`.
pub struct ConfidenceInterval {
    /// Value of the pixel.
    pub value: f64,
    /// Standard error of the mean over passes; infinite before the second pass.
    pub standard_error: f64,
    /// Bias as estimated from a second radius; positive if the pixel is too bright.
    pub bias: f64,
    /// Standard error of the bias.
    pub bias_error: f64,
    /// What bounds of the bias add to twice its estimate; 0 where the estimate is sufficient. Of light that is at most a
    /// twentieth of the pixel, three times that light; at edges, a bound from the photons' distribution and from a smaller
    /// radius; where photons are few, the light that may have been missed.
    pub bounded: f64,
    /// Effective number of photons within the disc, over all passes: as many with equal power would have
    /// the same relative variance (Kish 1965).
    pub photons: f64,
    /// `noise + 2·|bias| + bounded`, where the first is Student's t for 95 % times the standard error, plus a
    /// correction for skewed noise: bounds the distance to the true value, which is the mean over the pixel. Infinite
    /// where there is no error estimate.
    pub half_width: f64,
    /// Why there is no error estimate.
    pub flags: Flags,
    /// Why the interval is wider than noise and bias: what [`ConfidenceInterval::bounded`] allows for. Empty where a bound of
    /// less than a twentieth of the light is sufficient.
    pub allowed: Flags,
}

/// Number of passes from which on errors are estimated. With fewer, stopping as soon as the error is small
/// enough would favour passes whose error happens to be underestimated: 92 instead of 95 % of the intervals
/// are right with 2 passes, 94 with 8.
const MIN_PASSES: u32 = 8;

/// The effective number of passes (Kish 1965), below which the spread of the passes is that of a few bright ones: as many
/// equal passes and otherwise black ones would have the same relative variance. It is below 4 where the relative standard
/// error is above 1/2, for many passes, or above 0.38 for 8 of them.
const MIN_EFFECTIVE_PASSES: f64 = 4.0;

/// The share of a pixel up to which light that may have been missed is bounded instead of flagged, where photons are few.
const SCARCE: f64 = 0.1;

/// Noise of photons over that of the bias that they show with a second radius, by the Epanechnikov kernel
/// ([`crate::Kernel::second_radius_noise`]); too large for other kernels, where less noise is taken to be skewed as strongly as
/// that of reflections.
const PHOTON_NOISE: f64 = 2.0;

/// The true value of such light is between 0 and 4 times its estimate: at an edge of a surface the disc is half
/// empty, at the corner of one with right angles three quarters of it; at an edge of light the estimate is at most
/// the brighter side.
const BOUND: f64 = 3.0;

impl ConfidenceInterval {
    /// With fewer photons, the distribution of the sums is too far from normal.
    pub const MIN_PHOTONS: f64 = 32.0;

    /// With fewer photons, the expected light may be more than twice what was found: 8 photons were drawn from a Poisson
    /// distribution with a mean of at most 15.8, by its 95 % interval.
    pub const MIN_BOUNDED_PHOTONS: f64 = 8.0;

    /// The share of a pixel up to which light without a bias estimate is bounded instead of flagged.
    pub const MINOR: f64 = 0.05;

    /// Why noise and bias alone are no error estimate, whether there is an interval or not. Error targets and forecasts are of
    /// the pixels without any but [`Flags::RARE`].
    #[must_use]
    pub fn reasons(&self) -> Flags {
        self.flags | self.allowed
    }
}

impl Film {
    /// Confidence interval of each pixel; `None` if error statistics are disabled, or not those of all pixels.
    ///
    /// Light that is estimated from photon maps has a bias, which is estimated at visible points and at the hits of
    /// final-gather rays. The latter are never treated as uneven, since their light comes from many places. Shadow rays have
    /// no bias. Where the estimate of the bias does not suffice, the interval contains a bound. A pixel is flagged instead if
    /// the light is unlike that beside a straight edge, or if more than a tenth of it may have been missed for lack of
    /// photons, unless such light is at most a twentieth of the pixel.
    #[must_use]
    pub fn confidence_intervals(&self) -> Option<Vec<ConfidenceInterval>> {
        let interval = self.interval()?;
        Some(parallel::collect(self.pixels.len(), interval))
    }

    /// The function that gives the confidence interval of a pixel.
    pub(crate) fn interval(&self) -> Option<impl Fn(usize) -> ConfidenceInterval + Sync + '_> {
        let errors = self.errors.as_ref().filter(|errors| errors.len() == self.pixels.len())?;
        let n = f64::from(self.passes.max(1));
        let quantile = student_975(n - 1.0);
        let to_user = self.units.radiance_to_user();
        // A surface without photons cannot be told from a dark one: if any pixel has photons, those whose
        // first surface can store photons have to have some too, and media in which shadow rays find light.
        let any = errors.iter().any(ErrorPixel::is_known);
        let is_asked = move |error: &ErrorPixel, pixel: &FilmPixel| {
            let sees_medium = pixel.hits == 0 && pixel.layers[Layer::Direct as usize].iter().any(|&light| light > 0.0);
            let sees_surface = pixel.hits > 0 && pixel.albedo.iter().any(|&a| a > 0.0);
            error.is_known() || (any && (sees_surface || sees_medium))
        };
        // Standard error of a mean of n numbers, from their sum and the sum of their squares.
        let standard_error = move |sum: f64, square: f64| {
            if self.passes < 2 { f64::INFINITY } else { ((square - sum * sum / n).max(0.0) / (n * (n - 1.0))).sqrt() }
        };
        let per_photon = PerMap::from_fn(|kind| self.light_per_photon(errors, kind));
        Some(move |index: usize| {
            let (pixel, error) = (&self.pixels[index], &errors[index]);
            let sum = pixel.layers.iter().flatten().sum::<f64>() / 3.0;
            let (bias, bias_error) = (error.bias / n, standard_error(error.bias, error.bias_square));
            let (half, half_error) = (error.narrow / n, standard_error(error.narrow, error.narrow_square));
            let noise = standard_error(sum, pixel.square);
            let photons: f64 = error.photon_moments.values().map(PhotonMoments::photons).sum();
            let mut flags = Flags::default();
            let few = photons < ConfidenceInterval::MIN_PHOTONS && is_asked(error, pixel);
            let mut doubtful = PerMap::splat(few);
            flags.set(Flags::FEW_PHOTONS, few);
            for (kind, moments) in error.photon_moments.iter() {
                flags.set(Flags::OTHER_SURFACE, flags.contains(Flags::OTHER_SURFACE) || moments.strays());
                flags.set(Flags::UNEVEN, flags.contains(Flags::UNEVEN) || moments.is_uneven());
                doubtful[kind] |= moments.strays() || moments.is_uneven();
            }
            let curved = differ(bias, bias_error, 2.0 * half, 2.0 * half_error);
            flags.set(Flags::CURVED, curved);
            let light = PerMap::from_fn(|kind| error.light(pixel, kind));
            // Light of maps whose bias is not known. Where it is a small part of the pixel, its error is small too.
            let unknown: f64 =
                doubtful.iter().filter(|(_, doubt)| curved || **doubt).map(|(kind, _)| light[kind]).sum();
            let (mut bounded, mut allowed) = (0.0, Flags::default());
            if unknown <= ConfidenceInterval::MINOR * sum && !(few && photons < ConfidenceInterval::MIN_BOUNDED_PHOTONS)
            {
                flags = Flags::default();
                bounded = BOUND * unknown / n;
            } else if few {
                let missed: f64 =
                    light.iter().map(|(kind, light)| error.missed(pixel, kind, *light, per_photon[kind])).sum();
                if missed <= SCARCE * sum {
                    bounded = missed / n;
                    (flags, allowed) = (allowed, flags);
                }
            } else if light
                .iter()
                .all(|(kind, light)| *light <= ConfidenceInterval::MINOR * sum || !error.photon_moments[kind].is_fold())
            {
                // Of the two estimates of the bias the larger, if it is so beyond the noise of the second.
                let larger = bias.abs().max(2.0 * half.abs() - 4.0 * half_error);
                let edge: f64 = light.iter().map(|(kind, light)| error.photon_moments[kind].edge_bound() * light).sum();
                bounded = (2.0 * larger).max(edge / n) - 2.0 * bias.abs();
                (flags, allowed) = (allowed, flags);
            }
            flags.set(Flags::FEW_PASSES, self.passes < MIN_PASSES);
            flags.set(Flags::RARE, self.passes >= MIN_PASSES && sum * sum < MIN_EFFECTIVE_PASSES * pixel.square);
            let half_width = if flags.is_empty() {
                let found: f64 = light.values().sum();
                let skew = skew(sum / n, noise, [found / n, PHOTON_NOISE * bias_error]);
                (noise_width(quantile, noise, skew) + 2.0 * bias.abs() + bounded) * to_user
            } else {
                f64::INFINITY
            };
            ConfidenceInterval {
                value: sum / n * to_user,
                standard_error: noise * to_user,
                bias: bias * to_user,
                bias_error: bias_error * to_user,
                bounded: bounded * to_user,
                photons,
                half_width,
                flags,
                allowed,
            }
        })
    }

    /// The light of a map that a photon contributes to a pixel, over its albedo; both are sums over passes. 0 if no
    /// photon was found.
    fn light_per_photon(&self, errors: &[ErrorPixel], kind: MapKind) -> f64 {
        let (light, photons) = self.pixels.iter().zip(errors).fold((0.0, 0.0), |(light, photons), (pixel, error)| {
            let found = error.photon_moments[kind].photons() * albedo(pixel);
            (light + error.light(pixel, kind), photons + found)
        });
        if photons > 0.0 { light / photons } else { 0.0 }
    }
}

/// Mean albedo of the first visible surface, a sum over passes.
fn albedo(pixel: &FilmPixel) -> f64 {
    pixel.albedo.iter().sum::<f64>() / 3.0
}

/// Whether one of two biases is more than twice the other, beyond 3 standard errors.
fn differ(a: f64, a_error: f64, b: f64, b_error: f64) -> bool {
    let more = |a: f64, a_error: f64, b: f64, b_error: f64| {
        a.abs() - 2.0 * b.abs() > 3.0 * (a_error * a_error + 4.0 * b_error * b_error).sqrt()
    };
    more(a, a_error, b, b_error) || more(b, b_error, a, a_error)
}
