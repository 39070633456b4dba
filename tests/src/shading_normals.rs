//! Shading normals that differ from geometric ones: light by photons equals light by shadow rays and by gather rays.

use std::f64::consts::PI;

use photon_core::{Direct, Estimator, Filter, Indirect, Settings};
use photon_scene::{
    LightDesc, MaterialDesc, SceneBuilder, TextureDesc, TextureRef, TexturesDesc, VertexAttributes, shapes,
};

use crate::harness::{TestBackend, look_at_point, per_pass};
use crate::stats::{assert_agrees, moments, standard_error};

fn settings() -> Settings {
    Settings { photons: 20_000, alpha: 1.0, estimator: Estimator::Radius { radius: Some(0.05) }, ..Settings::default() }
}

/// A square of half side `half` in the plane y = `y`, facing up, whose normals are tilted towards +x by `degrees`: by
/// vertex normals or by a normal map.
fn tilted(builder: &mut SceneBuilder, material: MaterialDesc, (half, y): (f64, f64), degrees: f64, mapped: bool) {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let positions: Vec<[f64; 3]> =
        [[-half, half], [half, half], [half, -half], [-half, -half]].map(|[x, z]| [x, y, z]).to_vec();
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    if !mapped {
        let attributes = VertexAttributes::default().with_normals(vec![[sin, cos, 0.0]; 4]);
        let material = builder.material(material);
        return builder.mesh_with("tilted", positions, triangles, attributes, material);
    }
    // u runs along +x, the tangent; the second texel keeps the map from being one colour, and is not used.
    let texel = [(0.5 + 0.5 * sin) as f32, 0.5, (0.5 + 0.5 * cos) as f32, 1.0];
    let image = TextureDesc::float32("bumps", 2, 1, &[texel, [0.5, 0.5, 1.0, 1.0]]).filtered(Filter::Nearest);
    let image = builder.texture(image);
    let textures = TexturesDesc::default().with_normal(TextureRef::new(image));
    let material = builder.material(material.with_textures(textures));
    let uvs = vec![vec![[0.1, 0.9], [0.4, 0.9], [0.4, 0.1], [0.1, 0.1]]];
    let attributes = VertexAttributes::default().with_uvs(uvs);
    builder.mesh_with("tilted", positions, triangles, attributes, material);
}

fn agrees<T: TestBackend>(what: &str, builder: SceneBuilder, settings: &Settings, truth: f64, bound: f64) {
    let scene = builder.build().unwrap();
    let values = per_pass::<T>(&scene, settings, 16, 4);
    assert_agrees(what, moments(&values).0, truth, standard_error(&values), bound * truth);
}

/// G9: parallel light along the geometric normal on a shading normal tilted by t: `ρE₀ cos t/π`, by shadow rays and by
/// photons, from vertex normals and from a normal map. Normals have 16 bits a coordinate.
pub fn g9_parallel_light<T: TestBackend>() {
    let albedo = 0.6;
    for (degrees, mapped) in [(20.0, false), (50.0, false), (50.0, true)] {
        for direct in [Direct::Nee, Direct::Photons] {
            let mut builder = SceneBuilder::new();
            tilted(&mut builder, MaterialDesc::lambert("floor", [albedo; 3]), (1.0, 0.0), degrees, mapped);
            builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [PI; 3] });
            look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 1.0, 0.2);
            let s = Settings { direct, indirect: Indirect::None, ..settings() };
            let truth = albedo * degrees.to_radians().cos();
            agrees::<T>(&format!("{direct:?} {degrees} {mapped}"), builder, &s, truth, 3e-4);
        }
    }
}

/// Parallel light from the side that the normal is tilted to, and from the other: `cos` of the angle to the normal, 0 if
/// that is beyond a right angle, although the triangle is lit.
pub fn g9_light_from_the_sides<T: TestBackend>() {
    let (tilt, height) = (40.0_f64, 20.0_f64);
    for (side, truth) in [(1.0, (90.0 - height - tilt).to_radians().cos()), (-1.0, 0.0)] {
        for direct in [Direct::Nee, Direct::Photons] {
            let mut builder = SceneBuilder::new();
            tilted(&mut builder, MaterialDesc::lambert("floor", [1.0; 3]), (1.0, 0.0), tilt, false);
            let (sin, cos) = height.to_radians().sin_cos();
            builder.light("sun", LightDesc::Directional { direction: [-side * cos, -sin, 0.0], irradiance: [PI; 3] });
            look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 1.0, 0.2);
            let s = Settings { direct, indirect: Indirect::None, ..settings() };
            let values = per_pass::<T>(&builder.build().unwrap(), &s, 16, 4);
            let bound = 1e-3 * truth + 1e-6;
            assert_agrees(&format!("{direct:?} {side}"), moments(&values).0, truth, standard_error(&values), bound);
        }
    }
}

