//! The Cornell box (Goral, Torrance, Greenberg and Battaile 1984), simplified: right angles, and 5.5
//! metres instead of 55 centimetres.

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, MaterialDesc};
use crate::shapes::{cuboid, rotate_y, translate};

/// Half the width of the box; the height is twice this.
pub(super) const HALF: f64 = 2.75;

const WHITE: [f64; 3] = [0.73, 0.73, 0.71];
const RED: [f64; 3] = [0.63, 0.065, 0.05];
const GREEN: [f64; 3] = [0.14, 0.45, 0.09];
/// Colour of a warm area light, brightest channel 1.
const WARM: [f64; 3] = [1.0, 0.87, 0.70];
/// Distance of the area light below the ceiling, metres.
const GAP: f64 = 0.02;

/// Five walls with the front left open; an area light below the ceiling, centred at `[x, z]`, with the given
/// width, depth and radiance in its brightest channel; and a camera in front.
pub(super) fn room([x, z]: [f64; 2], [width, depth]: [f64; 2], radiance: f64) -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let white = scene.material(MaterialDesc::lambert("white", WHITE));
    let red = scene.material(MaterialDesc::lambert("red", RED));
    let green = scene.material(MaterialDesc::lambert("green", GREEN));
    let area_light = scene.material(MaterialDesc::emissive("light", [0.0; 3], WARM.map(|part| part * radiance)));

    let (h, top) = (HALF, 2.0 * HALF);
    scene.quad("floor", [[-h, 0., h], [h, 0., h], [h, 0., -h], [-h, 0., -h]], white);
    scene.quad("ceiling", [[-h, top, -h], [h, top, -h], [h, top, h], [-h, top, h]], white);
    scene.quad("back wall", [[-h, 0., -h], [h, 0., -h], [h, top, -h], [-h, top, -h]], white);
    scene.quad("left wall", [[-h, 0., h], [-h, 0., -h], [-h, top, -h], [-h, top, h]], red);
    scene.quad("right wall", [[h, 0., -h], [h, 0., h], [h, top, h], [h, top, -h]], green);

    let y = top - GAP;
    let ([x0, x1], [z0, z1]) = ([x - width / 2.0, x + width / 2.0], [z - depth / 2.0, z + depth / 2.0]);
    scene.quad("light", [[x0, y, z0], [x1, y, z0], [x1, y, z1], [x0, y, z1]], area_light);

    // At this distance the open front exactly fills a square picture.
    let distance = 8.0;
    let fov = 2.0 * (0.998 * h / distance).atan();
    scene.camera("front", CameraDesc::look_at([0., h, h + distance], [0., h, 0.], [0., 1., 0.], fov));
    scene
}

/// The classical arrangement: a tall block at the back, a cube in front.
pub(super) fn cornell() -> SceneBuilder {
    let mut scene = room([0.0, 0.0], [1.3, 1.05], 32.0);
    let block = scene.material(MaterialDesc::lambert("blocks", WHITE));
    let (a, b) = (0.825, 1.65);
    let tall = cuboid([-a, 0., -a], [a, 2.0 * b, a]);
    let low = cuboid([-a, 0., -a], [a, b, a]);
    add(&mut scene, "tall block", translate(rotate_y(tall, 0.3), [-0.9, 0., -0.9]), block);
    add(&mut scene, "low block", translate(rotate_y(low, -0.3), [0.95, 0., 0.95]), block);
    scene
}
