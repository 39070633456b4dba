//! Solid angles of nearby triangles compared with photon-core's.

use photon_core::glam::{DVec3, Vec3};
use photon_core::random::unit_f32;
use photon_core::{cosine_warp, solid_angle};

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
        row("solid_angle_sample, by cosine", 4, Bound::Conditioned(2e-6, "its condition", condition_by_cosine), |i| {
            by_cosine(corners(i), i)
        }),
        Row { draw: cosines, ..row("cosine_warp", 3, Bound::Relative(2e-6), warped) },
    ]
}

/// A surface normal at the eye.
const NORMAL: Vec3 = Vec3::new(0.36, 0.48, 0.8);

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
    towards(corners, i, None)
}

fn by_cosine(corners: [Vec3; 3], i: &Input) -> Output {
    towards(corners, i, Some(NORMAL))
}

/// Cosines, some of them below 0, and two random words.
fn cosines(d: &mut Draw) -> Input {
    let mut made = input([0.0; 4], [0.0; 4], [0.0; 4]);
    for place in 0..3 {
        let cosine = if d.now_and_then() { d.pick(&[0.0, 1.0, 1e-6, -0.5]) } else { d.between(-0.3, 1.0) };
        made.0[place] = cosine.to_bits();
    }
    (made.0[4], made.0[5]) = (d.word(), d.word());
    made
}

fn warped(i: &Input) -> Output {
    let (u, v, per_density) = cosine_warp::warp(i.vector(0).to_array(), unit_f32(i.0[4]), unit_f32(i.0[5]));
    output([u, v, per_density])
}

fn towards(corners: [Vec3; 3], i: &Input, normal: Option<Vec3>) -> Output {
    let packed = i.0[11];
    let (u, v) = (unit_f32(packed & 0xFFFF_0000), unit_f32(packed << 16));
    match solid_angle::sample(corners, i.float(3), i.float(7), normal, u, v) {
        Some(seen) => output([1.0, seen.b, seen.c, seen.per_pdf]),
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
    condition_of(i, sampled)
}

fn condition_of(i: &Input, function: fn([Vec3; 3], &Input) -> Output) -> f64 {
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
    let [_, b, c, ..] = function(self::corners(i), i).map(|word| f64::from(f32::from_bits(word)));
    let mut weights = [1.0 - b - c, b, c];
    weights[pole] = 0.0;
    let across = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
    let left = 1.0 + across.normalize_or_zero().dot(units[pole]);
    let condition = condition(i, function).max(OFF / half).max(OFF / left.max(0.0));
    if condition > 1e4 { f64::INFINITY } else { condition }
}

/// With a normal the numbers change by errors of the cosines, relative to their sum.
fn condition_by_cosine(i: &Input) -> f64 {
    let sum: f32 = corners(i).map(|corner| NORMAL.dot(corner.normalize_or_zero()).max(0.0)).iter().sum();
    let condition = condition_of(i, by_cosine) * (1.0 + 1.0 / f64::from(sum));
    if condition < 1e4 { condition } else { f64::INFINITY }
}

/// The bounds are meaningful: most views are well-conditioned, and most have a positive solid angle.
#[test]
fn most_views_are_decided() {
    let inputs = inputs(view);
    let conditions: [fn(&Input) -> f64; 3] =
        [|input| condition(input, angle), condition_of_sample, condition_by_cosine];
    for condition in conditions {
        let decided = inputs.iter().filter(|input| condition(input).is_finite()).count();
        assert!(decided * 2 > inputs.len(), "{decided} of {}", inputs.len());
    }
    let seen = inputs.iter().filter(|input| sampled(corners(input), input)[0] != 0).count();
    assert!(seen * 2 > inputs.len(), "{seen} of {}", inputs.len());
}
