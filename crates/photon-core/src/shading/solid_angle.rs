//! Solid angles of triangles, and sampling of triangles uniformly in solid angle, or roughly in proportion to a cosine.
//!
//! The value of irradiance from a point sampled uniformly in the area of a light contains the cosines
//! divided by the squared distance, which is unbounded near the light, and has infinite variance where a
//! light touches a wall. With a direction sampled uniformly in solid angle, it is the radiance times the
//! solid angle times one cosine.

use glam::Vec3;

use crate::cosine_warp;
use crate::math::{sin_cos_turns, turns_of};

/// Squared distance of a triangle, in units of the spread of its corners, from which on it is not near:
/// twice the square of 4 radii.
pub const NEAR: f32 = 32.0;

/// A triangle is invisible from points closer than this to its plane: half a step of [`crate::offset`],
/// which exceeds the rounding errors of points and normals in a unit box. Otherwise, by rounding, the
/// triangles next to a point in its own plane could fill a hemisphere with light.
pub const MIN_HEIGHT: f32 = 1.0 / 2_097_152.0;

/// Whether a triangle, with corners relative to the eye, is nearer than four times its radius, which is the
/// largest distance of a corner from the centroid, or slightly more if the corners are equally far from it.
///
/// Otherwise the distances of its points differ by less than a factor of 5/3, and the values of points
/// uniform in area, cosine over squared distance, by less than 5 (for a centroid at distance `d`, 4 radii
/// `r` away, `((d + r)/(d − r))³`).
#[inline]
#[must_use]
pub fn is_near([a, b, c]: [Vec3; 3]) -> bool {
    let sum = a + b + c;
    // Three times the squared distance of the centroid, and the sum of the squared distances of the corners
    // from it: at least three halves of the largest. Far away the latter is a difference of large numbers,
    // but then the former decides.
    let away = sum.dot(sum) * 0.333_333_34;
    let spread = (a.dot(a) + b.dot(b) + c.dot(c)) - away;
    away < NEAR * spread
}

/// A point on a triangle, sampled by its solid angle.
// Exhaustive: backends write it as a literal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Weight of the second corner, in `[0, 1]`.
    pub b: f32,
    /// Weight of the third corner, in `[0, 1]`; together with the second's at most 1, except for rounding.
    pub c: f32,
    /// The reciprocal of the density of the direction per solid angle, steradians: if directions are uniform, the solid angle of
    /// the whole triangle, in `(0, 2π]`.
    pub per_pdf: f32,
}

/// The solid angle of a triangle, with corners relative to the eye: steradians, in `[0, 2π]`, by Van
/// Oosterom and Strackee 1983, equation 8. `height` > 0 is the eye's distance from its plane, `area` its
/// area.
#[inline]
#[must_use]
pub fn of([a, b, c]: [Vec3; 3], height: f32, area: f32) -> f32 {
    let [x, y, z] = [a, b, c].map(Vec3::length);
    let rest = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    4.0 * std::f32::consts::PI * turns_of(2.0 * area * height, rest)
}

