//! Rooms of fog: shafts of light, and a caustic in the air.

use super::add;
use crate::builder::{MaterialId, SceneBuilder};
use crate::describe::{AmbientMedium, CameraDesc, LightDesc, MaterialDesc};
use crate::shapes::{cuboid, icosphere};

/// Half the width and the depth of the room with a window, and its height.
const HALF: f64 = 3.0;
const HEIGHT: f64 = 3.2;
/// Thickness of the wall with the window.
const WALL: f64 = 0.2;
/// The window, from the back to the front and from below to above, and the number of its openings.
const WINDOW: [[f64; 2]; 2] = [[-2.4, -1.4], [0.75, 2.75]];
const OPENINGS: u32 = 3;
/// Height of the wall between two openings: the shafts of light are apart as seen from the side.
const BETWEEN: f64 = 0.52;

/// A room full of mist; through three openings in a wall, one above the other, falls the light of a spot light outside.
pub(super) fn fog() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let plaster = scene.material(MaterialDesc::lambert("plaster", [0.40, 0.38, 0.35]));
    let boards = scene.material(MaterialDesc::lambert("boards", [0.32, 0.23, 0.16]));
    let clay = scene.material(MaterialDesc::lambert("clay", [0.62, 0.26, 0.14]));
    scene.medium(AmbientMedium::new([0.14; 3], [0.002; 3]).with_phase(0.2));

    let (h, top) = (HALF, HEIGHT);
    scene.quad("floor", [[-h, 0., h], [h, 0., h], [h, 0., -h], [-h, 0., -h]], boards);
    scene.quad("ceiling", [[-h, top, -h], [h, top, -h], [h, top, h], [-h, top, h]], plaster);
    scene.quad("back wall", [[-h, 0., -h], [h, 0., -h], [h, top, -h], [-h, top, -h]], plaster);
    scene.quad("right wall", [[h, 0., -h], [h, 0., h], [h, top, h], [h, top, -h]], plaster);
    scene.quad("front wall", [[h, 0., h], [-h, 0., h], [-h, top, h], [h, top, h]], plaster);
    window(&mut scene, plaster);
    // Slightly above the floor: if they touched, it would be ambiguous which one a ray hits.
    add(&mut scene, "ball", icosphere(5, [-0.75, 0.402, -1.75], 0.4), clay);
    add(&mut scene, "block", cuboid([1.5, 0.002, -2.2], [2.2, 0.9, -1.5]), plaster);

    let spot = LightDesc::Spot {
        position: [-7.6, 4.9, -1.9],
        direction: [4.6, -3.15, 0.0],
        intensity: [5000.0, 4350.0, 3400.0],
        inner_angle: 0.21,
        outer_angle: 0.26,
    };
    scene.light("spot outside", spot);
    scene.camera("inside", CameraDesc::look_at([0.4, 1.4, 2.85], [-0.75, 1.2, -1.9], [0., 1., 0.], 0.98));
    scene
}

/// The wall at the left, with openings.
fn window(scene: &mut SceneBuilder, material: MaterialId) {
    let [[back, front], [low, high]] = WINDOW;
    let (inner, outer) = (-HALF, -HALF - WALL);
    // Beyond the floor, the ceiling and the other walls, whose edges are at its inner side.
    let (bottom, top, end) = (-0.1, HEIGHT + 0.1, HALF + 0.1);
    add(scene, "wall before the window", cuboid([outer, bottom, front], [inner, top, end]), material);
    add(scene, "wall behind the window", cuboid([outer, bottom, -end], [inner, top, back]), material);
    let height = (high - low - BETWEEN * f64::from(OPENINGS - 1)) / f64::from(OPENINGS);
    for part in 0..=OPENINGS {
        let opening = low + (height + BETWEEN) * f64::from(part);
        let from = if part == 0 { bottom } else { opening - BETWEEN };
        let to = if part == OPENINGS { top } else { opening };
        // They reach into the walls beside the window.
        let shape = cuboid([outer, from, back - 0.05], [inner, to, front + 0.05]);
        add(scene, &format!("wall between, part {part}"), shape, material);
    }
}

/// A glass ball in fog, before a spotlight: behind the ball its light converges to a caustic in the air.
pub(super) fn glass_fog() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let slate = scene.material(MaterialDesc::lambert("slate", [0.20, 0.21, 0.23]));
    let wall = scene.material(MaterialDesc::lambert("wall", [0.16, 0.19, 0.24]));
    let glass = scene.material(MaterialDesc::glass("glass", 1.5));
    let glow = scene.material(MaterialDesc::emissive("panel", [0.0; 3], [1.4, 1.7, 2.1]));
    scene.medium(AmbientMedium::new([0.12; 3], [0.01; 3]));

    let x = 2.6;
    scene.quad("floor", [[-x, 0., 1.8], [x, 0., 1.8], [x, 0., -1.6], [-x, 0., -1.6]], slate);
    scene.quad("wall", [[-x, 0., -1.6], [x, 0., -1.6], [x, 2.8, -1.6], [-x, 2.8, -1.6]], wall);
    // Dim light from above, by which the room is seen.
    scene.quad("panel", [[-1.2, 2.9, -1.2], [1.2, 2.9, -1.2], [1.2, 2.9, 1.2], [-1.2, 2.9, 1.2]], glow);
    add(&mut scene, "ball", icosphere(7, [-0.45, 1.10, 0.0], 0.42), glass);
    let spot = LightDesc::Spot {
        position: [-3.0, 2.0, 0.0],
        direction: [2.55, -0.90, 0.0],
        intensity: [320.0, 300.0, 256.0],
        inner_angle: 0.168,
        outer_angle: 0.188,
    };
    scene.light("spot", spot);
    scene.camera("front", CameraDesc::look_at([0.15, 1.15, 3.9], [0.15, 0.95, 0.0], [0., 1., 0.], 0.60));
    scene
}
