//! A corner of a room in which every surface is textured, coloured by its vertices, or smoothed by vertex normals.

use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, MaterialDesc};
use crate::mesh::VertexAttributes;
use crate::shapes::{Shape, icosphere, uv_sphere};
use crate::texture::{TextureDesc, TextureRef, TexturesDesc};
use photon_core::{Filter, Wrap};

/// Half the width of the room, metres.
const HALF: f64 = 2.0;
/// Texels on a side of the images.
const SIDE: u32 = 32;

/// The texels of an image, by column and row.
fn image(color: impl Fn(u32, u32) -> [u8; 4]) -> Vec<[u8; 4]> {
    (0..SIDE * SIDE).map(|i| color(i % SIDE, i / SIDE)).collect()
}

/// Tiles of two colours with light joints.
fn tiles(x: u32, y: u32) -> [u8; 4] {
    let half = SIDE / 2;
    match (x.is_multiple_of(half) || y.is_multiple_of(half), (x < half) == (y < half)) {
        (true, _) => [205, 200, 190, 255],
        (false, true) => [150, 70, 45, 255],
        (false, false) => [190, 140, 95, 255],
    }
}

/// Normals of round bumps, four on a side: half a turn of a sine on both axes, 20 degrees steep at most.
fn bumps(x: u32, y: u32) -> [u8; 4] {
    let slope = |i: u32| -0.36 * libm::sin(std::f64::consts::TAU * (f64::from(i) + 0.5) * 4.0 / f64::from(SIDE));
    let (a, b) = (slope(x), slope(y));
    let length = libm::sqrt(a * a + b * b + 1.0);
    let byte = |part: f64| libm::round((0.5 + 0.5 * part / length) * 255.0) as u8;
    [byte(a), byte(-b), byte(1.0), 255]
}

/// A window of four panes: warm and cool light behind dark bars.
fn panes(x: u32, y: u32) -> [u8; 4] {
    let middle = |i: u32| i.abs_diff(SIDE / 2) < 2;
    match (middle(x) || middle(y), x < SIDE / 2) {
        (true, _) => [0, 0, 0, 255],
        (false, true) => [255, 215, 160, 255],
        (false, false) => [170, 205, 255, 255],
    }
}

/// A quad whose texture coordinates run `times` from its first corner to the second, and as often to the last.
pub(super) fn textured_quad(
    scene: &mut SceneBuilder,
    name: &str,
    corners: [[f64; 3]; 4],
    times: f64,
    material: MaterialDesc,
) {
    let material = scene.material(material);
    let uvs = vec![vec![[0.0, times], [times, times], [times, 0.0], [0.0, 0.0]]];
    let attributes = VertexAttributes { uvs, ..VertexAttributes::default() };
    scene.mesh_with(name, corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]], attributes, material);
}

/// A ball around `center` with the normals of a sphere.
pub(super) fn smooth(
    scene: &mut SceneBuilder,
    name: &str,
    ball: Shape,
    center: [f64; 3],
    colored: bool,
    material: MaterialDesc,
) {
    let (positions, triangles) = ball;
    let from = |p: &[f64; 3]| [p[0] - center[0], p[1] - center[1], p[2] - center[2]];
    let normals: Vec<[f64; 3]> = positions.iter().map(from).collect();
    let color = |n: &[f64; 3]| [0.55 + 0.45 * n[0], 0.55 + 0.45 * n[1], 0.55 + 0.45 * n[2], 1.0];
    let colors = if colored { normals.iter().map(color).collect() } else { Vec::new() };
    let material = scene.material(material);
    let attributes = VertexAttributes { normals, colors, ..VertexAttributes::default() };
    scene.mesh_with(name, positions, triangles, attributes, material);
}

/// A tiled floor, a wall with a normal map, a window that shines in two colours, a ball coloured by its vertices and a
/// mirror ball, both of few triangles.
pub(super) fn textures() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let tiles = scene.texture(TextureDesc::srgb8("tiles", SIDE, SIDE, &image(tiles)));
    let bumps = scene.texture(TextureDesc::linear8("bumps", SIDE, SIDE, &image(bumps)));
    let panes = TextureDesc::srgb8("panes", SIDE, SIDE, &image(panes)).wrapped([Wrap::Clamp; 2]);
    let panes = scene.texture(panes.filtered(Filter::Nearest));
    let used = |texture| Some(TextureRef::new(texture));
    let none = TexturesDesc::default();

    let (h, top) = (HALF, 2.0 * HALF);
    let floor = [[-h, 0., h], [h, 0., h], [h, 0., -h], [-h, 0., -h]];
    let textures = TexturesDesc { base_color: used(tiles), ..none };
    textured_quad(&mut scene, "floor", floor, 3.0, MaterialDesc::lambert("tiles", [1.0; 3]).with_textures(textures));
    let back = [[-h, 0., -h], [h, 0., -h], [h, top, -h], [-h, top, -h]];
    let textures = TexturesDesc { normal: used(bumps), ..none };
    textured_quad(&mut scene, "wall", back, 2.0, MaterialDesc::lambert("bumps", [0.7; 3]).with_textures(textures));
    let white = scene.material(MaterialDesc::lambert("white", [0.75; 3]));
    scene.quad("right wall", [[h, 0., -h], [h, 0., h], [h, top, h], [h, top, -h]], white);
    scene.quad("ceiling", [[-h, top, -h], [h, top, -h], [h, top, h], [-h, top, h]], white);
    scene.quad("left wall", [[-h, 0., h], [-h, 0., -h], [-h, top, -h], [-h, top, h]], white);
    let x = 0.01 - h;
    let window = [[x, 1.2, 0.9], [x, 1.2, -0.9], [x, 3.0, -0.9], [x, 3.0, 0.9]];
    let textures = TexturesDesc { emission: used(panes), ..none };
    let emissive = MaterialDesc::emissive("window", [0.0; 3], [12.0; 3]).with_textures(textures);
    textured_quad(&mut scene, "window", window, 1.0, emissive);

    let (painted, mirror) = ([-0.7, 0.75, -0.6], [0.75, 0.65, 0.3]);
    let paint = MaterialDesc::lambert("painted", [1.0; 3]);
    smooth(&mut scene, "painted ball", icosphere(2, painted, 0.75), painted, true, paint);
    let silver = MaterialDesc::mirror("silver", [0.9, 0.9, 0.88]);
    smooth(&mut scene, "mirror ball", uv_sphere(16, 8, mirror, 0.65), mirror, false, silver);

    let fov = 2.0 * libm::atan(0.998 * h / 6.0);
    scene.camera("front", CameraDesc::look_at([0., h, h + 6.0], [0., h, 0.], [0., 1., 0.], fov));
    scene
}
