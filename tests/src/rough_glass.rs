//! Rough glass: GGX reflection and transmission of solids and thin sheets.

use std::f64::consts::{PI, TAU};

use photon_core::glam::DVec3;
use photon_core::{Direct, EnvironmentMap, Estimator, Indirect, Settings};
use photon_scene::{CameraDesc, LightDesc, MaterialDesc, Projection, SceneBuilder, Surface, shapes};

use crate::gloss_reference::half_vectors;
use crate::harness::{TestBackend, look_at_point, per_pass, trace};
use crate::stats::{assert_agrees, moments, standard_error};

fn solid(roughness: f64, ior: f64) -> MaterialDesc {
    MaterialDesc::new("glass", Surface::Dielectric { ior, absorption: [0.0; 3], tint: [1.0; 3], roughness })
}

fn sheet(roughness: f64) -> MaterialDesc {
    MaterialDesc::new("pane", Surface::Thin { ior: 1.5, tint: [1.0; 3], roughness })
}

fn settings(direct: Direct, indirect: Indirect, max_bounces: u32) -> Settings {
    Settings {
        direct,
        indirect,
        max_bounces,
        photons: 20_000,
        alpha: 1.0,
        estimator: Estimator::Radius { radius: Some(0.1) },
        ..Settings::default()
    }
}

/// Exact Fresnel reflectance from index 1 to `eta`.
fn fresnel(cosine: f64, eta: f64) -> f64 {
    let squared = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
    if squared <= 0.0 {
        return 1.0;
    }
    let t = squared.sqrt();
    let (s, p) = ((cosine - eta * t) / (cosine + eta * t), (eta * cosine - t) / (eta * cosine + t));
    0.5 * (s * s + p * p)
}

fn lambda(alpha: f64, cosine: f64) -> f64 {
    0.5 * ((1.0 + alpha * alpha * (1.0 / (cosine * cosine) - 1.0)).sqrt() - 1.0)
}

fn distribution(alpha: f64, h: DVec3) -> f64 {
    alpha * alpha / (PI * (h.x * h.x + h.z * h.z + alpha * alpha * h.y * h.y).powi(2))
}

/// What single scattering loses from a direction with this cosine in index 1, at a boundary to `eta`: 1 less
/// ∫ (F G2(o, r) + (1 − F) G2(o, t)) (o·h) D / cos dω over half vectors, whose density is D cos.
fn lost(alpha: f64, cosine: f64, eta: f64) -> f64 {
    let o = DVec3::new((1.0 - cosine * cosine).sqrt(), cosine, 0.0);
    let grid = (300, 64);
    let masking = |height: f64| 1.0 / (1.0 + lambda(alpha, cosine) + lambda(alpha, height));
    let mut sum = 0.0;
    for h in half_vectors(alpha, grid) {
        let (across, up) = (o.dot(h), h.y);
        if across <= 0.0 {
            continue;
        }
        let reflectance = fresnel(across, eta);
        let reflected = 2.0 * across * up - cosine;
        let mut share = if reflected > 0.0 { reflectance * masking(reflected) } else { 0.0 };
        if reflectance < 1.0 {
            let beyond = (1.0 - (1.0 - across * across) / (eta * eta)).sqrt();
            let transmitted = up * (across / eta - beyond) - cosine / eta;
            share += if transmitted < 0.0 { (1.0 - reflectance) * masking(-transmitted) } else { 0.0 };
        }
        sum += share * across / (cosine * up);
    }
    1.0 - sum / f64::from(grid.0 * grid.1)
}

fn mean_lost(alpha: f64, eta: f64) -> f64 {
    let n = 24;
    (0..n).map(|k| (f64::from(k) + 0.5) / f64::from(n)).map(|c| 2.0 * c * lost(alpha, c, eta)).sum::<f64>()
        / f64::from(n)
}

