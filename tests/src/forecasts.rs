//! E9: in uniform light the error after more passes is known, and so are noise and bias of its forecast.

use photon_core::{ConfidenceInterval, ErrorModel, Kernel, Schedule, radius_squared_factor, student_975};

use crate::fields::{EXPECTED, SMOOTH, Trial, films_of};
use crate::harness::TestBackend;
use crate::stats::{SIGMAS, moments, standard_error};

const ALPHA: f64 = 2.0 / 3.0;

/// Passes before the forecast.
const FORECAST_PASSES: u32 = 8;

/// Pixels per forecast.
const PIXELS: usize = 256;

/// Fraction of the pixels whose error is bounded.
const SHARE: f64 = 0.95;

/// Half-width of a pixel's confidence interval after `passes` passes, in standard errors of the pixel: the quantile
/// of Student's t for the noise, and the quantile of a normal distribution for the bias that a second radius
/// measures where there is none.
///
/// For the Epanechnikov kernel that bias has half the noise of the pixel ([`Kernel::second_radius_noise`]), and
/// counts twice.
fn quantiles(passes: u32) -> (f64, f64) {
    (student_975(f64::from(passes) - 1.0), 1.96)
}

/// The half-width that 95 % of the pixels should have, relative to the truth. An estimate has the variance
/// R(K)/(λr²) of A6, that is 4/3 over the expected number of photons; the mean of n passes has the sum of their
/// variances over n².
fn known(passes: u32) -> f64 {
    let inverse: f64 = (0..passes).map(|pass| radius_squared_factor(pass, ALPHA).recip()).sum();
    let (t, z) = quantiles(passes);
    (4.0 / 3.0 / EXPECTED * inverse).sqrt() / f64::from(passes) * (t + z)
}

/// A mixture of half-widths `certain + chance·|z|`, with z normally distributed, and the weight of each component.
struct Mixture(Vec<[f64; 3]>);

impl Mixture {
    /// The fraction of half-widths up to `bound`.
    fn within(&self, bound: f64) -> f64 {
        let share = |[share, certain, chance]: &[f64; 3]| share * normal_within((bound - certain) / chance);
        self.0.iter().map(share).sum::<f64>() / self.0.iter().map(|[share, ..]| share).sum::<f64>()
    }

    /// The half-width below which 95 % lie, by bisection.
    fn quantile(&self) -> f64 {
        let (mut low, mut high) = (0.0, 20.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            *(if self.within(middle) < SHARE { &mut low } else { &mut high }) = middle;
        }
        high
    }

    /// Standard error of that quantile estimated from `PIXELS` pixels: `√(p (1−p)/n)` over the density there.
    fn error(&self) -> f64 {
        let (at, step) = (self.quantile(), 0.01);
        let density = (self.within(at + step) - self.within(at - step)) / (2.0 * step);
        (SHARE * (1.0 - SHARE) / PIXELS as f64).sqrt() / density
    }
}

