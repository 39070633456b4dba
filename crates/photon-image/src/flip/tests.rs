//! Known values, and which differences must be detected.

use super::*;

fn flat(colour: [f32; 3]) -> Vec<[f32; 3]> {
    vec![colour; 32 * 24]
}

fn of(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    mean(a, b, 32, PIXELS_PER_DEGREE)
}

/// Smooth stripes and a disc, so that all parts of the measure contribute.
fn scene() -> Vec<[f32; 3]> {
    let pixel = |at: usize| {
        let (x, y) = ((at % 32) as f32, (at / 32) as f32);
        let disc = if (x - 12.0).hypot(y - 10.0) < 6.0 { 0.6 } else { 0.1 };
        [0.5 + 0.4 * (0.6 * x).sin(), disc, 0.3 + 0.01 * y]
    };
    (0..32 * 24).map(pixel).collect()
}

#[test]
fn equal_pictures_do_not_differ() {
    for picture in [flat([0.0; 3]), flat([1.0; 3]), scene()] {
        assert!(map(&picture, &picture, 32, PIXELS_PER_DEGREE).iter().all(|&value| value == 0.0));
    }
    assert!(map(&[], &[], 0, PIXELS_PER_DEGREE).is_empty());
}

/// Between uniform pictures only the colour difference remains. White is 100 away from black: 100^0.7 = 25.119. Green
/// and blue are 203.3 apart by HyAB of the Lab values in `colour`, with Hunt's adjustment: 41.28 to the power 0.7. Above 0.4
/// of that, 16.51, the rest goes to the last twentieth: 0.95 + 0.05 (25.119 − 16.51) / (41.28 − 16.51) = 0.9674.
#[test]
fn black_and_white_are_nearly_1_apart() {
    let value = of(&flat([0.0; 3]), &flat([1.0; 3]));
    assert!((value - 0.9674).abs() < 2e-4, "{value}");
    let most = of(&flat([0.0, 1.0, 0.0]), &flat([0.0, 0.0, 1.0]));
    assert!((most - 1.0).abs() < 1e-9, "{most}");
}

/// Values of the authors' program (flip-evaluator 1.7, in single precision) for the same pictures: one with
/// less red, a white pixel, and its upper half a pixel to the right.
#[test]
fn the_authors_program_agrees() {
    let clean = scene();
    let mut other = clean.clone();
    other[20 * 32 + 27] = [1.0; 3];
    other.iter_mut().for_each(|pixel| pixel[0] *= 0.9);
    for row in other.chunks_exact_mut(32).take(12) {
        row.rotate_right(1);
    }
    let map = map(&clean, &other, 32, PIXELS_PER_DEGREE);
    let mean = map.iter().sum::<f64>() / map.len() as f64;
    let most = map.iter().fold(0.0_f64, |most, &value| most.max(value));
    let ours = [mean, map[20 * 32 + 27], map[3 * 32 + 12], most];
    for (ours, theirs) in ours.into_iter().zip([0.238_752, 0.452_394, 0.414_813, 0.645_324]) {
        assert!((ours - theirs).abs() < 5e-4, "{ours} {theirs}");
    }
    // Their white point differs in the last digits.
    let value = of(&flat([0.0; 3]), &flat([1.0; 3]));
    assert!((value - 0.967_391).abs() < 2e-5, "{value}");
}

#[test]
fn order_does_not_matter_and_values_stay_in_range() {
    let (a, b) = (scene(), flat([0.4, 0.2, 0.9]));
    let (there, back) = (map(&a, &b, 32, PIXELS_PER_DEGREE), map(&b, &a, 32, PIXELS_PER_DEGREE));
    assert_eq!(there, back);
    assert!(there.iter().all(|value| (0.0..=1.0).contains(value)) && there.iter().any(|&value| value > 0.2));
}

/// A single wrong pixel is detected, a larger error more strongly, and only in its neighbourhood.
#[test]
fn a_firefly_is_seen_where_it_is() {
    let clean = scene();
    let with = |value: f32| {
        let mut picture = clean.clone();
        picture[20 * 32 + 27] = [value; 3];
        map(&clean, &picture, 32, PIXELS_PER_DEGREE)
    };
    let (small, large) = (with(0.5), with(1.0));
    assert!(large[20 * 32 + 27] > 0.3 && large[20 * 32 + 27] > small[20 * 32 + 27]);
    // Beyond the radius of the widest filter, ten pixels.
    assert!(large[20 * 32 + 5] == 0.0 && large[2 * 32 + 27] == 0.0);
}

/// A shifted edge is a feature, which weighs more than a uniform colour difference of the same size.
#[test]
fn an_edge_counts_more_than_a_gradient() {
    let step = |at: usize| [if at % 32 < 16 { 0.2 } else { 0.35 }; 3];
    let ramp = |at: usize| [0.2 + 0.15 * (at % 32) as f32 / 31.0; 3];
    let (edge, smooth): (Vec<_>, Vec<_>) = (0..32 * 24).map(|at| (step(at), ramp(at))).unzip();
    let grey = flat([0.275; 3]);
    let at_edge = map(&grey, &edge, 32, PIXELS_PER_DEGREE)[12 * 32 + 16];
    let same_place = map(&grey, &smooth, 32, PIXELS_PER_DEGREE)[12 * 32 + 16];
    assert!(at_edge > 2.0 * same_place, "{at_edge} {same_place}");
}

#[test]
fn what_is_no_number_is_compared_as_black() {
    let broken = flat([f32::NAN, f32::NEG_INFINITY, -1.0]);
    assert_eq!(of(&flat([0.0; 3]), &broken), 0.0);
    assert!(of(&flat([1.0; 3]), &broken) > 0.9);
}
