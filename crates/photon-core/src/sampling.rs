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
    // sqrt(1 - u) > 0 since u < 1: never in the plane itself.
    about(n, (1.0 - u).sqrt(), v)
}

/// A direction with density 1/4π.
#[inline]
#[must_use]
pub fn uniform_sphere(u: f32, v: f32) -> Vec3 {
    about(Vec3::Z, 1.0 - 2.0 * u, v)
}

/// The direction at angle acos `cos_theta` from `axis` and `turns` around it.
#[inline]
#[must_use]
pub fn about(axis: Vec3, cos_theta: f32, turns: f32) -> Vec3 {
    let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
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

/// Share of a spot's power that it sends within its inner cone; the rest falls off between the
/// cones.
#[must_use]
pub fn spot_core_share(cos_inner: f32, cos_outer: f32) -> f32 {
    let core = 1.0 - cos_inner;
    core / (core + (cos_inner - cos_outer) / 3.0)
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

/// Cosine from the axis of a spot, with density in proportion to its intensity.
#[inline]
#[must_use]
pub fn spot_cosine(cos_inner: f32, cos_outer: f32, u: f32) -> f32 {
    let share = spot_core_share(cos_inner, cos_outer);
    if u < share {
        1.0 - (u / share) * (1.0 - cos_inner)
    } else {
        // ∫ x² = x³/3 inverted, x rising from the outer cone to the inner one.
        let x = cube_root((u - share) / (1.0 - share));
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
        assert_eq!(spot_core_share(c, c), 1.0);
    }
}
