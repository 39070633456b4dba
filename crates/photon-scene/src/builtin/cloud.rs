//! A cloud: a grid of densities from octaves of noise.

use super::add;
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, GridDesc, LightDesc, MaterialDesc};
use crate::shapes::cuboid;

/// The box of the cloud, and its cells.
const LOW: [f64; 3] = [-1.3, 0.55, -0.8];
const HIGH: [f64; 3] = [1.3, 1.75, 0.8];
const CELLS: [u32; 3] = [104, 48, 64];

/// Balls whose union is the body: centres and radii, in metres.
const BALLS: [([f64; 3], f64); 7] = [
    ([-0.05, 1.06, 0.0], 0.52),
    ([-0.55, 0.96, 0.08], 0.38),
    ([0.50, 0.98, -0.05], 0.42),
    ([0.16, 1.28, 0.05], 0.36),
    ([-0.30, 1.22, -0.12], 0.34),
    ([-0.88, 0.88, 0.0], 0.26),
    ([0.90, 0.86, 0.06], 0.27),
];
/// Height of the flat bottom.
const BOTTOM: f64 = 0.74;

/// A cloud over a floor, lit by a spot light from the side and dimly from above.
pub(super) fn cloud() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let ground = scene.material(MaterialDesc::lambert("ground", [0.22, 0.27, 0.16]));
    let sky = scene.material(MaterialDesc::lambert("sky", [0.16, 0.30, 0.55]));
    let glow = scene.material(MaterialDesc::emissive("panel", [0.0; 3], [1.3, 1.6, 2.0]));
    let grid = GridDesc::new(CELLS, densities()).with_box(LOW, HIGH);
    let cloud = MaterialDesc::boundary("cloud", [0.02; 3]).with_scattering([30.0; 3], 0.5).with_grid(grid);
    let cloud = scene.material(cloud);

    let x = 3.2;
    scene.quad("ground", [[-x, 0., 2.4], [x, 0., 2.4], [x, 0., -1.8], [-x, 0., -1.8]], ground);
    scene.quad("sky", [[-x, 0., -1.8], [x, 0., -1.8], [x, 3.6, -1.8], [-x, 3.6, -1.8]], sky);
    scene.quad("panel", [[-1.6, 3.4, -1.4], [1.6, 3.4, -1.4], [1.6, 3.4, 1.4], [-1.6, 3.4, 1.4]], glow);
    add(&mut scene, "cloud", cuboid(LOW, HIGH), cloud);
    let spot = LightDesc::Spot {
        position: [-3.0, 3.6, 2.6],
        direction: [3.0, -2.5, -2.6],
        intensity: [340.0, 315.0, 270.0],
        inner_angle: 0.32,
        outer_angle: 0.42,
    };
    scene.light("sun", spot);
    scene.camera("front", CameraDesc::look_at([0.25, 0.85, 4.2], [0.0, 1.02, 0.0], [0., 1., 0.], 0.66));
    scene
}

/// The density of each cell, from 0 to 1.
fn densities() -> Vec<f32> {
    let at = |index: u32| {
        let cell = [index % CELLS[0], index / CELLS[0] % CELLS[1], index / CELLS[0] / CELLS[1]];
        let point = std::array::from_fn(|axis| {
            let share = (f64::from(cell[axis]) + 0.5) / f64::from(CELLS[axis]);
            LOW[axis] + (HIGH[axis] - LOW[axis]) * share
        });
        density(point) as f32
    };
    (0..CELLS.iter().product()).map(at).collect()
}

fn density(point: [f64; 3]) -> f64 {
    // Depth below the surface of the body, relative to its size.
    let below = |(center, radius): &([f64; 3], f64)| {
        let squared: f64 = (0..3).map(|axis| (point[axis] - center[axis]).powi(2)).sum();
        1.0 - squared.sqrt() / radius
    };
    let body = BALLS.iter().map(below).fold(f64::NEG_INFINITY, f64::max).min((point[1] - BOTTOM) * 5.0);
    let (mut noise, mut weight, mut frequency) = (0.0, 0.5, 4.0);
    for octave in 0..4 {
        noise += weight * value_noise(point.map(|part| part * frequency), octave);
        (weight, frequency) = (0.5 * weight, 2.1 * frequency);
    }
    let edge = ((body + 0.9 * (noise - 0.55)) / 0.22).clamp(0.0, 1.0);
    edge * edge * (3.0 - 2.0 * edge)
}

/// Noise from 0 to 1 with one value at each lattice point, smooth in between.
fn value_noise(at: [f64; 3], octave: u32) -> f64 {
    let low = at.map(f64::floor);
    let share: [f64; 3] = std::array::from_fn(|axis| {
        let share = at[axis] - low[axis];
        share * share * (3.0 - 2.0 * share)
    });
    let corner = |number: u32| {
        let bits = [number & 1, number >> 1 & 1, number >> 2];
        let weights = (0..3).map(|axis| if bits[axis] == 1 { share[axis] } else { 1.0 - share[axis] });
        let mut hash = octave.wrapping_mul(0x9E37_79B9);
        for axis in 0..3 {
            // Mixes each coordinate (Wang 2007).
            hash ^= (low[axis] as i32 as u32).wrapping_add(bits[axis]);
            hash = (hash ^ 61 ^ hash >> 16).wrapping_mul(9);
            hash = (hash ^ hash >> 4).wrapping_mul(0x27D4_EB2D);
            hash ^= hash >> 15;
        }
        weights.product::<f64>() * f64::from(hash) / f64::from(u32::MAX)
    };
    (0..8).map(corner).sum()
}
