//! A ball of water in sunlight, and its rainbow on a screen (Theodoric of Freiberg 1304, Descartes 1637).

use std::f64::consts::TAU;

use crate::builder::{MaterialId, SceneBuilder};
use crate::describe::{CameraDesc, Dispersion, LightDesc, MaterialDesc};
use crate::mesh::VertexAttributes;
use crate::shapes::icosphere;

/// Radius of the ball, which is at the origin.
const BALL: f64 = 0.1;
/// Distance of the screen, towards the sun.
const SCREEN: f64 = 1.0;
/// Radii of the hole in the screen, through which the sun shines on the ball, and of its rim.
const RING: [f64; 2] = [1.02 * BALL, 1.5];
/// Distance of the sun, all of whose light meets the ball: its directions differ by half a degree, as those of the true sun. From
/// farther away, the ball would be too small beside the scene for exact refractions.
const SUN: f64 = 20.0;
/// Irradiance at the ball, W/m².
const IRRADIANCE: f64 = 1500.0;
/// n = A + B/λ² of water: 1.3311 at 0.7 µm, 1.3428 at 0.4 µm.
const WATER: [f64; 2] = [1.325_427, 0.002_779_7];

/// The sun shines along −z, through a hole in a round screen; the ball sends the bow back to the screen, at 40.6 to 42.4 degrees
/// from the axis, and a fainter one in inverse order from 50.4 degrees on. The rest of the light leaves the scene.
pub(super) fn rainbow() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let white = scene.material(MaterialDesc::lambert("screen", [0.8; 3]));
    let water = scene.material(MaterialDesc::glass("water", 1.333).with_dispersion(Dispersion::Cauchy(WATER)));
    // With normals that point away from the centre, chords err by the depth of a triangle below the ball: 0.01 degrees.
    let (positions, triangles) = icosphere(5, [0.0; 3], BALL);
    let normals = positions.iter().map(|position| position.map(|part| part / BALL)).collect();
    scene.mesh_with("ball", positions, triangles, VertexAttributes::default().with_normals(normals), water);
    screen(&mut scene, white);
    let sun = LightDesc::Spot {
        position: [0.0, 0.0, SUN],
        direction: [0.0, 0.0, -1.0],
        intensity: [IRRADIANCE * SUN * SUN; 3],
        inner_angle: 0.99 * BALL / SUN,
        outer_angle: BALL / SUN,
    };
    scene.light("sun", sun);
    scene.camera("bow", CameraDesc::look_at([0.45, 0.25, -1.5], [0.05, 0.5, 1.0], [0.0, 1.0, 0.0], 0.66));
    scene
}

/// A ring that faces the ball.
fn screen(scene: &mut SceneBuilder, material: MaterialId) {
    const SIDES: u32 = 128;
    let around = |radius: f64| {
        (0..SIDES).map(move |side| {
            let (sine, cosine) = libm::sincos(TAU * f64::from(side) / f64::from(SIDES));
            [radius * cosine, radius * sine, SCREEN]
        })
    };
    let positions = RING.into_iter().flat_map(around).collect();
    let pair = |side: u32| {
        let next = (side + 1) % SIDES;
        [[side, next, SIDES + next], [side, SIDES + next, SIDES + side]]
    };
    scene.mesh("screen", positions, (0..SIDES).flat_map(pair).collect(), material);
}
