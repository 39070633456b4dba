//! Environment maps: seen, sampled by shadow rays, and as photons.

use std::f64::consts::PI;

use photon_core::{Direct, EnvironmentMap, Estimator, Layer, Pipeline, Render, Settings, View};
use photon_scene::{CameraDesc, EnvironmentDesc, LightDesc, MaterialDesc, Projection, SceneBuilder, Sun, shapes};

use crate::harness::{TestBackend, direct_settings, film, look_at_point, means_per_pass, per_pass, trace, watts};
use crate::stats::{assert_agrees, moments, standard_error};

fn settings(direct: Direct) -> Settings {
    direct_settings(direct, 0.2)
}

/// `L = 1 + a ω_y` in rows fine enough that linear interpolation differs by less than 1e-4.
fn gradient(a: f64) -> EnvironmentMap {
    let (width, height) = (8, 256);
    let radiance = |row: usize| 1.0 + a * (PI * (row as f64 + 0.5) / height as f64).cos();
    let texels: Vec<[f32; 3]> = (0..width * height).map(|i| [radiance(i / width) as f32, 1.0, 0.5]).collect();
    EnvironmentMap::new(width, &texels, 0.0).unwrap()
}

/// A square plate of half side 1 through the origin with this normal, and a camera close above it.
fn plate(normal: [f64; 3], albedo: f64) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let material = builder.material(MaterialDesc::lambert("plate", [albedo; 3]));
    let n = photon_core::glam::DVec3::from(normal);
    let across = n.any_orthonormal_vector();
    let up = n.cross(across);
    let corner = |a: f64, b: f64| (across * a + up * b).to_array();
    builder.quad("plate", [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], material);
    look_at_point(&mut builder, [0.0; 3], normal, 0.5, 0.1);
    builder
}

/// G10: under `L = 1 + a ω_y` a plate of normal n has irradiance `π (1 + ⅔ a n_y)`, by shadow rays and by photons.
pub fn g10_plate_under_a_gradient<T: TestBackend>() {
    let (a, albedo) = (0.8, 0.6);
    for normal in [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.48, 0.6, -0.64]] {
        let truth = albedo * (1.0 + 2.0 / 3.0 * a * normal[1]);
        for direct in [Direct::Nee, Direct::Photons] {
            let mut builder = plate(normal, albedo);
            builder.environment(gradient(a));
            let scene = builder.build().unwrap();
            let mut values = Vec::new();
            let s = settings(direct);
            for (seed, passes) in [(0, 16), (1, 16)] {
                values.extend(per_pass_red::<T>(&scene, &Settings { seed, ..s.clone() }, passes));
            }
            let what = format!("{direct:?} {normal:?}");
            assert_agrees(&what, moments(&values).0, truth, standard_error(&values), 2e-4 * truth);
        }
    }
}

/// Mean of the red channel over the pixels of each pass.
fn per_pass_red<T: TestBackend>(scene: &photon_scene::Scene, settings: &Settings, passes: u32) -> Vec<f64> {
    let red =
        |beauty: &[[f32; 3]]| vec![beauty.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / beauty.len() as f64];
    means_per_pass::<T>(scene, settings, (passes, 4), red).swap_remove(0)
}

/// G10: an even environment of radiance L sends `4π²R²L` through the sphere of radius R around the scene, and all of the
/// flux that photons take away is absorbed or escapes.
pub fn g10_power<T: TestBackend>() {
    let mut builder = plate([0.0, 1.0, 0.0], 0.5);
    builder.environment(EnvironmentMap::constant([0.5, 1.0, 1.5]).unwrap());
    let scene = builder.build().unwrap();
    let radius = f64::from(scene.view().radius) * scene.units().scale;
    let (_, tally) = trace::<T>(2, &scene, &settings(Direct::Photons), &[20_000]);
    let sent = watts(&scene, &tally, &tally.flux_emitted);
    assert!((sent / (4.0 * PI * PI * radius * radius) - 1.0).abs() < 1e-4, "{sent}");
}

/// A plate under the clear sky of the built-in scene `sky`, flat on the ground and tilted towards the sun: its irradiance
/// is that of the map by quadrature, and that of the sun, `E cos θ`; by shadow rays and by photons.
pub fn sky_and_sun<T: TestBackend>() {
    let desc = EnvironmentDesc::sky(32.0, 3.0).rotated(52.0).scaled(0.03);
    let baked = desc.bake().unwrap();
    let Sun { direction, irradiance, .. } = baked.sun.unwrap();
    for normal in [[0.0, 1.0, 0.0], [-0.48, 0.8, -0.36]] {
        let cosine = -(0..3).map(|axis| direction[axis] * normal[axis]).sum::<f64>();
        let sun = irradiance[0] * cosine;
        let sky = quadrature(&baked.map, normal);
        // Both matter.
        assert!(sky > 0.1 * sun && sun > sky, "{sky} {sun}");
        for direct in [Direct::Nee, Direct::Photons] {
            let mut builder = plate(normal, 0.5);
            builder.environment_from(&desc).unwrap();
            let values = per_pass_red::<T>(&builder.build().unwrap(), &settings(direct), 12);
            let truth = 0.5 / PI * (sky + sun);
            let what = format!("{direct:?} {normal:?}");
            assert_agrees(&what, moments(&values).0, truth, standard_error(&values), 1e-3 * truth);
        }
    }
}

