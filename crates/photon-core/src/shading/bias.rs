//! The bias of an estimate, as estimated from two other radii.
//!
//! Bias grows as r², so that an estimate over twice the area has twice the bias.

use crate::scene::layout::{ErrorMoments, Estimate};

impl ErrorMoments {
    /// The bias of `estimate` as estimated from the two other radii, in units of its flux: the estimate
    /// over twice the area minus `estimate`, and `estimate` minus the one over half the area. To be divided
    /// by π r² and the number of paths.
    #[must_use]
    pub fn biases(&self, estimate: &Estimate) -> ([f64; 3], [f64; 3]) {
        let flux = estimate.flux.map(f64::from);
        let wide = std::array::from_fn(|c| 0.5 * f64::from(self.wide[c]) - flux[c]);
        (wide, std::array::from_fn(|c| flux[c] - 2.0 * f64::from(self.narrow[c])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The irradiance `1 + b r²` has the bias `b r²`: the first difference is once this, the second half of it.
    #[test]
    fn a_bias_that_grows_with_the_area_is_found() {
        for bias in [-0.25_f32, 0.0, 0.5] {
            let flux = |area: f32| [area * (1.0 + bias * area); 3];
            let estimate = Estimate { flux: flux(1.0), radius_squared: 1.0, photons: 9, ..Estimate::default() };
            let moments = ErrorMoments { wide: flux(2.0), narrow: flux(0.5), photons: 9, ..ErrorMoments::default() };
            let bias = f64::from(bias);
            assert_eq!(moments.biases(&estimate), ([bias; 3], [0.5 * bias; 3]));
        }
    }
}
