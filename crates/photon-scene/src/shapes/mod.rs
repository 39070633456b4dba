//! Triangle meshes of simple shapes, in f64 and user space, y upwards.
//!
//! Closed shapes share vertices between neighbouring triangles, so that they have no seams, and
//! outward-facing: their triangles run counter-clockwise as seen from outside. [`flip`] turns a solid
//! into a room.
//!
//! Counts below the minimum are raised to it. Sizes are not checked here:
//! [`crate::SceneBuilder::build`] reports numbers that are not finite.

mod plane;
mod revolution;
mod solid;
mod sphere;

pub use plane::{disc, grid, quad};
pub use revolution::{cylinder, revolve, revolve_loop, torus, tube};
pub use solid::{cuboid, height_field, prism, rotate_y, translate};
pub use sphere::{icosphere, uv_sphere};

use crate::edges;
use glam::DVec3;

/// Vertices, and three indices into them for each triangle.
pub type Shape = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// The same shape with front and back exchanged.
#[must_use]
pub fn flip((positions, mut triangles): Shape) -> Shape {
    for corners in &mut triangles {
        corners.swap(1, 2);
    }
    (positions, triangles)
}

/// Merges several shapes into one.
#[must_use]
pub fn join(shapes: impl IntoIterator<Item = Shape>) -> Shape {
    let mut joined = Shape::default();
    for (positions, triangles) in shapes {
        let first = joined.0.len() as u32;
        joined.0.extend(positions);
        joined.1.extend(triangles.into_iter().map(|corners| corners.map(|index| index + first)));
    }
    joined
}

/// Sum of the areas of all triangles.
#[must_use]
pub fn area(shape: &Shape) -> f64 {
    corners(shape).map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
}

