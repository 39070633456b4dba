//! Confidence intervals of pixels: noise from the variance over passes, bias from a second radius, and
//! flags where neither is reliable.
//!
//! Stores sums, like the film, so that passes may be rendered anywhere and added. A variance from a sum of
//! squares in f64 loses its precision only where the standard deviation of a pass is below 10⁻⁷ of the
//! pixel.

use bitflags::bitflags;
use bytemuck::Zeroable;

use crate::film::Film;
use crate::parallel;
use crate::requirements::map_kind::{MapKind, PerMap};
use crate::scene::layout::{ErrorMoments, Estimate, Query};

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

/// Distribution of the photons of one map around a pixel's queries: sums of [`ErrorMoments`] with the
/// weights of the queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Zeroable)]
// Exhaustive: a backend must fill in every sum.
pub struct PhotonMoments {
    /// Σ power.
    pub power: f64,
    /// Σ of the squared powers.
    pub power_squared: f64,
    /// Σ power times the offset in the tangent plane.
    pub slope: [f64; 2],
    /// Σ power times the quadrupole of the offset.
    pub quadrupole: [f64; 2],
    /// Σ power of photons on other surfaces.
    pub stray: f64,
}

impl PhotonMoments {
    /// A photon farther from the query's plane than this fraction of the wide radius counts as lying on another
    /// surface: [`ErrorMoments::stray`].
    pub const OFF_PLANE: f32 = 0.25;

    fn add(&mut self, other: &Self) {
        self.power += other.power;
        self.power_squared += other.power_squared;
        for axis in 0..2 {
            self.slope[axis] += other.slope[axis];
            self.quadrupole[axis] += other.quadrupole[axis];
        }
        self.stray += other.stray;
    }

    /// Effective number of photons: as many with equal power would have the same relative variance (Kish
    /// 1965).
    fn photons(&self) -> f64 {
        if self.power_squared > 0.0 { self.power * self.power / self.power_squared } else { 0.0 }
    }

    /// Whether the disc extends to another surface, with more than a fiftieth of its light there.
    fn strays(&self) -> bool {
        self.stray > 0.02 * (self.power + self.stray)
    }

    /// Whether the light has an edge within the disc, which no second radius detects: an edge through the
    /// centre halves both estimates.
    ///
    /// Over a disc of radius R, the mean of x/R is at most 1/4 for any linear field that is nowhere
    /// negative, and 4/3π at a straight edge through the centre. The mean of the quadrupole is 0 for any
    /// linear field, with variance 1/6 for each of its two components, per photon: one in eighty pixels
    /// exceeds 3 standard errors by chance, and the flag also requires more than a twentieth.
    fn is_uneven(&self) -> bool {
        let photons = self.photons();
        if photons < 8.0 {
            return false;
        }
        let slope = libm::hypot(self.slope[0], self.slope[1]) / self.power;
        let quadrupole = libm::hypot(self.quadrupole[0], self.quadrupole[1]) / self.power;
        slope > 0.25 || (quadrupole > 0.05 && quadrupole > 3.0 * (1.0 / (6.0 * photons)).sqrt())
    }
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
    /// Reasons why a pixel has no error estimate; empty if it has one.
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
    /// Bound of the bias of light that has no bias estimate: three times that light, which is at most a twentieth of the
    /// pixel; 0 if there is none.
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
}

/// Number of passes from which on errors are estimated. With fewer, stopping as soon as the error is small
/// enough would favour passes whose error happens to be underestimated: 92 instead of 95 % of the intervals
/// are right with 2 passes, 94 with 8.
const MIN_PASSES: u32 = 8;

/// The effective number of passes (Kish 1965), below which the spread of the passes is that of a few bright ones: as many
/// equal passes and otherwise black ones would have the same relative variance. It is below 4 where the relative standard
/// error is above 1/2, for many passes, or above 0.38 for 8 of them.
pub(crate) const MIN_EFFECTIVE_PASSES: f64 = 4.0;

/// With fewer photons, the distribution of the sums is too far from normal.
pub(crate) const MIN_PHOTONS: f64 = 32.0;

/// With fewer photons, the expected light may be more than twice what was found: 8 photons were drawn from a Poisson
/// distribution with a mean of at most 15.8, by its 95 % interval.
const MIN_BOUNDED_PHOTONS: f64 = 8.0;

/// The share of a pixel up to which light without a bias estimate is bounded instead of flagged.
const MINOR: f64 = 0.05;

/// The true value of such light is between 0 and 4 times its estimate: at an edge of a surface the disc is half
/// empty, at the corner of one with right angles three quarters of it; at an edge of light the estimate is at most
/// the brighter side.
const BOUND: f64 = 3.0;