/// Irradiance of a plane from the red channel of a map, by the midpoint rule with a point in the middle of each texel, in
/// f64 but for the lookups.
pub(crate) fn quadrature(map: &EnvironmentMap, normal: [f64; 3]) -> f64 {
    let (width, height) = (map.width(), map.height());
    let mut sum = 0.0;
    for row in 0..height {
        let v = (f64::from(row) + 0.5) / f64::from(height);
        let (sin, cos) = (PI * v).sin_cos();
        let mut line = 0.0;
        for column in 0..width {
            let u = (f64::from(column) + 0.5) / f64::from(width);
            let phi = 2.0 * PI * (u - f64::from(map.rotation()) - 0.5);
            let direction = [phi.sin() * sin, cos, -phi.cos() * sin];
            let cosine: f64 = (0..3).map(|axis| direction[axis] * normal[axis]).sum();
            if cosine > 0.0 {
                line += cosine * f64::from(map.bilinear(u as f32, v as f32).x);
            }
        }
        sum += line * sin;
    }
    sum * (PI / f64::from(height)) * (2.0 * PI / f64::from(width))
}

/// What leaves the scene sees the environment: straight, in a mirror and through glass; the centre of the map is −z, a
/// quarter to its right is +x; a rotation turns it counter-clockwise as seen from +y.
pub fn seen_by_the_camera<T: TestBackend>() {
    let (width, height) = (256, 128);
    // Red towards −z, green towards +x, blue upwards.
    let color = |i: usize| {
        let (phi, theta) =
            (2.0 * PI * ((i % width) as f64 + 0.5) / width as f64, PI * ((i / width) as f64 + 0.5) / height as f64);
        let (x, z) = (-phi.sin() * theta.sin(), phi.cos() * theta.sin());
        [1.0 - z, 1.0 + x, 1.0 + theta.cos()].map(|c| c as f32)
    };
    let texels: Vec<[f32; 3]> = (0..width * height).map(color).collect();
    let look = |direction: [f64; 3], turns: f64, mirror: bool| {
        let mut builder = SceneBuilder::new();
        let grey = builder.material(MaterialDesc::lambert("beside", [0.5; 3]));
        builder.quad("beside", [[3.0, 0.0, 3.0], [4.0, 0.0, 3.0], [4.0, 0.0, 2.0], [3.0, 0.0, 2.0]], grey);
        if mirror {
            let mirror = builder.material(MaterialDesc::mirror("mirror", [1.0; 3]));
            builder.quad(
                "mirror",
                [[-1.0, -1.0, -1.0], [1.0, -1.0, -1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, -1.0]],
                mirror,
            );
        } else {
            let glass = builder.material(MaterialDesc::glass("glass", 1.5));
            let (positions, triangles) = shapes::cuboid([-0.2; 3], [0.25; 3]);
            builder.mesh("glass", positions, triangles, glass);
        }
        builder.environment(EnvironmentMap::new(width, &texels, turns).unwrap());
        let up = if direction[1].abs() > 0.5 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
        let position = direction.map(|c| if mirror { 0.0 } else { 0.5 - c });
        let projection = Projection::Orthographic { half_height: 0.01 };
        builder.camera("eye", CameraDesc::new(position, direction, up, projection));
        let s = Settings { caustics: false, ..settings(Direct::None) };
        film::<T>(&builder.build().unwrap(), &s, 1, 1).beauty()[0].map(f64::from)
    };
    let expected = |direction: [f64; 3]| [1.0 - direction[2], 1.0 + direction[0], 1.0 + direction[1]];
    let close = |found: [f64; 3], truth: [f64; 3], what: &str| {
        for c in 0..3 {
            assert!((found[c] - truth[c]).abs() < 5e-3, "{what}: {found:?} instead of {truth:?}");
        }
    };
    for direction in
        [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, 0.8]]
    {
        close(look(direction, 0.0, false), expected(direction), "straight or through glass");
    }
    // What was towards −z is now towards −x.
    close(look([-1.0, 0.0, 0.0], 0.25, false), expected([0.0, 0.0, -1.0]), "rotated");
    // The mirror faces +z.
    close(look([0.0, 0.0, -1.0], 0.0, true), expected([0.0, 0.0, 1.0]), "in a mirror");
    close(look([0.6, 0.0, -0.8], 0.0, true), expected([0.6, 0.0, 0.8]), "in a mirror, obliquely");
}

