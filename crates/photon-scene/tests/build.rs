//! What the builder makes of valid scenes: normalisation, powers, names.

use photon_core::{Camera, Light, Material, Units};
use photon_scene::{CameraDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, Surface, ThinLens};
use std::f64::consts::PI;

/// A floor, an area light above it, a glass tetrahedron, and one light of each other kind; lengths times
/// `size`, radiances times `brightness`.
fn scene(size: f64, brightness: f64) -> Scene {
    nudged(size, brightness, 0.0)
}

/// The same, with the point light moved by `nudge`.
fn nudged(size: f64, brightness: f64, nudge: f64) -> Scene {
    let mut builder = SceneBuilder::new();
    let at = |x: f64, y: f64, z: f64| [x * size, y * size, z * size];
    let glow = |value: f64| [value * brightness, 0.5 * value * brightness, 0.25 * value * brightness];
    let white = builder.material(MaterialDesc::lambert("white", [0.7, 0.6, 0.5]));
    let area_light = builder.material(MaterialDesc::emissive("light", [0.0; 3], glow(9.0)));
    let absorption = [0.3 / size, 0.2 / size, 0.1 / size];
    let glass = builder.material(MaterialDesc::new(
        "glass",
        Surface::Dielectric { ior: 1.5, absorption, tint: [1.0; 3], roughness: 0.0 },
    ));
    let floor = [at(-1.3, 0.1, 1.1), at(1.7, 0.1, 1.1), at(1.7, 0.1, -1.9), at(-1.3, 0.1, -1.9)];
    builder.quad("floor", floor, white);
    builder.quad("light", [at(-0.3, 2.0, -0.3), at(0.3, 2.0, -0.3), at(0.3, 2.0, 0.3), at(-0.3, 2.0, 0.3)], area_light);
    let corners = vec![at(0.0, 0.5, 0.0), at(0.4, 0.5, 0.0), at(0.0, 0.9, 0.0), at(0.0, 0.5, 0.4)];
    builder.mesh("gem", corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], glass);
    let intensity = glow(2.0).map(|value| value * size * size);
    builder.light("bulb", LightDesc::Point { position: at(0.1 + nudge, 1.5, 0.2), intensity });
    let direction = at(0.2, -1.0, 0.1);
    let (inner_angle, outer_angle) = (0.2, 0.5);
    builder
        .light("spot", LightDesc::Spot { position: at(0.5, 1.0, 0.0), direction, intensity, inner_angle, outer_angle });
    builder.light("sun", LightDesc::Directional { direction, irradiance: glow(3.0) });
    builder.camera("front", CameraDesc::look_at(at(0.0, 1.0, 4.0), at(0.0, 1.0, 0.0), at(0.0, 1.0, 0.0), 0.8));
    builder.build().expect("a sound scene")
}

fn tables(scene: &Scene) -> (Vec<u8>, Vec<f32>) {
    let view = scene.view();
    let mut bytes = Vec::new();
    let mut numbers = Vec::new();
    let camera = scene.camera(None, 30, 20).expect("a camera");
    let floats = |numbers: &mut Vec<f32>, rows: &[[f32; 3]]| numbers.extend(rows.iter().flatten());
    floats(&mut numbers, view.positions);
    for primitive in view.primitives {
        floats(&mut numbers, &[primitive.normal]);
    }
    for material in view.materials {
        floats(&mut numbers, &[material.albedo, material.emission]);
    }
    for medium in view.media {
        floats(&mut numbers, &[medium.absorption]);
    }
    for light in view.lights {
        floats(&mut numbers, &[light.position, light.direction, light.power, [light.area, light.radius, 0.0]]);
    }
    floats(&mut numbers, &[camera.origin, camera.forward, camera.right, camera.up]);
    numbers.push(view.radius);
    bytes.extend(numbers.iter().flat_map(|number| number.to_bits().to_le_bytes()));
    bytes.extend(view.light_cdf.iter().flat_map(|start| start.to_le_bytes()));
    bytes.extend(view.triangles.iter().flatten().flat_map(|index| index.to_le_bytes()));
    (bytes, numbers)
}

/// Largest difference, relative to the larger number or to 1.
fn difference(left: &[f32], right: &[f32]) -> f32 {
    assert_eq!(left.len(), right.len());
    left.iter().zip(right).map(|(a, b)| (a - b).abs() / a.abs().max(b.abs()).max(1.0)).fold(0.0, f32::max)
}

