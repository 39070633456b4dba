//! A room under strings of bulbs, with lanterns on the floor: several hundred lights of very different strength.

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, LightDesc, MaterialDesc};
use crate::shapes::{cuboid, cylinder, icosphere, rotate_y, translate};

/// Half the width of the room, metres.
const HALF: f64 = 2.0;
const HEIGHT: f64 = 2.8;
/// Strings of bulbs, and bulbs on each.
const BULBS: u32 = 16;
/// Colours of the bulbs.
const COLORS: [[f64; 3]; 6] =
    [[1.0, 0.8, 0.5], [1.0, 0.2, 0.1], [0.2, 0.9, 0.3], [0.2, 0.4, 1.0], [1.0, 0.6, 0.1], [0.9, 0.2, 0.8]];

/// 256 point lights below the ceiling, five spotlights on the back wall, and nine lanterns of 20 triangles each.
pub(super) fn many_lights() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let white = scene.material(MaterialDesc::lambert("white", [0.75; 3]));
    let floor = scene.material(MaterialDesc::lambert("floor", [0.45, 0.4, 0.35]));
    let wood = scene.material(MaterialDesc::lambert("wood", [0.6, 0.42, 0.25]));
    let (h, top) = (HALF, HEIGHT);
    scene.quad("floor", [[-h, 0., h], [h, 0., h], [h, 0., -h], [-h, 0., -h]], floor);
    scene.quad("ceiling", [[-h, top, -h], [h, top, -h], [h, top, h], [-h, top, h]], white);
    scene.quad("back wall", [[-h, 0., -h], [h, 0., -h], [h, top, -h], [-h, top, -h]], white);
    scene.quad("left wall", [[-h, 0., h], [-h, 0., -h], [-h, top, -h], [-h, top, h]], white);
    scene.quad("right wall", [[h, 0., -h], [h, 0., h], [h, top, h], [h, top, -h]], white);
    for (x, z, size, angle) in [(-0.9, -0.8, 0.7, 0.4), (0.9, -1.0, 0.9, -0.3), (0.45, 0.5, 0.4, 0.9)] {
        let r = 0.5 * size;
        let block = translate(rotate_y(cuboid([-r, 0., -r], [r, size, r]), angle), [x, 0., z]);
        add(&mut scene, "block", block, wood);
    }
    add(&mut scene, "column", cylinder([-1.45, 0., 0.6], 0.14, top, 48), white);

    for index in 0..BULBS * BULBS {
        let (along, string) = (index % BULBS, index / BULBS);
        let part = |i: u32| (f64::from(i) + 0.5) / f64::from(BULBS);
        let sag = libm::sin(std::f64::consts::PI * part(along));
        let position = [h * (2.0 * part(along) - 1.0), 2.5 - 0.4 * sag, h * (2.0 * part(string) - 1.0)];
        // From 8 to 512 milliwatts per steradian.
        let strength = 0.008 * f64::from(1_u32 << (3 * ((3 * along + 5 * string) % 3)));
        let color = COLORS[((along + 2 * string) % 6) as usize];
        scene.light("bulb", LightDesc::Point { position, intensity: color.map(|part| part * strength) });
    }
    for index in 0..5_u32 {
        let x = 0.75 * (f64::from(index) - 2.0);
        let (position, direction) = ([x, top - 0.1, 0.4 - h], [0., -1., -0.25]);
        let (intensity, inner_angle, outer_angle) = ([3.0, 2.6, 2.0], 0.2, 0.35);
        scene.light("spot", LightDesc::Spot { position, direction, intensity, inner_angle, outer_angle });
    }
    for index in 0..9_u32 {
        let (column, row) = (f64::from(index % 3) - 1.0, f64::from(index / 3) - 1.0);
        let radius = 0.05 + 0.01 * f64::from(index % 4);
        let emission = COLORS[(index % 6) as usize].map(|part| 12.0 * part);
        let lantern = scene.material(MaterialDesc::emissive("lantern", [0.0; 3], emission));
        let (positions, triangles) = icosphere(0, [1.5 * column + 0.1, radius + 0.02, 0.5 * row + 1.2], radius);
        scene.mesh("lantern", positions, triangles, lantern);
    }
    let fov = 2.0 * libm::atan(0.998 * h / 4.6);
    scene.camera("front", CameraDesc::look_at([0., 1.7, h + 4.6], [0., 1.3, 0.], [0., 1., 0.], fov));
    scene
}