/// G9: a closed shell that emits 1 and reflects a half has radiance 2: on a small plate whose normal is tilted by t the
/// result is `2 (1 + cos t)/2`, less the share that the limit of 32 takes (shading_normal.rs). Direct light is by shadow
/// rays or by photons, and gather rays find what the shell reflects. Photons have a larger variance, since their weight
/// grows towards the horizon, so their tilt is smaller.
pub fn g9_even_sky<T: TestBackend>() {
    for (name, direct, degrees, lost) in
        [("shadow rays", Direct::Nee, 45.0, 0.004_679), ("photons", Direct::Photons, 15.0, 0.000_549)]
    {
        let mut builder = SceneBuilder::new();
        let glow = builder.material(MaterialDesc::emissive("shell", [0.5; 3], [1.0; 3]));
        let (positions, triangles) = shapes::flip(shapes::icosphere(4, [0.0; 3], 1.0));
        builder.mesh("shell", positions, triangles, glow);
        tilted(&mut builder, MaterialDesc::lambert("plate", [1.0; 3]), (0.1, 0.0), degrees, false);
        look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.02);
        let estimator = Estimator::Radius { radius: Some(0.05) };
        let s = Settings {
            direct,
            indirect: Indirect::Gather,
            gather_rays: 16,
            shadow_rays: 4,
            max_bounces: 64,
            photons: 40_000,
            estimator,
            ..settings()
        };
        let truth = (1.0 + degrees.to_radians().cos()) * (1.0 - lost);
        // The plate absorbs and reflects light in proportion to its area, of 0.02 in 12.6.
        agrees::<T>(name, builder, &s, truth, 4e-3);
    }
}

/// Photons leave a surface with a tilted shading normal as radiance does: a floor in the sun
/// lights a ceiling by `ρE₀ cos t · F`, found from the global map and by gather rays. F is that of a square of half side a
/// at distance h: `4/(2π) · 2 (a/√(a²+h²)) atan(a/√(a²+h²))`.
pub fn photons_scattered_by_a_tilted_normal<T: TestBackend>() {
    let (degrees, albedo, half) = (50.0_f64, 0.8, 0.5_f64);
    let s = (half * half + 1.0).sqrt();
    let form = 4.0 / PI * (half / s) * (half / s).atan();
    let truth = albedo * degrees.to_radians().cos() * form;
    let scene = |degrees: f64| {
        let mut builder = SceneBuilder::new();
        tilted(&mut builder, MaterialDesc::lambert("floor", [albedo; 3]), (half, 0.0), degrees, false);
        // Its shadow falls beside the floor.
        let white = builder.material(MaterialDesc::lambert("ceiling", [1.0; 3]));
        builder.quad("ceiling", [[-0.3, 1.0, -0.3], [0.3, 1.0, -0.3], [0.3, 1.0, 0.3], [-0.3, 1.0, 0.3]], white);
        let elevation = 40.0_f64.to_radians();
        let direction = [0.0, -elevation.sin(), -elevation.cos()];
        let strength = PI / elevation.sin();
        builder.light("sun", LightDesc::Directional { direction, irradiance: [strength; 3] });
        look_at_point(&mut builder, [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], 0.2, 0.02);
        builder
    };
    let s = Settings { direct: Direct::None, gather_rays: 16, max_bounces: 2, ..settings() };
    let by_map = Settings { estimator: Estimator::Radius { radius: Some(0.12) }, ..s.clone() };
    agrees::<T>("map", scene(degrees), &by_map, truth, 0.01);
    // Gather rays read estimates beside the edges of the floor too, which lose area, whatever the normals.
    let by_rays = Settings { indirect: Indirect::Gather, ..s };
    let [flat, found] = [0.0, degrees].map(|degrees| per_pass::<T>(&scene(degrees).build().unwrap(), &by_rays, 16, 4));
    let cos = degrees.to_radians().cos();
    let error = standard_error(&found).hypot(cos * standard_error(&flat));
    let expected = cos * moments(&flat).0;
    assert_agrees("gather", moments(&found).0, expected, error, 1e-3 * expected);
    assert!((expected / truth - 1.0).abs() < 0.1, "{expected} {truth}");
}

