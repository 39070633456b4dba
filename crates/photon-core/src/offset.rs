//! Points on triangles, and rays that leave them without hitting them again.

use glam::Vec3;

/// The point `(1 − u − v) a + u b + v c`: far closer to the surface than `origin + t·direction`.
#[inline]
#[must_use]
pub fn barycentric(vertices: [Vec3; 3], u: f32, v: f32) -> Vec3 {
    let [a, b, c] = vertices;
    a * (1.0 - u - v) + b * u + c * v
}

/// Moves `point` off its surface to the side that `normal` points to, by some 16 steps of the
/// rounding of geometry within a unit box. The only epsilon of the project.
///
/// Along the normal and no other way, unlike the offset in steps of each coordinate (Wächter and
/// Binder 2019, section 6.2.2.4), which is for geometry of any size: near an edge that one can push
/// the point sideways through the next wall. Of 2·10⁷ bounces in a rotated room 15 leaked with it.
#[inline]
#[must_use]
pub fn off_surface(point: Vec3, normal: Vec3) -> Vec3 {
    point + normal * STEP
}

const STEP: f32 = 1.0 / 1_048_576.0;

/// No weight is raised to more than this: of three such, the rest is more than half.
const MOST: f32 = 1.0 / 16.0;

/// A point of a triangle that a ray begins at: [`barycentric`], two steps at least from its edges.
///
/// Rounding may put a point beside an edge behind the wall that begins there, which the next ray then
/// never meets. For photons that leave a lamp; rays that go on from a hit begin at the hit, since moving
/// those let paths into the thin wall of a finely cut cylinder, though 5 of 10⁸ bounces in a rotated room
/// leak without it. Distances are bounded from
/// below by norms without roots, whose bits would not be the same everywhere; slivers keep a
/// sixteenth of their width.
#[inline]
#[must_use]
pub fn within(vertices: [Vec3; 3], u: f32, v: f32) -> Vec3 {
    if u.min(v).min(1.0 - u - v) >= MOST {
        return barycentric(vertices, u, v);
    }
    let [u, v] = inward(vertices, u, v);
    barycentric(vertices, u, v)
}

/// Weights of the second and third vertex that are two steps at least from every edge.
fn inward([a, b, c]: [Vec3; 3], u: f32, v: f32) -> [f32; 2] {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    // Twice the area, by its largest component; a length by the sum of its components.
    let area = ab.cross(ac).abs().max_element();
    let least = |edge: Vec3| {
        let length = edge.x.abs() + edge.y.abs() + edge.z.abs();
        let wanted = 2.0 * STEP * length;
        if wanted < MOST * area { wanted / area } else { MOST }
    };
    let (u, v) = (u.max(least(ac)), v.max(least(ab)));
    let lack = least(bc) - (1.0 - u - v);
    if lack > 0.0 { if u > v { [u - lack, v] } else { [u, v - lack] } } else { [u, v] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distances from the three edges.
    fn distances([a, b, c]: [Vec3; 3], point: Vec3) -> [f64; 3] {
        let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| (from.as_dvec3(), to.as_dvec3()));
        edges.map(|(from, to)| (point.as_dvec3() - from).cross(to - from).length() / (to - from).length())
    }

    #[test]
    fn points_keep_away_from_edges_and_stay_where_they_are_otherwise() {
        let triangles = [
            [Vec3::ZERO, Vec3::X, Vec3::Y],
            [Vec3::new(-0.5, 0.1, 0.2), Vec3::new(0.4, -0.5, 0.3), Vec3::new(0.1, 0.45, -0.4)],
            [Vec3::splat(0.25), Vec3::new(0.25, 0.251, 0.25), Vec3::new(0.2505, 0.25, 0.2502)],
        ];
        for triangle in triangles {
            for (u, v) in
                [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.0, 0.3), (0.7, 0.0), (1e-7, 1e-7), (0.2, 0.8)]
            {
                let (before, after) = (barycentric(triangle, u, v), within(triangle, u, v));
                // Rounding of a point is less than a step.
                assert!(distances(triangle, after).iter().all(|&away| away > 1.5e-6), "{triangle:?} {u} {v}");
                assert!(before.distance(after) < 3e-5, "{triangle:?} {u} {v}: {before} {after}");
            }
            for (u, v) in [(0.3, 0.3), (0.05, 0.9), (0.04, 0.04), (0.9, 0.06)] {
                assert_eq!(within(triangle, u, v), barycentric(triangle, u, v));
            }
        }
    }

    #[test]
    fn slivers_and_what_is_no_triangle_give_points_within() {
        let sliver = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 1e-7, 0.0)];
        for triangle in [sliver, [Vec3::ONE * 0.5; 3], [Vec3::ZERO, Vec3::X, Vec3::X * 0.5]] {
            for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.4, 0.6)] {
                let [u, v] = inward(triangle, u, v);
                assert!(u > 0.0 && v > 0.0 && u + v < 1.0, "{u} {v}");
            }
        }
    }

    #[test]
    fn moves_to_the_side_of_the_normal_and_no_farther_than_needed() {
        for p in [Vec3::ZERO, Vec3::splat(0.5), Vec3::new(-0.5, 0.02, 0.3), Vec3::splat(1e-30)] {
            for n in [Vec3::X, -Vec3::Y, Vec3::new(0.6, -0.64, 0.48)] {
                let moved = (off_surface(p, n) - p).dot(n);
                assert!(moved > 9e-7 && moved < 1e-6, "{p} {n}: {moved}");
                let sideways = (off_surface(p, n) - p).cross(n).length();
                assert!(sideways < 6e-8, "{p} {n}: {sideways}");
            }
        }
    }
}
