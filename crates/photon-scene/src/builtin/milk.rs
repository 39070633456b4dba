//! A glass of milk: a solid that scatters light, within one that refracts it.

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, LightDesc, MaterialDesc, Surface};
use crate::shapes::{revolve, translate};

/// Height of the glass, its outer radii at the foot and at the rim, and the thickness of its wall and of its bottom.
const HEIGHT: f64 = 0.13;
const RADII: [f64; 2] = [0.029, 0.037];
const WALL: f64 = 0.0022;
const BOTTOM: f64 = 0.007;
/// Height of the milk.
const LEVEL: f64 = 0.098;
const SEGMENTS: u32 = 512;
/// A film of air between the glass and the table.
const FILM: f64 = 2e-4;

/// Outer radius of the glass at a height.
fn radius(height: f64) -> f64 {
    RADII[0] + (RADII[1] - RADII[0]) * height / HEIGHT
}

/// A glass of milk on a table, under a spot light.
///
/// The milk reaches into the glass, whose priority is higher: where both are it is glass, and there is no gap between them.
pub(super) fn milk() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let table = scene.material(MaterialDesc::lambert("table", [0.44, 0.27, 0.15]));
    let wall = scene.material(MaterialDesc::lambert("wall", [0.26, 0.36, 0.44]));
    let glow = scene.material(MaterialDesc::emissive("panel", [0.0; 3], [0.50, 0.52, 0.56]));
    let glass = scene.material(MaterialDesc::glass("glass", 1.5).with_priority(1));
    // Fat and protein absorb blue light most.
    let milk = Surface::Dielectric { ior: 1.35, absorption: [0.05, 0.15, 0.6], tint: [1.0; 3], roughness: 0.0 };
    let milk = scene.material(MaterialDesc::new("milk", milk).with_scattering([220.0; 3], 0.7));

    let x = 0.34;
    scene.quad("table", [[-x, 0., 0.30], [x, 0., 0.30], [x, 0., -0.30], [-x, 0., -0.30]], table);
    scene.quad("wall", [[-x, 0., -0.30], [x, 0., -0.30], [x, 0.44, -0.30], [-x, 0.44, -0.30]], wall);
    // Dim light from above, by which the room is seen.
    let (y, half) = (0.40, 0.20);
    scene.quad("panel", [[-half, y, -half], [half, y, -half], [half, y, half], [-half, y, half]], glow);
    let spot = LightDesc::Spot {
        position: [-0.22, 0.36, 0.20],
        direction: [0.22, -0.30, -0.20],
        intensity: [0.90, 0.82, 0.70],
        inner_angle: 0.21,
        outer_angle: 0.45,
    };
    scene.light("spot", spot);

    let inner = |height: f64| radius(height) - WALL;
    let profile = [
        [0.0, 0.0],
        [radius(0.0) - 0.001, 0.0],
        [radius(0.0), 0.001],
        [radius(HEIGHT), HEIGHT - 0.0006],
        [radius(HEIGHT) - 0.5 * WALL, HEIGHT],
        [inner(HEIGHT), HEIGHT - 0.0006],
        [inner(BOTTOM), BOTTOM + 0.001],
        [inner(BOTTOM) - 0.001, BOTTOM],
        [0.0, BOTTOM],
    ];
    add(&mut scene, "glass", translate(revolve(&profile, SEGMENTS), [0.0, FILM, 0.0]), glass);
    let within = |height: f64| inner(height) + 0.5 * WALL;
    let (low, high) = (0.5 * BOTTOM, LEVEL);
    let body = [[0.0, low], [within(low), low], [within(high), high], [0.0, high]];
    add(&mut scene, "milk", translate(revolve(&body, SEGMENTS), [0.0, FILM, 0.0]), milk);
    scene.camera("table", CameraDesc::look_at([0.06, 0.20, 0.36], [0.0, 0.058, 0.0], [0., 1., 0.], 0.46));
    scene
}
