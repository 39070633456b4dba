//! Origins of shadow rays on coarse meshes with vertex normals; `shadow_terminator.glsl` is the twin.
//!
//! Near the shadow terminator, where light grazes the smooth surface that vertex normals describe, whole triangles face
//! away from the light: they would be black, beside triangles that are shaded smoothly. Shadow rays therefore start
//! outside the mesh, at the mean of the projections of the point p to the tangent planes of the vertices,
//! `p' = p − Σ wᵢ ((p − vᵢ)·nᵢ) nᵢ`. That is a point of the smooth surface of Boubekeur and Alexa 2008 ("Phong
//! Tessellation", equation 3). On a convex surface, where p is below all of these planes, it is the point of Hanika 2021
//! ("Hacking the Shadow Terminator", Ray Tracing Gems II, chapter 4), who leaves out planes that p is above; with those,
//! p' is p on a flat triangle with the same normal at all vertices, tilted or not. At vertices and in hollows, p' is p too.
//!
//! Where p' is not p, light counts by its cosine to the shading normal alone, although it may come from below the plane of
//! the triangle: the limit of [`crate::shading_normal`] does not apply.

use glam::Vec3;

use crate::scene::caster::Ray;
use crate::shading::offset;

/// The vector from `point` to where shadow rays start: `point` is on the triangle, with barycentric coordinates `weights`,
/// and `geometric` is its unit normal on the side of the viewer; the sides of `normals` do not matter. At most as long as the longest edge. 0 if
/// it ends less than [`offset::STEP`] above the triangle, or if a coordinate is 1 or more, half the size of the scene.
#[inline]
#[must_use]
pub fn offset(vertices: [Vec3; 3], normals: [Vec3; 3], weights: [f32; 3], point: Vec3, geometric: Vec3) -> Vec3 {
    let [a, b, c]: [Vec3; 3] = std::array::from_fn(|corner| {
        let below = -(point - vertices[corner]).dot(normals[corner]);
        normals[corner] * (weights[corner] * below)
    });
    let sum = a + b + c;
    if sum.dot(geometric) >= offset::STEP && sum.abs().max_element() < 1.0 { sum } else { Vec3::ZERO }
}

/// The ray from a surface to where shadow rays start. If it meets anything, they must start at the surface instead.
#[inline]
#[must_use]
pub fn probe(point: Vec3, geometric: Vec3, offset: Vec3) -> Ray {
    let length = offset.length();
    Ray { origin: offset::off_surface(point, geometric), direction: offset / length, t_max: length }
}

/// `offset`, of coordinates below 1, in 32 bits: a common exponent of the coordinates in 5 bits, and 9 bits for each of
/// them, so that it is off by at most 1/256 of its largest coordinate along each axis. 0 for 0 and for less than 2⁻³¹.
#[inline]
#[must_use]
pub fn pack(offset: Vec3) -> u32 {
    let largest = offset.abs().max_element();
    // Below 2 to the power of this.
    let exponent = ((largest.to_bits() >> 23) as i32 - 126).min(0);
    if exponent < -30 {
        return 0;
    }
    let scale = f32::from_bits(((135 - exponent) as u32) << 23);
    let bits = |coordinate: f32| ((coordinate * scale + 256.5) as i32).clamp(1, 511) as u32;
    ((exponent + 31) as u32) << 27 | bits(offset.z) << 18 | bits(offset.y) << 9 | bits(offset.x)
}

