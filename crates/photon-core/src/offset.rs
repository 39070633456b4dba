//! Points on triangles, and rays that leave them without hitting them again.

use glam::Vec3;

/// The point `(1 − u − v) a + u b + v c`: far closer to the surface than `origin + t·direction`.
#[inline]
#[must_use]
pub fn barycentric(vertices: [Vec3; 3], u: f32, v: f32) -> Vec3 {
    let [a, b, c] = vertices;
    a * (1.0 - u - v) + b * u + c * v
}

/// Moves `point` off its surface to the side that `normal` points to, by some 256 steps of its own
/// rounding (Wächter and Binder 2019, section 6.2.2.4). The only epsilon of the project; it is for
/// geometry within a unit box.
#[inline]
#[must_use]
pub fn off_surface(point: Vec3, normal: Vec3) -> Vec3 {
    const NEAR_ORIGIN: f32 = 1.0 / 32.0;
    const ABSOLUTE: f32 = 1.0 / 65_536.0;
    const STEPS: f32 = 256.0;
    let axis = |p: f32, n: f32| {
        if p.abs() < NEAR_ORIGIN {
            // Steps shrink with p, so that near 0 they would come to nothing.
            p + ABSOLUTE * n
        } else {
            let steps = (STEPS * n) as i32;
            f32::from_bits(p.to_bits().wrapping_add_signed(if p < 0.0 { -steps } else { steps }))
        }
    };
    Vec3::new(axis(point.x, normal.x), axis(point.y, normal.y), axis(point.z, normal.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moves_to_the_side_of_the_normal_and_no_farther_than_needed() {
        for p in [Vec3::ZERO, Vec3::splat(0.5), Vec3::new(-0.5, 0.02, 0.3), Vec3::splat(1e-30)] {
            for n in [Vec3::X, -Vec3::Y, Vec3::new(0.6, -0.64, 0.48)] {
                let moved = (off_surface(p, n) - p).dot(n);
                assert!(moved > 1e-7 && moved < 6e-5, "{p} {n}: {moved}");
            }
        }
    }
}
