//! Forecasts from made-up trials with known noise and bias.

use super::super::bias::{BIAS_EXPONENT, CORRELATED, HIDDEN, MAX_BIAS_SQUARED, reference, standard_error};
use super::*;

const PIXELS: usize = 4096;

/// Independent numbers with mean 0 and variance 1, from a counter.
fn noise(stream: u64) -> impl Iterator<Item = f64> {
    (0..PIXELS as u64).map(move |i| {
        let uniform = |part: u64| {
            let mut word = (stream << 40) ^ (i << 8) ^ part;
            for _ in 0..3 {
                word = (word ^ (word >> 31)).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x1234_5678_9abc_def1);
            }
            ((word >> 11) as f64) / (1_u64 << 53) as f64
        };
        // Twelve uniform numbers have the variance 1.
        (0..12).map(uniform).sum::<f64>() - 6.0
    })
}

/// Pixels of 1 with a relative noise of 0.2 over the factor, and a bias of `bias` times its square.
fn trial(area: Area, factor: f64, bias: f64, stream: u64) -> Trial {
    let pass = |stream: u64| noise(stream).map(|x| 1.0 + bias * factor * factor + 0.2 / factor * x).collect();
    Trial { area, factor, passes: [pass(2 * stream), pass(2 * stream + 1)], seconds: 0.25 * factor * factor }
}

#[test]
fn curves_are_powers_between_points_and_beyond() {
    let curve =
        Curve { points: [0.5, 1.0, 2.0].map(|x: f64| [x, 3.0 * x * x]).to_vec(), exponents: [0.0, 4.0], below: None };
    for factor in [0.25_f64, 0.5, 0.7, 1.0, 1.9, 2.0, 5.0] {
        assert!((curve.at(factor) / (3.0 * factor * factor) - 1.0).abs() < 1e-12, "{factor}");
    }
    let known = Curve { below: Some(1.0), ..curve.clone() };
    assert!((known.at(0.25) - 0.375).abs() < 1e-12 && (known.at(0.7) / 3.0 / 0.49 - 1.0).abs() < 1e-12);
    let flat = Curve { exponents: [-2.0, 0.0], ..curve };
    assert!((flat.at(0.25) - 0.75).abs() < 1e-12 && (flat.at(5.0) - 12.0).abs() < 1e-12, "exponents are limited");
    let one = Curve { points: vec![[1.0, 7.0]], exponents: [-2.0, 2.0], below: None };
    assert_eq!([one.at(0.5), one.at(3.0)], [7.0; 2]);
    assert_eq!(Curve { points: Vec::new(), exponents: [0.0; 2], below: None }.at(1.0), 0.0);
}