/// The inverse of [`pack`].
#[inline]
#[must_use]
pub fn unpack(bits: u32) -> Vec3 {
    if bits == 0 {
        return Vec3::ZERO;
    }
    let scale = f32::from_bits(((bits >> 27) + 88) << 23);
    Vec3::from([bits, bits >> 9, bits >> 18].map(|part| ((part & 511) as f32 - 256.0) * scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WEIGHTS: [[f32; 3]; 4] = [[0.3, 0.3, 0.4], [0.1, 0.2, 0.7], [0.0, 0.5, 0.5], [0.9, 0.05, 0.05]];

    fn interpolated(values: [Vec3; 3], [a, b, c]: [f32; 3]) -> Vec3 {
        values[0] * a + values[1] * b + values[2] * c
    }

    /// On a unit sphere with normals `vᵢ`, the sum is `Σ_{i<j} wᵢ wⱼ (1 − vᵢ·vⱼ)(vᵢ + vⱼ)`, and p' is outside the sphere.
    #[test]
    fn offsets_on_a_sphere() {
        let corners = [[0.0, 0.6, 0.8], [0.48, -0.36, 0.8], [-0.48, -0.36, 0.8]].map(Vec3::from);
        let [a, b, c] = corners;
        let geometric = (b - a).cross(c - a).normalize_or_zero() * -1.0;
        for weights in WEIGHTS {
            let point = interpolated(corners, weights);
            let found = offset(corners, corners, weights, point, geometric);
            let mut expected = Vec3::ZERO;
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                let share = weights[i] * weights[j] * (1.0 - corners[i].dot(corners[j]));
                expected += (corners[i] + corners[j]) * share;
            }
            assert!(found.distance(expected) < 1e-6, "{weights:?}: {found} for {expected}");
            assert!((point + found).length() > 1.0, "{weights:?}: {}", (point + found).length());
            // Seen from inside, the sphere is hollow.
            let inside = corners.map(|normal| -normal);
            assert_eq!(offset(corners, inside, weights, point, -geometric), Vec3::ZERO);
        }
        assert_eq!(offset(corners, corners, [1.0, 0.0, 0.0], a, geometric), Vec3::ZERO);
    }

    /// On a flat triangle with its own normal at all vertices, nothing moves, to the bit.
    #[test]
    fn flat_triangles_have_no_offset() {
        let corners = [[0.1, 0.7, -0.3], [0.9, 0.2, 0.4], [-0.2, -0.5, 0.6]].map(Vec3::from);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        for weights in WEIGHTS {
            let point = interpolated(corners, weights);
            assert_eq!(offset(corners, [normal; 3], weights, point, normal), Vec3::ZERO);
        }
        // Nor with a tilted one.
        for tilted in [[0.2, 0.4, 0.9], [-0.6, 0.1, 0.7]] {
            let tilted = (normal * 2.0 + Vec3::from(tilted)).normalize_or_zero();
            for weights in WEIGHTS {
                let point = interpolated(corners, weights);
                assert_eq!(offset(corners, [tilted; 3], weights, point, normal), Vec3::ZERO);
            }
        }
        // Normals that point below the surface never move it there.
        let below = offset(corners, [-normal, -normal, normal], WEIGHTS[0], interpolated(corners, WEIGHTS[1]), normal);
        assert!(below.dot(normal) >= 0.0, "{below}");
        assert_eq!(offset(corners, [Vec3::NAN; 3], WEIGHTS[0], corners[0], normal), Vec3::ZERO);
    }

    #[test]
    fn packed_offsets_are_near() {
        for exponent in 0..30 {
            for direction in [[1.0, -0.3, 0.2], [-0.5, 0.49999, 0.01], [0.0, 0.0, -0.999_99], [0.5, -0.5, 0.5]] {
                let offset = Vec3::from(direction) * 0.999 / f32::from_bits((127 + exponent) << 23);
                let (found, largest) = (unpack(pack(offset)), offset.abs().max_element());
                assert!((found - offset).abs().max_element() <= largest / 256.0, "{offset}: {found}");
                assert_eq!(pack(found), pack(offset), "{offset}");
            }
        }
        assert_eq!((pack(Vec3::ZERO), unpack(0)), (0, Vec3::ZERO));
        assert_eq!(pack(Vec3::splat(1e-12)), 0);
        assert!(unpack(pack(Vec3::splat(3.0))).max_element() < 1.0);
    }

    #[test]
    fn probes_end_at_the_new_origin() {
        let ray = probe(Vec3::ZERO, Vec3::Z, Vec3::new(0.3, 0.0, 0.4));
        assert_eq!((ray.origin, ray.t_max), (Vec3::Z * offset::STEP, 0.5));
        assert!(ray.direction.distance(Vec3::new(0.6, 0.0, 0.8)) < 1e-6);
    }
}
