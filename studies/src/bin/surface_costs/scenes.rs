//! Pairs of scenes that differ in one feature.

use photon_core::{CausticPhotons, EnvironmentMap, Estimator, Settings, Stage};
use photon_scene::{
    AlphaMode, LightDesc, MaterialDesc, MaterialId, SceneBuilder, TextureDesc, TextureId, TextureRef, TexturesDesc,
    VertexAttributes, shapes,
};
use photon_tests::harness::look_at_point;

/// A feature beside the same scene without it.
pub(crate) struct Pair {
    /// What the ratio is of.
    pub(crate) what: &'static str,
    /// The stages whose times are compared.
    pub(crate) stages: &'static [Stage],
    /// The ratio that was aimed for, at most.
    pub(crate) goal: f64,
    /// With the feature, and without.
    pub(crate) scenes: [SceneBuilder; 2],
    pub(crate) settings: Settings,
}

/// What all pairs have in common.
fn settings(photons: u32) -> Settings {
    Settings {
        photons,
        max_bounces: 8,
        estimator: Estimator::Radius { radius: Some(0.1) },
        caustic_photons: CausticPhotons::Shared,
        ..Settings::default()
    }
}

pub(crate) fn pairs(photons: u32) -> Vec<Pair> {
    let pass = &Stage::ALL[2..];
    let pair = |what, stages, goal, scenes| Pair { what, stages, goal, scenes, settings: settings(photons) };
    vec![
        pair("texture: photon paths", &[Stage::Trace], 1.15, [room(Walls::Textured), room(Walls::Diffuse)]),
        pair("texture: camera paths", &[Stage::Eye], 1.25, [room(Walls::Textured), room(Walls::Diffuse)]),
        pair("vertex normals: photon paths", &[Stage::Trace], 1.10, [balls(true), balls(false)]),
        pair("plastic / diffuse: whole pass", pass, 2.0, [room(Walls::Plastic), room(Walls::Diffuse)]),
        pair("BSDF for each photon / none: estimates", &[Stage::Estimate], 2.0, [sun(true), sun(false)]),
        pair("ten sheets with alpha / opaque: camera paths", &[Stage::Eye], 2.5, [sheets(true), sheets(false)]),
        pair(
            "mesh beside sheets with alpha / alone: photon paths",
            &[Stage::Trace],
            1.02,
            [beside(true), beside(false)],
        ),
        pair("environment / directional light: shadow rays", &[Stage::Direct], 1.3, [lit_by(true), lit_by(false)]),
        pair("100,000 lights / 16: shadow rays", &[Stage::Direct], 2.0, [point_lights(316), point_lights(4)]),
    ]
}

#[derive(Clone, Copy)]
enum Walls {
    Diffuse,
    Textured,
    Plastic,
}

/// Texels of two values whose mean is that of the walls without a texture, in no order.
fn noise(scene: &mut SceneBuilder) -> TextureId {
    const SIZE: u32 = 1024;
    let texels: Vec<[u8; 4]> = (0..SIZE * SIZE)
        .map(|index| {
            let value = if index.wrapping_mul(0x9E37_79B9) >> 31 == 0 { 77 } else { 178 };
            [value, value, value, 255]
        })
        .collect();
    scene.texture(TextureDesc::linear8("noise", SIZE, SIZE, &texels))
}

/// A closed room under a point light; the camera looks at the floor.
fn room(walls: Walls) -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let material = match walls {
        Walls::Diffuse => MaterialDesc::lambert("walls", [0.5; 3]),
        Walls::Plastic => MaterialDesc::plastic("walls", [0.5; 3], 0.5),
        Walls::Textured => {
            let textures = TexturesDesc::default().with_base_color(TextureRef::new(noise(&mut scene)));
            MaterialDesc::lambert("walls", [1.0; 3]).with_textures(textures)
        }
    };
    let walls = scene.material(material);
    for (axis, side) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
        let corner = |u: f64, v: f64| {
            let mut point = [side; 3];
            (point[(axis + 1) % 3], point[(axis + 2) % 3]) = (u, v);
            point
        };
        let mut corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        if side > 0.0 {
            corners.reverse();
        }
        let uvs = vec![vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
        let attributes = VertexAttributes::default().with_uvs(uvs);
        scene.mesh_with("wall", corners, vec![[0, 1, 2], [0, 2, 3]], attributes, walls);
    }
    scene.light("light", LightDesc::Point { position: [0.1, 0.2, 0.3], intensity: [1.0; 3] });
    look_at_point(&mut scene, [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], 1.5, 0.9);
    scene
}

/// 27 balls of 1280 triangles in the same room.
fn balls(smooth: bool) -> SceneBuilder {
    let mut scene = room(Walls::Diffuse);
    let grey = scene.material(MaterialDesc::lambert("balls", [0.5; 3]));
    for index in 0..27 {
        let center = [index % 3, index / 3 % 3, index / 9].map(|step| 0.55 * (f64::from(step) - 1.0) - 0.1);
        let (positions, triangles) = shapes::icosphere(3, center, 0.2);
        let outwards = |p: &[f64; 3]| std::array::from_fn(|axis| p[axis] - center[axis]);
        let normals = if smooth { positions.iter().map(outwards).collect() } else { Vec::new() };
        scene.mesh_with("ball", positions, triangles, VertexAttributes::default().with_normals(normals), grey);
    }
    scene
}