/// Variance and squared bias are recovered from two passes, within 4.5 standard errors, also of trials with areas of another
/// kind than the reference: there the bias is that of the reference's kind, and what is added.
#[test]
fn errors_are_those_of_noise_and_bias() {
    let factors = [0.7, 1.4, 2.0];
    let trials = |area, bias, first| {
        (first..).zip(factors).map(|(stream, factor)| trial(area, factor, bias, stream)).collect::<Vec<_>>()
    };
    let (surface, disc) = (trials(Area::Surface, 0.06, 10), trials(Area::Disc, 0.1, 20));
    let reference = reference(&surface);
    let weights = vec![1.0; PIXELS];
    let direct = [noise(90).map(|x| 0.3 * x).collect(), noise(91).map(|x| 0.3 * x).collect()];
    let variance_of = |factor: f64| 0.04 / (factor * factor);
    // The product of two differences with the variance σ² and the mean b of each has the variance σ⁴ + 2 b² σ². The
    // reference is 4/3 of the trial with the factor 0.7, less 1/3 of that with 1.4; both may be correlated with the
    // trial, which at most adds their standard deviations.
    let deviation = |bias: f64, parts: &[(f64, f64)]| {
        let each = parts.iter().map(|(part, factor)| part * variance_of(*factor).sqrt()).sum::<f64>().powi(2);
        (each * each + 2.0 * bias * bias * each).sqrt()
    };
    for (trials, bias) in [(&surface, 0.06_f64), (&disc, 0.1)] {
        let all: Vec<&Trial> = trials.iter().collect();
        let model = Model::new(&all, &reference, variance(&direct, &weights), &weights, ([0.25, 0.5], 0.0), 1.0);
        for factor in [1.4, 2.0] {
            let passes = 100.0;
            let seconds = 0.75 + 0.25 * factor * factor;
            let [pass, error, direct] = model.forecast(1.0, factor, passes * seconds + 1e-9);
            let error = error - model.bias.hidden(factor);
            assert!((pass - seconds).abs() < 1e-12);
            // The mean of half of a squared difference has the relative standard error √(2/n).
            let z = (direct * passes / 0.09 - 1.0) / (2.0 / PIXELS as f64).sqrt();
            assert!(z.abs() < 4.5, "{direct}: z = {z}");
            // Of the power through two points, each has this weight at the factor.
            let power = |factor: f64| factor.powf(BIAS_EXPONENT);
            let whole = power(1.4).powi(2) + power(2.0).powi(2);
            let (mut common, mut spread) = (0.0, 0.0);
            for at in [1.4, 2.0] {
                let (weight, bias) = (power(factor) * power(at) / whole, 0.06 * at * at);
                common += weight * bias * bias;
                spread += weight * deviation(bias, &[(1.0, at), (4.0 / 3.0, 0.7), (1.0 / 3.0, 1.4)]);
            }
            let (own, base) = (bias * factor * factor, 0.06 * factor * factor);
            if bias > 0.06 {
                let parts = [(1.0, factor), (4.0 / 3.0, 0.7), (1.0 / 3.0, 1.4)];
                spread += deviation(own, &parts) + deviation(base, &parts);
            }
            let (variance, others) = (variance_of(factor), 0.09_f64);
            let expected = (variance + others) / passes + common + own * own - base * base;
            let noise = 2.0 * (variance.powi(2) + others.powi(2)) / passes.powi(2);
            let z = (error - expected) / ((noise + spread * spread) / PIXELS as f64).sqrt();
            assert!(z.abs() < 4.5, "{factor}: {error} for {expected}, z = {z}");
        }
    }
}

/// What two passes without bias leave uncertain counts in full at the greatest radius and is as its fourth power: after many
/// passes, the least radius is the best.
#[test]
fn bias_may_be_hidden_by_noise() {
    let trials = [0.7, 1.4, 2.0].map(|factor| trial(Area::Surface, factor, 0.0, (factor * 10.0) as u64));
    let all: Vec<&Trial> = trials.iter().collect();
    let (reference, weights) = (reference(&trials), vec![1.0; PIXELS]);
    let model = Model::new(&all, &reference, 0.0, &weights, ([0.25, 0.5], 0.0), 1.0);
    let product =
        |i: usize| -> f64 { (0..2).map(|pass| trials[2].passes[pass][i] - reference.passes[pass][i]).product() };
    let products: Vec<f64> = (0..PIXELS).map(|i| product(i).clamp(-MAX_BIAS_SQUARED, MAX_BIAS_SQUARED)).collect();
    let expected = HIDDEN * standard_error(&products);
    assert!(expected > 0.0 && (model.bias.hidden(2.0) / expected - 1.0).abs() < 1e-9, "{expected}");
    assert!((model.bias.hidden(2.0) / model.bias.hidden(1.0) - 16.0).abs() < 1e-9);
    let errors = [0.5, 0.7, 1.0, 1.4, 2.0].map(|factor| model.forecast(1.0, factor, 1e9)[1]);
    assert!(errors.is_sorted() && errors[4] >= expected, "{errors:?}");
}

