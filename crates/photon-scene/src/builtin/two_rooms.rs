//! Light through a door ajar, after the scene known from Metropolis light transport (Veach and
//! Guibas 1997).

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, MaterialDesc};
use crate::shapes::{cuboid, cylinder, icosphere, rotate_y, translate};

const HALF: f64 = 2.4;
const HEIGHT: f64 = 2.7;
/// The rooms extend from z = BACK, the back wall of the lit room, to z = FRONT, the wall behind the camera.
const BACK: f64 = -2.6;
const FRONT: f64 = 4.4;
/// The wall between the rooms extends from z = −WALL to 0.
const WALL: f64 = 0.16;
/// Range of x of the doorway.
const DOOR: [f64; 2] = [0.1, 1.1];
const LINTEL: f64 = 2.1;
/// Opening angle of the door, radians.
const AJAR: f64 = 0.72;

/// Two closed rooms; the area light is in the far one, the camera in the near one.
pub(super) fn two_rooms() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let wall = scene.material(MaterialDesc::lambert("wall", [0.76, 0.74, 0.70]));
    let lit = scene.material(MaterialDesc::lambert("far wall", [0.80, 0.76, 0.68]));
    let floor = scene.material(MaterialDesc::lambert("floor", [0.50, 0.41, 0.33]));
    let door = scene.material(MaterialDesc::lambert("door", [0.24, 0.36, 0.48]));
    let table = scene.material(MaterialDesc::lambert("table", [0.66, 0.62, 0.58]));
    let clay = scene.material(MaterialDesc::lambert("clay", [0.70, 0.34, 0.20]));
    let mirror = scene.material(MaterialDesc::mirror("mirror", [0.92; 3]));
    let glass = scene.material(MaterialDesc::glass("glass", 1.5));
    let area_light = scene.material(MaterialDesc::emissive("light", [0.0; 3], [90., 83., 72.]));

    let (h, top, mid) = (HALF, HEIGHT, -WALL / 2.0);
    scene.quad("floor", [[-h, 0., FRONT], [h, 0., FRONT], [h, 0., BACK], [-h, 0., BACK]], floor);
    // The walls and ceilings of both rooms, without floors; they meet inside the wall between them.
    for (name, back, front, paint) in [("near room", mid, FRONT, wall), ("far room", BACK, mid, lit)] {
        scene.quad(name, [[-h, top, back], [h, top, back], [h, top, front], [-h, top, front]], paint);
        scene.quad(name, [[-h, 0., front], [-h, 0., back], [-h, top, back], [-h, top, front]], paint);
        scene.quad(name, [[h, 0., back], [h, 0., front], [h, top, front], [h, top, back]], paint);
    }
    scene.quad("back wall", [[-h, 0., BACK], [h, 0., BACK], [h, top, BACK], [-h, top, BACK]], lit);
    scene.quad("front wall", [[h, 0., FRONT], [-h, 0., FRONT], [-h, top, FRONT], [h, top, FRONT]], wall);

    // The wall between the rooms; its ends extend into floor, ceiling and outer walls.
    let e = 0.05;
    add(&mut scene, "left of the door", cuboid([-h - e, -e, -WALL], [DOOR[0], top + e, 0.]), wall);
    add(&mut scene, "right of the door", cuboid([DOOR[1], -e, -WALL], [h + e, top + e, 0.]), wall);
    add(&mut scene, "lintel", cuboid([DOOR[0] - e, LINTEL, -WALL], [DOOR[1] + e, top + e, 0.]), wall);
    // Hinged on the right, opens towards the camera.
    let leaf = cuboid([-(DOOR[1] - DOOR[0]), 0.01, -0.04], [0., LINTEL - 0.01, 0.]);
    add(&mut scene, "door", translate(rotate_y(leaf, AJAR), [DOOR[1], 0., 0.05]), door);

    add(&mut scene, "table", cylinder([-0.75, 0.68, 1.35], 0.62, 0.04, 96), table);
    add(&mut scene, "foot", cylinder([-0.75, 0., 1.35], 0.06, 0.70, 48), table);
    let on_table = |x, z, radius| [x, 0.722 + radius, z];
    add(&mut scene, "clay ball", icosphere(5, on_table(-1.08, 1.28, 0.17), 0.17), clay);
    add(&mut scene, "mirror ball", icosphere(6, on_table(-0.70, 1.10, 0.19), 0.19), mirror);
    add(&mut scene, "glass ball", icosphere(6, on_table(-0.52, 1.58, 0.16), 0.16), glass);

    // Upright like a window, to the right of what the camera sees through the doorway: from there it shines
    // past the door onto the table, and a good share of its photons passes the doorway.
    let z = BACK + 0.02;
    scene.quad("light", [[1.1, 0.9, z], [2.1, 0.9, z], [2.1, 2.3, z], [1.1, 2.3, z]], area_light);
    scene.camera("dark room", CameraDesc::look_at([-0.35, 1.45, 4.25], [-0.15, 1.08, 0.], [0., 1., 0.], 0.80));
    scene
}
