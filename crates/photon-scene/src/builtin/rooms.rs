//! Light that has a long way to go.

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, MaterialDesc};
use crate::shapes;

/// Two rooms side by side; the lamp is in the left one, the viewer in the right one, and the door
/// between them is ajar.
#[must_use]
pub fn two_rooms() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let plaster = builder.material(MaterialDesc::lambert("plaster", [0.78, 0.76, 0.72]));
    let boards = builder.material(MaterialDesc::lambert("boards", [0.5, 0.32, 0.18]));
    let blue = builder.material(MaterialDesc::lambert("blue", [0.2, 0.35, 0.6]));
    let lamp = builder.material(MaterialDesc::emissive("lamp", [0.0; 3], [60.0, 52.0, 42.0]));
    // Room inside: x from -4 to 4, y from 0 to 2.6, z from -2 to 2; walls face inwards.
    let (l, h, d) = (4.0, 2.6, 2.0);
    builder.quad("floor", [[-l, 0.0, d], [l, 0.0, d], [l, 0.0, -d], [-l, 0.0, -d]], boards);
    builder.quad("ceiling", [[-l, h, -d], [l, h, -d], [l, h, d], [-l, h, d]], plaster);
    builder.quad("far wall", [[-l, 0.0, -d], [l, 0.0, -d], [l, h, -d], [-l, h, -d]], plaster);
    builder.quad("near wall", [[l, 0.0, d], [-l, 0.0, d], [-l, h, d], [l, h, d]], plaster);
    builder.quad("left wall", [[-l, 0.0, d], [-l, 0.0, -d], [-l, h, -d], [-l, h, d]], plaster);
    builder.quad("right wall", [[l, 0.0, -d], [l, 0.0, d], [l, h, d], [l, h, -d]], plaster);
    // The wall between, 0.1 thick, with an opening from z = -1.2 to -0.2, 2.1 high. Its parts reach a
    // little into floor, ceiling and walls, so that no light passes beside them.
    let o = 0.01;
    add(&mut builder, "partition, front", shapes::cuboid([-0.05, -o, -0.2], [0.05, h + o, d + o]), plaster);
    add(&mut builder, "partition, back", shapes::cuboid([-0.05, -o, -d - o], [0.05, h + o, -1.2]), plaster);
    add(&mut builder, "lintel", shapes::cuboid([-0.05, 2.1, -1.2 - o], [0.05, h + o, -0.2 + o]), plaster);
    // Hinged at z = -1.2, opened into the right room.
    let door = shapes::cuboid([0.0, 0.02, 0.0], [0.04, 2.08, 0.98]);
    add(&mut builder, "door", shapes::translate(shapes::rotate_y(door, 0.55), [0.06, 0.0, -1.19]), blue);
    add(&mut builder, "chest", shapes::cuboid([2.2, 0.0, -1.7], [3.2, 0.7, -1.0]), boards);
    let y = h - 0.01;
    builder.quad("lamp", [[-2.3, y, -1.0], [-1.7, y, -1.0], [-1.7, y, -0.4], [-2.3, y, -0.4]], lamp);
    builder.camera("dark room", CameraDesc::look_at([3.7, 1.5, 1.75], [0.4, 1.0, -0.95], [0.0, 1.0, 0.0], 1.0));
    builder
}
