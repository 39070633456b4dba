//! The distribution of the photons around a pixel's queries, and what it says about the bias of their estimate.

use bytemuck::Zeroable;

use super::BOUND;

/// The mean offset beside a straight edge through the centre: the centroid of half a disc.
const EDGE_OFFSET: f64 = 4.0 / (3.0 * std::f64::consts::PI);

/// Calibrated in the fields of the test suite, at edges between 0 and 0.9 radii away.
const EDGE_MARGIN: f64 = 1.15;

/// Distribution of the photons of one map around a pixel's queries: sums of [`crate::ErrorMoments`] with the
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
    /// surface: [`crate::ErrorMoments::stray`].
    pub const OFF_PLANE: f32 = 0.25;

    /// With fewer photons, their distribution is not known.
    pub const MIN_PHOTONS: f64 = 8.0;

    /// The largest share of the light that may lie on other surfaces.
    pub const MAX_STRAY: f64 = 0.02;

    /// The largest mean offset in a linear field, over the radius of the disc.
    pub const MAX_OFFSET: f64 = 0.25;

    /// The largest mean quadrupole of even light, in the same unit, squared.
    pub const MAX_QUADRUPOLE: f64 = 0.05;

    pub(super) fn add(&mut self, other: &Self) {
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
    pub(super) fn photons(&self) -> f64 {
        if self.power_squared > 0.0 { self.power * self.power / self.power_squared } else { 0.0 }
    }

    /// Whether the disc extends to another surface, with more than a fiftieth of its light there.
    pub(super) fn strays(&self) -> bool {
        self.stray > Self::MAX_STRAY * (self.power + self.stray)
    }

    /// Whether the light has an edge within the disc, which no second radius detects: an edge through the
    /// centre halves both estimates.
    ///
    /// Over a disc of radius R, the mean of x/R is at most 1/4 for any linear field that is nowhere
    /// negative, and 4/3π at a straight edge through the centre. The mean of the quadrupole is 0 for any
    /// linear field, with variance 1/6 for each of its two components, per photon: one in eighty pixels
    /// exceeds 3 standard errors by chance, and the flag also requires more than a twentieth.
    pub(super) fn is_uneven(&self) -> bool {
        self.photons() >= Self::MIN_PHOTONS
            && (self.offset() > Self::MAX_OFFSET || self.has_quadrupole(Self::MAX_QUADRUPOLE))
    }

    /// Whether the light is unlike that beside any straight edge: a fold of a caustic, a line, a corner, or the dark side of
    /// an edge, where nothing bounds the error.
    ///
    /// With a straight edge at distance d from the centre, mean offset and quadrupole are, in units of R, (0.42, 0) at d = 0,
    /// (0.31, 0.07) at 0.2, (0.24, 0.087) at 0.35 and less beyond, and (0.48, 0.05) at 0.1 on the dark side; less for an edge
    /// between two lights. Folds have a quadrupole of about 0.16.
    pub(super) fn is_fold(&self) -> bool {
        let most = (0.03 + 0.5 * (self.offset() - EDGE_OFFSET).abs()).min(0.09);
        self.photons() >= Self::MIN_PHOTONS && self.has_quadrupole(most)
    }

    /// Bound of the bias at an edge within the disc, as a multiple of the estimate; 0 if there is none.
    ///
    /// The bias is 0.15, 0.34, 0.6, 0.85 and 1 times the estimate at a straight edge on whose bright side the mean offset is
    /// 0.25, 0.31, 0.37, 0.41 and 0.42 of R; which is about the cube of its ratio to 4/3π. Averages over pixels and radii need
    /// the margin. On the dark side all of the estimate is bias; in the corner of an area of light it is up to 3 times that.
    pub(super) fn edge_bound(&self) -> f64 {
        let offset = self.offset();
        if self.photons() < Self::MIN_PHOTONS || offset <= Self::MAX_OFFSET {
            return 0.0;
        }
        (EDGE_MARGIN * (offset / EDGE_OFFSET).powi(3)).min(BOUND)
    }

    /// Length of the mean offset of the photons, over the wide radius.
    fn offset(&self) -> f64 {
        libm::hypot(self.slope[0], self.slope[1]) / self.power
    }

    /// Whether the mean of the quadrupole is longer than this, and not by chance.
    fn has_quadrupole(&self, most: f64) -> bool {
        let length = libm::hypot(self.quadrupole[0], self.quadrupole[1]) / self.power;
        length > most && length > 3.0 * (1.0 / (6.0 * self.photons())).sqrt()
    }
}