#[test]
fn powers_of_two_change_no_bit() {
    let reference = tables(&scene(1.0, 1.0)).0;
    for (size, brightness) in
        [(2.0, 1.0), (2_f64.powi(-90), 1.0), (2_f64.powi(120), 1.0), (1.0, 2_f64.powi(66)), (2_f64.powi(40), 0.5)]
    {
        assert!(tables(&scene(size, brightness)).0 == reference, "size {size:e}, brightness {brightness:e}");
    }
    assert!(tables(&nudged(1.0, 1.0, 1e-7)).0 != reference, "the comparison detects a change of the last bit");
}

#[test]
fn extreme_sizes_and_brightnesses_give_the_same_tables() {
    let reference = scene(1.0, 1.0);
    for (size, brightness) in [(1e30, 1.0), (1e-30, 1.0), (1.0, 1e20), (1.0, 1e-20), (1e-30, 1e20)] {
        let other = scene(size, brightness);
        let worst = difference(&tables(&reference).1, &tables(&other).1);
        assert!(worst <= 1e-6, "size {size:e}, brightness {brightness:e}: {worst:e}");
        let ratio = other.units().power / reference.units().power / size / size / brightness;
        assert!((ratio - 1.0).abs() < 1e-12, "power: {ratio}");
    }
    assert!(difference(&[1.0, 0.5], &[1.0, 0.500_01]) > 1e-6, "the comparison can fail");
}

#[test]
fn powers_are_those_of_the_closed_forms() {
    let scene = scene(1.0, 1.0);
    let view = scene.view();
    let (cos_in, cos_out) = (0.2_f64.cos(), 0.5_f64.cos());
    // π L A, 4π I, 2π I ((1 − cos inner) + (cos inner − cos outer)/3), E π R².
    let radius = f64::from(view.lights[4].radius) * scene.units().scale;
    let spot = 2.0 * PI * 2.0 * ((1.0 - cos_in) + (cos_in - cos_out) / 3.0);
    let expected = [PI * 9.0 * 0.18, PI * 9.0 * 0.18, 4.0 * PI * 2.0, spot, 3.0 * PI * radius * radius];
    assert_eq!(view.lights.len(), expected.len());
    let mut sum = 0.0;
    for (light, red) in view.lights.iter().zip(expected) {
        for (channel, factor) in [1.0, 0.5, 0.25].into_iter().enumerate() {
            let watts = f64::from(light.power[channel]) * scene.units().power;
            assert!((watts / (red * factor) - 1.0).abs() < 3e-7, "{light:?}: {watts} instead of {}", red * factor);
            sum += f64::from(light.power[channel]) / 3.0;
        }
    }
    assert!((sum - 1.0).abs() < 1e-6);
    let kinds: Vec<u32> = view.lights.iter().map(|light| light.kind).collect();
    assert_eq!(kinds, [Light::TRIANGLE, Light::TRIANGLE, Light::POINT, Light::SPOT, Light::DIRECTIONAL]);
    assert!((0..2).all(|light| scene.mesh_of_triangle(view.lights[light].primitive) == "light"));
    assert_eq!(view.lights[0].primitive + 1, view.lights[1].primitive);
    // Radiance converts back to the user's units.
    let radiance = f64::from(view.materials[1].emission[0]) * scene.units().radiance_to_user();
    assert!((radiance / 9.0 - 1.0).abs() < 1e-6, "{radiance}");
    // Emission times area times π is the emitted power, in normalised units too.
    let flux = view.materials[1].emission[0] * view.lights[0].area * std::f32::consts::PI;
    assert!((flux / view.lights[0].power[0] - 1.0).abs() < 1e-6);
}

#[test]
fn the_box_is_of_unit_size_about_the_origin() {
    let scene = scene(7.0, 1.0);
    let view = scene.view();
    let largest = view.positions.iter().flatten().fold(0.0_f32, |found, part| found.max(part.abs()));
    assert_eq!(largest, 0.5);
    for &at in view.positions {
        assert!(glam::Vec3::from(at).length() <= view.radius);
        let there = scene.units().point_to_user(at);
        let back = scene.units().point(there);
        assert!(glam::Vec3::from(at).distance(glam::Vec3::from(back)) < 1e-7);
    }
    for primitive in view.primitives {
        assert!((glam::Vec3::from(primitive.normal).length() - 1.0).abs() < 1e-6);
    }
    let floor = (0..8).find(|&triangle| scene.mesh_of_triangle(triangle) == "floor").expect("a floor") as usize;
    assert_eq!(view.primitives[floor].normal, [0.0, 1.0, 0.0], "counter-clockwise is the front");
    assert_eq!(view.materials[2].ior, 1.5);
    assert!((view.media[1].absorption[0] - 0.9).abs() < 1e-6, "0.3 per length, over 3 lengths");
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
}

