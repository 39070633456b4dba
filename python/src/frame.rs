//! The frame in which points of f64 are searched in f32: recentred, and scaled by a power of two.
//!
//! Distances in the frame are known within a bound. A search in f32 for a slightly larger radius therefore finds all
//! points within a radius, and exact distances, in f64, decide among them.

/// Coordinates beyond this are refused, so that differences are finite.
pub(crate) const MAX_COORDINATE: f64 = 1e300;

/// A query farther from the centre than this many half sides of the points' box is answered without the index, since in
/// f32 all points are equally far from it.
const FAR: f64 = 1_048_576.0;

/// The position and the size of points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    center: [f64; 3],
    /// A power of two; points are within `[-1, 1]` in the frame.
    scale: f64,
}

/// A query in a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    pub(crate) at: [f64; 3],
    /// Position for the search in f32; `None` if it is too far away for it.
    pub(crate) rounded: Option<[f32; 3]>,
    /// Factor on differences of coordinates, a power of two, against overflow and underflow of their squares.
    pub(crate) scale: f64,
    /// Bound on the error of distances of rounded positions.
    slack: f64,
}

impl Frame {
    /// The frame of points, whose coordinates are finite and at most [`MAX_COORDINATE`].
    pub(crate) fn new(points: &[[f64; 3]]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for point in points {
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        if points.is_empty() {
            return Self { center: [0.0; 3], scale: 1.0 };
        }
        let center: [f64; 3] = std::array::from_fn(|axis| 0.5 * low[axis] + 0.5 * high[axis]);
        let side = |axis: usize| (high[axis] - center[axis]).max(center[axis] - low[axis]);
        let half = side(0).max(side(1)).max(side(2));
        Self { center, scale: if half > 0.0 { reciprocal_power(half) } else { 1.0 } }
    }

    /// The factor from lengths to lengths in the frame, a power of two.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// A point in the frame, rounded.
    pub(crate) fn rounded(&self, point: &[f64; 3]) -> [f32; 3] {
        std::array::from_fn(|axis| ((point[axis] - self.center[axis]) * self.scale) as f32)
    }

    /// A query, whose coordinates are finite and at most [`MAX_COORDINATE`].
    pub(crate) fn probe(&self, at: [f64; 3]) -> Probe {
        let away = (0..3).map(|axis| (at[axis] - self.center[axis]).abs()).fold(0.0, f64::max);
        let local = away * self.scale;
        if local > FAR {
            return Probe { at, rounded: None, scale: reciprocal_power(away), slack: 0.0 };
        }
        // Coordinates are rounded by at most 2⁻²⁴ of their size; √3 of that, and what squares of f32 lose to underflow.
        let slack = 1.8 * 2_f64.powi(-24) * (1.0 + local) + 2_f64.powi(-58);
        Probe { at, rounded: Some(self.rounded(&at)), scale: self.scale, slack }
    }
}

/// Relative error of squared distances in f32, of roots, and a margin.
const ROUNDING: f64 = 1e-6;

impl Probe {
    /// Squared distance of a point, scaled.
    #[inline]
    pub(crate) fn distance_squared(&self, point: &[f64; 3]) -> f64 {
        let [x, y, z]: [f64; 3] = std::array::from_fn(|axis| (self.at[axis] - point[axis]) * self.scale);
        // The order of scipy, so that distances have the same bits.
        x * x + y * y + z * z
    }

    /// Squared radius in f32 that includes all points whose scaled distance is at most `radius`.
    pub(crate) fn outer(&self, radius: f64) -> f32 {
        let radius = (radius + self.slack) * (1.0 + ROUNDING);
        ((radius * radius * (1.0 + ROUNDING)) as f32).next_up()
    }

    /// Squared radius in f32 that includes only points whose scaled distance is below `radius`; negative if there are none.
    pub(crate) fn inner(&self, radius: f64) -> f32 {
        let radius = (radius - self.slack) * (1.0 - ROUNDING);
        if radius > 0.0 { ((radius * radius * (1.0 - ROUNDING)) as f32).next_down() } else { -1.0 }
    }

    /// Whether all points whose squared distance in f32 is at least `rounded` are farther than the scaled squared distance
    /// `exact`.
    pub(crate) fn is_beyond(&self, rounded: f32, exact: f64) -> bool {
        f64::from(rounded).sqrt() * (1.0 - ROUNDING) - self.slack > exact.sqrt() * (1.0 + ROUNDING)
    }
}

/// A power of two whose product with `size`, above 0, is at most 1 and, unless `size` is extreme, at least 1/2.
fn reciprocal_power(size: f64) -> f64 {
    let exponent = (size.to_bits() >> 52) as i32 - 1023;
    2_f64.powi(-(exponent.clamp(-1000, 1000) + 1))
}
