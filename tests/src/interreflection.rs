//! C: interreflection.

use photon_core::{Direct, Estimator, Indirect, Settings};
use photon_scene::{LightDesc, MaterialDesc, SceneBuilder, shapes};
use std::f64::consts::{FRAC_1_PI, PI};

use crate::harness::{TestBackend, look_at_point, per_pass, trace, watts};
use crate::stats::{assert_agrees, moments, standard_error};

/// A closed room of one material, seen from inside: one square metre of a wall, less in a sphere. The light is
/// uniform, so a wider view averages over more photons; edges stay at least one radius away.
fn room(shape: shapes::Shape, albedo: f64, radiance: f64, look: [f64; 3], normal: [f64; 3]) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::emissive("wall", [albedo; 3], [radiance; 3]));
    let shape = if shapes::volume(&shape) > 0.0 { shapes::flip(shape) } else { shape };
    // In a sphere, the start points of a view that wide would lie outside.
    let half = if shape.1.len() > 1000 { 0.3 } else { 0.5 };
    builder.mesh("room", shape.0, shape.1, wall);
    look_at_point(&mut builder, look, normal, 0.2, half);
    builder
}

fn cube(albedo: f64, radiance: f64) -> SceneBuilder {
    room(shapes::cuboid([-1.0; 3], [1.0; 3]), albedo, radiance, [0.2, -1.0, 0.1], [0.0, 1.0, 0.0])
}

fn settings() -> Settings {
    Settings {
        photons: 40_000,
        max_bounces: 4096,
        alpha: 1.0,
        estimator: Estimator::Radius { radius: Some(0.2) },
        ..Settings::default()
    }
}

