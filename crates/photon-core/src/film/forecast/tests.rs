//! Forecasts for known errors.

use super::group::normal_quantile;
use super::*;
use crate::random::{Domain, Sampler};
use crate::settings::RandomKind;

fn intervals(noise: f64, bias: f64, bias_error: f64) -> Vec<ConfidenceInterval> {
    let interval = ConfidenceInterval {
        value: 2.0,
        standard_error: 2.0 * noise,
        bias: 2.0 * bias,
        bias_error: 2.0 * bias_error,
        bounded: 0.0,
        photons: 1000.0,
        half_width: 1.0,
        flags: Flags::default(),
        allowed: Flags::default(),
    };
    let mut intervals = vec![interval; 90];
    intervals.extend(vec![ConfidenceInterval { flags: Flags::UNEVEN, half_width: f64::INFINITY, ..interval }; 10]);
    // Alternating signs, so that neighbours are not correlated.
    intervals.iter_mut().step_by(2).for_each(|interval| interval.bias *= -1.0);
    intervals
}

fn model_of(intervals: &[ConfidenceInterval], passes: u32, alpha: f64) -> Option<ErrorModel> {
    ErrorModel::new(intervals, Schedule::of(passes, alpha), 0.95, 0.5)
}

#[test]
fn radii_go_to_where_noise_and_bias_balance() {
    let best =
        |bias: f64, noise: f64| model_of(&intervals(noise, bias, 0.5 * noise), 8, 1.0).unwrap().best_scale(10_000);
    // Noise alone gives the largest factor, a bias that is far above it the smallest.
    assert_eq!((best(0.05, 0.1), best(1.0, 0.01)), (2.0, 0.25));
    // Squared noise falls by 1250/c; the systematic part of the bias has a square of 0.0032 c². They
    // balance at c³ = 1/1250/(2·0.0032) = 1/8.
    assert!((best(0.2532_f64.sqrt(), 1.0) - 0.5).abs() < 1e-9);
}

#[test]
fn errors_fall_as_the_cube_root_of_passes() {
    let model = model_of(&intervals(0.1, 0.1, 0.05), 1000, 2.0 / 3.0).unwrap();
    assert!((model.error() - (student_975(999.0) * 0.1 + 0.2)).abs() < 1e-12);
    let least = ErrorModel::least_error_after;
    let half = f64::from(model.passes_until(least(&model, 1000) / 2.0, least).unwrap());
    assert!((half / 8000.0 - 1.0).abs() < 0.1, "{half}");
    // By the upper bound, a bias without noise falls as the fourth root.
    let biased = model_of(&intervals(0.0, 0.1, 0.0), 100_000, 2.0 / 3.0).unwrap();
    for (of, power) in [(ErrorModel::error_after as fn(&ErrorModel, u32) -> f64, 0.25), (least, 1.0 / 3.0)] {
        let half = f64::from(biased.passes_until(0.1, of).unwrap());
        assert!((half / 100_000.0 / 2.0_f64.powf(1.0 / power) - 1.0).abs() < 0.05, "{half} {power}");
    }
    assert!((model.forecast(None, 1.0, 9).claimed - 0.9).abs() < 1e-12);
}

#[test]
fn noise_alone_at_a_fixed_radius_falls_as_the_square_root() {
    let model = model_of(&intervals(0.1, 0.05, 0.05), 1000, 1.0).unwrap();
    let half = f64::from(model.passes_until(model.error_after(1000) / 2.0, ErrorModel::error_after).unwrap());
    assert!((half / 4000.0 - 1.0).abs() < 0.02, "{half}");
    // A bias that does not decrease is a lower limit.
    let floor = model_of(&intervals(0.1, 0.05, 0.0), 1000, 1.0).unwrap();
    assert_eq!(floor.passes_until(0.09, ErrorModel::error_after), None);
    assert_eq!(floor.passes_until(10.0, ErrorModel::error_after), Some(1000));
}

