//! Boundaries that light passes: transmittance by every kind of ray, media that overlap, and surfaces in the plane of a boundary.

use std::f64::consts::FRAC_1_PI;

use photon_core::{Direct, Film, Indirect, Layer, Render as _, Settings};
use photon_scene::{AmbientMedium, LightDesc, MaterialDesc, Scene, SceneBuilder, shapes};

use crate::harness::{TestBackend, direct_settings};
use crate::media::{assert_mean, camera, cases, fixed_radius, mean, per_pass, renderer};

/// A scene in a frame of its own, whatever is added: two specks in opposite corners.
fn framed() -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let black = builder.material(MaterialDesc::lambert("speck", [0.0; 3]));
    for at in [-4.0, 4.0 - 1e-3] {
        let to = at + 1e-3;
        builder.quad("speck", [[at, at, at], [to, at, at], [to, to, at], [at, to, to]], black);
    }
    builder
}

/// A closed mesh in a medium that absorbs.
fn ink(builder: &mut SceneBuilder, (positions, triangles): shapes::Shape, absorption: f64, priority: u32) {
    let ink = builder.material(MaterialDesc::boundary("ink", [absorption; 3]).with_priority(priority));
    builder.mesh("ink", positions, triangles, ink);
}

fn rendered<T: TestBackend>(scene: &Scene, settings: &Settings, size: u32) -> Film {
    let mut renderer = renderer::<T>(scene, scene.view().media, settings, size);
    renderer.pass(0, &mut ()).unwrap();
    renderer.film().unwrap()
}

/// A body of a column: from x to x, absorption, priority.
type Body = (f64, f64, f64, u32);

/// Transmittances of media that overlap, with the camera outside and inside: columns side by side, seen along x from −3 to a quad of
/// radiance 1 at 3. f32 keeps them to 2e-5.
pub fn rays_cross_media<T: TestBackend>() {
    // The optical depth from end to end.
    let columns: &[(&str, &[Body], f64)] = &[
        ("nothing", &[], 0.0),
        ("one", &[(-1.0, 1.0, 0.4, 0)], 0.8),
        ("around the camera", &[(-3.5, 1.0, 0.3, 0)], 1.2),
        ("around everything", &[(-3.5, 3.5, 0.2, 0)], 1.2),
        ("the camera on a face", &[(-3.0, 3.0, 0.2, 0)], 1.2),
        ("two with a common face", &[(-1.0, 0.0, 0.4, 0), (0.0, 1.0, 0.7, 0)], 1.1),
        ("two alike that overlap", &[(-1.0, 0.5, 0.4, 0), (-0.5, 1.0, 0.4, 0)], 0.8),
        ("nested: the inner one", &[(-2.0, 2.0, 0.1, 0), (-0.5, 0.5, 1.0, 0)], 1.3),
        ("nested: the outer one", &[(-2.0, 2.0, 0.1, 1), (-0.5, 0.5, 1.0, 0)], 0.4),
        ("a cavity", &[(-2.0, 2.0, 0.3, 0), (-0.5, 0.5, 0.0, 0)], 0.9),
        ("dense", &[(-0.5, 0.5, 9.0, 0)], 9.0),
        ("glass within", &[(-2.0, 2.0, 0.4, 0)], 1.2),
        ("glass filled", &[(-2.0, 2.0, 0.4, 1)], 1.6),
    ];
    let count = columns.len();
    let mut builder = SceneBuilder::new();
    let glow = builder.material(MaterialDesc::emissive("glow", [0.0; 3], [1.0; 3]));
    let z = count as f64;
    builder.quad("glow", [[3.0, -1.0, -z], [3.0, -1.0, z], [3.0, 1.0, z], [3.0, 1.0, -z]], glow);
    let glass = builder.material(MaterialDesc::glass("glass", 1.5));
    for (number, (what, bodies, _)) in columns.iter().enumerate() {
        let middle = number as f64 + 0.5 - 0.5 * z;
        let block =
            |from: f64, to: f64, half: f64| shapes::cuboid([from, -half, middle - half], [to, half, middle + half]);
        for (inner, &(from, to, absorption, priority)) in bodies.iter().enumerate() {
            ink(&mut builder, block(from, to, 0.45 - 0.05 * inner as f64), absorption, priority);
        }
        if what.starts_with("glass") {
            let (positions, triangles) = block(-0.5, 0.5, 0.4);
            builder.mesh("glass", positions, triangles, glass);
        }
    }
    camera(&mut builder, [-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.5 * z);
    // Four pixels for each column, of which those in the middle see it, in the middle row.
    let size = 4 * count as u32;
    let scene = builder.build().unwrap();
    let film = rendered::<T>(&scene, &direct_settings(Direct::Nee, 0.1), size);
    let seen = |number: usize| {
        let pixel = (size / 2) as usize * size as usize + 4 * number + 1;
        film.pixels[pixel].layers[Layer::Emission as usize][0] * film.units.radiance_to_user()
    };
    for (number, &(what, _, depth)) in columns.iter().enumerate() {
        let (found, expected) = (seen(number), (-depth).exp());
        if what.starts_with("glass") {
            // Reflection at two faces, of which the camera sees 0.04 · 0.04 or, by chance, 0.04 as reflected twice.
            let expected = expected * 0.96 * 0.96;
            assert!((0.999..1.05).contains(&(found / expected)), "{what}: {found}, expected {expected}");
        } else {
            assert!((found / expected - 1.0).abs() < 2e-5, "{what}: {found}, expected {expected}");
        }
    }
}

/// A white floor under a sun, and the camera close above it.
fn sunlit(fill: impl Fn(&mut SceneBuilder)) -> Scene {
    let mut builder = framed();
    let grey = builder.material(MaterialDesc::lambert("floor", [0.5; 3]));
    builder.quad("floor", [[-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0], [-2.0, 0.0, -2.0]], grey);
    builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [1.0; 3] });
    camera(&mut builder, [0.0, 0.1, 0.0], [0.0, -1.0, 0.0], 0.5);
    fill(&mut builder);
    builder.build().unwrap()
}