/// Samples a point on a triangle uniformly in solid angle, unless there is a normal, for `u` and `v` uniform in `[0, 1)`.
///
/// With a surface normal, the density of the directions is roughly proportional to the cosine to it, by
/// [`cosine_warp::warp`].
///
/// `corners` are relative to the eye, `height` > 0 is the eye's distance from their plane, and `area` the
/// area of the triangle. `None` if the triangle is seen so thin that its solid angle cannot be
/// distinguished from 0 in single precision; then another sampling method has to be used.
///
/// The solid angle is by Van Oosterom and Strackee 1983, equation 8. As in Arvo 1995, a corner moves along
/// its side until the triangle has the share `u` of the solid angle, and the direction is then on the great
/// arc from there to the opposite corner; but computed with tangents of half angles, which the equation of
/// Van Oosterom and Strackee gives without inverse cosines, and which are accurate for thin triangles. The
/// corner opposite the widest side is the pole, since the eye may be almost on an edge.
#[inline]
#[must_use]
pub fn sample(corners: [Vec3; 3], height: f32, area: f32, normal: Option<Vec3>, u: f32, v: f32) -> Option<Seen> {
    let [x, y, z] = corners.map(Vec3::length);
    if !(x.min(y).min(z) > 0.0) {
        return None;
    }
    let units = [corners[0] * (1.0 / x), corners[1] * (1.0 / y), corners[2] * (1.0 / z)];
    let [xy, yz, zx] = [units[0].dot(units[1]), units[1].dot(units[2]), units[2].dot(units[0])];
    // The triple product of the unit vectors: more accurate from the height than from the vectors.
    let volume = (height / x) * (2.0 * area / (y * z));
    // Half the solid angle, in turns.
    let half = turns_of(volume, 1.0 + xy + yz + zx);
    let first = if zx <= xy.min(yz) {
        0
    } else if xy <= yz {
        1
    } else {
        2
    };
    let (second, third) = ((first + 1) % 3, (first + 2) % 3);
    let (from, pole, to) = (units[first], units[second], units[third]);
    let lengths = [x, y, z];
    // The vector from the first corner to the third, perpendicular to the first direction.
    let side = corners[third] - corners[first];
    let across = side - from * side.dot(from);
    let breadth = across.length();
    if !(half > 0.0 && volume > 0.0 && breadth > 0.0) {
        return None;
    }
    let tangent = across * (1.0 / breadth);
    let (u, v, per_density) = match normal {
        Some(normal) => cosine_warp::warp([from, pole, to].map(|unit| normal.dot(unit)), u, v),
        None => (u, v, 1.0),
    };
    // tan(half the solid angle up to θ) = t [from pole tangent] / (1 + from·pole + t pole·tangent) for t =
    // tan(θ/2), solved for t = rise/run.
    let (sin, cos) = sin_cos_turns(u * half);
    let rise = sin * (1.0 + from.dot(pole)).max(0.0);
    let run = (cos * (volume * (lengths[third] / breadth)) - sin * pole.dot(tangent)).max(0.0);
    let square = rise * rise + run * run;
    if !(square > 0.0) {
        return None;
    }
    let sin_theta = 2.0 * rise * run / square;
    let cos_theta = (run - rise) * (run + rise) / square;
    // Position on the side: by the law of sines, both terms at least 0.
    let before = lengths[first] * sin_theta;
    let after = (breadth * cos_theta - lengths[third] * to.dot(from) * sin_theta).max(0.0);
    let along = share(before, after);
    // From the pole to that point, uniform in the cosine.
    let end = from * cos_theta + tangent * sin_theta;
    let gap = pole - end;
    let versine = (0.5 * gap.dot(gap)).min(2.0);
    let part = v * versine;
    // sin φ divided by the sine of the whole arc.
    let sines = (v * (2.0 - part) / (2.0 - versine).max(1e-12)).sqrt();
    let reach = (corners[first] + side * along).length();
    let before = lengths[second] * sines;
    let after = reach * ((1.0 - part) - (1.0 - versine) * sines).max(0.0);
    let transmitted = share(before, after);
    let mut weights = [0.0; 3];
    weights[first] = transmitted * (1.0 - along);
    weights[second] = 1.0 - transmitted;
    weights[third] = transmitted * along;
    let solid_angle = 4.0 * std::f32::consts::PI * half;
    Some(Seen { b: weights[1], c: weights[2], per_pdf: solid_angle * per_density })
}