/// A mirror whose normals are tilted by t turns parallel light, straight down, by 2t: a plate across its way gets `E₀`, as
/// parallel light keeps its radiance, although the beam is `cos 2t` as wide. A camera that looks down sees what is there.
pub fn a_mirror_with_tilted_normals<T: TestBackend>() {
    let (degrees, albedo) = (20.0_f64, 0.7);
    for mapped in [false, true] {
        let mut builder = SceneBuilder::new();
        tilted(&mut builder, MaterialDesc::mirror("mirror", [1.0; 3]), (0.5, 0.0), degrees, mapped);
        let (sin, cos) = (2.0 * degrees).to_radians().sin_cos();
        let plate = |half: f64, at: f64| {
            let (center, across) = ([at * sin, at * cos], [half * cos, -half * sin]);
            let corner = |a: f64, z: f64| [center[0] + a * across[0], center[1] + a * across[1], z];
            [corner(-1.0, -half), corner(1.0, -half), corner(1.0, half), corner(-1.0, half)]
        };
        let mut lit = builder.clone();
        let grey = lit.material(MaterialDesc::lambert("plate", [albedo; 3]));
        lit.quad("plate", plate(0.15, 1.0), grey);
        lit.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [PI; 3] });
        look_at_point(&mut lit, [sin, cos, 0.0], [-sin, -cos, 0.0], 0.1, 0.03);
        let s = Settings { direct: Direct::None, ..settings() };
        agrees::<T>("by photons", lit, &s, albedo, 2e-3);

        let glow = builder.material(MaterialDesc::emissive("glow", [0.5; 3], [1.0; 3]));
        builder.quad("glow", plate(0.05, 1.0), glow);
        look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.03);
        let s = Settings { direct: Direct::None, indirect: Indirect::None, caustics: false, ..settings() };
        agrees::<T>("by the camera", builder, &s, 1.0, 1e-6);
    }
}

/// A coarse sphere with smooth vertex normals, of glass or a mirror, in a shell of uniform radiance: every camera
/// path ends at the shell, so that the ball is as bright in every pixel; and the shell, which reflects a half of the
/// photons that reach it past the ball, is `e/(1−ρ)` bright.
pub fn smooth_balls_in_an_even_shell<T: TestBackend>() {
    for (name, material) in
        [("glass", MaterialDesc::glass("ball", 1.5)), ("mirror", MaterialDesc::mirror("ball", [1.0; 3]))]
    {
        let mut builder = SceneBuilder::new();
        let (positions, triangles) = shapes::icosphere(1, [0.0; 3], 0.4);
        let normals = positions.iter().map(|p: &[f64; 3]| p.map(|c| c / 0.4)).collect();
        let material = builder.material(material);
        let attributes = VertexAttributes::default().with_normals(normals);
        builder.mesh_with("ball", positions, triangles, attributes, material);
        let shell = builder.material(MaterialDesc::emissive("shell", [0.5; 3], [1.0; 3]));
        let (positions, triangles) = shapes::flip(shapes::icosphere(5, [0.0; 3], 1.0));
        builder.mesh("shell", positions, triangles, shell);
        let mut wall = builder.clone();
        look_at_point(&mut builder, [0.0; 3], [0.0, 0.0, 1.0], 0.85, 0.3);
        let s = Settings { direct: Direct::None, indirect: Indirect::None, caustics: false, ..settings() };
        let film = crate::harness::film::<T>(&builder.build().unwrap(), &Settings { max_bounces: 4096, ..s }, 2, 16);
        for pixel in film.beauty() {
            assert!((pixel[0] - 1.0).abs() < 1e-5, "{name}: {pixel:?}");
        }
        look_at_point(&mut wall, [0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 0.3, 0.1);
        let estimator = Estimator::Radius { radius: Some(0.15) };
        let s = Settings { max_bounces: 4096, photons: 20_000, estimator, ..settings() };
        // The triangles of the shell are up to 2e-3 off a sphere.
        agrees::<T>(name, wall, &s, 2.0, 3e-3);
    }
}
