//! From uniform numbers to points and directions.

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

/// A direction about `n` with density cos θ/π.
#[inline]
#[must_use]
pub fn cosine_hemisphere(n: Vec3, u: f32, v: f32) -> Vec3 {
    // sqrt(1 - u) > 0 since u < 1: never in the plane itself. The sine from u, not from the cosine,
    // whose rounding would be all of it near the pole.
    around(n, u.sqrt(), (1.0 - u).sqrt(), v)
}

/// A direction with density 1/4π.
#[inline]
#[must_use]
pub fn uniform_sphere(u: f32, v: f32) -> Vec3 {
    around(Vec3::Z, 2.0 * (u * (1.0 - u)).sqrt(), 1.0 - 2.0 * u, v)
}

/// The direction at angle acos `cos_theta` from `axis` and `turns` around it.
#[inline]
#[must_use]
pub fn about(axis: Vec3, cos_theta: f32, turns: f32) -> Vec3 {
    let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt();
    around(axis, sin_theta, cos_theta, turns)
}

fn around(axis: Vec3, sin_theta: f32, cos_theta: f32, turns: f32) -> Vec3 {
    let (sin, cos) = sin_cos_turns(turns);
    let (tangent, bitangent) = basis(axis);
    (tangent * (sin_theta * cos) + bitangent * (sin_theta * sin) + axis * cos_theta).normalize_or(axis)
}

/// Weights of the second and third vertex for a uniform point of a triangle (Turk 1990).
#[inline]
#[must_use]
pub fn triangle(u: f32, v: f32) -> (f32, f32) {
    let root = u.sqrt();
    (root * (1.0 - v), root * v)
}

/// A uniform point of the unit disc.
#[inline]
#[must_use]
pub fn disc(u: f32, v: f32) -> (f32, f32) {
    let r = u.sqrt();
    let (sin, cos) = sin_cos_turns(v);
    (r * cos, r * sin)
}

/// A spot's intensity at `cos_theta` from its axis, relative to that on the axis: glTF's
/// `KHR_lights_punctual`, squared.
#[inline]
#[must_use]
pub fn spot_falloff(cos_theta: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    if cos_theta >= cos_inner {
        1.0
    } else if cos_theta <= cos_outer {
        0.0
    } else {
        let x = (cos_theta - cos_outer) / (cos_inner - cos_outer);
        x * x
    }
}

/// Solid angle that [`spot_falloff`] integrates to: a spot's power over its intensity.
#[must_use]
pub fn spot_solid_angle(cos_inner: f32, cos_outer: f32) -> f64 {
    let (inner, outer) = (f64::from(cos_inner), f64::from(cos_outer));
    std::f64::consts::TAU * ((1.0 - inner) + (inner - outer) / 3.0)
}

/// Cosine from the axis of a spot, with density in proportion to its intensity; 1 for `u` = 0,
/// falling from there.
#[inline]
#[must_use]
pub fn spot_cosine(cos_inner: f32, cos_outer: f32, u: f32) -> f32 {
    // Power over 2π and the intensity on the axis: within the inner cone, and between the cones.
    let core = 1.0 - cos_inner;
    let rim = (cos_inner - cos_outer) * (1.0 / 3.0);
    let depth = u * (core + rim);
    // Always so without a rim, since u < 1.
    if depth < core {
        1.0 - depth
    } else {
        // ∫ x² = x³/3 inverted, x rising from the outer cone to the inner one. From 1 - u, which is
        // exact: the root is steep at 0.
        let x = cube_root((1.0 - u) * ((core + rim) / rim)).min(1.0);
        cos_outer + x * (cos_inner - cos_outer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// S28: any unit vector, the poles and neighbours of the sign change included.
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

    /// The sine of the smallest angles: the whole of what is random there.
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

    #[test]
    fn spot_cosines_follow_the_intensity() {
        let (inner, outer) = (0.9_f32, 0.7_f32);
        let n = 100_000;
        let mean: f64 = (0..n).map(|i| f64::from(spot_cosine(inner, outer, (i as f32 + 0.5) / n as f32))).sum::<f64>()
            / f64::from(n);
        // ∫ c f(c) dc / ∫ f(c) dc, by a fine sum.
        let (mut top, mut bottom) = (0.0, 0.0);
        for i in 0..100_000 {
            let c = 0.7 + 0.3 * (f64::from(i) + 0.5) / 100_000.0;
            let f = f64::from(spot_falloff(c as f32, inner, outer));
            top += c * f;
            bottom += f;
        }
        assert!((mean - top / bottom).abs() < 1e-4, "{mean} {}", top / bottom);
        assert!((spot_solid_angle(inner, outer) - std::f64::consts::TAU * bottom * 0.3 / 100_000.0).abs() < 1e-3);
        // B8: a hard cone of 30°.
        let c = 30.0_f32.to_radians().cos();
        assert!((spot_solid_angle(c, c) - 0.841_787_2).abs() < 1e-6);
        for u in [0.0, 0.5, 1.0 - 1.0 / 16_777_216.0] {
            assert!((c..=1.0).contains(&spot_cosine(c, c, u)));
        }
        // All of it between the cones: the density is zero at the outer one.
        assert_eq!(spot_cosine(1.0, 0.5, 0.0), 1.0);
        assert!((spot_cosine(1.0, 0.5, 0.875) - 0.75).abs() < 1e-6);
    }
}