/// The probability of a normal distribution within ±z; Simpson's rule, accurate to 10⁻⁶.
fn normal_within(z: f64) -> f64 {
    const STEPS: u32 = 32;
    let step = z.clamp(0.0, 8.0) / f64::from(STEPS);
    let weight = |i: u32| if i == 0 || i == STEPS { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
    let sum: f64 = (0..=STEPS).map(|i| weight(i) * (-0.5 * (f64::from(i) * step).powi(2)).exp()).sum();
    sum * step / 3.0 * (2.0 / std::f64::consts::PI).sqrt()
}

/// The expected ratio of a forecast's lower bound to the known error: the lower bound takes the noise two standard
/// errors below its estimate. The logarithm of a variance with 7 degrees of freedom has variance ψ′(7/2) = 0.3304;
/// that of the noise is half as large.
fn least_of() -> f64 {
    (-(0.3304 / PIXELS as f64).sqrt()).exp()
}

/// Checks that the lower bound of forecasts, divided by the known error, has the expected mean. `ratios` are
/// independent, so the standard error of their mean is `√(s²/n)`. Chance correlations between neighbours, whose
/// square is 1/256, and the quantile of a sample contribute less than a hundredth.
fn is_forecast(ratios: &[f64]) -> Result<(), String> {
    let (mean, chance) = (moments(ratios).0, SIGMAS * standard_error(ratios) + 0.01);
    let (low, high) = (least_of() - chance, least_of() + chance);
    if (low..=high).contains(&mean) { Ok(()) } else { Err(format!("{mean} is not within {low} and {high}")) }
}

/// In uniform light, where the bias is 0, the number of passes for a given error is known: 16 pilots of 256 pixels
/// each, and a film that has reached its error.
pub fn e9_what_an_error_takes_is_foretold<T: TestBackend>() {
    let mut on = T::make(2);
    let mut claims_of = |side: u32, passes: u32| {
        let (mut intervals, trial) = (Vec::new(), Trial { passes, alpha: ALPHA, side, seed: 92 });
        let keep = &mut |film: photon_core::Film| intervals = film.confidence_intervals().unwrap();
        films_of(&mut on, &SMOOTH[0], &trial, &[passes], keep).unwrap();
        intervals
    };
    let second = Kernel::Epanechnikov.second_radius_noise();
    // Pixels are independent, so every 256 of them form a pilot.
    let intervals = claims_of(64, FORECAST_PASSES);
    let pilots = |schedule: Schedule, factor: f64| -> Vec<ErrorModel> {
        let wrong = |interval: &ConfidenceInterval| ConfidenceInterval {
            standard_error: interval.standard_error * factor,
            bias: interval.bias * factor,
            bias_error: interval.bias_error * factor,
            ..*interval
        };
        let of = |intervals: &[ConfidenceInterval]| intervals.iter().map(wrong).collect::<Vec<_>>();
        intervals
            .chunks(PIXELS)
            .map(|intervals| ErrorModel::new(&of(intervals), schedule, SHARE, second).unwrap())
            .collect()
    };
    let ratios = |pilots: &[ErrorModel], passes: u32| -> Vec<f64> {
        pilots.iter().map(|pilot| pilot.least_error_after(passes) / known(passes)).collect()
    };
    let schedule = Schedule::of(FORECAST_PASSES, ALPHA);
    let pilots_of_8 = pilots(schedule, 1.0);
    for passes in [64, 512, 4096] {
        is_forecast(&ratios(&pilots_of_8, passes)).unwrap();
        // The true error exceeds the forecast's upper bound, which includes a possible bias, for at most one pilot
        // in 44 (two standard errors of the noise): for 6 or more of 16 by chance less than once in a million.
        let beyond = pilots_of_8.iter().filter(|pilot| pilot.error_after(passes) < known(passes)).count();
        assert!(beyond < 6, "{beyond} of 16 forecasts are too low");
        // Conversely, the error is reached after that many passes. The search ends when the next candidate is the
        // next integer or within half a percent.
        let pilot = &pilots_of_8[0];
        let target = known(passes);
        let forecast = pilot.forecast(Some(target), 1.0, 1 << 20);
        let least = forecast.passes_least.unwrap();
        let before = (f64::from(least) / 1.005).floor().min(f64::from(least - 1)) as u32;
        assert!(pilot.least_error_after(least) <= target && pilot.least_error_after(before) > target, "{least}");
        assert!(forecast.passes_needed.unwrap() >= least);
    }
    // Negative control: noise too small or too large by a quarter, and a schedule that ignores that radii shrink.
    for factor in [0.75, 1.25] {
        assert!(is_forecast(&ratios(&pilots(schedule, factor), 64)).is_err(), "{factor}");
    }
    assert!(is_forecast(&ratios(&pilots(Schedule::of(FORECAST_PASSES, 1.0), 1.0), 64)).is_err());

    // The error reached after 24 passes is the known one, up to the noise of each pixel's estimate: a variance with
    // 23 degrees of freedom has a relative variance of 2/23, its square root a quarter of that.
    let passes = 24;
    let now = ErrorModel::new(&claims_of(16, passes), Schedule::of(passes, ALPHA), SHARE, second).unwrap();
    let (t, z) = quantiles(passes);
    let spread = (0.5 / (f64::from(passes) - 1.0)).sqrt();
    let part = |step: i32| {
        let away = f64::from(step) / 8.0;
        [(-0.5 * away * away).exp(), t * (1.0 + away * spread), 1.0]
    };
    let claimed = Mixture((-40..=40).map(part).collect());
    let away = now.error() / known(passes) * (t + z) - claimed.quantile();
    assert!(away.abs() <= SIGMAS * claimed.error(), "{away}, standard error {}", claimed.error());
    assert!((0.75 * claimed.quantile() - claimed.quantile()).abs() > SIGMAS * claimed.error());
}
