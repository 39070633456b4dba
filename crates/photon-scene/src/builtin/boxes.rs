//! The Cornell box (after Goral, Torrance, Greenberg and Battaile 1984), in metres.

use super::add;
use crate::builder::{MaterialId, SceneBuilder};
use crate::describe::{CameraDesc, MaterialDesc};
use crate::shapes;

/// Half the width of the box; it is as deep as wide, and as high.
const HALF: f64 = 1.0;
const HEIGHT: f64 = 2.0;

/// Five walls, open to the viewer, a lamp of `half` side just beneath the ceiling, a camera.
fn walls(half: f64, radiance: f64) -> (SceneBuilder, MaterialId) {
    let mut builder = SceneBuilder::new();
    let white = builder.material(MaterialDesc::lambert("white", [0.73; 3]));
    let red = builder.material(MaterialDesc::lambert("red", [0.63, 0.065, 0.05]));
    let green = builder.material(MaterialDesc::lambert("green", [0.14, 0.45, 0.091]));
    let warm = [1.0, 0.82, 0.6].map(|c| c * radiance);
    let lamp = builder.material(MaterialDesc::emissive("lamp", [0.0; 3], warm));
    let (w, h) = (HALF, HEIGHT);
    builder.quad("floor", [[-w, 0.0, w], [w, 0.0, w], [w, 0.0, -w], [-w, 0.0, -w]], white);
    builder.quad("ceiling", [[-w, h, -w], [w, h, -w], [w, h, w], [-w, h, w]], white);
    builder.quad("back wall", [[-w, 0.0, -w], [w, 0.0, -w], [w, h, -w], [-w, h, -w]], white);
    builder.quad("left wall", [[-w, 0.0, w], [-w, 0.0, -w], [-w, h, -w], [-w, h, w]], red);
    builder.quad("right wall", [[w, 0.0, -w], [w, 0.0, w], [w, h, w], [w, h, -w]], green);
    let y = h - 0.005;
    builder.quad("lamp", [[-half, y, -half], [half, y, -half], [half, y, half], [-half, y, half]], lamp);
    let fov = 0.69;
    builder.camera("front", CameraDesc::look_at([0.0, 1.0, 3.9], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], fov));
    (builder, white)
}

/// Diffuse walls, two blocks, a lamp in the ceiling.
#[must_use]
pub fn cornell() -> SceneBuilder {
    let (mut builder, white) = walls(0.25, 17.0);
    let tall = shapes::rotate_y(shapes::cuboid([-0.3, 0.0, -0.3], [0.3, 1.2, 0.3]), 0.3);
    let short = shapes::rotate_y(shapes::cuboid([-0.3, 0.0, -0.3], [0.3, 0.6, 0.3]), -0.3);
    add(&mut builder, "tall block", shapes::translate(tall, [-0.35, 0.0, -0.35]), white);
    add(&mut builder, "short block", shapes::translate(short, [0.35, 0.0, 0.35]), white);
    builder
}

/// The same walls with a ball of glass and a ball that mirrors; a smaller lamp, for a crisp caustic.
#[must_use]
pub fn cornell_glass() -> SceneBuilder {
    let (mut builder, _) = walls(0.18, 33.0);
    let glass = builder.material(MaterialDesc::glass("glass", 1.5));
    let mirror = builder.material(MaterialDesc::mirror("mirror", [0.92; 3]));
    add(&mut builder, "glass ball", shapes::icosphere(7, [0.42, 0.42, 0.35], 0.36), glass);
    add(&mut builder, "mirror ball", shapes::icosphere(6, [-0.42, 0.4, -0.3], 0.4), mirror);
    builder
}
