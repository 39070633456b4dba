//! E9: what more passes bring is known where light is even, and so are chance and bias of foretelling it.

use photon_core::{ConfidenceInterval, ErrorModel, Kernel, Schedule, radius_squared_factor, student_975};

use crate::fields::{EXPECTED, SMOOTH, Trial, films_of};
use crate::harness::TestBackend;
use crate::stats::{SIGMAS, moments, standard_error};

const ALPHA: f64 = 2.0 / 3.0;

/// Passes of the pilot.
const PILOT: u32 = 8;

/// Pixels that a forecast is made of.
const PIXELS: usize = 256;

/// Share of the pixels whose error is looked at.
const SHARE: f64 = 0.95;

/// What a pixel claims after so many passes: the quantile of Student's t, and that of a normal distribution for the
/// bias that a second radius tells where there is none, in standard errors of the pixel.
///
/// For Epanechnikov's kernel that bias is half as noisy as the pixel ([`Kernel::second_radius_noise`]), and counts
/// twice.
fn quantiles(passes: u32) -> (f64, f64) {
    (student_975(f64::from(passes) - 1.0), 1.96)
}

/// The error that 95 % of the pixels should claim, as a fraction of the truth. An estimate has the variance R(K)/(λr²)
/// of A6, 4/3 over the photons expected, and the mean of n passes that of theirs over n.
fn known(passes: u32) -> f64 {
    let inverse: f64 = (0..passes).map(|pass| radius_squared_factor(pass, ALPHA).recip()).sum();
    let (t, z) = quantiles(passes);
    (4.0 / 3.0 / EXPECTED * inverse).sqrt() / f64::from(passes) * (t + z)
}

/// Claims of `certain + chance·|z|`, z normally distributed, each with its share of the pixels.
struct Mixture(Vec<[f64; 3]>);

impl Mixture {
    /// The share of claims up to `bound`.
    fn within(&self, bound: f64) -> f64 {
        let share = |[share, certain, chance]: &[f64; 3]| share * normal_within((bound - certain) / chance);
        self.0.iter().map(share).sum::<f64>() / self.0.iter().map(|[share, ..]| share).sum::<f64>()
    }

    /// The claim that 95 % are within, by halving intervals.
    fn quantile(&self) -> f64 {
        let (mut low, mut high) = (0.0, 20.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            *(if self.within(middle) < SHARE { &mut low } else { &mut high }) = middle;
        }
        high
    }

    /// Standard error of that from so many pixels: `√(p (1−p)/n)` over the density there.
    fn error(&self) -> f64 {
        let (at, step) = (self.quantile(), 0.01);
        let density = (self.within(at + step) - self.within(at - step)) / (2.0 * step);
        (SHARE * (1.0 - SHARE) / PIXELS as f64).sqrt() / density
    }
}

/// The share of a normal distribution within ±z; Simpson's rule, to 10⁻⁶.
fn normal_within(z: f64) -> f64 {
    const STEPS: u32 = 32;
    let step = z.clamp(0.0, 8.0) / f64::from(STEPS);
    let weight = |i: u32| if i == 0 || i == STEPS { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
    let sum: f64 = (0..=STEPS).map(|i| weight(i) * (-0.5 * (f64::from(i) * step).powi(2)).exp()).sum();
    sum * step / 3.0 * (2.0 / std::f64::consts::PI).sqrt()
}

/// What a forecast at least is of what is known: noise is taken for two standard errors less than told. The logarithm of a
/// variance of 7 degrees of freedom has the variance ψ′(7/2) = 0.3304; that of noise is a half as large.
fn least_of() -> f64 {
    (-(0.3304 / PIXELS as f64).sqrt()).exp()
}

/// Whether what is foretold at least for so many passes, over what is known, is that on average; `ratios` are
/// independent, and know their mean to `√(s²/n)`. Neighbours that seem to share their luck by chance, correlations of
/// which the square is 1/256, and the quantile of a sample are within a hundredth.
fn is_forecast(ratios: &[f64]) -> Result<(), String> {
    let (mean, chance) = (moments(ratios).0, SIGMAS * standard_error(ratios) + 0.01);
    let (low, high) = (least_of() - chance, least_of() + chance);
    if (low..=high).contains(&mean) { Ok(()) } else { Err(format!("{mean} is not within {low} and {high}")) }
}

/// Under even light, whose bias is 0, the passes that an error takes are known: 16 pilots of 256 pixels each, and a film
/// that has got there.
pub fn e9_what_an_error_takes_is_foretold<T: TestBackend>() {
    let mut on = T::make(2);
    let mut claims_of = |side: u32, passes: u32| {
        let (mut intervals, trial) = (Vec::new(), Trial { passes, alpha: ALPHA, side, seed: 92 });
        let keep = &mut |film: photon_core::Film| intervals = film.confidence_intervals().unwrap();
        films_of(&mut on, &SMOOTH[0], &trial, &[passes], keep).unwrap();
        intervals
    };
    let second = Kernel::Epanechnikov.second_radius_noise();
    // Pixels are independent, so that each 256 are a pilot by themselves.
    let intervals = claims_of(64, PILOT);
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
    let schedule = Schedule::of(PILOT, ALPHA);
    let pilots_of_8 = pilots(schedule, 1.0);
    for passes in [64, 512, 4096] {
        is_forecast(&ratios(&pilots_of_8, passes)).unwrap();
        // Truth is beyond the most, which a bias that may be there raises, no more often than one pilot in 44 by two
        // standard errors of the noise: of 16, 6 or more by chance less than once in a million.
        let beyond = pilots_of_8.iter().filter(|pilot| pilot.error_after(passes) < known(passes)).count();
        assert!(beyond < 6, "{beyond} of 16 foretell too little");
        // Seen from the other side: that error is reached after so many passes. They are searched for until the next that
        // is tried is the next at all, or within a half percent.
        let pilot = &pilots_of_8[0];
        let target = known(passes);
        let forecast = pilot.forecast(Some(target), 1.0, 1 << 20);
        let least = forecast.passes_least.unwrap();
        let before = (f64::from(least) / 1.005).floor().min(f64::from(least - 1)) as u32;
        assert!(pilot.least_error_after(least) <= target && pilot.least_error_after(before) > target, "{least}");
        assert!(forecast.passes_needed.unwrap() >= least);
    }
    // What must fail does: noise too small or too large by a quarter, and radii that are not known to shrink.
    for factor in [0.75, 1.25] {
        assert!(is_forecast(&ratios(&pilots(schedule, factor), 64)).is_err(), "{factor}");
    }
    assert!(is_forecast(&ratios(&pilots(Schedule::of(PILOT, 1.0), 1.0), 64)).is_err());

    // What has been reached after 24 passes is what was known, by the noise of each pixel: a variance from 23 degrees of
    // freedom has a relative one of 2/23, its root the quarter of that.
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
    assert!(away.abs() <= SIGMAS * claimed.error(), "{away}, known to {}", claimed.error());
    assert!((0.75 * claimed.quantile() - claimed.quantile()).abs() > SIGMAS * claimed.error());
}