/// The BSDF of a boundary, normal +y, for light from `i` in a medium of index `n_i` below to `o` in one of index `n_o`
/// above: Walter et al. 2007, equation 21, and what it loses.
fn transmitted(alpha: f64, (o, n_o): (DVec3, f64), (i, n_i): (DVec3, f64)) -> f64 {
    let both = -(o * n_o + i * n_i);
    let h = both.normalize_or_zero() * both.y.signum();
    let (a, b) = (o.dot(h), i.dot(h));
    let masking = 1.0 / (1.0 + lambda(alpha, o.y) + lambda(alpha, -i.y));
    let passes = 1.0 - fresnel(a, n_i / n_o);
    let single = (a * b / (o.y * i.y)).abs() * n_o * n_o * passes * masking * distribution(alpha, h)
        / (n_i * b + n_o * a).powi(2);
    let sum = n_o * n_o * mean_lost(alpha, n_i / n_o) + n_i * n_i * mean_lost(alpha, n_o / n_i);
    let rest = n_o * n_o * lost(alpha, o.y, n_i / n_o) * lost(alpha, -i.y, n_o / n_i) / (PI * sum);
    if a > 0.0 && b < 0.0 { single + rest } else { rest }
}

/// A camera in direction `o` from the origin, which it sees through a tiny square.
fn look_along(builder: &mut SceneBuilder, o: DVec3) {
    let projection = Projection::Orthographic { half_height: 1e-4 };
    builder.camera("oblique", CameraDesc::new((o * 0.5).to_array(), (-o).to_array(), [0.0, 0.0, 1.0], projection));
}

/// G4: in an even environment of radiance 1, balls, blocks and panes of rough glass show 1 at any roughness. The tables
/// allow 2.5e-3 at each of some four surfaces of a path.
pub fn g4_white_furnace<T: TestBackend>() {
    for (roughness, ior, is_solid) in
        [(0.1, 1.5, true), (0.4, 1.5, true), (1.0, 1.5, true), (0.4, 2.4, true), (0.4, 1.05, true), (0.5, 1.5, false)]
    {
        let mut builder = SceneBuilder::new();
        if is_solid {
            let glass = builder.material(solid(roughness, ior));
            let (positions, triangles) = shapes::icosphere(2, [0.0; 3], 0.5);
            builder.mesh("ball", positions, triangles, glass);
        } else {
            let pane = builder.material(sheet(roughness));
            builder.quad("pane", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], pane);
        }
        look_at_point(&mut builder, [0.0; 3], [0.48, 0.8, 0.36], 2.0, 0.3);
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
        let scene = builder.build().unwrap();
        let values = per_pass::<T>(&scene, &settings(Direct::Nee, Indirect::None, 512), 12, 10);
        let what = format!("roughness {roughness}, index {ior}, solid {is_solid}");
        assert_agrees(&what, moments(&values).0, 1.0, standard_error(&values), 1e-2);
    }
}

