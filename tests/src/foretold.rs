//! E9: what more passes bring is known where light is even, and so are chance and bias of foretelling it.

use photon_core::{Claim, Kernel, Prospect, Schedule, radius_squared_factor, student_975};

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

/// By which factor forecasts are too large on average, from pilots of 256 pixels, for two reasons.
///
/// The noise of the bias is taken from each pixel by itself, in units of that of the pixel: X, whose square is the ratio w
/// of two variances of ν = 7 degrees of freedom that correlate by r² = 9/16 (estimates and their differences from
/// those of twice the area correlate by r = −1/2 / √(4/3 · 1/3)). Its density is that of Bose (1935),
/// `(1−r²)^(ν/2) / B(ν/2, ν/2) · w^(ν/2−1) (1+w) / ((1+w)² − 4 r² w)^((ν+1)/2)`. Where X < 1, what the photons lack of the
/// noise is taken for noise that falls as the root of the passes.
///
/// And squared biases, less their noise, are known to `c = √((2 + 2/7)/256)` of that noise. If they are too large
/// by chance, they are taken for bias that stays: on average `c/√(2π)`, and two standard errors more at most, half of
/// which goes into the root. At most such bias falls as r^(3/2), not as r².
fn too_large(passes: u32) -> f64 {
    const STEPS: i32 = 160;
    let (bias, noise) = Schedule::of(PILOT, ALPHA).factors(passes);
    let (t, z) = quantiles(passes);
    let (nu, r2) = (f64::from(PILOT) - 1.0, 9.0 / 16.0);
    let other = (f64::from(PILOT) / f64::from(passes)).sqrt() / noise;
    // Steps of the logarithm of w; the factors that do not depend on w cancel.
    let part = |step: i32| {
        let w = (f64::from(step) / 16.0).exp();
        let density = w.powf(nu / 2.0 - 1.0) * (1.0 + w) / ((1.0 + w).powi(2) - 4.0 * r2 * w).powf((nu + 1.0) / 2.0);
        let photons = w.min(1.0);
        [density * w, t * (photons + (1.0 - photons) * other * other).sqrt(), w.sqrt()]
    };
    let wide = Mixture((-STEPS..=STEPS).map(part).collect()).quantile() / (t + z);
    let lucky = ((2.0 + 2.0 / nu) / PIXELS as f64).sqrt() * ((2.0 * std::f64::consts::PI).sqrt().recip() + 2.0);
    wide + z * 0.5 * lucky * (bias.powf(0.75) / noise).powi(2) / (t + z)
}

/// By how much the ends of a forecast may lie apart from what is known for noise alone: two standard errors of the noise
/// of all pixels. The mean of n logarithms of variances from ν = 7 degrees of freedom has the variance ψ'(ν/2)/n,
/// 0.330/256, and the root half its standard error.
fn doubt() -> f64 {
    2.0 * 0.5 * (0.330 / PIXELS as f64).sqrt()
}

/// Whether what is foretold for so many passes, over what is known, is 1 on average: not above at the least and not
/// below at the most, but by no more off than is known of forecasts too. `ratios` are both, of independent pilots that
/// know their mean to `√(s²/n)`.
fn is_foretold(ratios: &[Vec<f64>; 2], passes: u32) -> Result<(), String> {
    let bounds = [(1.0 - doubt(), 1.0), (1.0, too_large(passes) * (1.0 + doubt()))];
    for (ratios, (low, high)) in ratios.iter().zip(bounds) {
        let (mean, chance) = (moments(ratios).0, SIGMAS * standard_error(ratios));
        if !(low - chance..=high + chance).contains(&mean) {
            return Err(format!("{passes} passes: {mean} is not within {low} and {high}, known to {chance}"));
        }
    }
    Ok(())
}

/// Under even light, whose bias is 0, the passes that an error takes are known: 16 pilots of 256 pixels each, and a film
/// that has got there.
pub fn e9_what_an_error_takes_is_foretold<T: TestBackend>() {
    let mut on = T::make(2);
    let mut claims_of = |side: u32, passes: u32| {
        let (mut claims, trial) = (Vec::new(), Trial { passes, alpha: ALPHA, side, seed: 92 });
        let keep = &mut |film: photon_core::Film| claims = film.claims().unwrap();
        films_of(&mut on, &SMOOTH[0], &trial, &[passes], keep).unwrap();
        claims
    };
    let second = Kernel::Epanechnikov.second_radius_noise();
    // Pixels are independent, so that each 256 are a pilot by themselves.
    let claims = claims_of(64, PILOT);
    let pilots = |schedule: Schedule, factor: f64| -> Vec<Prospect> {
        let wrong = |claim: &Claim| Claim {
            standard_error: claim.standard_error * factor,
            bias: claim.bias * factor,
            bias_error: claim.bias_error * factor,
            ..*claim
        };
        let of = |claims: &[Claim]| claims.iter().map(wrong).collect::<Vec<_>>();
        claims.chunks(PIXELS).map(|claims| Prospect::new(&of(claims), schedule, SHARE, second).unwrap()).collect()
    };
    let ratios = |pilots: &[Prospect], passes: u32| {
        [Prospect::least_error_after, Prospect::error_after]
            .map(|end| pilots.iter().map(|pilot| end(pilot, passes) / known(passes)).collect::<Vec<_>>())
    };
    let schedule = Schedule::of(PILOT, ALPHA);
    let pilots_of_8 = pilots(schedule, 1.0);
    for passes in [64, 512, 4096] {
        is_foretold(&ratios(&pilots_of_8, passes), passes).unwrap();
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
        assert!(is_foretold(&ratios(&pilots(schedule, factor), 64), 64).is_err(), "{factor}");
    }
    assert!(is_foretold(&ratios(&pilots(Schedule::of(PILOT, 1.0), 1.0), 64), 64).is_err());

    // What has been reached after 24 passes is what was known, by the noise of each pixel: a variance from 23 degrees of
    // freedom has a relative one of 2/23, its root the quarter of that.
    let passes = 24;
    let now = Prospect::new(&claims_of(16, passes), Schedule::of(passes, ALPHA), SHARE, second).unwrap();
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