#[test]
fn both_sides_emit_twice() {
    let build = |emits_both_sides| {
        let mut builder = SceneBuilder::new();
        let area_light = MaterialDesc::emissive("area light", [0.0; 3], [1.0; 3]).with_both_sides(emits_both_sides);
        let area_light = builder.material(area_light);
        builder.quad("area light", [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], area_light);
        builder.build().expect("an area light")
    };
    let (one, two) = (build(false), build(true));
    assert_eq!(two.units().power, 2.0 * one.units().power);
    assert!((one.units().power - PI).abs() < 1e-12);
    assert_eq!(two.view().lights[0].flags, Light::BOTH_SIDES);
    assert_eq!(two.view().materials[0].flags, Material::EMITS_BOTH_SIDES);
    assert_eq!(one.view().materials[0].flags | one.view().lights[0].flags, 0);
}

#[test]
fn triangles_without_area_are_dropped_and_slivers_stay() {
    let mut builder = SceneBuilder::new();
    let white = builder.material(MaterialDesc::lambert("white", [0.5; 3]));
    let sliver = vec![[0.0, 0.0, 0.0], [1.0, 0.3, 0.2], [0.5, 0.15 + 1e-6, 0.1]];
    builder.mesh("empty", Vec::new(), Vec::new(), white);
    builder.mesh("sliver", sliver, vec![[0, 1, 2]], white);
    // Collinear, with a repeated vertex, and too small for f32.
    let third = 1.0 / 3.0;
    let flat = vec![
        [0.0, 0.0, 0.0],
        [0.1, 0.2, 0.3],
        [third * 0.1, third * 0.2, third * 0.3],
        [0.5, 0.5, 0.5],
        [0.5 + 1e-12, 0.5, 0.5],
        [0.5, 0.5 + 1e-12, 0.5],
    ];
    builder.mesh("flat", flat, vec![[0, 1, 2], [0, 1, 1], [3, 4, 5]], white);
    builder.quad("floor", [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 0.0]], white);
    let scene = builder.build().expect("a scene");
    assert_eq!(scene.dropped_triangles(), 3);
    assert!(scene.warnings().iter().any(|line| line.contains("3 triangles")), "{:?}", scene.warnings());
    let mut names: Vec<&str> = (0..4).map(|primitive| scene.mesh_of_triangle(primitive)).collect();
    names.sort_unstable();
    assert_eq!(names, ["", "floor", "floor", "sliver"]);
    let mut sources: Vec<_> = scene.triangle_sources().collect();
    sources.sort_unstable();
    assert_eq!(sources, [(1, 0), (3, 0), (3, 1)]);
    for primitive in scene.view().primitives {
        assert!((glam::Vec3::from(primitive.normal).length() - 1.0).abs() < 1e-6, "{primitive:?}");
    }
    assert_eq!(scene.view().positions.len(), 7, "vertices that no triangle uses are removed");
}

#[test]
fn stray_vertices_do_not_shrink_the_scene() {
    let mut builder = SceneBuilder::new();
    let white = builder.material(MaterialDesc::lambert("white", [0.5; 3]));
    builder.mesh("one", vec![[1e9; 3], [0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]], vec![[1, 2, 3]], white);
    let scene = builder.build().expect("a scene");
    assert_eq!(scene.units(), Units { center: [1.0, 1.0, 0.0], scale: 2.0, power: 1.0 });
}

#[test]
fn nothing_at_all_is_a_scene_with_a_warning() {
    let scene = SceneBuilder::new().build().expect("an empty scene");
    assert_eq!(scene.view().triangles.len() + scene.view().lights.len(), 0);
    assert_eq!(scene.units(), Units::default());
    assert!(scene.warnings()[0].contains("no triangles"));
    let mut builder = SceneBuilder::new();
    builder.light("bulb", LightDesc::Point { position: [5.0, 6.0, 7.0], intensity: [1.0; 3] });
    let scene = builder.build().expect("a bulb alone");
    assert_eq!(scene.units().center, [5.0, 6.0, 7.0]);
    assert_eq!(scene.view().lights[0].position, [0.0; 3]);
}