fn floor(scene: &mut SceneBuilder, name: &str, height: f64, half: f64, material: MaterialId) {
    let corners = [[-half, height, half], [half, height, half], [half, height, -half], [-half, height, -half]];
    scene.quad(name, corners, material);
}

/// Parallel light through a pane onto a floor: each estimate sums photons, weighted by the BSDF of a metal or not.
fn sun(metal: bool) -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let ground = match metal {
        true => MaterialDesc::metal("floor", [0.5; 3], 0.5),
        false => MaterialDesc::lambert("floor", [0.5; 3]),
    };
    let ground = scene.material(ground);
    let pane = scene.material(MaterialDesc::thin("pane", 1.5));
    floor(&mut scene, "floor", 0.0, 1.0, ground);
    floor(&mut scene, "pane", 0.5, 1.0, pane);
    let direction = [0.0, -1.0, 0.0];
    scene.light("sun", LightDesc::Directional { direction, irradiance: [1.0; 3] });
    look_at_point(&mut scene, [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.25, 0.9);
    scene
}

/// Ten sheets, seen from above: chequered ones, of whose squares every second is a hole, or opaque ones.
fn sheets(alpha: bool) -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let mut sheet = MaterialDesc::lambert("sheet", [0.5; 3]);
    if alpha {
        let texels: Vec<[u8; 4]> =
            (0..64 * 64_u32).map(|i| [255, 255, 255, if (i % 64 + i / 64) % 2 == 0 { 0 } else { 255 }]).collect();
        let texture = scene.texture(TextureDesc::linear8("chequers", 64, 64, &texels));
        let textures = TexturesDesc::default().with_alpha(TextureRef::new(texture));
        sheet = sheet.with_alpha(AlphaMode::Mask { cutoff: 0.5 }, 1.0).with_textures(textures);
    }
    let sheet = scene.material(sheet);
    for index in 0..10 {
        let height = 0.05 * f64::from(index);
        let corners = vec![[-1.0, height, 1.0], [1.0, height, 1.0], [1.0, height, -1.0], [-1.0, height, -1.0]];
        let uvs = vec![vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
        let attributes = VertexAttributes::default().with_uvs(uvs);
        scene.mesh_with("sheet", corners, vec![[0, 1, 2], [0, 2, 3]], attributes, sheet);
    }
    scene.light("light", LightDesc::Point { position: [0.0, 2.0, 0.0], intensity: [1.0; 3] });
    look_at_point(&mut scene, [0.0; 3], [0.0, 1.0, 0.0], 1.0, 0.9);
    scene
}

/// The room with balls; outside of it a sheet with alpha, or nothing.
fn beside(alpha: bool) -> SceneBuilder {
    let mut scene = balls(false);
    let mut sheet = MaterialDesc::lambert("sheet", [0.5; 3]);
    if alpha {
        sheet = sheet.with_alpha(AlphaMode::Blend, 0.5);
    }
    let sheet = scene.material(sheet);
    floor(&mut scene, "sheet", -1.2, 0.5, sheet);
    scene
}

/// A floor and a ball under an environment of 1024 by 512 texels, or under parallel light.
fn lit_by(environment: bool) -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let grey = scene.material(MaterialDesc::lambert("grey", [0.5; 3]));
    floor(&mut scene, "floor", 0.0, 1.0, grey);
    let (positions, triangles) = shapes::icosphere(4, [0.0, 0.5, 0.0], 0.4);
    scene.mesh("ball", positions, triangles, grey);
    if environment {
        let texel = |index: u32| [0.2 + (index.wrapping_mul(0x9E37_79B9) >> 24) as f32 / 128.0; 3];
        let texels: Vec<[f32; 3]> = (0..1024 * 512).map(texel).collect();
        scene.environment(EnvironmentMap::new(1024, &texels, 0.0).expect("positive texels in full rows"));
    } else {
        scene.light("sun", LightDesc::Directional { direction: [0.3, -1.0, 0.2], irradiance: [1.0; 3] });
    }
    look_at_point(&mut scene, [0.0; 3], [0.0, 1.0, 0.0], 2.0, 0.9);
    scene
}

/// A floor of 8 by 8 under a square grid of point lights, 0.3 above it.
fn point_lights(side: u32) -> SceneBuilder {
    let mut scene = SceneBuilder::new();
    let grey = scene.material(MaterialDesc::lambert("floor", [0.5; 3]));
    floor(&mut scene, "floor", 0.0, 4.0, grey);
    let place = |step: u32| 8.0 * ((f64::from(step) + 0.5) / f64::from(side) - 0.5);
    for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
        let position = [place(column), 0.3, place(row)];
        let intensity = [1.0 / f64::from(side * side); 3];
        scene.light("light", LightDesc::Point { position, intensity });
    }
    look_at_point(&mut scene, [0.0; 3], [0.0, 1.0, 0.0], 0.25, 3.6);
    scene
}
