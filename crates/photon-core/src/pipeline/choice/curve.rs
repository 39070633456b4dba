//! Values as powers of the factor on radii, between and beyond those that are measured.

/// A curve through values that are measured for several factors, by powers between them and beyond.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// Factor and value, both > 0, by increasing factor.
    pub(super) points: Vec<[f64; 2]>,
    /// Least and greatest exponent.
    pub(super) exponents: [f64; 2],
    /// The exponent below the least factor, if that is known; else that of the first two points.
    pub(super) below: Option<f64>,
}

impl Curve {
    pub(super) fn at(&self, factor: f64) -> f64 {
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
