//! Means, standard errors, and comparisons based on them.

/// Tolerance in standard errors: about 7 false alarms per million tests.
pub const SIGMAS: f64 = 4.5;

/// Mean and unbiased variance.
#[must_use]
pub fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, variance)
}

/// Standard error of the mean of independent values: `√(s²/n)`.
#[must_use]
pub fn standard_error(values: &[f64]) -> f64 {
    (moments(values).1 / values.len() as f64).sqrt()
}

/// Whether `found` is within 4.5 standard errors, plus a non-random tolerance `bound`, of `truth`.
#[must_use]
pub fn agrees(found: f64, truth: f64, error: f64, bound: f64) -> bool {
    (found - truth).abs() <= SIGMAS * error + bound
}

/// Asserts [`agrees`].
///
/// # Panics
/// If they do not agree; the message contains all numbers.
pub fn assert_agrees(what: &str, found: f64, truth: f64, error: f64, bound: f64) {
    assert!(
        agrees(found, truth, error, bound),
        "{what}: {found} instead of {truth}; z = {:.2}, bound {bound}",
        (found - truth) / error
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_known_values() {
        assert_eq!(moments(&[1.0, 2.0, 3.0, 4.0]), (2.5, 5.0 / 3.0));
        assert!((standard_error(&[1.0, 2.0, 3.0, 4.0]) - (5.0_f64 / 12.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn the_comparison_fails_where_it_must() {
        assert!(agrees(1.0, 1.4, 0.1, 0.0));
        assert!(!agrees(1.0, 1.5, 0.1, 0.0));
        assert!(agrees(1.0, 1.5, 0.1, 0.1));
        assert!(!agrees(f64::NAN, 1.0, 0.1, 0.1) && !agrees(1.0, 1.0, f64::NAN, 0.1));
    }

    #[test]
    #[should_panic(expected = "instead of")]
    fn a_wrong_value_panics() {
        assert_agrees("x", 2.0, 1.0, 0.1, 0.0);
    }
}
