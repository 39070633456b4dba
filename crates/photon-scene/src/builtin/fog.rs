//! Rooms of fog: shafts of light, and a caustic in the air.

use super::add;
use crate::builder::{MaterialId, SceneBuilder};
use crate::describe::{AmbientMedium, CameraDesc, LightDesc, MaterialDesc};
use crate::shapes::{cuboid, icosphere};

/// Half the width and the depth of the room with a window, and its height.
const HALF: f64 = 3.0;
const HEIGHT: f64 = 3.2;
/// Thickness of the wall with the window.
const WALL: f64 = 0.25;
/// The window, from the front to the back and from below to above, and the number of its openings.
const WINDOW: [[f64; 2]; 2] = [[-2.3, 0.7], [1.1, 2.7]];
const OPENINGS: u32 = 4;
/// Width of the pillars between the openings.
const PILLAR: f64 = 0.34;

/// A room full of mist; through a window with pillars falls the light of a lamp outside.
pub(super) fn fog() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let plaster = scene.material(MaterialDesc::lambert("plaster", [0.48, 0.45, 0.41]));
    let boards = scene.material(MaterialDesc::lambert("boards", [0.42, 0.30, 0.20]));
    let clay = scene.material(MaterialDesc::lambert("clay", [0.62, 0.26, 0.14]));
    scene.medium(AmbientMedium::new([0.16; 3], [0.004; 3]).with_anisotropy(0.35));

    let (h, top) = (HALF, HEIGHT);
    scene.quad("floor", [[-h, 0., h], [h, 0., h], [h, 0., -h], [-h, 0., -h]], boards);
    scene.quad("ceiling", [[-h, top, -h], [h, top, -h], [h, top, h], [-h, top, h]], plaster);
    scene.quad("back wall", [[-h, 0., -h], [h, 0., -h], [h, top, -h], [-h, top, -h]], plaster);
    scene.quad("right wall", [[h, 0., -h], [h, 0., h], [h, top, h], [h, top, -h]], plaster);
    scene.quad("front wall", [[h, 0., h], [-h, 0., h], [-h, top, h], [h, top, h]], plaster);
    window(&mut scene, plaster);
    add(&mut scene, "ball", icosphere(5, [-0.35, 0.452, -0.9], 0.45), clay);
    add(&mut scene, "block", cuboid([0.75, 0.002, -1.9], [1.45, 0.9, -1.2]), plaster);

    let lamp = LightDesc::Spot {
        position: [-6.2, 4.5, -1.5],
        direction: [3.2, -2.6, 0.7],
        intensity: [620.0, 540.0, 420.0],
        inner_angle: 0.40,
        outer_angle: 0.48,
    };
    scene.light("lamp outside", lamp);
    scene.camera("inside", CameraDesc::look_at([1.7, 1.5, 2.7], [-0.9, 1.25, -1.2], [0., 1., 0.], 0.95));
    scene
}

/// The wall at the left, with openings.
fn window(scene: &mut SceneBuilder, material: MaterialId) {
    let [[front, back], [low, high]] = WINDOW;
    let (inner, outer) = (-HALF, -HALF - WALL);
    // Deeper than the floor and higher than the ceiling, whose edges are at its inner side.
    let below = cuboid([outer, -0.1, -HALF - 0.1], [inner, low, HALF + 0.1]);
    add(scene, "wall below the window", below, material);
    let above = cuboid([outer, high, -HALF - 0.1], [inner, HEIGHT + 0.1, HALF + 0.1]);
    add(scene, "wall above the window", above, material);
    let width = (back - front - PILLAR * f64::from(OPENINGS - 1)) / f64::from(OPENINGS);
    for pillar in 0..=OPENINGS {
        let from = front + (width + PILLAR) * f64::from(pillar) - PILLAR;
        // The first and the last are the rest of the wall.
        let from = if pillar == 0 { -HALF - 0.1 } else { from };
        let to = match pillar {
            0 => front,
            OPENINGS => HALF + 0.1,
            _ => from + PILLAR,
        };
        let from = if pillar == OPENINGS { back } else { from };
        add(scene, &format!("pillar {pillar}"), cuboid([outer, low - 0.1, from], [inner, high + 0.1, to]), material);
    }
}

/// A glass ball in fog, before a spotlight: behind the ball its light converges to a caustic in the air.
pub(super) fn glass_fog() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let slate = scene.material(MaterialDesc::lambert("slate", [0.20, 0.21, 0.23]));
    let wall = scene.material(MaterialDesc::lambert("wall", [0.12, 0.14, 0.18]));
    let glass = scene.material(MaterialDesc::glass("glass", 1.5));
    let glow = scene.material(MaterialDesc::emissive("panel", [0.0; 3], [0.10, 0.12, 0.16]));
    scene.medium(AmbientMedium::new([0.12; 3], [0.01; 3]));

    let x = 2.6;
    scene.quad("floor", [[-x, 0., 1.8], [x, 0., 1.8], [x, 0., -1.6], [-x, 0., -1.6]], slate);
    scene.quad("wall", [[-x, 0., -1.6], [x, 0., -1.6], [x, 2.8, -1.6], [-x, 2.8, -1.6]], wall);
    // Dim light from above, by which the room is seen.
    scene.quad("panel", [[-1.2, 2.9, -1.2], [1.2, 2.9, -1.2], [1.2, 2.9, 1.2], [-1.2, 2.9, 1.2]], glow);
    add(&mut scene, "ball", icosphere(7, [-0.35, 1.02, 0.0], 0.42), glass);
    let spot = LightDesc::Spot {
        position: [-2.35, 1.72, 0.0],
        direction: [2.0, -0.70, 0.0],
        intensity: [60.0, 56.0, 48.0],
        inner_angle: 0.225,
        outer_angle: 0.25,
    };
    scene.light("spot", spot);
    scene.camera("front", CameraDesc::look_at([0.15, 1.15, 3.9], [0.1, 0.95, 0.0], [0., 1., 0.], 0.62));
    scene
}