/// Equal pixels, whose noise and bias as measured by 8 passes differ only by chance: 95 % of them end up
/// within 1.96 standard errors for the noise, plus twice 1.96 of half as much for the bias.
///
/// After 8 passes it is uncertain whether there is a bias. With b for the noise of a pixel's bias, the mean
/// of bias² minus its variance is 0 with a standard error of τ = b² √((2 + 2/7)/4000): the square of a
/// normal deviate has variance 2, a χ² of 7 degrees divided by 7 has 2/7. After 100 times the passes at the
/// same radius, noise is 1/10 and the bias unchanged, so that a bias² of z τ predicts the error times (1 +
/// √(1 + 100 z τ/b²))/2. Two standard errors are added or subtracted, noise is known within 1/√(2·7·4000),
/// and the quantile within 1 %: the true value lies between the bounds, except for 0.05 of the pilots by
/// the former and 0.05 by the latter.
#[test]
fn luck_of_the_pilot_is_not_foretold() {
    const PILOTS: usize = 32;
    let tau = ((2.0 + 2.0 / 7.0) / 4000.0_f64).sqrt();
    let highest = |z: f64| 0.5 * (1.0 + (1.0 + 100.0 * z * tau).sqrt());
    let slack = 6.5 / (2.0 * 7.0 * 4000.0_f64).sqrt() + 0.01;
    let (mut within, mut off) = (0, 0);
    for pilot in 0..PILOTS {
        let intervals: Vec<ConfidenceInterval> = (0..4000).map(|pixel| told_by_chance(pilot * 4000 + pixel)).collect();
        let model = model_of(&intervals, 8, 1.0).unwrap();
        let truth = 2.0 * student_975(799.0) * 0.01;
        let (least, most) = (model.least_error_after(800) / truth, model.error_after(800) / truth);
        assert!(least > 1.0 - slack && least < highest(2.5) + slack, "{pilot}: {least}");
        assert!(most > 1.0 - slack && most < highest(6.5) + slack, "{pilot}: {most}");
        within += usize::from(least <= 1.01 && most >= 0.99);
        // Without the correction for chance, pixels with large deviates predict a bias that does not exist.
        let alone = intervals.iter().map(|c| 2.0 * (c.bias * c.bias - c.bias_error * c.bias_error).max(0.0).sqrt());
        let mut alone: Vec<f64> = alone.collect();
        alone.sort_by(f64::total_cmp);
        assert!(alone[3800] / truth > highest(6.5) + slack, "{}", alone[3800]);
        // Neighbours with the same photons count as one pixel: treating them as independent would be too
        // confident.
        let shared: Vec<ConfidenceInterval> =
            intervals.iter().step_by(40).flat_map(|interval| [*interval; 40]).collect();
        let shared = model_of(&shared, 8, 1.0).unwrap();
        off += usize::from(shared.least_error_after(800) / truth > 1.01 || shared.error_after(800) / truth < 0.99);
        assert!(shared.error_after(800) / shared.least_error_after(800) > 1.5 * most / least);
    }
    // Binomial: of 32 at 0.9, 4.5 √(32·0.9·0.1) fewer than 28.8.
    let few = 4.5 * (32.0 * 0.9 * 0.1_f64).sqrt();
    assert!(within as f64 >= 28.8 - few && (off as f64) <= 3.2 + few, "{within} within, {off} off, of {PILOTS}");
}

/// A pixel with noise 0.1 and no bias, as measured by 8 passes.
fn told_by_chance(pixel: usize) -> ConfidenceInterval {
    let mut sampler = Sampler::new(RandomKind::Counter, 5, 0, Domain::Gather, pixel as u32);
    let mut normal = |index: u32| {
        let [word, ..] = sampler.words(index);
        normal_quantile((f64::from(word) + 0.5) / 4_294_967_296.0)
    };
    let draws: Vec<f64> = (0..8).map(&mut normal).collect();
    let mean = draws.iter().sum::<f64>() / 8.0;
    let spread = (draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 7.0).sqrt();
    ConfidenceInterval {
        value: 1.0,
        standard_error: 0.1 * spread,
        bias: 0.05 * normal(8),
        bias_error: 0.05 * spread,
        bounded: 0.0,
        photons: 1000.0,
        half_width: 1.0,
        flags: Flags::default(),
        allowed: Flags::default(),
    }
}

/// 90 pixels with an error of 0.4 that have an estimate, and 10 with four times that, which are included
/// with a share of 1 − √b where bias falls as b, or once they have enough photons: as soon as they are a
/// twentieth of all, 95 % of the pixels are no longer within the error of the others.
#[test]
fn pixels_at_edges_join_in_as_radii_shrink() {
    let of = |flags: Flags, photons: f64| joining(flags, photons, 4.0);
    let schedule = Schedule::of(8, 2.0 / 3.0);
    // 10 (1 − √b) are a twentieth of themselves plus 90 where √b is 1 − 0.45/0.95.
    let join = (8..100_000).find(|&passes| schedule.factors(passes).0.sqrt() < 1.0 - 0.45 / 0.95).unwrap();
    for flag in EDGES {
        let model = of(flag, 1000.0);
        let over = |passes| model.error_after(passes) / model.least_error_after(passes);
        assert!(over(join - 1) < 2.0 && over(join + 1) > 3.5, "{} {}", over(join - 1), over(join + 1));
        let forecast = model.forecast(Some(model.least_error_after(2 * join)), 1.0, 3 * join);
        assert!(forecast.may_be_reached() && !forecast.is_reachable(), "{forecast:?}");
    }
    // 16 photons have doubled as soon as passes times squared radii have: before 32 passes.
    let model = of(Flags::FEW_PHOTONS, 16.0);
    let over = |passes| model.error_after(passes) / model.least_error_after(passes);
    assert!(over(16) < 1.5 && over(32) > 3.5, "{} {}", over(16), over(32));
    // And pixels without photons are never included.
    let never = of(Flags::FEW_PHOTONS, 0.0).error_after(1 << 20);
    assert!(never / model.least_error_after(1 << 20) < 3.0, "{never}");
}