/// Light of a sun on a floor below absorbing slabs: the transmittance, by shadow rays and by the same photons; nothing of it is a
/// caustic. A floor in the plane of the boundary loses as much as one within.
pub fn shadow_rays_and_photons_pass<T: TestBackend>() {
    let slab = |low: f64, high: f64| {
        move |builder: &mut SceneBuilder| ink(builder, shapes::cuboid([-2.0, low, -2.0], [2.0, high, 2.0]), 0.5, 0)
    };
    let boxed = |low: f64| {
        move |builder: &mut SceneBuilder| {
            builder.medium(AmbientMedium::new([0.0; 3], [0.5; 3]).with_bounds([-2.0, low, -2.0], [2.0, 1.0, 2.0]));
        }
    };
    let without = sunlit(|_| {});
    // From the floor to the camera it is 0.1, within the slab where that reaches the floor.
    let all: [(&str, Scene, f64); 5] = [
        ("above", sunlit(slab(1.0, 2.0)), 0.5),
        ("flush", sunlit(slab(0.0, 1.0)), 0.55),
        ("through the floor", sunlit(slab(-0.1, 1.0)), 0.55),
        ("a flush box", sunlit(boxed(0.0)), 0.55),
        ("a box through the floor", sunlit(boxed(-0.1)), 0.55),
    ];
    for direct in [Direct::Nee, Direct::Photons] {
        let settings = Settings { caustics: true, photons: 20_000, ..direct_settings(direct, 0.1) };
        let of = |scene: &Scene| {
            let film = rendered::<T>(scene, &settings, 4);
            [Layer::Direct, Layer::Caustic].map(|layer| mean(&film, &[layer], 0))
        };
        let [clear, _] = of(&without);
        for (what, scene, depth) in cases::<T, _>(&all) {
            let ([found, caustic], expected) = (of(scene), clear * (-depth).exp());
            assert!((found / expected - 1.0).abs() < 2e-5, "{what}, {direct:?}: {found}, expected {expected}");
            assert_eq!(caustic, 0.0, "{what}");
        }
    }
}