/// The first of two lengths divided by their sum, 0 if that is 0.
#[inline]
fn share(first: f32, second: f32) -> f32 {
    let both = first + second;
    if both > 0.0 { (first / both).min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{philox4x32, unit_f32};
    use glam::DVec3;

    /// Spherical excess of the angles between the planes of the sides (Girard), in f64: uses neither the
    /// triple product nor half angles.
    fn by_excess(corners: [DVec3; 3]) -> f64 {
        let [a, b, c] = corners.map(DVec3::normalize_or_zero);
        let angle = |at: DVec3, one: DVec3, other: DVec3| at.cross(one).angle_between(at.cross(other));
        angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - std::f64::consts::PI
    }

    /// Corners relative to an eye at the origin, with height and area.
    fn seen(corners: [Vec3; 3]) -> ([Vec3; 3], f32, f32) {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a);
        let height = normal.dot(a).abs() / normal.length();
        (corners, height as f32, (0.5 * normal.length()) as f32)
    }

    fn numbers(i: u32) -> (f32, f32) {
        let [u, v, ..] = philox4x32([i, 0, 0, 0], [11, 0]);
        (unit_f32(u), unit_f32(v))
    }

    /// A unit triangle with eyes in front of its centre, an edge, a corner and outside of an edge; slivers;
    /// a corner of a cube.
    fn views() -> Vec<[Vec3; 3]> {
        let flat = [Vec3::ZERO, Vec3::X, Vec3::new(0.3, 0.8, 0.0)];
        let sliver = [Vec3::ZERO, Vec3::X, Vec3::new(0.6, 0.01, 0.0)];
        let mut views = vec![[Vec3::X, Vec3::Y, Vec3::Z], [Vec3::Y, Vec3::X, Vec3::Z * 0.2]];
        for (triangle, x, y) in [
            (flat, 0.4, 0.3),
            (flat, 0.5, 0.0),
            (flat, 0.0, 0.0),
            (flat, 0.5, -0.1),
            (sliver, 0.6, 0.003),
            (sliver, -0.1, 0.2),
        ] {
            for height in [1.0, 0.1, 1e-2, 1e-3] {
                views.push(triangle.map(|corner| corner - Vec3::new(x, y, height)));
            }
        }
        views
    }

    #[test]
    fn solid_angles() {
        let (corners, height, area) = seen([Vec3::X, Vec3::Y, Vec3::Z]);
        let octant = sample(corners, height, area, None, 0.5, 0.5).expect("wide").per_pdf;
        assert!((f64::from(octant) - std::f64::consts::FRAC_PI_2).abs() < 1e-6, "{octant}");
        // Half a face of a cube of side 2 around the eye: a twelfth of the sphere.
        let (corners, height, area) = seen([Vec3::new(-1.0, -1.0, 1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::ONE]);
        let half = sample(corners, height, area, None, 0.5, 0.5).expect("wide").per_pdf;
        assert!((f64::from(half) - std::f64::consts::FRAC_PI_3).abs() < 1e-6, "{half}");
        for view in views() {
            let (corners, height, area) = seen(view);
            let found = f64::from(sample(corners, height, area, None, 0.5, 0.5).expect("wide").per_pdf);
            let truth = by_excess(view.map(Vec3::as_dvec3));
            // Rounding of the corners moves the eye by a relative 1e-7: by at most that share of the
            // height, or of its distance to the edges.
            for found in [found, f64::from(of(corners, height, area))] {
                assert!((found - truth).abs() < 2e-6 + 2e-7 * truth / f64::from(height), "{view:?}: {found} {truth}");
            }
        }
    }

    /// χ² of the counts in 64 similar parts of the triangle, with an eighth of its side each, minus the
    /// degrees of freedom, divided by its standard deviation √(2·63). The expected count of a part is from
    /// its solid angle by the other formula.
    fn chi_squared(view: [Vec3; 3], point: impl Fn(f32, f32) -> (f32, f32)) -> f64 {
        const SIDE: usize = 8;
        let n = 60_000;
        let mut counts = [[[0.0_f64; 2]; SIDE]; SIDE];
        for i in 0..n {
            let (u, v) = numbers(i);
            let (b, c) = point(u, v);
            let (b, c) = (b * SIDE as f32, c * SIDE as f32);
            let (i, j) = ((b as usize).min(SIDE - 1), (c as usize).min(SIDE - 1));
            let over = b.fract() + c.fract() > 1.0 && i + j < SIDE - 1;
            counts[i][j][usize::from(over)] += 1.0;
        }
        let [a, b, c] = view.map(Vec3::as_dvec3);
        let at = |i: usize, j: usize| a + (b - a) * (i as f64 / SIDE as f64) + (c - a) * (j as f64 / SIDE as f64);
        let whole = by_excess([a, b, c]);
        let (mut sum, mut free) = (0.0, -1.0);
        for i in 0..SIDE {
            for j in 0..SIDE - i {
                let parts = [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]];
                for over in 0..if i + j < SIDE - 1 { 2 } else { 1 } {
                    let expected = f64::from(n) * by_excess(parts[over]) / whole;
                    let difference = counts[i][j][over] - expected;
                    // With fewer than 5 expected, the counts are too far from normal for χ².
                    if expected >= 5.0 {
                        sum += difference * difference / expected;
                        free += 1.0;
                    }
                }
            }
        }
        (sum - free) / (2.0 * free).sqrt()
    }

    #[test]
    fn directions_are_uniform_in_solid_angle() {
        let mut worst = 0.0_f64;
        let mut by_area = 0;
        for view in views() {
            let (corners, height, area) = seen(view);
            let z = chi_squared(view, |u, v| {
                let seen = sample(corners, height, area, None, u, v).expect("wide");
                (seen.b, seen.c)
            });
            worst = worst.max(z.abs());
            assert!(z.abs() <= 4.5, "{view:?}: {z}");
            by_area += usize::from(chi_squared(view, crate::sampling::triangle).abs() > 4.5);
        }
        assert!(by_area > views().len() / 2, "{by_area}: the test does not detect points uniform in area");
    }

    /// With and without a normal, the mean of the cosine over the density is the irradiance by a triangle of radiance 1 (Lambert
    /// 1760; half of the sum over sides of angle times the cosine of their plane's normal). With it the
    /// variance is less, unless all corners have the same cosine, as in the first view. Standard errors are those of the samples.
    #[test]
    fn irradiance_is_that_of_lambert() {
        for (normal, view, most) in [
            (Vec3::Z, [Vec3::new(-1.0, -1.0, 1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::ONE], 1.001),
            (Vec3::Z, [Vec3::new(0.0, 0.5, 0.2), Vec3::new(2.0, 0.5, 0.1), Vec3::new(0.3, 0.9, 3.0)], 0.2),
            (Vec3::new(0.6, 0.0, 0.8), [Vec3::X, Vec3::Y, Vec3::Z], 0.5),
            (Vec3::Y, [Vec3::new(0.1, 1.0, 0.0), Vec3::new(0.2, 1.0, 3.0), Vec3::new(-2.0, 1.5, -0.5)], 0.2),
        ] {
            let [a, b, c] = view.map(|corner| corner.as_dvec3().normalize_or_zero());
            let of_side = |from: DVec3, to: DVec3| {
                from.angle_between(to) * from.cross(to).normalize_or_zero().dot(normal.as_dvec3())
            };
            let truth = 0.5 * (of_side(a, b) + of_side(b, c) + of_side(c, a)).abs();
            let (corners, height, area) = seen(view);
            let variance = |by: Option<Vec3>| {
                let n = 40_000;
                let (mut sum, mut squares) = (0.0, 0.0);
                for i in 0..n {
                    let (u, v) = numbers(i);
                    let Seen { b, c, per_pdf } = sample(corners, height, area, by, u, v).expect("wide");
                    let direction = (view[0] * (1.0 - b - c) + view[1] * b + view[2] * c).normalize_or_zero();
                    let value = f64::from(per_pdf * normal.dot(direction).max(0.0));
                    (sum, squares) = (sum + value, squares + value * value);
                }
                let mean = sum / f64::from(n);
                let variance = squares / f64::from(n) - mean * mean;
                let error = (variance / f64::from(n)).sqrt();
                assert!((mean - truth).abs() <= 4.5 * error + 2e-6, "{view:?}: {mean} {truth} ± {error}");
                variance
            };
            let ratio = variance(Some(normal)) / variance(None);
            assert!(ratio < most, "{view:?}: {ratio}");
        }
    }

    /// Eyes within 1e-6 of the plane, on edges, at corners; needles; triangles a million times as large or
    /// as small.
    #[test]
    fn extremes_give_points_within() {
        let mut given = 0;
        for i in 0..20_000_u32 {
            let [p, q, r, s] = philox4x32([i, 1, 0, 0], [12, 0]);
            let pick = |word: u32, of: &[f32]| of[word as usize % of.len()];
            let size = pick(p, &[1.0, 1e-3, 1e-6, 0.3]);
            let breadth = pick(p >> 8, &[1.0, 1e-2, 1e-5, 1e-7, 0.0]);
            let lean = pick(p >> 16, &[0.0, 0.5, 1.0, 1.7, -3.0]);
            let triangle = [Vec3::ZERO, Vec3::X, Vec3::new(lean, breadth, 0.0)];
            let (u, v) = (pick(q, &[0.0, 1.0, 0.5, 0.25, -0.3]), pick(q >> 8, &[0.0, 1.0, 0.5, 1e-7, 0.25]));
            let height = pick(q >> 16, &[1e-9, 1e-7, 1e-6, 1e-3, 0.3]);
            let eye = triangle[1] * u + triangle[2] * v + Vec3::Z * height;
            let turn = glam::Quat::from_axis_angle(crate::sampling::uniform_sphere(unit_f32(r), unit_f32(s)), 1.0);
            let view = triangle.map(|corner| turn * ((corner - eye) * size));
            let area = 0.5 * breadth * size * size;
            let (u, v) = numbers(i);
            let (u, v) =
                (pick(s, &[u, 0.0, 1.0 - f32::EPSILON / 2.0]), pick(s >> 8, &[v, 0.0, 1.0 - f32::EPSILON / 2.0]));
            let normal = (i % 2 == 1).then_some(crate::sampling::uniform_sphere(unit_f32(q), unit_f32(p)));
            let Some(seen) = sample(view, height * size, area, normal, u, v) else { continue };
            given += 1;
            let Seen { b, c, per_pdf } = seen;
            let most = if normal.is_some() { 6.0 * 6.283_187 } else { 6.283_187 };
            assert!(per_pdf > 0.0 && per_pdf < most, "{view:?}: {seen:?}");
            assert!(b >= 0.0 && c >= 0.0 && b + c <= 1.000_000_2, "{view:?} {u} {v}: {seen:?}");
        }
        assert!(given > 10_000, "{given}");
        for none in
            [[Vec3::ZERO; 3], [Vec3::X; 3], [Vec3::X, Vec3::X * 2.0, Vec3::X * 3.0], [Vec3::ZERO, Vec3::X, Vec3::Y]]
        {
            assert_eq!(sample(none, 0.0, 0.0, None, 0.5, 0.5), None);
            assert_eq!(sample(none, 0.0, 0.0, Some(Vec3::X), 0.5, 0.5), None);
        }
    }

    /// For triangles that are not near, the largest cosine over squared distance exceeds the mean by less
    /// than a factor of 5.
    #[test]
    fn what_is_not_near_has_bounded_values() {
        let (mut near, mut most) = (0, 0.0_f64);
        for i in 0..4000_u32 {
            let [p, q, r, s] = philox4x32([i, 2, 0, 0], [13, 0]);
            let eye = crate::sampling::uniform_sphere(unit_f32(p), unit_f32(q)) * (0.1 + 8.0 * unit_f32(r));
            let third = Vec3::new(unit_f32(s), if i % 3 == 0 { 0.01 } else { 0.9 }, 0.0);
            let view = [Vec3::ZERO, Vec3::X, third].map(|corner| corner - eye);
            if is_near(view) {
                near += 1;
                continue;
            }
            let (_, height, area) = seen(view);
            let mean = by_excess(view.map(Vec3::as_dvec3)) / f64::from(area);
            let value = |corner: Vec3| f64::from(height) / f64::from(corner.length()).powi(3);
            most = view.map(value).into_iter().fold(most, |most, value| most.max(value / mean));
        }
        assert!((400..3600).contains(&near), "{near}");
        assert!(most > 1.2 && most < 5.0, "{most}");
    }
}
