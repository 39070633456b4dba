//! A terrace in the morning sun: a screen of coloured panes, a glass ball, metals and clay under a clear sky.

use std::f64::consts::TAU;

use super::add;
use super::textures::{smooth, textured_quad};
use crate::builder::{MaterialId, SceneBuilder};
use crate::describe::{CameraDesc, MaterialDesc, Surface};
use crate::environment::EnvironmentDesc;
use crate::mesh::VertexAttributes;
use crate::shapes::{cuboid, disc, icosphere, join, revolve, torus, translate};
use crate::texture::{TextureDesc, TextureRef, TexturesDesc};

/// Height of the terrace above the ground, metres.
const TERRACE: f64 = 0.12;
/// Texels on a side of the image of the flagstones.
const SIDE: u32 = 64;

/// Four flagstones of slightly different colours with dark joints.
fn flagstones() -> Vec<[u8; 4]> {
    let stone = SIDE / 2;
    let texel = |i: u32| {
        let (x, y) = (i % SIDE, i / SIDE);
        match (x.is_multiple_of(stone) || y.is_multiple_of(stone), x / stone + 2 * (y / stone)) {
            (true, _) => [92, 86, 78, 255],
            (false, 0) => [196, 186, 168, 255],
            (false, 1) => [184, 172, 152, 255],
            (false, 2) => [178, 170, 156, 255],
            (false, _) => [190, 176, 152, 255],
        }
    };
    (0..SIDE * SIDE).map(texel).collect()
}

/// The terrace: flagstones between the lower and the upper corner in x and z, and an edge down to the ground.
fn terrace(scene: &mut SceneBuilder, [x0, z0]: [f64; 2], [x1, z1]: [f64; 2]) {
    let image = scene.texture(TextureDesc::srgb8("flagstones", SIDE, SIDE, &flagstones()));
    let textures = TexturesDesc { base_color: Some(TextureRef::new(image)), ..TexturesDesc::default() };
    let stones = MaterialDesc::lambert("flagstones", [1.0; 3]).with_textures(textures);
    let top = [[x0, TERRACE, z1], [x1, TERRACE, z1], [x1, TERRACE, z0], [x0, TERRACE, z0]];
    textured_quad(scene, "terrace", top, 4.0, stones);
    let edge = scene.material(MaterialDesc::lambert("edge", [0.42, 0.39, 0.34]));
    let below = |[x, _, z]: [f64; 3]| [x, 0.0, z];
    for side in 0..4 {
        let (a, b) = (top[side], top[(side + 1) % 4]);
        scene.quad("terrace edge", [below(a), below(b), b, a], edge);
    }
}

/// A wooden screen with three by two coloured panes.
fn screen(scene: &mut SceneBuilder, wood: MaterialId) {
    let (left, width, height, z, bar) = (-1.75, 0.62, 0.82, -1.05, 0.035);
    let tints = [[0.95, 0.22, 0.12], [0.98, 0.72, 0.15], [0.20, 0.62, 0.25], [0.15, 0.35, 0.90]];
    let panes = tints.map(|tint| {
        let surface = Surface::Thin { ior: 1.5, tint, roughness: 0.0 };
        scene.material(MaterialDesc::new("coloured pane", surface))
    });
    let mut bars = Vec::new();
    for column in 0..4 {
        let x = left + width * f64::from(column);
        bars.push(cuboid([x - bar, TERRACE, z - bar], [x + bar, TERRACE + 2.0 * height + bar, z + bar]));
        if column == 3 {
            break;
        }
        for row in 0..3 {
            let y = TERRACE + height * f64::from(row);
            bars.push(cuboid([x + bar, y - bar, z - bar], [x + width - bar, y + bar, z + bar]));
            if row < 2 {
                let (right, top) = (x + width - bar, y + height - bar);
                let (low, bottom) = (x + bar, y + bar);
                let pane = [[low, bottom, z], [right, bottom, z], [right, top, z], [low, top, z]];
                scene.quad("pane", pane, panes[((column + 2 * row) % 4) as usize]);
            }
        }
    }
    add(scene, "screen", join(bars), wood);
}