/// The standard error of independent numbers is σ/√n, and that of numbers that are the same 64 times is 8 times as large.
#[test]
fn standard_errors_are_those_of_means() {
    let independent: Vec<f64> = noise(7).collect();
    let same: Vec<f64> = (0..PIXELS).map(|i| independent[i / CORRELATED]).collect();
    let root = (PIXELS as f64).sqrt();
    // From 64 means, whose spread has the relative standard error 1/√(2·63).
    for (values, expected) in [(&independent, 1.0 / root), (&same, 8.0 / root)] {
        let z = (standard_error(values) / expected - 1.0) * (2.0_f64 * 63.0).sqrt();
        assert!(z.abs() < 4.5, "{z}");
    }
    assert_eq!(standard_error(&[1.0; 64]), 0.0);
}

/// Variance 3 + 8/rays, and 5 + 2 rays seconds; more noise with more rays is not believed.
#[test]
fn more_gather_rays_have_less_noise_and_take_longer() {
    let of = |rays: u32| [3.0 + 8.0 / f64::from(rays), 5.0 + 2.0 * f64::from(rays)];
    for rays in [1, 2, 4, 16] {
        let found = with_gather_rays([(1, of(1)), (4, of(4))], rays);
        assert!(found.iter().zip(of(rays)).all(|(found, expected)| (found - expected).abs() < 1e-12), "{found:?}");
    }
    assert_eq!(with_gather_rays([(1, [1.0, 2.0]), (4, [1.5, 1.0])], 16), [1.5, 1.0]);
    assert_eq!(with_gather_rays([(1, [9.0, 1.0]), (4, [1.0, 4.0])], 16), [0.25, 16.0]);
}

/// Four times the paths: discs with half of the radius contain as many photons, and have less bias.
#[test]
fn more_paths_make_smaller_discs() {
    let trials = [0.7, 1.4, 2.0].map(|factor| Trial {
        passes: [vec![1.0 + 0.1 * factor * factor; PIXELS], vec![1.0 + 0.1 * factor * factor; PIXELS]],
        ..trial(Area::Surface, factor, 0.0, 0)
    });
    let all: Vec<&Trial> = trials.iter().collect();
    let model = Model::new(&all, &reference(&trials), 0.0, &vec![1.0; PIXELS], ([0.25, 0.5], 0.0), 1.0);
    let ([once, coarse, _], [more, fine, _]) = (model.forecast(1.0, 1.4, 1e9), model.forecast(4.0, 1.4, 1e9));
    assert!((more - once - 3.0 * 0.5).abs() < 1e-12, "{more} {once}");
    // The power through 0.01 · 1.4⁴ at 1.4 and 0.01 · 2⁴ at 2.
    let power = |factor: f64| factor.powf(BIAS_EXPONENT);
    let products = 0.01 * (1.4_f64.powi(4) * power(1.4) + 16.0 * power(2.0));
    let expected = power(1.4) * products / (power(1.4).powi(2) + power(2.0).powi(2));
    assert!((coarse / expected - 1.0).abs() < 1e-6, "{coarse} {expected}");
    assert!((coarse / fine / power(2.0) - 1.0).abs() < 1e-6, "{fine}");
}

/// A single point that is thirty times too bright does not decide.
#[test]
fn outliers_of_the_bias_are_limited() {
    let flat = [0.7, 1.4]
        .map(|factor| Trial { passes: [vec![1.0; PIXELS], vec![1.0; PIXELS]], ..trial(Area::Surface, factor, 0.0, 0) });
    let [least, mut trial] = flat;
    trial.passes.iter_mut().for_each(|pass| pass[7] = 30.0);
    let trials = [least, trial];
    let all: Vec<&Trial> = trials.iter().collect();
    let model = Model::new(&all, &reference(&trials), 0.0, &vec![1.0; PIXELS], ([0.25, 0.5], 0.0), 1.0);
    // Without the limit it would be (4/3 · 29)² times as much.
    let [_, error, _] = model.forecast(1.0, 1.4, 1e9);
    // One of the means deviates, so that the standard error is the mean itself.
    assert!((error * PIXELS as f64 / MAX_BIAS_SQUARED - (1.0 + HIDDEN)).abs() < 1e-6, "{error}");
}