#[test]
fn dark_lights_are_left_out() {
    let mut builder = SceneBuilder::new();
    builder.light("off", LightDesc::Point { position: [0.0; 3], intensity: [0.0; 3] });
    builder.light("faint", LightDesc::Point { position: [1.0; 3], intensity: [1e-60; 3] });
    builder.light("on", LightDesc::Point { position: [2.0; 3], intensity: [1.0; 3] });
    let scene = builder.build().expect("a scene");
    assert_eq!(scene.view().lights.len(), 1);
    assert_eq!(scene.view().light_cdf, [0]);
    assert!((scene.units().power - 4.0 * PI).abs() < 1e-12);
}

#[test]
fn cameras_follow_the_picture() {
    let mut builder = SceneBuilder::new();
    let white = builder.material(MaterialDesc::lambert("white", [0.5; 3]));
    builder.quad("wall", [[-2.0, -1.0, 0.0], [2.0, -1.0, 0.0], [2.0, 1.0, 0.0], [-2.0, 1.0, 0.0]], white);
    builder.camera("eye", CameraDesc::look_at([0.0, 0.0, 8.0], [0.0; 3], [0.1, 3.0, -1.0], PI / 2.0));
    let mut flat = CameraDesc::look_at([0.0, 0.0, 1e3], [0.0; 3], [0.0, 1.0, 0.0], 1.0);
    flat.projection = Projection::Orthographic { half_height: 2.0 };
    builder.camera("flat", flat);
    let frame = builder.frame_camera();
    builder.camera("frame", frame);
    let scene = builder.build().expect("a wall");
    let eye = scene.camera(None, 200, 100).expect("the first");
    assert_eq!((eye.origin, eye.kind), ([0.0, 0.0, 2.0], Camera::PERSPECTIVE));
    let near = |left: [f32; 3], right: [f32; 3]| glam::Vec3::from(left).distance(glam::Vec3::from(right)) < 1e-6;
    assert!(near(eye.forward, [0.0, 0.0, -1.0]));
    assert!((glam::Vec3::from(eye.right).length() - 2.0).abs() < 1e-6, "{eye:?}");
    assert!((glam::Vec3::from(eye.up).length() - 1.0).abs() < 1e-6);
    // In units of the scene, of which 4 are one in normalised space.
    assert_eq!((eye.lens_radius, eye.focus_distance), (0.0, 0.0));
    let lens = ThinLens::new(1.0, 8.0);
    let with = scene.camera_with_lens(Some("eye"), lens, 200, 100).expect("a lens");
    assert_eq!(with, Camera { lens_radius: 0.125, focus_distance: 2.0, ..eye });
    let without = scene.camera_with_lens(Some("eye"), ThinLens::new(0.0, 8.0), 200, 100).expect("none");
    assert_eq!(without, eye);
    let flat = scene.camera(Some("flat"), 50, 100).expect("by name");
    assert_eq!((flat.kind, flat.up), (Camera::ORTHOGRAPHIC, [0.0, 0.5, 0.0]));
    assert!(near(flat.right, [0.25, 0.0, 0.0]));
    assert_eq!(scene.camera_names().collect::<Vec<_>>(), ["eye", "flat", "frame"]);
    let frame = scene.camera(Some("frame"), 100, 100).expect("the framing one");
    assert!(frame.origin[2] * frame.up[1] > 0.5, "the wall's edge is within the picture: {frame:?}");
}

#[test]
fn solids_are_checked_for_holes_and_sides() {
    let warn = |triangles: Vec<[u32; 3]>, twin: Option<Vec<[u32; 3]>>| {
        let mut builder = SceneBuilder::new();
        let glass = builder.material(MaterialDesc::glass("glass", 1.5));
        let corners = |size: f64| vec![[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0], [0.0, 0.0, size]];
        builder.mesh("gem", corners(1.0), triangles, glass);
        if let Some(twin) = twin {
            let inner = corners(0.4).into_iter().map(|at| at.map(|part| part + 0.1)).collect();
            builder.mesh("bubble", inner, twin, glass);
        }
        builder.build().expect("a gem").warnings().join("\n")
    };
    let closed = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let inward: Vec<[u32; 3]> = closed.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert_eq!(warn(closed.clone(), None), "");
    assert_eq!(warn(closed.clone(), Some(inward.clone())), "", "a bubble faces inwards");
    assert!(warn(inward, None).contains("inside out"));
    assert!(warn(closed[1..].to_vec(), None).contains("3 edges"));
}