impl Film {
    /// Confidence interval of each pixel; `None` if error statistics are disabled, or not those of all pixels.
    ///
    /// A pixel is flagged if the bias of some of its light has no estimate and this light is more than a twentieth of it;
    /// of less light, the interval contains a bound.
    ///
    /// Light that is estimated from photon maps has a bias, which is estimated at visible points and at the
    /// hits of final-gather rays. The latter are never flagged as uneven, since their light comes from many
    /// places. Shadow rays have no bias.
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
        // first surface can store photons have to have some too.
        let any = errors.iter().any(ErrorPixel::is_known);
        let is_asked = move |error: &ErrorPixel, pixel: &crate::FilmPixel| {
            error.is_known() || (any && pixel.hits > 0 && pixel.albedo.iter().any(|&a| a > 0.0))
        };
        // Standard error of a mean of n numbers, from their sum and the sum of their squares.
        let standard_error = move |sum: f64, square: f64| {
            if self.passes < 2 { f64::INFINITY } else { ((square - sum * sum / n).max(0.0) / (n * (n - 1.0))).sqrt() }
        };
        Some(move |index: usize| {
            let (pixel, error) = (&self.pixels[index], &errors[index]);
            let sum = pixel.layers.iter().flatten().sum::<f64>() / 3.0;
            let (bias, bias_error) = (error.bias / n, standard_error(error.bias, error.bias_square));
            let (half, half_error) = (error.narrow / n, standard_error(error.narrow, error.narrow_square));
            let noise = standard_error(sum, pixel.square);
            let photons: f64 = error.photon_moments.values().map(PhotonMoments::photons).sum();
            let mut flags = Flags::default();
            let few = photons < MIN_PHOTONS && is_asked(error, pixel);
            let mut doubtful = PerMap::splat(few);
            flags.set(Flags::FEW_PHOTONS, few);
            for (kind, moments) in error.photon_moments.iter() {
                flags.set(Flags::OTHER_SURFACE, flags.contains(Flags::OTHER_SURFACE) || moments.strays());
                flags.set(Flags::UNEVEN, flags.contains(Flags::UNEVEN) || moments.is_uneven());
                doubtful[kind] |= moments.strays() || moments.is_uneven();
            }
            let curved = differ(bias, bias_error, 2.0 * half, 2.0 * half_error);
            flags.set(Flags::CURVED, curved);
            // Light of maps whose bias is not known. Where it is a small part of the pixel, its error is small too. A map
            // without photons gave none of its layer, which is of shadow rays then.
            let light = |kind: MapKind| match error.photon_moments[kind].power > 0.0 {
                true => pixel.layers[kind.layer() as usize].iter().sum::<f64>() / 3.0,
                false => 0.0,
            };
            let unknown: f64 =
                doubtful.iter().filter(|(_, doubt)| curved || **doubt).map(|(kind, _)| light(kind)).sum();
            let bounded = if unknown <= MINOR * sum && !(few && photons < MIN_BOUNDED_PHOTONS) {
                flags = Flags::default();
                BOUND * unknown / n
            } else {
                0.0
            };
            flags.set(Flags::FEW_PASSES, self.passes < MIN_PASSES);
            flags.set(Flags::RARE, self.passes >= MIN_PASSES && sum * sum < MIN_EFFECTIVE_PASSES * pixel.square);
            let half_width = if flags.is_empty() {
                (noise_width(quantile, noise, sum / n) + 2.0 * bias.abs() + bounded) * to_user
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
            }
        })
    }
}

/// Whether one of two biases is more than twice the other, beyond 3 standard errors.
fn differ(a: f64, a_error: f64, b: f64, b_error: f64) -> bool {
    let more = |a: f64, a_error: f64, b: f64, b_error: f64| {
        a.abs() - 2.0 * b.abs() > 3.0 * (a_error * a_error + 4.0 * b_error * b_error).sqrt()
    };
    more(a, a_error, b, b_error) || more(b, b_error, a, a_error)
}

/// Half width of the interval for the noise alone, of a mean of passes with this standard error: `quantile` of Student's t
/// times the error, plus the correction of Johnson (1978, "Modified t tests and confidence intervals for asymmetrical
/// populations") for a skewness γ of the n passes, γ(2t² + 1)/(6√n) times the error.
///
/// The skewness is taken as 4σ/μ, where σ and μ are deviation and mean of a pass: a gamma distribution has 2σ/μ, a
/// lognormal one 3σ/μ + (σ/μ)³. Then γ/√n is 4 times the relative standard error. Without the correction, intervals miss
/// pixels in which bright reflections are rare: too few were drawn, and the value and its error are both too small.
/// [`crate::ErrorModel`] leaves it out: it falls twice as fast as the error.
fn noise_width(quantile: f64, error: f64, mean: f64) -> f64 {
    let relative = if mean.abs() > 0.0 { error / mean.abs() } else { 0.0 };
    error * (quantile + SKEWNESS * relative * (2.0 * quantile * quantile + 1.0) / 6.0)
}

/// Skewness of the noise of a pass, over its relative deviation.
const SKEWNESS: f64 = 4.0;

/// The 97.5 % quantile of Student's t: the half-width of a 95 % interval in standard errors.
///
/// By its expansion in powers of 1/ν about the normal quantile (Fisher and Cornish 1960); the error is less
/// than 10⁻³ from 5 degrees of freedom on. Infinite below 1.
#[must_use]
pub fn student_975(freedom: f64) -> f64 {
    const Z: f64 = 1.959_963_984_540_054;
    if !(freedom >= 1.0) {
        return f64::INFINITY;
    }
    let z2 = Z * Z;
    let terms = [
        (z2 + 1.0) / 4.0,
        ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
        ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) / 92_160.0,
    ];
    let series = terms.iter().rev().fold(0.0, |sum, term| (sum + term) / freedom);
    Z * (1.0 + series)
}