/// Volume enclosed by a closed shape, negative if it faces inwards (divergence theorem).
#[must_use]
pub fn volume(shape: &Shape) -> f64 {
    corners(shape).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// Number of directed edges without a counterpart in the opposite direction; 0 for a closed shape.
#[must_use]
pub fn open_edges(shape: &Shape) -> usize {
    edges::open_edges(edges::edges_of(shape.1.iter().copied()))
}

fn corners((positions, triangles): &Shape) -> impl Iterator<Item = [DVec3; 3]> {
    triangles.iter().map(|corners| corners.map(|index| DVec3::from_array(positions[index as usize])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Checks that shared vertices close the mesh: every edge twice, once per direction, and no unused vertex.
    pub(super) fn assert_closed(name: &str, shape: &Shape) {
        assert_eq!(open_edges(shape), 0, "{name} has open edges");
        let mut edges: Vec<(u32, u32)> = shape.1.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        edges.sort_unstable();
        assert!(edges.windows(2).all(|pair| pair[0] != pair[1]), "{name} uses an edge twice in one direction");
        let mut used = vec![false; shape.0.len()];
        shape.1.iter().flatten().for_each(|&index| used[index as usize] = true);
        assert!(used.into_iter().all(|used| used), "{name} has vertices that no triangle uses");
    }

    /// Euler characteristic V − E + F.
    fn euler(shape: &Shape) -> i64 {
        shape.0.len() as i64 - (shape.1.len() * 3 / 2) as i64 + shape.1.len() as i64
    }

    #[test]
    fn closed_shapes_are_closed_face_outwards_and_have_the_right_size() {
        let at = [3.0, -2.0, 0.5];
        // Name, shape, area, volume, Euler characteristic, relative tolerance of area and volume.
        let cases = [
            ("icosphere", icosphere(5, at, 2.0), 16.0 * PI, 32.0 / 3.0 * PI, 2, 2e-3),
            ("uv sphere", uv_sphere(128, 64, at, 2.0), 16.0 * PI, 32.0 / 3.0 * PI, 2, 2e-3),
            ("cuboid", cuboid([-1., 0., 2.], [1., 3., 6.]), 52.0, 24.0, 2, 1e-14),
            ("cylinder", cylinder(at, 0.5, 2.0, 256), 2.5 * PI, 0.5 * PI, 2, 1e-3),
            ("tube", tube(at, 1.0, 1.5, 0.5, 512), 5.0 * PI, 0.625 * PI, 0, 1e-3),
            ("torus", torus(at, 2.0, 0.5, 256, 128), 4.0 * PI * PI, PI * PI, 0, 1e-3),
            ("height field", height_field([0., 0.], [2., 3.], [4, 5], -1.0, |_, _| 1.0), 32.0, 12.0, 2, 1e-14),
            (
                "prism",
                prism(&[[0., 0.], [0., 2.], [1., 2.], [1., 1.], [2., 1.], [2., 0.]], 3, 0., 1.),
                14.,
                3.,
                2,
                1e-14,
            ),
        ];
        for (name, shape, expected_area, expected_volume, characteristic, tolerance) in cases {
            assert_closed(name, &shape);
            let (area, volume) = (area(&shape), volume(&shape));
            assert!((area / expected_area - 1.0).abs() < tolerance, "{name}: area {area}, not {expected_area}");
            assert!(
                (volume / expected_volume - 1.0).abs() < tolerance,
                "{name}: volume {volume}, not {expected_volume}"
            );
            assert_eq!(euler(&shape), characteristic, "{name}");
            let flipped = super::volume(&flip(shape));
            assert!((flipped + volume).abs() <= 1e-12 * volume, "{name}: flipped, {flipped}");
        }
    }

    #[test]
    fn the_check_for_closed_shapes_sees_a_hole() {
        let mut holed = icosphere(2, [0.0; 3], 1.0);
        holed.1.swap_remove(7);
        assert_eq!(open_edges(&holed), 3);
        let mut turned = cuboid([0.0; 3], [1.0; 3]);
        turned.1[0].swap(0, 1);
        assert!(open_edges(&turned) > 0);
    }

    #[test]
    fn absurd_counts_are_taken_as_the_least() {
        for (name, shape) in [
            ("uv sphere", uv_sphere(0, 0, [0.0; 3], 1.0)),
            ("cylinder", cylinder([0.0; 3], 1.0, 1.0, 0)),
            ("tube", tube([0.0; 3], 1.0, 2.0, 1.0, 1)),
            ("torus", torus([0.0; 3], 2.0, 1.0, 0, 0)),
            ("height field", height_field([0.0; 2], [1.0; 2], [0, 0], -1.0, |_, _| 0.0)),
            ("icosphere", icosphere(0, [0.0; 3], 1.0)),
        ] {
            assert_closed(name, &shape);
            assert!(volume(&shape) > 0.0, "{name}");
        }
    }

    #[test]
    fn flat_shapes_have_the_right_area_and_side() {
        let corners = [[0., 0., 0.], [0., 0., 3.], [2., 0., 3.], [2., 0., 0.]];
        for (name, shape, expected) in [
            ("quad", quad(corners), 6.0),
            ("grid", grid(corners, 5, 7), 6.0),
            ("disc", disc([1.0, 2.0, 3.0], [0.0, 5.0, 0.0], 2.0, 1024), 4.0 * PI),
        ] {
            assert!((area(&shape) / expected - 1.0).abs() < 1e-4, "{name}: {}", area(&shape));
            for [a, b, c] in super::corners(&shape) {
                assert!((b - a).cross(c - a).y > 0.0, "{name} must face upwards");
            }
        }
        assert_eq!(grid(corners, 5, 7).1.len(), 70);
        assert_eq!(grid(corners, 0, 0).1.len(), 2);
    }

    #[test]
    fn joined_and_moved_shapes_keep_their_size() {
        let one = cuboid([0.0; 3], [1.0, 2.0, 3.0]);
        let moved = translate(rotate_y(one.clone(), 0.7), [5.0, 6.0, 7.0]);
        let both = join([one, moved]);
        assert_closed("both", &both);
        assert!((volume(&both) - 12.0).abs() < 1e-10, "{}", volume(&both));
    }
}
