//! Caustics by reflection and by refraction.

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, LightDesc, MaterialDesc, Surface};
use crate::shapes;

/// A metal ring on a table, lit from the side: rays from a point on the circle would make a cardioid
/// exactly; from a lamp somewhat outside and above they make its cusped curve.
#[must_use]
pub fn ring() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let table = builder.material(MaterialDesc::lambert("table", [0.7, 0.66, 0.6]));
    let metal = builder.material(MaterialDesc::mirror("metal", [0.9, 0.75, 0.45]));
    let corners = [[-3.0, 0.0, 3.0], [3.0, 0.0, 3.0], [3.0, 0.0, -3.0], [-3.0, 0.0, -3.0]];
    add(&mut builder, "table", shapes::quad(corners), table);
    add(&mut builder, "ring", shapes::tube([0.0, 0.001, 0.0], 1.0, 1.04, 0.45, 4096), metal);
    let position = [2.6, 1.9, 0.6];
    builder.light(
        "lamp",
        LightDesc::Spot {
            position,
            direction: [-position[0] - 0.2, -position[1], -position[2]],
            intensity: [32.0; 3],
            inner_angle: 0.5,
            outer_angle: 0.75,
        },
    );
    builder.camera("above", CameraDesc::look_at([-0.3, 3.9, 2.6], [0.0, 0.05, 0.05], [0.0, 1.0, 0.0], 0.55));
    builder
}

/// Water with waves in a basin, under the sun.
#[must_use]
pub fn pool() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let tiles = builder.material(MaterialDesc::lambert("tiles", [0.55, 0.75, 0.82]));
    let rim = builder.material(MaterialDesc::lambert("rim", [0.75, 0.72, 0.66]));
    let water = Surface::Dielectric { ior: 1.33, absorption: [0.25, 0.06, 0.03], tint: [1.0; 3] };
    let water = builder.material(MaterialDesc::new("water", water));
    let (w, deep, edge) = (2.0, -1.2, 0.25);
    // The basin: floor and walls, which reach above the water, and a rim around.
    builder.quad("floor", [[-w, deep, w], [w, deep, w], [w, deep, -w], [-w, deep, -w]], tiles);
    builder.quad("far wall", [[-w, deep, -w], [w, deep, -w], [w, edge, -w], [-w, edge, -w]], tiles);
    builder.quad("near wall", [[w, deep, w], [-w, deep, w], [-w, edge, w], [w, edge, w]], tiles);
    builder.quad("left wall", [[-w, deep, w], [-w, deep, -w], [-w, edge, -w], [-w, edge, w]], tiles);
    builder.quad("right wall", [[w, deep, -w], [w, deep, w], [w, edge, w], [w, edge, -w]], tiles);
    let o = w + 1.0;
    for (name, corners) in [
        ("far rim", [[-o, edge, -w], [o, edge, -w], [o, edge, -o], [-o, edge, -o]]),
        ("left rim", [[-o, edge, w], [-w, edge, w], [-w, edge, -w], [-o, edge, -w]]),
        ("right rim", [[w, edge, w], [o, edge, w], [o, edge, -w], [w, edge, -w]]),
        ("near rim", [[-o, edge, o], [o, edge, o], [o, edge, w], [-o, edge, w]]),
    ] {
        builder.quad(name, corners, rim);
    }
    // A hair narrower than the basin and above its floor: a sheet of air around it bends nothing that
    // matters, and no two surfaces share a plane.
    let gap = 1e-3;
    let waves = |x: f64, z: f64| {
        let wave = |kx: f64, kz: f64, phase: f64| (kx * x + kz * z + phase).sin();
        0.016 * wave(4.1, 1.7, 0.3)
            + 0.013 * wave(-2.3, 4.7, 1.9)
            + 0.008 * wave(6.3, -5.9, 4.2)
            + 0.005 * wave(9.1, 7.3, 2.6)
    };
    let extent = w - gap;
    let body = shapes::height_field([-extent, -extent], [extent, extent], [384, 384], deep + gap, waves);
    add(&mut builder, "water", body, water);
    builder.light("sun", LightDesc::Directional { direction: [-0.25, -1.0, -0.3], irradiance: [10.0, 9.4, 8.4] });
    builder.camera("side", CameraDesc::look_at([0.6, 3.6, 4.6], [0.0, -0.7, -0.1], [0.0, 1.0, 0.0], 0.62));
    builder
}
