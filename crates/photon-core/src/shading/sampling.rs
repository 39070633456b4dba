//! Sampling of points and directions from uniform numbers.

use glam::Vec3;

use crate::math::{cube_root, sin_cos_turns};

/// Two unit vectors that complete `n` to a right-handed orthonormal basis (Duff, Burgess,
/// Christensen, Hery, Kensler, Liani and Villemin 2017, listing 3).
#[inline]
#[must_use]
pub fn basis(n: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0_f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// A direction around `n` with density cos θ/π.
#[inline]
#[must_use]
pub fn cosine_hemisphere(n: Vec3, u: f32, v: f32) -> Vec3 {
    // sqrt(1 - u) > 0 since u < 1: the direction is never in the tangent plane. The sine is computed from
    // u, since from the cosine it would consist of rounding errors near the pole.
    around(n, u.sqrt(), (1.0 - u).sqrt(), v)
}

/// A direction with density 1/4π. `u` counts modulo 1, in `[-1, 1]`: with [`crate::random::centred_f32`],
/// both poles are where the precision of `f32` is highest; in `[0, 1)` heights near the poles are 2⁻²³
/// apart, as those of 24 bits are.
#[inline]
#[must_use]
pub fn uniform_sphere(u: f32, v: f32) -> Vec3 {
    let h = u.abs();
    let cos_theta = 1.0 - 2.0 * h;
    around(Vec3::Z, 2.0 * (h * (1.0 - h)).sqrt(), if u < 0.0 { -cos_theta } else { cos_theta }, v)
}

/// The direction at `versine` = 1 − cos θ from `axis`, and `turns` around it. With a cosine, angles below
/// 0.02° would be rounded to 0.
#[inline]
#[must_use]
pub fn about(axis: Vec3, versine: f32, turns: f32) -> Vec3 {
    let sin_theta = (versine * (2.0 - versine)).max(0.0).sqrt();
    around(axis, sin_theta, 1.0 - versine, turns)
}

/// 1 − cos of the angle from the axis of a direction within a cone, with density proportional to the cosine: irradiance of
/// a plane perpendicular to the axis is then the same from each sample. `outer` is the versine of the cone, at most 1.
#[inline]
#[must_use]
pub fn sun_versine(outer: f32, u: f32) -> f32 {
    let squared_sine = u * (outer * (2.0 - outer));
    squared_sine / (1.0 + (1.0 - squared_sine).sqrt())
}

/// 1 − cos of the angle between two unit vectors, in `[0, 2]`; accurate for very small angles too.
#[inline]
#[must_use]
pub fn versine(a: Vec3, b: Vec3) -> f32 {
    0.5 * (a - b).length_squared()
}

fn around(axis: Vec3, sin_theta: f32, cos_theta: f32, turns: f32) -> Vec3 {
    let (sin, cos) = sin_cos_turns(turns);
    let (tangent, bitangent) = basis(axis);
    (tangent * (sin_theta * cos) + bitangent * (sin_theta * sin) + axis * cos_theta).normalize_or(axis)
}

/// Weights of the second and third vertex for a uniform point in a triangle (Turk 1990).
#[inline]
#[must_use]
pub fn triangle(u: f32, v: f32) -> (f32, f32) {
    let root = u.sqrt();
    (root * (1.0 - v), root * v)
}

/// A uniform point in the unit disc.
#[inline]
#[must_use]
pub fn disc(u: f32, v: f32) -> (f32, f32) {
    let r = u.sqrt();
    let (sin, cos) = sin_cos_turns(v);
    (r * cos, r * sin)
}

/// Intensity of a spot light at `versine` from its axis, relative to that on the axis:
/// `KHR_lights_punctual` of glTF, squared. `inner` ≤ `outer` are versines too.
#[inline]
#[must_use]
pub fn spot_falloff(versine: f32, inner: f32, outer: f32) -> f32 {
    if versine <= inner {
        1.0
    } else if versine >= outer {
        0.0
    } else {
        let x = (outer - versine) / (outer - inner);
        x * x
    }
}

/// Integral of [`spot_falloff`] over solid angle: the power of a spot light divided by its intensity.
#[must_use]
pub fn spot_solid_angle(inner: f32, outer: f32) -> f64 {
    let (inner, outer) = (f64::from(inner), f64::from(outer));
    std::f64::consts::TAU * (inner + (outer - inner) / 3.0)
}

/// Samples a versine from the axis of a spot light, with density proportional to its intensity; 0 for `u` =
/// 0, and increasing.
#[inline]
#[must_use]
pub fn spot_versine(inner: f32, outer: f32, u: f32) -> f32 {
    // Power divided by 2π and the intensity on the axis: within the inner cone, and between the cones.
    let rim = (outer - inner) * (1.0 / 3.0);
    let depth = u * (inner + rim);
    // Always taken if there is no falloff, since u < 1.
    if depth < inner {
        depth
    } else {
        // Inverse of ∫ x² = x³/3, with x increasing from the outer cone to the inner one. From 1 - u, which
        // is exact: the root is steep at 0.
        let x = cube_root((1.0 - u) * ((inner + rim) / rim)).min(1.0);
        outer - x * (outer - inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// S28: any unit vector, including the poles and neighbours of the sign change.
    #[test]
    fn basis_is_orthonormal() {
        let mut cases = vec![Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(1e-30, 0.0, -1.0), Vec3::new(1.0, 0.0, -0.0)];
        for i in 0..10_000 {
            let (u, v) = (((i * 37) % 10_000) as f32 / 10_000.0, i as f32 / 10_000.0);
            cases.push(uniform_sphere(u, v));
        }
        for n in cases {
            let (t, b) = basis(n);
            for (a, want) in [
                (t.dot(b), 0.0),
                (t.dot(n), 0.0),
                (b.dot(n), 0.0),
                (t.length(), 1.0),
                (b.length(), 1.0),
                (t.cross(b).dot(n), 1.0),
            ] {
                assert!((a - want).abs() < 1e-6, "{n}: {a} not {want}");
            }
        }
    }

    /// The sine of very small angles, which contains all of the randomness there.
    #[test]
    fn directions_near_the_pole_are_not_coarse() {
        for i in 1..1000 {
            let u = i as f32 / 16_777_216.0;
            for direction in [cosine_hemisphere(Vec3::Z, u, 0.0), uniform_sphere(u * 0.25, 0.0)] {
                assert!(
                    (f64::from(direction.x) / f64::from(u).sqrt() - 1.0).abs() < 1e-6 + f64::from(u),
                    "{u}: {direction}"
                );
            }
        }
    }

    /// Of the directions within 0.0035 radians of a pole, the share within 0.003 is (0.003/0.0035)² except
    /// for the sines, with binomial variance. With 24 bits of the word it is 38 of 52.
    #[test]
    fn directions_about_the_poles_are_even() {
        let share = |half: f64| (0.5 * half).sin().powi(2);
        let (inner, outer) = (share(0.003), share(0.0035));
        let n = 1_000_000_u32;
        let z = |number: fn(u32) -> f32, down: bool| {
            let within = (0..n).filter(|&i| {
                let word = crate::random::philox4x32([i, 0, 0, 0], [3, 5])[0];
                let near = (f64::from(word) * outer) as u32;
                let direction = uniform_sphere(number(if down { !near } else { near }), 0.0);
                let sine = f64::from(direction.x);
                assert_eq!(direction.z < 0.0, down);
                sine < 0.003_f64.sin()
            });
            let (p, n) = (inner / outer, f64::from(n));
            (within.count() as f64 - n * p) / (n * p * (1.0 - p)).sqrt()
        };
        for down in [false, true] {
            let (fine, coarse) = (z(crate::random::centred_f32, down), z(crate::random::unit_f32, down));
            assert!(fine.abs() <= 4.5 && coarse.abs() > 4.5, "{fine} {coarse}");
        }
    }

    #[test]
    fn spot_versines_follow_the_intensity() {
        let (inner, outer) = (0.1_f32, 0.3_f32);
        let n = 100_000;
        let mean: f64 = (0..n).map(|i| f64::from(spot_versine(inner, outer, (i as f32 + 0.5) / n as f32))).sum::<f64>()
            / f64::from(n);
        // ∫ v f(v) dv / ∫ f(v) dv, by a fine sum.
        let (mut top, mut bottom) = (0.0, 0.0);
        for i in 0..100_000 {
            let v = 0.3 * (f64::from(i) + 0.5) / 100_000.0;
            let f = f64::from(spot_falloff(v as f32, inner, outer));
            top += v * f;
            bottom += f;
        }
        assert!((mean - top / bottom).abs() < 1e-4, "{mean} {}", top / bottom);
        assert!((spot_solid_angle(inner, outer) - std::f64::consts::TAU * bottom * 0.3 / 100_000.0).abs() < 1e-3);
        // B8: a hard cone of 30°.
        let v = 1.0 - 30.0_f32.to_radians().cos();
        assert!((spot_solid_angle(v, v) - 0.841_787_2).abs() < 1e-6);
        for u in [0.0, 0.5, 1.0 - 1.0 / 16_777_216.0] {
            assert!((0.0..=v).contains(&spot_versine(v, v, u)));
        }
        // With all of it between the cones, the density is zero at the outer one.
        assert_eq!(spot_versine(0.0, 0.5, 0.0), 0.0);
        assert!((spot_versine(0.0, 0.5, 0.875) - 0.25).abs() < 1e-6);
    }

    /// A cone of a ten-thousandth of a degree, whose cosine is 1 in f32, up to one of 120°.
    #[test]
    fn directions_about_an_axis_lie_at_their_versine() {
        for axis in [Vec3::Z, Vec3::new(0.6, -0.64, 0.48), -Vec3::Y] {
            for (v, bound) in [(1.5e-12_f32, 0.3), (1.5e-8, 2e-3), (1e-4, 1e-4), (0.5, 1e-5), (1.5, 1e-5)] {
                for turn in 0..8 {
                    let found = versine(about(axis, v, turn as f32 / 8.0), axis);
                    assert!((found / v - 1.0).abs() < bound, "{axis} {v}: {found}");
                }
            }
        }
    }
}
