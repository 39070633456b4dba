//! A corner of a room with metal and plastic balls of several roughnesses on a floor of worn, glazed tiles.

use super::textures::{smooth, textured_quad};
use crate::builder::SceneBuilder;
use crate::describe::{CameraDesc, MaterialDesc, Surface};
use crate::shapes::icosphere;
use crate::texture::{TextureDesc, TextureRef, TexturesDesc};

/// Half the width of the room, metres.
const HALF: f64 = 2.0;
/// Texels on a side of the images of the tiles, and tiles on a side.
const SIDE: u32 = 64;
const TILES: u32 = 4;
/// Radius of the balls.
const RADIUS: f64 = 0.42;

/// The texels of an image of tiles: of joints, or of a tile with its number and the distance to its centre, 0 to 1.
fn tiles(joint: [u8; 4], tile: impl Fn(u32, f64) -> [u8; 4]) -> Vec<[u8; 4]> {
    let size = SIDE / TILES;
    let texel = |i: u32| {
        let (x, y) = (i % SIDE, i / SIDE);
        if x.is_multiple_of(size) || y.is_multiple_of(size) {
            return joint;
        }
        let from_middle = |i: u32| (f64::from(i % size) - 0.5 * f64::from(size)) / (0.5 * f64::from(size));
        let (a, b) = (from_middle(x), from_middle(y));
        tile(x / size + y / size * TILES, libm::sqrt(0.5 * (a * a + b * b)))
    };
    (0..SIDE * SIDE).map(texel).collect()
}

/// Dark and light tiles with grey joints.
fn colors() -> Vec<[u8; 4]> {
    tiles([150, 145, 138, 255], |number, _| match (number + number / TILES) % 2 {
        0 => [58, 74, 80, 255],
        _ => [188, 176, 158, 255],
    })
}

/// Rough joints, and tiles whose glaze is worn in the middle, each to another degree; no metal.
fn roughness() -> Vec<[u8; 4]> {
    tiles([255, 230, 0, 255], |number, distance| {
        let worn = f64::from(number * 7 % (TILES * TILES)) / f64::from(TILES * TILES);
        [255, (30.0 + 120.0 * worn * (1.0 - distance)) as u8, 0, 255]
    })
}

/// A glazed floor with textures of colour and roughness, four metal and four plastic balls from smooth to rough, one that
/// is half metal, an area light in the ceiling and a window.
pub(super) fn gloss() -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let colors = scene.texture(TextureDesc::srgb8("tiles", SIDE, SIDE, &colors()));
    let roughness = scene.texture(TextureDesc::linear8("glaze", SIDE, SIDE, &roughness()));
    let (h, top) = (HALF, 1.6 * HALF);
    let textures = TexturesDesc {
        base_color: Some(TextureRef::new(colors)),
        metallic_roughness: Some(TextureRef::new(roughness)),
        ..TexturesDesc::default()
    };
    let floor = [[-h, 0., h], [h, 0., h], [h, 0., -h], [-h, 0., -h]];
    let tiled = MaterialDesc::plastic("tiles", [1.0; 3], 1.0).with_textures(textures);
    textured_quad(&mut scene, "floor", floor, 2.0, tiled);

    let wall = scene.material(MaterialDesc::lambert("wall", [0.72, 0.70, 0.66]));
    scene.quad("back wall", [[-h, 0., -h], [h, 0., -h], [h, top, -h], [-h, top, -h]], wall);
    scene.quad("left wall", [[-h, 0., h], [-h, 0., -h], [-h, top, -h], [-h, top, h]], wall);
    scene.quad("ceiling", [[-h, top, -h], [h, top, -h], [h, top, h], [-h, top, h]], wall);
    let paint = scene.material(MaterialDesc::plastic("gloss paint", [0.55, 0.16, 0.12], 0.4));
    scene.quad("right wall", [[h, 0., -h], [h, 0., h], [h, top, h], [h, top, -h]], paint);

    let area_light = scene.material(MaterialDesc::emissive("ceiling light", [0.0; 3], [18.0, 16.5, 14.0]));
    let y = top - 0.01;
    scene.quad("ceiling light", [[-0.5, y, -0.5], [0.5, y, -0.5], [0.5, y, 0.3], [-0.5, y, 0.3]], area_light);
    let window = scene.material(MaterialDesc::emissive("window", [0.0; 3], [5.0, 6.5, 8.0]));
    let x = 0.01 - h;
    scene.quad("window", [[x, 0.9, 0.4], [x, 0.9, -1.0], [x, 2.4, -1.0], [x, 2.4, 0.4]], window);

    let half_metal =
        Surface::Glossy { base_color: [0.80, 0.45, 0.35], metallic: 0.5, roughness: 0.3, specular: 1.0, ior: 1.5 };
    let balls = [
        ([-1.4, 0.9], MaterialDesc::metal("silver", [0.95, 0.93, 0.88], 0.1)),
        ([-0.50, 0.9], MaterialDesc::metal("gold", [0.98, 0.76, 0.33], 0.25)),
        ([0.50, 0.9], MaterialDesc::metal("copper", [0.94, 0.62, 0.50], 0.45)),
        ([1.4, 0.9], MaterialDesc::metal("iron", [0.56, 0.57, 0.58], 0.7)),
        ([-1.4, -0.3], MaterialDesc::plastic("red plastic", [0.70, 0.06, 0.05], 0.1)),
        ([-0.50, -0.3], MaterialDesc::plastic("green plastic", [0.10, 0.45, 0.12], 0.25)),
        ([0.50, -0.3], MaterialDesc::plastic("blue plastic", [0.08, 0.16, 0.60], 0.45)),
        ([1.4, -0.3], MaterialDesc::plastic("white plastic", [0.85; 3], 0.7)),
        ([0.0, -1.35], MaterialDesc::new("half metal", half_metal)),
    ];
    for ([x, z], material) in balls {
        let center = [x, RADIUS, z];
        let name = format!("{} ball", material.name);
        smooth(&mut scene, &name, icosphere(3, center, RADIUS), center, false, material);
    }

    let fov = 2.0 * libm::atan(1.65 / 6.0);
    scene.camera("front", CameraDesc::look_at([0., 1.9, h + 6.0], [0., 1.45, 0.], [0., 1., 0.], fov));
    scene
}