/// A ring that stands upright, turned by `angle` about the y axis, with the normals of a torus.
fn standing_ring(scene: &mut SceneBuilder, center: [f64; 3], (major, minor): (f64, f64), angle: f64, of: MaterialId) {
    let (positions, triangles) = torus([0.0; 3], major, minor, 96, 32);
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    // About x by a quarter, then about y.
    let turn = |[x, y, z]: [f64; 3]| [cos * x - sin * y, -z, -sin * x - cos * y];
    let normal = |&[x, y, z]: &[f64; 3]| {
        let from_axis = libm::hypot(x, z);
        turn([x * (1.0 - major / from_axis), y, z * (1.0 - major / from_axis)])
    };
    let normals = positions.iter().map(normal).collect();
    let (positions, triangles) = translate((positions.into_iter().map(turn).collect(), triangles), center);
    let attributes = VertexAttributes { normals, ..VertexAttributes::default() };
    scene.mesh_with("ring", positions, triangles, attributes, of);
}

/// A terrace on wide ground under `sky:32,3`, with the sun to the left ahead of the camera: coloured panes that cast their
/// colours, a glass ball and its caustic, a copper ring, a chromium ball and a clay pot. Light is three hundredths of that of
/// the day, so that the picture needs no exposure.
pub(super) fn sky() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    // The ground of the sky has this albedo too, so that the disc has no visible edge.
    let ground = scene.material(MaterialDesc::lambert("ground", [0.2; 3]));
    add(&mut scene, "ground", disc([0.0; 3], [0.0, 1.0, 0.0], 9.0, 96), ground);
    terrace(&mut scene, [-2.4, -1.9], [2.4, 2.3]);
    let wood = scene.material(MaterialDesc::lambert("wood", [0.30, 0.18, 0.10]));
    screen(&mut scene, wood);

    let ball = [1.05, TERRACE + 0.42, 0.55];
    let (positions, triangles) = icosphere(4, ball, 0.42);
    let glass = scene.material(MaterialDesc::glass("glass", 1.5));
    scene.mesh("glass ball", positions, triangles, glass);
    let copper = scene.material(MaterialDesc::metal("copper", [0.94, 0.62, 0.50], 0.28));
    standing_ring(&mut scene, [1.35, TERRACE + 0.74, -0.85], (0.60, 0.14), 0.5, copper);
    let chrome = [-0.55, TERRACE + 0.3, 0.95];
    let material = MaterialDesc::metal("chromium", [0.66, 0.67, 0.68], 0.08);
    smooth(&mut scene, "chromium ball", icosphere(4, chrome, 0.3), chrome, false, material);
    let clay = scene.material(MaterialDesc::lambert("clay", [0.62, 0.28, 0.16]));
    let profile =
        [[0.0, 0.0], [0.17, 0.0], [0.29, 0.52], [0.32, 0.52], [0.32, 0.60], [0.27, 0.60], [0.16, 0.06], [0.0, 0.06]];
    add(&mut scene, "pot", translate(revolve(&profile, 64), [-1.75, TERRACE, 0.45]), clay);
    let leaf = scene.material(MaterialDesc::lambert("box tree", [0.10, 0.22, 0.06]));
    add(&mut scene, "box tree", bush([-1.75, TERRACE + 0.86, 0.45], 0.38), leaf);

    let environment = EnvironmentDesc::sky(32.0, 3.0).rotated(52.0).scaled(0.03);
    scene.environment_from(&environment).expect("a sky within its range");
    let fov = 2.0 * libm::atan(0.36);
    scene.camera("front", CameraDesc::look_at([0.5, 1.8, 6.5], [0.0, 0.8, 0.0], [0.0, 1.0, 0.0], fov));
    scene
}

/// A ball with an uneven surface, like a clipped shrub.
fn bush(center: [f64; 3], radius: f64) -> crate::shapes::Shape {
    let (mut positions, triangles) = icosphere(5, [0.0; 3], radius);
    for p in &mut positions {
        let wave = |a: f64, b: f64, c: f64| libm::sin(TAU * (a * p[0] + b * p[1] + c * p[2]) / radius);
        let grow =
            1.0 + 0.05 * (wave(2.1, 0.7, -1.3) * wave(-0.9, 1.9, 1.1) + wave(3.3, -2.9, 1.7) * wave(1.3, 2.3, -3.1));
        *p = p.map(|c| c * grow);
    }
    translate((positions, triangles), center)
}
