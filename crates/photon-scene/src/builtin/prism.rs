//! White light through a prism, and its spectrum on a wall (Newton 1672).

use glam::DVec2;

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, Dispersion, LightDesc, MaterialDesc};
use crate::shapes::{cuboid, prism as extruded};

/// Dense flint SF11, by Schott's catalogue.
const SF11: [f64; 6] = [1.737_596_95, 0.313_747_346, 1.898_781_01, 0.013_188_707, 0.062_306_814_2, 155.236_29];
/// Length of the prism's sides, and its height.
const SIDE: f64 = 0.3;
const HEIGHT: f64 = 0.34;
/// The lights, along x.
const SOURCE: f64 = -1.5;
/// Angle of the cones of light: 12 millimetres at the prism.
const CONE: f64 = 0.008;
/// The wall behind.
const WALL: f64 = -1.4;

/// A prism of flint glass on a table; a sheet of white light, of narrow cones one above the other, falls on it along x at the
/// angle of least deviation.
pub(super) fn prism() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let table = scene.material(MaterialDesc::lambert("table", [0.50, 0.48, 0.45]));
    let wall = scene.material(MaterialDesc::lambert("wall", [0.75, 0.75, 0.75]));
    let housing = scene.material(MaterialDesc::lambert("housing", [0.06, 0.06, 0.07]));
    let flint = Dispersion::Sellmeier(SF11);
    let glass = scene.material(MaterialDesc::glass("flint", 1.5).with_dispersion(flint));
    let glow = scene.material(MaterialDesc::emissive("light", [0.0; 3], [1.2; 3]));

    let x = 2.6;
    scene.quad("table", [[-x, 0., 1.6], [x, 0., 1.6], [x, 0., WALL], [-x, 0., WALL]], table);
    scene.quad("wall", [[-x, 0., WALL], [x, 0., WALL], [x, 2., WALL], [-x, 2., WALL]], wall);
    // Dim light from above, by which the room is seen.
    scene.quad("light", [[-1., 2.2, -0.6], [1., 2.2, -0.6], [1., 2.2, 1.0], [-1., 2.2, 1.0]], glow);
    add(&mut scene, "housing", cuboid([SOURCE - 0.25, 0.002, -0.06], [SOURCE - 0.01, HEIGHT, 0.16]), housing);

    // The light that enters in the middle of a side passes parallel to the base: it meets that side at an angle whose sine is
    // half the refractive index, and 30° of it are from the side's own direction.
    let incidence = libm::asin(0.5 * flint.index(1.5, 0.55));
    let turned = DVec2::from_angle(std::f64::consts::FRAC_PI_6 - incidence);
    let h = 0.75_f64.sqrt() * SIDE;
    let place = |x: f64, z: f64| turned.rotate(DVec2::new(x, z)).to_array();
    let corners = [place(-SIDE / 2., -h / 3.), place(0., 2. * h / 3.), place(SIDE / 2., -h / 3.)];
    // A film of air lies between it and the table.
    add(&mut scene, "prism", extruded(&corners, 0, 0.002, HEIGHT), glass);
    let [_, z] = place(-SIDE / 4., h / 6.);
    // From near the table to near the top of the prism, and three that graze the table.
    let level = (0..11).map(|step| (0.03 + 0.025 * f64::from(step), 0.0));
    let grazing = [0.9, 1.4, 2.2].map(|reach| (0.04, -0.04 / reach));
    for (number, (y, slope)) in level.chain(grazing).enumerate() {
        let ray = LightDesc::Spot {
            position: [SOURCE, y, z],
            direction: [1.0, slope, 0.0],
            intensity: [200.0; 3],
            inner_angle: 0.7 * CONE,
            outer_angle: CONE,
        };
        scene.light(format!("ray {number}"), ray);
    }
    scene.camera("table", CameraDesc::look_at([0.05, 1.0, 1.9], [0.2, 0.14, -0.7], [0., 1., 0.], 0.48));
    scene
}