/// P3: a shaft of sunlight in a boundary and in a box is direct light: α f E e^(−σ(z + d))(1 − e^(−σw)), here with d = 0.
pub fn p3_shaft<T: TestBackend>() {
    let (low, high) = ([0.0, -4.0, -2.0], [1.0, 0.0, 2.0]);
    let mist = |builder: &mut SceneBuilder| {
        let mist = MaterialDesc::boundary("mist", [0.05; 3]).with_scattering([0.05; 3], 0.0);
        let mist = builder.material(mist);
        let (positions, triangles) = shapes::cuboid(low, high);
        builder.mesh("mist", positions, triangles, mist);
    };
    let boxed = |builder: &mut SceneBuilder| {
        builder.medium(AmbientMedium::new([0.05; 3], [0.05; 3]).with_bounds(low, high));
    };
    let fills: [&dyn Fn(&mut SceneBuilder); 2] = [&mist, &boxed];
    for fill in cases::<T, _>(&fills) {
        let mut builder = framed();
        fill(&mut builder);
        builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [1.0; 3] });
        camera(&mut builder, [-1.0, -2.0, 0.0], [1.0, 0.0, 0.0], 1e-3);
        let scene = builder.build().unwrap();
        let settings = Settings { photons: 10_000, caustics: true, shadow_rays: 4, ..fixed_radius(0.1) };
        let media = scene.view().media;
        let [direct, ..] = per_pass::<T>(&scene, media, &settings, (8, 4), &[Layer::Direct]);
        let expected = 0.5 * 0.25 * FRAC_1_PI * (-0.2_f64).exp() * -(-0.1_f64).exp_m1();
        assert_mean("shaft", &direct, expected, 2e-5);
        let [caustic, ..] = per_pass::<T>(&scene, media, &settings, (1, 4), &[Layer::Caustic]);
        assert_eq!(caustic, [0.0]);
    }
}

/// P12: in a closed room of even walls, media that absorb nothing change nothing, though one fills the room exactly, one reaches
/// through a wall, and one touches a ball of glass.
pub fn p12_furnace<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let walls = builder.material(MaterialDesc::emissive("walls", [0.5; 3], [FRAC_1_PI; 3]));
    let (positions, triangles) = shapes::flip(shapes::cuboid([-1.0; 3], [1.0; 3]));
    builder.mesh("room", positions, triangles, walls);
    let glass = builder.material(MaterialDesc::glass("glass", 1.5));
    let (positions, triangles) = shapes::icosphere(3, [0.4, -0.3, 0.4], 0.4);
    builder.mesh("ball", positions, triangles, glass);
    for (scattering, shape) in [
        (0.5, shapes::cuboid([-1.0; 3], [1.0; 3])),
        (2.0, shapes::cuboid([0.2, -1.0, -0.5], [1.2, -0.1, 0.5])),
        (1.0, shapes::icosphere(2, [-0.4, 0.3, 0.2], 0.5)),
    ] {
        let mist = MaterialDesc::boundary("mist", [0.0; 3]).with_scattering([scattering; 3], 0.3);
        let mist = builder.material(mist);
        builder.mesh("mist", shape.0, shape.1, mist);
    }
    camera(&mut builder, [-0.7, 0.1, -0.2], [0.9, -0.15, 0.4], 0.4);
    let scene = builder.build().unwrap();
    let settings = Settings { photons: 30_000, caustics: true, shadow_rays: 4, max_bounces: 200, ..fixed_radius(0.05) };
    let [found, ..] = per_pass::<T>(&scene, scene.view().media, &settings, (12, 16), &Layer::ALL);
    // As the furnace without boundaries.
    assert_mean("furnace", &found, 2.0 * FRAC_1_PI, 1.5e-2);
}

/// A boundary of a medium that changes no light changes no bit, though another one absorbs.
pub fn a_clear_boundary_changes_no_bit<T: TestBackend>() {
    let scene = |is_there: bool| {
        sunlit(|builder| {
            ink(builder, shapes::cuboid([-1.0, 0.5, -1.0], [0.0, 1.0, 1.0]), 0.5, 0);
            if is_there {
                ink(builder, shapes::icosphere(2, [0.5, 1.0, 0.0], 0.45), 0.0, 3);
            }
        })
    };
    let settings = Settings { indirect: Indirect::Map, photons: 2000, ..direct_settings(Direct::Nee, 0.1) };
    let [with, without] = [true, false].map(|is_there| rendered::<T>(&scene(is_there), &settings, 16));
    assert!(with.pixels == without.pixels);
    assert!(scene(true).view().boundaries.triangles.len() > 300);
}
