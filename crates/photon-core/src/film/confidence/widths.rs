//! Half widths of intervals for noise alone.

/// Half width for the noise of a mean of passes with this standard error: `quantile` of Student's t for 95 % times the error,
/// plus the correction of Johnson (1978, "Modified t tests and confidence intervals for asymmetrical populations") for a
/// skewness γ of the n passes, γ(2t² + 1)/(6√n) times the error; `skew` is γ/√n.
///
/// Without the correction, intervals miss pixels in which bright reflections are rare: too few were drawn, and the value and
/// its error are both too small. [`crate::ErrorModel`] leaves it out: it falls twice as fast as the error.
pub(super) fn noise_width(quantile: f64, error: f64, skew: f64) -> f64 {
    error * (quantile + skew * (2.0 * quantile * quantile + 1.0) / 6.0)
}

/// The skewness of the mean of passes with this value and standard error, of which photons contribute `photons`: their mean
/// and standard error. Third central moments add.
///
/// For photons in equal number everywhere the Epanechnikov kernel gives a skewness of 9/8 times the relative error. All other
/// noise is taken to have 4 times: a gamma distribution with deviation σ and mean μ has 2σ/μ, a lognormal one 3σ/μ + (σ/μ)³.
pub(super) fn skew(value: f64, error: f64, photons: [f64; 2]) -> f64 {
    let [light, scatter] = photons.map(f64::abs);
    let scatter = if light > 0.0 { scatter.min(error) } else { 0.0 };
    let third = |error: f64, mean: f64| if mean > 0.0 { error.powi(4) / mean } else { 0.0 };
    let rest = (error * error - scatter * scatter).max(0.0).sqrt();
    let sum = PHOTON_SKEWNESS * third(scatter, light) + SKEWNESS * third(rest, value.abs());
    if sum > 0.0 && error.is_finite() { sum / error.powi(3) } else { 0.0 }
}

/// Skewness of the noise of a pass, over its relative deviation; and that of photons.
const SKEWNESS: f64 = 4.0;
const PHOTON_SKEWNESS: f64 = 9.0 / 8.0;

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
