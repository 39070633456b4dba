//! A ring on a table, with the cardioid caustic known from coffee cups.

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, LightDesc, MaterialDesc};
use crate::shapes::{disc, tube};

/// Radius of the inner wall.
const INNER: f64 = 1.0;
const OUTER: f64 = 1.06;
/// Height of the ring. A light at height H casts the whole caustic from the part of the wall at height H/4: there
/// a ray has travelled three quarters of its way to the caustic. From H/2 on, reflections reach across the ring, so
/// that the upper edge of the reflected light is not visible inside.
const RING: f64 = 0.62;
const LIGHT: f64 = 1.24;
/// The envelope is smooth only if the triangles are narrower than the resolution of the picture.
const SEGMENTS: u32 = 8192;

/// A golden ring, lit by a spot light straight above a point of its inner wall.
///
/// Seen from above, reflections in an upright cylinder are those in a circle, and rays from a point on
/// the circle, reflected once, envelop a cardioid, whose cusp lies a third of the radius beyond the
/// centre as seen from the light: at x = −1/3, z = 0.
pub(super) fn ring() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let table = scene.material(MaterialDesc::lambert("table", [0.62, 0.58, 0.54]));
    let gold = scene.material(MaterialDesc::mirror("gold", [0.95, 0.78, 0.42]));
    let panel = scene.material(MaterialDesc::emissive("panel", [0.0; 3], [0.36, 0.42, 0.50]));

    add(&mut scene, "table", disc([0., 0., 0.], [0., 1., 0.], 4.5, 128), table);
    // The lower rim extends into the table, so that no light leaks under it.
    add(&mut scene, "ring", tube([0., -0.01, 0.], INNER, OUTER, RING + 0.01, SEGMENTS), gold);
    // A dim, distant panel: fills the shadows and gives the metal something to reflect.
    scene.quad("panel", [[-5., 5., -7.5], [3., 5., -7.5], [3., 5., -1.], [-5., 5., -1.]], panel);
    scene.light(
        "spot",
        LightDesc::Spot {
            position: [INNER, LIGHT, 0.],
            // Along the bisector of the region to be lit: the table beyond, and the ring.
            direction: [-0.8, -LIGHT, 0.],
            intensity: [7.5, 7.2, 6.6],
            inner_angle: 0.9,
            outer_angle: 1.35,
        },
    );
    scene.camera("above", CameraDesc::look_at([0.6, 3.3, 2.6], [-0.05, 0.15, 0.08], [0., 1., 0.], 0.62));
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wall_is_high_enough_for_the_whole_caustic() {
        const { assert!(RING >= LIGHT / 2.0) }
    }

    /// Rays from the light, reflected in the mathematical cylinder near the plane of symmetry, cross
    /// that plane at a third of the radius.
    #[test]
    fn the_cusp_lies_a_third_of_the_radius_beyond_the_centre() {
        let angle = 1e-4_f64;
        // From (1, 0) to the wall at π − angle, and the reflected direction from there.
        let wall = [-angle.cos() * INNER, angle.sin() * INNER];
        let (dx, dz) = (wall[0] - INNER, wall[1]);
        let along = 2.0 * (dx * wall[0] + dz * wall[1]) / (INNER * INNER);
        let (rx, rz) = (dx - along * wall[0], dz - along * wall[1]);
        let crossing = wall[0] - wall[1] * rx / rz;
        assert!((crossing + INNER / 3.0).abs() < 1e-6, "{crossing}");
    }
}
