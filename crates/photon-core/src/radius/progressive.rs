//! Radii that shrink from pass to pass.

/// The factor on the squared radius of pass `index` (from 0) for `alpha` in `(0, 1]`.
///
/// Knaus and Zwicker 2011, equation 20 in closed form: `r²ₙ/r²₁ = Π_{j=1}^{n−1} (j+α)/(j+1) =
/// Γ(n+α) / (Γ(1+α) n!)` with `n = index + 1`. A function of the index alone, so that passes are
/// independent of each other and of where they run.
#[must_use]
pub fn radius_squared_factor(index: u32, alpha: f64) -> f64 {
    // Up to this index the product is exact, and as fast as the two logarithms.
    const DIRECT: u32 = 64;
    let product =
        |from: u32, to: u32| -> f64 { (from..to).map(|j| (f64::from(j) + alpha) / (f64::from(j) + 1.0)).product() };
    if index <= DIRECT {
        return product(1, index + 1);
    }
    // Γ(n+α)/Γ(n+1) by the asymptotic series of the quotient about n + α/2, continued from the product at
    // DIRECT, where the constant Γ(1+α) cancels (Tricomi and Erdélyi 1951, equation 13).
    let quotient = |n: f64| {
        let w = n + alpha / 2.0;
        let first = -(alpha - 1.0) * (alpha - 2.0) * alpha / (24.0 * w * w);
        libm::exp((alpha - 1.0) * libm::log(w) + first)
    };
    let n = f64::from(index) + 1.0;
    product(1, DIRECT + 1) * quotient(n) / quotient(f64::from(DIRECT) + 1.0)
}

/// The sum of the squared radii of `passes` passes, divided by that of the first: the bias of their sum is
/// proportional to it. `Σ fₙ = ((N + α) f_N − 1)/α`, since `Σ Γ(n+α)/n!` telescopes.
#[must_use]
pub fn radius_squared_sum(passes: u32, alpha: f64) -> f64 {
    let Some(last) = passes.checked_sub(1) else { return 0.0 };
    ((f64::from(passes) + alpha) * radius_squared_factor(last, alpha) - 1.0) / alpha
}

/// The sum of the reciprocals: the variance of their sum is proportional to it. `Σ 1/fₙ = ((N + 1)/f_N −
/// α)/(2 − α)`, likewise.
#[must_use]
pub fn inverse_radius_squared_sum(passes: u32, alpha: f64) -> f64 {
    let Some(last) = passes.checked_sub(1) else { return 0.0 };
    ((f64::from(passes) + 1.0) / radius_squared_factor(last, alpha) - alpha) / (2.0 - alpha)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_table() {
        for (passes, factor) in [(1, 1.0), (10, 0.508_516), (100, 0.238_389), (1000, 0.110_761), (10_000, 0.051_415_8)]
        {
            let got = radius_squared_factor(passes - 1, 2.0 / 3.0);
            assert!((got - factor).abs() < 1e-6, "{passes}: {got}");
        }
    }

    #[test]
    fn the_series_continues_the_product() {
        for alpha in [0.1, 0.5, 2.0 / 3.0, 0.9, 1.0] {
            let product: f64 = (1..=5000).map(|j| (f64::from(j) + alpha) / (f64::from(j) + 1.0)).product();
            let got = radius_squared_factor(5000, alpha);
            assert!((got / product - 1.0).abs() < 1e-6, "{alpha}: {got} {product}");
        }
    }

    #[test]
    fn alpha_one_keeps_the_radius() {
        assert_eq!(radius_squared_factor(0, 1.0), 1.0);
        assert!((radius_squared_factor(100_000, 1.0) - 1.0).abs() < 1e-12);
    }

    /// Means of squared radii, and variances per photon of the first pass, after Knaus and Zwicker.
    #[test]
    fn sums_are_the_published_means() {
        for (passes, mean, variance) in [
            (1, 1.0, 1.0),
            (10, 0.663_625, 0.157_237),
            (100, 0.344_967, 0.031_725_8),
            (10_000, 0.076_978_8, 0.001_458_84),
        ] {
            let n = f64::from(passes);
            let got =
                (radius_squared_sum(passes, 2.0 / 3.0) / n, inverse_radius_squared_sum(passes, 2.0 / 3.0) / n / n);
            assert!((got.0 / mean - 1.0).abs() < 1e-5 && (got.1 / variance - 1.0).abs() < 1e-5, "{passes}: {got:?}");
        }
        assert!(
            (radius_squared_sum(7, 1.0) - 7.0).abs() < 1e-12
                && (inverse_radius_squared_sum(7, 1.0) - 7.0).abs() < 1e-12
        );
        assert_eq!(radius_squared_sum(0, 0.5), 0.0);
    }
}
