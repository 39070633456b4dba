//! Positions and weights of area probes compared with photon-core's.

use photon_core::{Kernel, area};

use super::compare::{Bound, Denormals, worst};
use super::draw::{Draw, LAST, input, inputs};
use super::table::{Row, Twin, output};
use super::{Input, Output, assert_twin};
use crate::{Vulkan, shaders};

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let row =
        |name, function, bound, draw, twin| Row { name, module: &shaders::PROBE_AREA, function, bound, draw, twin };
    vec![
        row("area_spoke_turns", 0, Bound::Bits, place, |i| output([area::spoke_turns(i.0[4], i.float(2))])),
        row("area_probe", 1, Bound::Conditioned(4e-6, "its condition", condition), place, probe),
        row("area_outer_distance", 2, Bound::Conditioned(2e-6, "its condition", outer_condition), place, |i| {
            output([area::outer_distance(i.0[4], i.float(2))])
        }),
        row("area_second_weights", 3, Bound::Within(5e-6), distance, |i| {
            output(area::second_weights(kernel(i), i.float(3)))
        }),
        row("area_share", 4, Bound::Relative(4e-7), weights, |i| output([area::share(i.float(2), i.float(3))])),
    ]
}

fn kernel(i: &Input) -> Kernel {
    [Kernel::Constant, Kernel::Epanechnikov][i.0[0] as usize]
}

fn of_kernel(d: &mut Draw, x: f32, y: f32) -> Input {
    let mut made = input([0.0, 0.0, x, y], [0.0; 4], [0.0; 4]);
    made.0[0] = d.pick(&[0, 1]);
    made
}

/// A probe of a spoke, and a random number.
fn place(d: &mut Draw) -> Input {
    let random = d.unit();
    let mut made = of_kernel(d, random, 0.0);
    (made.0[4], made.0[5]) = (d.word() % area::SPOKES, d.word() % area::RINGS);
    made
}

/// A distance up to √2, the thresholds and their neighbours among them.
fn distance(d: &mut Draw) -> Input {
    let far = std::f32::consts::SQRT_2;
    let thresholds = [0.0, 0.5_f32.sqrt(), 0.75_f32.sqrt(), 1.0 - LAST, 1.0, far];
    let away = if d.now_and_then() { d.pick(&thresholds) } else { d.between(0.0, far) };
    of_kernel(d, 0.0, away)
}

/// A weight that was found, and the total weight.
fn weights(d: &mut Draw) -> Input {
    let all = d.magnitude(-10, 10);
    let found = if d.now_and_then() { d.pick(&[0.0, all, all * (1.0 - LAST), all / 16.0]) } else { all * d.unit() };
    of_kernel(d, found, all)
}

fn probe(i: &Input) -> Output {
    output([area::probe(kernel(i), i.0[4], i.0[5], i.float(2))])
}

/// Infinite where rounding of the sum decides between the two ends of a stratum, otherwise 1.
fn outer_condition(i: &Input) -> f64 {
    let sum = f64::from(i.float(2)) + f64::from(i.0[4]) * f64::from(0.618_034_f32);
    if (sum - sum.round()).abs() < 1e-6 { f64::INFINITY } else { 1.0 }
}

/// Condition number: square roots of small numbers amplify errors by their reciprocals. A root of 1e-3 may be entirely
/// rounding error.
fn condition(i: &Input) -> f64 {
    let distance = f64::from(area::probe(kernel(i), i.0[4], i.0[5], i.float(2)));
    let falls = kernel(i) == Kernel::Epanechnikov;
    // The distance is √(1 − rest) there, where the rest is a root itself.
    let rest = if falls { 1.0 - distance * distance } else { 1.0 };
    outer_condition(i) / (distance.max(1e-3) * rest.max(1e-3))
}

/// A wrong ring, a wrong kernel and a wrong lower limit are detected, and few inputs are undecided.
#[test]
fn a_wrong_area_probe_fails() {
    let Some(mut on) = Vulkan::for_tests() else { return };
    let decided = inputs(place).iter().filter(|input| condition(input).is_finite()).count();
    assert!(decided > 15_000, "{decided}");
    for row in rows() {
        let wrong: Twin = match row.function {
            0 => |i| output([area::spoke_turns(i.0[4] + 1, i.float(2))]),
            1 => |i| output([area::probe(kernel(i), i.0[4], (i.0[5] + 1) % area::RINGS, i.float(2))]),
            2 => |i| output([area::outer_distance(i.0[4] + 1, i.float(2))]),
            3 => |i| output(area::second_weights(Kernel::Epanechnikov, i.float(3))),
            _ => |i| output([(i.float(2) / i.float(3)).max(area::MIN_SHARE / 2.0)]),
        };
        assert_twin(&mut on, &row, &[], wrong);
    }
}

/// [`area::probe`] with a fused sum, and square roots off by `error` of themselves, with signs by the bits of `signs`.
fn rough_probe(i: &Input, error: f64, signs: u32) -> Output {
    let root = |x: f32, which: u32| {
        let sign = if signs >> which & 1 == 0 { 1.0 } else { -1.0 };
        (f64::from(x).sqrt() * (1.0 + sign * error)) as f32
    };
    let shift = (i.0[4] as f32).mul_add(0.618_034, i.float(2)).fract();
    let share = ((i.0[5] as f32 + shift) * (1.0 / area::RINGS as f32)).min(1.0 - f32::EPSILON);
    let rest = root(1.0 - share, 0);
    let falling = root((1.0 - rest).max(0.0), 1);
    output([if kernel(i) == Kernel::Epanechnikov { falling } else { root(share, 0) }])
}

/// The bound is what Vulkan allows: a fused sum and roots off by 5.4e-7 pass, roots off by ten times as much fail.
#[test]
fn a_device_at_the_limits_of_vulkan_passes() {
    let row = rows().remove(1);
    let inputs = inputs(row.draw);
    for signs in 0..4 {
        let with = |error| inputs.iter().map(|input| rough_probe(input, error, signs)).collect::<Vec<_>>();
        let share = worst(&row, &inputs, &with(5.4e-7), Denormals::Kept).unwrap();
        eprintln!("{share:.3} of the bound");
        assert!(worst(&row, &inputs, &with(5.4e-6), Denormals::Kept).is_err(), "{signs:b}");
    }
}