/// C1: radiosity `e/(1−ρ)` in any closed shape, with every way of lighting. Passes are independent; the error is
/// that of their mean.
pub fn c1_furnace<T: TestBackend>() {
    let tall =
        room(shapes::cuboid([-1.0, -3.0, -0.5], [1.0, 3.0, 0.5]), 0.8, FRAC_1_PI, [0.1, 0.5, 0.5], [0.0, 0.0, -1.0]);
    // An L shape: convex rooms could hide an error that a reentrant corner reveals.
    let plan = [[-1.0, -1.0], [-1.0, 2.0], [0.5, 2.0], [0.5, 0.5], [2.0, 0.5], [2.0, -1.0]];
    let bent = room(shapes::prism(&plan, 3, -0.75, 0.75), 0.8, FRAC_1_PI, [-0.3, -0.75, -0.3], [0.0, 1.0, 0.0]);
    let ball = room(shapes::icosphere(4, [0.0; 3], 1.0), 0.8, FRAC_1_PI, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let mut scenes = vec![("tall", 5.0, tall), ("bent", 5.0, bent), ("ball", 5.0, ball)];
    for (albedo, radiosity) in [(0.5, 2.0), (0.8, 5.0), (0.95, 20.0)] {
        scenes.push(("cube", radiosity, cube(albedo, FRAC_1_PI)));
    }
    for (name, radiosity, builder) in scenes {
        let scene = builder.build().unwrap();
        let settings = || Settings { photons: 10_000, ..settings() };
        for (way, s) in [
            ("shadow rays", settings()),
            ("photons", Settings { direct: Direct::Photons, ..settings() }),
            ("gather", Settings { indirect: Indirect::Gather, gather_rays: 4, ..settings() }),
            ("knn", Settings { estimator: Estimator::Knn { k: 60, max_radius: None }, ..settings() }),
        ] {
            // Gathered light comes from everywhere. Only the sphere has no edges, beyond which an estimate loses
            // area (A8); its tessellation changes the rest by less than a thousandth.
            let here = match name {
                "ball" => true,
                "cube" => way != "gather",
                _ => way == "shadow rays",
            };
            if !here {
                continue;
            }
            let bound = if name == "ball" { 2e-3 * radiosity } else { 0.0 };
            let values: Vec<f64> = per_pass::<T>(&scene, &s, 10, 6).iter().map(|l| l * PI).collect();
            let what = format!("{name}, {way}, {radiosity}");
            assert_agrees(&what, moments(&values).0, radiosity, standard_error(&values), bound);
        }
    }
}

/// C1 with an albedo of 0.99: radiosity 100, paths of a hundred bounces.
pub fn c1_furnace_of_high_albedo<T: TestBackend>() {
    let scene = cube(0.99, FRAC_1_PI).build().unwrap();
    let s = Settings { photons: 5000, ..settings() };
    let values: Vec<f64> = per_pass::<T>(&scene, &s, 24, 4).iter().map(|l| l * PI).collect();
    assert_agrees("0.99", moments(&values).0, 100.0, standard_error(&values), 0.0);
}

/// C1 with a bounce limit: photons land on the first D surfaces, hence `e (1 − ρ^(D+1))/(1 − ρ)`.
pub fn c1_depth_cap<T: TestBackend>() {
    let scene = cube(0.8, FRAC_1_PI).build().unwrap();
    let s = Settings { photons: 10_000, max_bounces: 9, direct: Direct::Photons, ..settings() };
    let values: Vec<f64> = per_pass::<T>(&scene, &s, 16, 6).iter().map(|l| l * PI).collect();
    assert_agrees("cap", moments(&values).0, 4.463_129, standard_error(&values), 0.0);
}

/// C2: an integrating sphere: indirect irradiance `Φρ/(A(1−ρ))` wherever the light is, with A the area of the mesh.
/// The triangles of an inscribed sphere change its kernel by less than 1e-3.
pub fn c2_integrating_sphere<T: TestBackend>() {
    let shape = shapes::flip(shapes::icosphere(5, [0.0; 3], 1.0));
    let area = shapes::area(&shape);
    for (albedo, light) in [(0.5, [0.0; 3]), (0.8, [0.5, 0.3, -0.4]), (0.95, [0.0, 0.7, 0.0])] {
        let mut builder = SceneBuilder::new();
        let wall = builder.material(MaterialDesc::lambert("wall", [albedo; 3]));
        builder.mesh("sphere", shape.0.clone(), shape.1.clone(), wall);
        builder.light("light", LightDesc::Point { position: light, intensity: [100.0 / (4.0 * PI); 3] });
        look_at_point(&mut builder, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.3, 0.1);
        let scene = builder.build().unwrap();
        let s = Settings { direct: Direct::None, ..settings() };
        let factor = PI / albedo;
        let values: Vec<f64> = per_pass::<T>(&scene, &s, 10, 6).iter().map(|l| l * factor).collect();
        let truth = 100.0 * albedo / (area * (1.0 - albedo));
        assert_agrees("sphere", moments(&values).0, truth, standard_error(&values), 2e-3 * truth);
    }
}

/// C3: a sphere of two different halves, `H = ⟨e⟩/(1 − ⟨ρ⟩)` everywhere.
pub fn c3_sphere_of_two_halves<T: TestBackend>() {
    let (positions, triangles) = shapes::flip(shapes::icosphere(5, [0.0; 3], 1.0));
    for (look, normal, radiosity) in
        [([0.0, -1.0, 0.0], [0.0, 1.0, 0.0], 1.2), ([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], 0.8)]
    {
        let mut builder = SceneBuilder::new();
        let lit = builder.material(MaterialDesc::emissive("lit", [0.2; 3], [FRAC_1_PI; 3]));
        let dark = builder.material(MaterialDesc::lambert("dark", [0.8; 3]));
        let height = |t: &[u32; 3]| t.iter().map(|&v| positions[v as usize][1]).sum::<f64>();
        let (low, high): (Vec<_>, Vec<_>) = triangles.iter().partition(|t| height(t) < 0.0);
        builder.mesh("low", positions.clone(), low, lit);
        builder.mesh("high", positions.clone(), high, dark);
        look_at_point(&mut builder, look, normal, 0.3, 0.1);
        let scene = builder.build().unwrap();
        let values: Vec<f64> = per_pass::<T>(&scene, &settings(), 16, 6).iter().map(|l| l * PI).collect();
        // The boundary follows triangle edges, not the equator; the halves differ in area by less than 1 %.
        assert_agrees("halves", moments(&values).0, radiosity, standard_error(&values), 8e-3);
    }
}

/// C6: parallel plates between mirrors.
pub fn c6_plates_between_mirrors<T: TestBackend>() {
    for (look, normal, radiosity) in
        [([0.1, -0.5, 0.1], [0.0, 1.0, 0.0], 5.0 / 3.0), ([0.1, 0.5, 0.1], [0.0, -1.0, 0.0], 4.0 / 3.0)]
    {
        let mut builder = SceneBuilder::new();
        let lit = builder.material(MaterialDesc::emissive("lit", [0.5; 3], [FRAC_1_PI; 3]));
        let dark = builder.material(MaterialDesc::lambert("dark", [0.8; 3]));
        let mirror = builder.material(MaterialDesc::mirror("mirror", [1.0; 3]));
        let (positions, triangles) = shapes::flip(shapes::cuboid([-0.5; 3], [0.5; 3]));
        let flat = |t: &[u32; 3]| {
            let heights = t.map(|v| positions[v as usize][1]);
            if heights == [-0.5; 3] {
                0
            } else if heights == [0.5; 3] {
                1
            } else {
                2
            }
        };
        for (part, material) in [lit, dark, mirror].into_iter().enumerate() {
            let own = triangles.iter().copied().filter(|t| flat(t) == part).collect();
            builder.mesh(["floor", "ceiling", "mirrors"][part], positions.clone(), own, material);
        }
        look_at_point(&mut builder, look, normal, 0.2, 0.05);
        let scene = builder.build().unwrap();
        let s = Settings { estimator: Estimator::Radius { radius: Some(0.1) }, ..settings() };
        let values: Vec<f64> = per_pass::<T>(&scene, &s, 16, 6).iter().map(|l| l * PI).collect();
        assert_agrees("plates", moments(&values).0, radiosity, standard_error(&values), 0.0);
    }
}

/// C7: a point light and mirrors, direct and reflected light: `1 + 0.9/5^1.5` with one mirror.
pub fn c7_point_light_and_mirrors<T: TestBackend>() {
    for (mirrors, truth) in [(1, 1.080_498_4), (2, 1.190_996_9)] {
        let mut builder = SceneBuilder::new();
        let grey = builder.material(MaterialDesc::lambert("grey", [0.5; 3]));
        let metal = builder.material(MaterialDesc::mirror("mirror", [0.9; 3]));
        let s = 0.3;
        builder.quad("receiver", [[-s, -s, 0.0], [s, -s, 0.0], [s, s, 0.0], [-s, s, 0.0]], grey);
        // Large, but small enough that enough photons hit it.
        let w = 6.0;
        builder.quad("mirror x", [[1.0, -w, -w], [1.0, -w, w], [1.0, w, w], [1.0, w, -w]], metal);
        if mirrors == 2 {
            builder.quad("mirror y", [[-w, 1.0, -w], [1.0, 1.0, -w], [1.0, 1.0, w], [-w, 1.0, w]], metal);
        }
        builder.light("light", LightDesc::Point { position: [0.0, 0.0, 1.0], intensity: [1.0; 3] });
        look_at_point(&mut builder, [0.0; 3], [0.0, 0.0, 1.0], 0.5, 0.01);
        let scene = builder.build().unwrap();
        let s = Settings {
            photons: 400_000,
            indirect: Indirect::None,
            alpha: 1.0,
            estimator: Estimator::Radius { radius: Some(0.12) },
            ..Settings::default()
        };
        let values: Vec<f64> = per_pass::<T>(&scene, &s, 16, 4).iter().map(|l| l * PI / 0.5).collect();
        // Curvature of the field over the radius: it changes the caustic part, at most a fifth, by less than 2 %.
        assert_agrees("mirrors", moments(&values).0, truth, standard_error(&values), 4e-3);
    }
}

/// C8: surfaces met per photon: mean `1/(1−ρ)`, standard error `√ρ/(1−ρ)/√N`.
pub fn c8_path_lengths<T: TestBackend>() {
    for albedo in [0.5, 0.8, 0.95] {
        let scene = cube(albedo, 1.0).build().unwrap();
        let n = 50_000;
        let (_, tally) = trace::<T>(2, &scene, &Settings { max_bounces: 100_000, ..settings() }, &[n]);
        let mean = tally.surfaces as f64 / f64::from(n);
        assert_agrees("length", mean, 1.0 / (1.0 - albedo), albedo.sqrt() / (1.0 - albedo) / f64::from(n).sqrt(), 0.0);
    }
}

/// C9: photon counts and flux balance exactly, in scenes of every kind.
pub fn c9_conservation<T: TestBackend>() {
    for (name, _) in photon_scene::builtin_names() {
        let scene = photon_scene::builtin(name).unwrap().build().unwrap();
        let s = Settings { max_bounces: 12, ..Settings::default() };
        let (_, tally) = trace::<T>(2, &scene, &s, &[20_000]);
        assert!(tally.balances(), "{name}: {tally:?}");
        let parts = [&tally.flux_absorbed, &tally.flux_escaped, &tally.flux_truncated, &tally.flux_dropped];
        let sum: f64 = parts.into_iter().map(|part| watts(&scene, &tally, part)).sum();
        assert!((sum / watts(&scene, &tally, &tally.flux_emitted) - 1.0).abs() < 1e-12, "{name}");
        assert_eq!(tally.dropped, 0, "{name}");
        // Power is distributed in proportion, for any colours.
        assert!((watts(&scene, &tally, &tally.flux_emitted) / scene.units().power - 1.0).abs() < 0.05, "{name}");
    }
}
