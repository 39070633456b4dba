//! Solid angles of nearby triangles compared with photon-core's.

use photon_core::glam::{DVec3, Vec3};
use photon_core::random::unit_f32;
use photon_core::solid_angle;

use super::compare::Bound;
use super::draw::{Draw, input, inputs};
use super::table::{Row, output, words};
use super::{Input, Output};
use crate::shaders;

/// The functions, their twins and their bounds.
pub(super) fn rows() -> Vec<Row> {
    let module = &shaders::PROBE_SOLID_ANGLE;
    let row = |name, function, bound, twin| Row { name, module, function, bound, draw: view, twin };
    vec![
        row("solid_angle_is_near", 0, Bound::Words, |i| words([solid_angle::is_near(corners(i)).into()])),
        row("solid_angle_of", 1, Bound::Conditioned(4e-6, "its condition", |i| condition(i, angle)), |i| {
            angle(corners(i), i)
        }),
        row("solid_angle_sample", 2, Bound::Conditioned(2e-6, "its condition", condition_of_sample), |i| {
            sampled(corners(i), i)
        }),
    ]
}

fn corners(i: &Input) -> [Vec3; 3] {
    [i.vector(0), i.vector(4), i.vector(8)]
}

/// A random triangle, sometimes thin, and an eye in front of its interior, its edges and corners, or beyond
/// them.
fn view(d: &mut Draw) -> Input {
    let [a, b, mut c] = [d.point(), d.point(), d.point()];
    if d.now_and_then() {
        c = a + (b - a) * d.between(0.0, 1.0) + (c - a) * 1e-3;
    }
    let normal = (b - a).cross(c - a);
    let weights = [0.0, 1.0, 0.5, -0.5];
    let mut weight = || if d.now_and_then() { d.pick(&weights) } else { d.between(-0.5, 1.5) };
    let foot = a + (b - a) * weight() + (c - a) * weight();
    let height = d.magnitude(-20, 2);
    let eye = foot - normal.normalize_or(Vec3::X) * height;
    let area = 0.5 * normal.length();
    let mut made =
        input((a - eye).extend(height).to_array(), (b - eye).extend(area).to_array(), (c - eye).extend(0.0).to_array());
    made.0[11] = d.word();
    made
}

fn angle(corners: [Vec3; 3], i: &Input) -> Output {
    output([solid_angle::of(corners, i.float(3), i.float(7))])
}

fn sampled(corners: [Vec3; 3], i: &Input) -> Output {
    let packed = i.0[11];
    let (u, v) = (unit_f32(packed & 0xFFFF_0000), unit_f32(packed << 16));
    match solid_angle::sample(corners, i.float(3), i.float(7), u, v) {
        Some(seen) => output([1.0, seen.b, seen.c, seen.solid_angle]),
        None => output([0.0]),
    }
}

/// Condition number: the change of the result for corners changed by 1e-6, divided by 1e-6; infinite if the
/// change selects another corner as the pole.
fn condition(i: &Input, function: fn([Vec3; 3], &Input) -> Output) -> f64 {
    const CHANGE: f32 = 1e-6;
    let before = function(corners(i), i);
    let mut condition = 1.0_f64;
    for (which, axis) in (0..9).map(|k| (k / 3, k % 3)) {
        let mut moved = corners(i);
        let size = moved[which].length();
        moved[which][axis] += CHANGE * size;
        let after = function(moved, i);
        for (a, b) in before.iter().zip(after) {
            let apart = f64::from(f32::from_bits(*a)) - f64::from(f32::from_bits(b));
            condition = condition.max(apart.abs() / f64::from(CHANGE));
        }
    }
    // Another pole gives an entirely different point.
    if condition > 1e4 { f64::INFINITY } else { condition }
}

/// Condition number of a sample, whose unit vectors have errors in length too: for each, a square root and a
/// division may contribute 5.4e-7 and 3e-7, so that a cosine is off by as much as 2e-6. In units of 1e-6, that
/// error is divided by
/// - the tangent of half the solid angle, if its numerator and denominator are small: an eye close to an edge;
/// - the distance of the arc from the pole through the point from half a turn: an eye close to the triangle;
/// - and the condition is infinite where rounding selects the pole, the corner opposite the smallest of three
///   cosines.
fn condition_of_sample(i: &Input) -> f64 {
    const OFF: f64 = 2.0;
    let corners = corners(i).map(|corner| corner.as_dvec3());
    let units = corners.map(DVec3::normalize_or_zero);
    let [a, b, c] = units;
    // By the opposite corner.
    let cosines = [b.dot(c), c.dot(a), a.dot(b)];
    let mut sorted = cosines;
    sorted.sort_by(f64::total_cmp);
    if sorted[1] - sorted[0] <= 2.0 * OFF * 1e-6 {
        return f64::INFINITY;
    }
    let half = (1.0 + cosines.iter().sum::<f64>()).hypot(a.cross(b).dot(c));
    let pole = cosines.iter().position(|&cosine| cosine <= sorted[0]).unwrap_or(0);
    let [_, b, c, ..] = sampled(self::corners(i), i).map(|word| f64::from(f32::from_bits(word)));
    let mut weights = [1.0 - b - c, b, c];
    weights[pole] = 0.0;
    let across = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
    let left = 1.0 + across.normalize_or_zero().dot(units[pole]);
    let condition = condition(i, sampled).max(OFF / half).max(OFF / left.max(0.0));
    if condition > 1e4 { f64::INFINITY } else { condition }
}

/// The bounds are meaningful: most views are well-conditioned, and most have a positive solid angle.
#[test]
fn most_views_are_decided() {
    let inputs = inputs(view);
    let conditions: [fn(&Input) -> f64; 2] = [|input| condition(input, angle), condition_of_sample];
    for condition in conditions {
        let decided = inputs.iter().filter(|input| condition(input).is_finite()).count();
        assert!(decided * 2 > inputs.len(), "{decided} of {}", inputs.len());
    }
    let seen = inputs.iter().filter(|input| sampled(corners(input), input)[0] != 0).count();
    assert!(seen * 2 > inputs.len(), "{seen} of {}", inputs.len());
}