/// Bias at edges of light, of the same size within reach of the radius, is forecast as a seventh to all of its mean square, also
/// at far smaller radii than those that are tried: a part of it is in the reference too. By the difference of the
/// trial that was extrapolated it would be a twentieth, with the factor 0.7.
#[test]
fn bias_of_edges_does_not_vanish() {
    let bias = |factor: f64| -> Vec<f64> {
        (0..PIXELS).map(|i| 1.0 + 0.1 * (1.0 - 3.0 * i as f64 / PIXELS as f64 / factor).max(0.0)).collect()
    };
    let trials = [0.7, 1.4, 2.0]
        .map(|factor| Trial { passes: [bias(factor), bias(factor)], ..trial(Area::Surface, factor, 0.0, 0) });
    let all: Vec<&Trial> = trials.iter().collect();
    let model = Model::new(&all, &reference(&trials), 0.0, &vec![1.0; PIXELS], ([0.25, 0.5], 0.0), 1.0);
    for factor in [0.3, 0.7, 1.4, 2.0] {
        let expected = mean(&bias(factor).iter().map(|value| (value - 1.0).powi(2)).collect::<Vec<_>>());
        let ratio = model.bias.squared(factor) / expected;
        assert!((0.14..1.0).contains(&ratio), "{factor}: {ratio}");
    }
}

/// More passes make the larger radius worse than the smaller one: its bias remains.
#[test]
fn with_time_bias_matters_more() {
    let trials = [0.7, 1.4, 2.0].map(|factor| trial(Area::Surface, factor, 0.03, (factor * 10.0) as u64));
    let all: Vec<&Trial> = trials.iter().collect();
    let model = Model::new(&all, &reference(&trials), 0.0, &vec![1.0; PIXELS], ([0.25, 0.5], 0.0), 1.0);
    let error = |factor: f64, seconds: f64| model.forecast(1.0, factor, seconds)[1];
    assert!(error(2.0, 2.0) < error(0.7, 2.0) && error(2.0, 1e4) > error(0.7, 1e4));
}

/// With radii per pixel: the time of estimates with the greatest radius, and a part of the least error with as many passes.
#[test]
fn radii_per_pixel_have_fewer_passes_and_a_smaller_error_of_each() {
    let trials = [0.7, 1.4, 2.0].map(|factor| trial(Area::Surface, factor, 0.03, (factor * 10.0) as u64));
    let all: Vec<&Trial> = trials.iter().collect();
    let weights = vec![1.0; PIXELS];
    // Of the 0.25 · 2² seconds of the greatest radius, 0.1 are for camera paths.
    let model = Model::new(&all, &reference(&trials), 0.5, &weights, ([0.25, 0.5], 0.1), 1.0);
    let expected = |more: f64| 0.25 + more * 0.5 + 0.1 + 1.35 * 0.9;
    let factors = [0.5, 0.7, 1.0, 1.4, 2.0];
    for (gain, more, passes, gained) in [
        (GAIN_OF_CAUSTICS, 1.0, 4.0, 1.0),
        (GAIN_OF_CAUSTICS, 1.0, 20.0, 0.8),
        (GAIN_OF_CAUSTICS, 1.0, 100.0, 0.63),
        (GAIN_OF_CAUSTICS, 4.0, 400.0, 0.345),
        (GAIN_WITHOUT_CAUSTICS, 1.0, 100.0, 1.4),
        (GAIN_WITHOUT_CAUSTICS, 4.0, 400.0, 0.625),
    ] {
        let [pass, error, others] = model.forecast_per_pixel(more, &factors, passes * expected(more), gain);
        assert!((pass / expected(more) - 1.0).abs() < 1e-9 && (others * passes / 0.5 - 1.0).abs() < 1e-9);
        let shared = factors.map(|factor| model.by_photons(more, factor, passes as u32));
        let least = shared.into_iter().fold(f64::INFINITY, f64::min);
        let part = (error - others) / least;
        assert!((part - gained).abs() < 1e-9 && least > 0.0, "{part}");
    }
}