/// Pixels with rare light take part in a target with the error that they have; without them it would be reached.
#[test]
fn rare_pixels_are_part_of_the_target() {
    let mut rare = intervals(0.1, 0.0, 0.0);
    rare.truncate(90);
    for interval in rare.iter_mut().take(9) {
        (interval.flags, interval.standard_error) = (Flags::RARE, 1.6);
    }
    let (all, others) = (model_of(&rare, 8, 1.0).unwrap(), model_of(&rare[9..], 8, 1.0).unwrap());
    assert!((all.error() - 8.0 * others.error()).abs() < 1e-12, "{} {}", all.error(), others.error());
}

/// 100 pixels, of which 10 have `times` the error of the others, and these flags.
fn joining(flags: Flags, photons: f64, times: f64) -> ErrorModel {
    let mut intervals = intervals(0.1, 0.1, 0.0);
    for interval in intervals.iter_mut().filter(|interval| !interval.flags.is_empty()) {
        (interval.flags, interval.photons) = (flags, photons);
        (interval.standard_error, interval.bias) = (times * interval.standard_error, times * interval.bias);
    }
    model_of(&intervals, 8, 2.0 / 3.0).unwrap()
}

/// Pixels that only lack photons are predicted to be included, and may have smaller errors than those with
/// an estimate: of 95 pixels, 5 and 85 with small errors, the 95 % quantile becomes that of the 85. Pixels
/// with an edge within the disc are not predictable.
#[test]
fn pixels_that_lack_photons_can_be_the_better_ones() {
    let mut few = intervals(0.1, 0.1, 0.0);
    for interval in few.iter_mut().skip(4) {
        (interval.standard_error, interval.bias) = (0.1 * interval.standard_error, 0.1 * interval.bias);
        (interval.flags, interval.photons) = (Flags::FEW_PHOTONS, 16.0);
    }
    let ratio = |intervals: &[ConfidenceInterval], passes| {
        let (whole, alone) =
            (model_of(intervals, 8, 2.0 / 3.0).unwrap(), model_of(&intervals[..4], 8, 2.0 / 3.0).unwrap());
        whole.least_error_after(passes) / alone.least_error_after(passes)
    };
    // 16 photons, less a standard error of 4, are 32 when passes times squared radii are 8/3 of what they
    // were.
    assert!(ratio(&few, 16) > 0.9 && ratio(&few, 64) < 0.2, "{} {}", ratio(&few, 16), ratio(&few, 64));
    for lost in [Flags::UNEVEN, Flags::FEW_PHOTONS] {
        let mut none = few.clone();
        let flagged = none.iter_mut().filter(|interval| !interval.flags.is_empty());
        flagged.for_each(|interval| {
            (interval.flags, interval.photons) = (lost, if lost == Flags::UNEVEN { 16.0 } else { 1.0 })
        });
        assert!(ratio(&none, 16) > 0.9, "{lost:?}");
    }
}

/// A target that is met, missed again as pixels are included, and finally met counts as met at the first
/// time if it stays so until the number of passes has doubled: nothing in between is evaluated.
#[test]
fn the_first_time_counts() {
    let model = model_of(&intervals(0.1, 0.0, 0.0), 8, 1.0).unwrap();
    let wave = |_: &ErrorModel, passes: u32| if (20..25).contains(&passes) || passes > 1000 { 0.1 } else { 1.0 };
    let found = model.passes_until(0.15, wave).unwrap();
    assert!(found > 1000 && found < 1010, "{found}");
    let wide = |_: &ErrorModel, passes: u32| if (20..200).contains(&passes) || passes > 1000 { 0.1 } else { 1.0 };
    assert_eq!(model.passes_until(0.15, wide), Some(20));
    assert_eq!(model.passes_until(0.15, |_, _| 1.0), None);
}

#[test]
fn quantiles_of_the_normal_distribution() {
    for (p, z) in [(0.5, 0.0), (0.975, 1.959_964), (0.025, -1.959_964), (0.999, 3.090_232)] {
        assert!((normal_quantile(p) - z).abs() < 5e-4, "{p}: {}", normal_quantile(p));
    }
}

#[test]
fn nothing_claimed_is_nothing_foretold() {
    let none: Vec<ConfidenceInterval> =
        intervals(0.1, 0.0, 0.0).iter().map(|c| ConfidenceInterval { flags: Flags::FEW_PASSES, ..*c }).collect();
    assert!(model_of(&none, 7, 1.0).is_none() && model_of(&[], 7, 1.0).is_none());
}