/// The radiance of parallel light behind a rough boundary, and of a point light, is the BSDF times the irradiance: seen
/// from inside of glass, from outside, and through a sheet. One surface alone, so that the light is sampled there.
pub fn light_behind_a_boundary<T: TestBackend>() {
    let towards = |cosine: f64, azimuth: f64| {
        let sine = (1.0 - cosine * cosine).sqrt();
        DVec3::new(sine * azimuth.cos(), cosine, sine * azimuth.sin())
    };
    for (roughness, o, i) in [
        (0.4, towards(0.9, 0.4), -towards(0.85, 0.5)),
        (0.7, towards(0.7, 0.0), -towards(0.9, 1.0)),
        (1.0, towards(0.5, 2.0), -towards(0.6, 4.0)),
    ] {
        let alpha = roughness * roughness;
        let check = |what: &str, builder: SceneBuilder, truth: f64| {
            let scene = builder.build().unwrap();
            let values = per_pass::<T>(&scene, &settings(Direct::Nee, Indirect::None, 1), 32, 12);
            let what = format!("{what}, roughness {roughness}");
            assert_agrees(&what, moments(&values).0, truth, standard_error(&values), 5e-3 * truth);
        };
        let block = |low: [f64; 3], high: [f64; 3]| {
            let mut builder = SceneBuilder::new();
            let glass = builder.material(solid(roughness, 1.5));
            let (positions, triangles) = shapes::cuboid(low, high);
            builder.mesh("block", positions, triangles, glass);
            builder
        };
        // Inside, with the glass above the boundary.
        let mut inside = block([-1.0, 0.0, -1.0], [1.0, 2.0, 1.0]);
        look_along(&mut inside, o);
        inside.light("sun", LightDesc::Directional { direction: (-i).to_array(), irradiance: [1.0; 3] });
        check("from inside", inside, -i.y * transmitted(alpha, (o, 1.5), (i, 1.0)));
        // Outside, with a point light in the glass below.
        let mut outside = block([-1.0, -2.0, -1.0], [1.0, 0.0, 1.0]);
        look_along(&mut outside, o);
        outside.light("bulb", LightDesc::Point { position: (i * 0.5).to_array(), intensity: [1.0; 3] });
        check("from outside", outside, 4.0 * -i.y * transmitted(alpha, (o, 1.0), (i, 1.5)));
        // A sheet transmits what it reflects, mirrored, by the reflectance of both its faces.
        let mut thin = SceneBuilder::new();
        let pane = thin.material(sheet(roughness));
        thin.quad("pane", [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], pane);
        look_along(&mut thin, o);
        thin.light("sun", LightDesc::Directional { direction: (-i).to_array(), irradiance: [1.0; 3] });
        let mirrored = DVec3::new(i.x, -i.y, i.z);
        let h = (o + mirrored).normalize_or_zero();
        let face = fresnel(o.dot(h), 1.5);
        let masking = 1.0 / (1.0 + lambda(alpha, o.y) + lambda(alpha, -i.y));
        let passes = (1.0 - face) / (1.0 + face) * distribution(alpha, h) * masking / (4.0 * o.y * -i.y);
        // With a reflectance of 1, nothing of what a boundary loses depends on the index.
        let rest = lost(alpha, o.y, 1e-9) * lost(alpha, -i.y, 1e-9) / (TAU * mean_lost(alpha, 1e-9));
        check("through a sheet", thin, -i.y * (passes + rest));
    }
}

/// G5: a closed room with walls of albedo .5 and emission 1, and rough glass that absorbs nothing: the radiance is 2/π
/// outside of the glass, so that photons bring 2 to each unit of area, and the camera sees 2/π everywhere.
pub fn g5_closed_room<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::emissive("wall", [0.5; 3], [1.0 / PI; 3]));
    let glass = builder.material(solid(0.6, 1.5));
    let pane = builder.material(sheet(0.8));
    let (positions, triangles) = shapes::flip(shapes::cuboid([-0.5; 3], [0.5; 3]));
    builder.mesh("walls", positions, triangles, wall);
    let (positions, triangles) = shapes::icosphere(2, [0.0, -0.1, 0.0], 0.25);
    builder.mesh("ball", positions, triangles, glass);
    builder.quad("pane", [[-0.4, 0.2, 0.4], [0.4, 0.2, 0.4], [0.4, 0.3, -0.4], [-0.4, 0.3, -0.4]], pane);
    look_at_point(&mut builder, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.45, 0.2);
    let scene = builder.build().unwrap();
    let settings = settings(Direct::Photons, Indirect::Map, 512);
    let paths = 2000;
    let powers: Vec<f64> = (0..10)
        .map(|seed| {
            let (photons, _) = trace::<T>(2, &scene, &Settings { seed, ..settings.clone() }, &[paths]);
            let power: f64 =
                photons.iter().flat_map(|(_, photons)| photons).map(|photon| f64::from(photon.power[0])).sum();
            power / f64::from(paths) * scene.units().power
        })
        .collect();
    assert_agrees("power on the walls", moments(&powers).0, 12.0, standard_error(&powers), 0.06);
    for indirect in [Indirect::Map, Indirect::Gather] {
        let settings = Settings { indirect, photons: 10_000, ..settings.clone() };
        let values = per_pass::<T>(&scene, &settings, 8, 6);
        let what = format!("{indirect:?}");
        assert_agrees(&what, moments(&values).0, 2.0 / PI, standard_error(&values), 1e-2 * 2.0 / PI);
    }
}