#[test]
fn dark_pixels_weigh_no_more_than_a_hundred_times_the_mean() {
    let trial = Trial { area: Area::Disc, factor: 1.0, passes: [vec![0.0, 1.0], vec![0.0, 2.0]], seconds: 1.0 };
    let weights = weights(&trial, &[0.0, 0.5]);
    // The mean radiance of the passes is 0.75 and 1.25.
    let weight = |radiance: f64, mean: f64| (radiance * radiance + 0.01 * mean * mean).recip();
    let expected = [[0.0, 0.0], [1.5, 2.5]].map(|[one, two]| 0.5 * (weight(one, 0.75) + weight(two, 1.25)));
    assert_eq!(weights, expected);
    assert!(super::weights(&Trial { passes: [vec![0.0], vec![0.0]], ..trial }, &[0.0])[0].is_finite());
}

/// The noise of the trial that is the reference, and that weights are taken from, is not measured as bias: pixels with each pair of
/// signs have the mean 0. Weights of the mean of both passes would make 3/2 n⁴ of it to the lowest order, with the relative
/// noise n of a pass, times (4/3)² since the reference is extrapolated.
#[test]
fn noise_is_not_bias() {
    let relative = 0.1;
    let signs = |pass: u32| (0..PIXELS).map(move |i| if i >> pass & 1 == 0 { 1.0 } else { -1.0 });
    let trials = [(0.7, relative), (1.4, 0.0), (2.0, 0.0)].map(|(factor, noise)| {
        let passes = [0, 1].map(|pass| signs(pass).map(|sign| 1.0 + noise * sign).collect());
        Trial { area: Area::Surface, factor, passes, seconds: 1.0 }
    });
    let reference = reference(&trials);
    let measured = |weights: &[f64]| {
        let difference = |pass: usize, i: usize| trials[2].passes[pass][i] - reference.passes[pass][i];
        mean(&(0..PIXELS).map(|i| difference(0, i) * difference(1, i) * weights[i]).collect::<Vec<_>>())
    };
    let least = &trials[0];
    let both = |i: usize| 0.5 * (least.passes[0][i] + least.passes[1][i]);
    let joint: Vec<f64> = (0..PIXELS).map(|i| both(i).powi(2).recip()).collect();
    let (found, wrong) = (measured(&weights(least, &[0.0; PIXELS])), measured(&joint));
    assert!(found.abs() < 1e-14, "{found}");
    let spurious = 1.5 * relative.powi(4) * (4.0_f64 / 3.0).powi(2);
    assert!((wrong / spurious - 1.0).abs() < 0.05, "{wrong} {spurious}");
}

/// Where radii are given only one factor is tried, and discs differ from areas of surfaces by bias alone.
#[test]
fn discs_have_bias_with_a_given_radius_too() {
    let trials = [(Area::Surface, 1.0), (Area::Disc, 1.2)]
        .map(|(area, value)| Trial { passes: [vec![value; PIXELS], vec![value; PIXELS]], ..trial(area, 1.0, 0.0, 0) });
    let reference = reference(&trials);
    let bias = |trial: &Trial| {
        Model::new(&[trial], &reference, 0.0, &vec![1.0; PIXELS], ([0.25, 0.5], 0.0), 1.0).bias.squared(1.0)
    };
    assert_eq!(bias(&trials[0]), 0.0);
    assert!((bias(&trials[1]) - 0.04).abs() < 1e-12);
}