/// One bright texel is a small source: irradiance `L Ω cos θ`, by shadow rays and by photons, beside a directional light
/// and a dim even part, which the choice of lights must weigh.
pub fn g10_one_texel_among_lights<T: TestBackend>() {
    let (width, height) = (128, 64);
    let (column, row) = (80, 12);
    let (even, bright) = (0.1, 500.0);
    let mut texels = vec![[even as f32; 3]; width * height];
    texels[row * width + column] = [bright as f32; 3];
    // A texel is a pyramid over the cells around it, whose integral is that of a step of its size, to second order.
    let theta = PI * (row as f64 + 0.5) / height as f64;
    let solid = (2.0 * PI / width as f64) * (PI / height as f64) * theta.sin();
    let truth = 0.5 / PI * (PI * even + (bright - even) * solid * theta.cos() + 2.0);
    for direct in [Direct::Nee, Direct::Photons] {
        let mut builder = plate([0.0, 1.0, 0.0], 0.5);
        builder.environment(EnvironmentMap::new(width, &texels, 0.3).unwrap());
        builder.light("sun", LightDesc::Directional { direction: [0.0, -1.0, 0.0], irradiance: [2.0; 3] });
        let values = per_pass::<T>(&builder.build().unwrap(), &Settings { shadow_rays: 4, ..settings(direct) }, 32, 4);
        assert_agrees(&format!("{direct:?}"), moments(&values).0, truth, standard_error(&values), 2e-3 * truth);
    }
}

/// Under an even environment a small plate is lit as if a ball of glass above it were not there: by shadow rays past the
/// ball, and by photons through it. What the plate sends back to itself is less than 1e-3 of that.
pub fn even_light_through_glass<T: TestBackend>() {
    let (albedo, half) = (0.5, 0.05);
    let mut builder = SceneBuilder::new();
    let material = builder.material(MaterialDesc::lambert("plate", [albedo; 3]));
    builder.quad("plate", [[-half, 0.0, half], [half, 0.0, half], [half, 0.0, -half], [-half, 0.0, -half]], material);
    let glass = builder.material(MaterialDesc::glass("ball", 1.5));
    let (positions, triangles) = shapes::icosphere(4, [0.0, 0.45, 0.0], 0.4);
    builder.mesh("ball", positions, triangles, glass);
    look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.02, 0.005);
    builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
    let estimator = Estimator::Radius { radius: Some(0.03) };
    let s = Settings { max_bounces: 256, photons: 60_000, shadow_rays: 16, estimator, ..settings(Direct::Nee) };
    let scene = builder.build().unwrap();
    let values = per_pass::<T>(&scene, &s, 16, 4);
    assert_agrees("with the ball", moments(&values).0, albedo, standard_error(&values), 1e-3 * albedo);
    // The ball keeps most of the sky from shadow rays.
    let shadows = per_pass::<T>(&scene, &Settings { caustics: false, ..s }, 4, 4);
    assert!(moments(&shadows).0 < 0.5 * albedo, "{shadows:?}");
}

/// With a transparent background, camera rays that miss see nothing in place of the environment: that, and nothing else, is
/// missing from the picture; through glass the environment is seen.
pub fn transparent_background<T: TestBackend>() {
    let mut builder = plate([0.0, 0.0, 1.0], 0.5);
    let glass = builder.material(MaterialDesc::thin("pane", 1.5));
    builder.quad("pane", [[-2.0, -2.0, 0.2], [0.0, -2.0, 0.2], [0.0, 2.0, 0.2], [-2.0, 2.0, 0.2]], glass);
    builder.camera(
        "whole",
        CameraDesc::new(
            [0.0, 0.0, 3.0],
            [0.0, 0.0, -1.0],
            [0.0, 1.0, 0.0],
            Projection::Orthographic { half_height: 3.1 },
        ),
    );
    builder.environment(gradient(0.0));
    let scene = builder.build().unwrap();
    let view = View { camera: scene.camera(Some("whole"), 16, 16).unwrap(), width: 16, height: 16 };
    let picture = |transparent_background: bool| {
        let settings = Settings { transparent_background, ..settings(Direct::Nee) };
        let mut renderer = Pipeline::new(T::make(2), &scene.view(), view, settings).unwrap();
        for pass in 0..4 {
            renderer.pass(pass, &mut ()).unwrap();
        }
        renderer.film().unwrap()
    };
    let (opaque, transparent) = (picture(false), picture(true));
    let alpha = transparent.alpha();
    assert_eq!(alpha, opaque.alpha());
    assert!([0.0, 1.0].iter().all(|end| alpha.contains(end)) && alpha.iter().any(|a| *a > 0.0 && *a < 1.0));
    for layer in Layer::ALL {
        for (pixel, (whole, found)) in opaque.layer(layer).iter().zip(transparent.layer(layer)).enumerate() {
            let missing = if layer == Layer::Emission { 1.0 - alpha[pixel] } else { 0.0 };
            assert!((whole[0] - found[0] - missing).abs() < 1e-5, "{layer:?} {pixel}: {whole:?} {found:?} {missing}");
        }
    }
    // Seen through the pane, beside the plate: as bright as the environment.
    let through = transparent.layer(Layer::Emission)[16 * 3 + 4];
    assert!((through[0] - 1.0).abs() < 1e-5, "{through:?}");
}
