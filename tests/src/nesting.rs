//! Solids within solids, beside each other and across each other.

use photon_core::glam::Vec3;
use photon_core::{
    Direct, Error, Indirect, MediaFeatures, PhotonRay, Pipeline, Requirements, Settings, Solids, TransportBackend, View,
};
use photon_scene::{CameraDesc, LightDesc, MaterialDesc, Projection, SceneBuilder, SceneError, Surface, shapes};

use crate::extremes::scenes::{follow, ray};
use crate::harness::{TestBackend, film, per_pass};
use crate::stats::{assert_agrees, moments, standard_error};

fn solid(builder: &mut SceneBuilder, name: &str, ior: f64, priority: u32, low: [f64; 3], high: [f64; 3]) {
    let material = builder.material(MaterialDesc::glass(name, ior).with_priority(priority));
    let (positions, triangles) = shapes::cuboid(low, high);
    builder.mesh(name, positions, triangles, material);
}

fn camera(builder: &mut SceneBuilder, y: f64) {
    let projection = Projection::Orthographic { half_height: 0.2 };
    let (direction, up) = ([0.0, -1.0, 0.0], [0.0, 0.0, 1.0]);
    builder.camera("down", CameraDesc::new([0.0, y, 0.0], direction, up, projection));
}

/// Emission alone: what the camera sees of a glow, by reflection and refraction. What is diffuse counts as black.
pub(crate) fn glow() -> Settings {
    Settings {
        photons: 1,
        max_bounces: 1000,
        direct: Direct::None,
        indirect: Indirect::None,
        caustics: false,
        ..Settings::default()
    }
}

/// A camera in a block of glass looks down at water. Above it, in the glass, is the only thing that shines, with radiance
/// 1, so that what is seen is the reflectance.
fn glass_over_water(water: f64, glass_priority: u32, water_priority: u32) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let sky = builder.material(MaterialDesc::emissive("sky", [0.5; 3], [1.0; 3]));
    let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
    builder.quad("sky", [[-0.9, 0.9, -0.9], [0.9, 0.9, -0.9], [0.9, 0.9, 0.9], [-0.9, 0.9, 0.9]], sky);
    builder.quad("black", [[-0.9, -0.9, 0.9], [0.9, -0.9, 0.9], [0.9, -0.9, -0.9], [-0.9, -0.9, -0.9]], black);
    solid(&mut builder, "glass", 1.5, glass_priority, [-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]);
    solid(&mut builder, "water", 1.33, water_priority, [-1.2, -1.0, -1.2], [1.2, water, 1.2]);
    camera(&mut builder, 0.5);
    builder
}

/// P20: glass on water reflects `((1.5−1.33)/(1.5+1.33))²` = .0036085 at normal incidence, where the water reaches into the
/// glass and the glass has priority, or was entered last; with a gap of air, by all orders, .0585. Where the water has
/// priority it is the boundary that is elsewhere, and no other reflectance.
pub fn p20_glass_on_water<T: TestBackend>() {
    let touching = ((1.5_f64 - 1.33) / (1.5 + 1.33)).powi(2);
    assert!((touching - 0.003_608_5).abs() < 1e-7);
    for (name, water, glass, priority) in
        [("glass first", 0.1, 1, 0), ("priority 7 and 3", 0.1, 7, 3), ("water first", 0.1, 0, 1)]
    {
        let film = film::<T>(&glass_over_water(water, glass, priority).build().unwrap(), &glow(), 2, 4);
        for pixel in film.beauty() {
            let seen = f64::from(pixel[0]);
            assert!((seen - touching).abs() < 1e-6, "{name}: {seen}");
        }
    }
    let [r, s] = [1.5_f64, 1.33].map(|n| ((n - 1.0) / (n + 1.0)).powi(2));
    let gap = (r + s - 2.0 * r * s) / (1.0 - r * s);
    assert!((gap - 0.0585).abs() < 1e-4);
    let values = per_pass::<T>(&glass_over_water(-0.1, 0, 0).build().unwrap(), &glow(), 64, 12);
    assert_agrees("with a gap", moments(&values).0, gap, standard_error(&values), 0.0);
}

/// The camera in three solids at once, one within the other, and an even glow around all: n² of it, whatever is between.
pub fn camera_in_three_solids<T: TestBackend>() {
    for (inner, middle, outer) in [(1.5, 1.33, 1.1), (1.1, 2.4, 1.33), (1.0, 1.5, 1.33)] {
        let mut builder = SceneBuilder::new();
        let shell = builder.material(MaterialDesc::emissive("glow", [0.5; 3], [1.0; 3]));
        let (positions, triangles) = shapes::flip(shapes::icosphere(3, [0.0; 3], 2.0));
        builder.mesh("shell", positions, triangles, shell);
        solid(&mut builder, "outer", outer, 0, [-1.0; 3], [1.0; 3]);
        solid(&mut builder, "middle", middle, 0, [-0.7; 3], [0.75; 3]);
        solid(&mut builder, "inner", inner, 0, [-0.4; 3], [0.45; 3]);
        camera(&mut builder, 0.1);
        let film = film::<T>(&builder.build().unwrap(), &glow(), 4, 4);
        for pixel in film.beauty() {
            let seen = f64::from(pixel[0]);
            assert!((seen / (inner * inner) - 1.0).abs() < 1e-5, "{inner}, {middle}, {outer}: {seen}");
        }
    }
}

/// A light in two solids at once sends its photons through both, and the inner one absorbs by its own coefficient: all
/// orders of reflection at the outer top and bottom, straight up and down.
pub fn light_in_two_solids<T: TestBackend>() {
    let (sigma, count) = (0.9_f64, 100_000_usize);
    let mut builder = SceneBuilder::new();
    let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
    builder.quad("floor", [[-1.0, -1.5, 1.0], [1.0, -1.5, 1.0], [1.0, -1.5, -1.0], [-1.0, -1.5, -1.0]], black);
    solid(&mut builder, "outer", 1.33, 0, [-1.0; 3], [1.0; 3]);
    let ink = Surface::Dielectric { ior: 1.33, absorption: [sigma; 3], tint: [1.0; 3], roughness: 0.0 };
    let ink = builder.material(MaterialDesc::new("inner", ink));
    let (positions, triangles) = shapes::cuboid([-0.5; 3], [0.5; 3]);
    builder.mesh("inner", positions, triangles, ink);
    builder.light("light", LightDesc::Point { position: [0.0; 3], intensity: [1.0; 3] });
    let scene = builder.build().unwrap();
    let view = scene.view();
    let solids = Solids::of(&view);
    let [media, _] = solids.locate().of_light(&view.lights[0]);
    let mut rays: Vec<PhotonRay> = (0..count)
        .map(|i| {
            let at = scene.units().point([i as f64 / count as f64 * 0.2, 0.0, 0.0]);
            PhotonRay { media: media.bits(), ..ray(at.into(), Vec3::NEG_Y) }
        })
        .collect();
    let (_, tally) = follow::<T>(&scene, &Settings { max_bounces: 200, ..Settings::default() }, &mut rays);
    // Indices match, so that only the outer bottom and top reflect: down 0.5 in ink, then r at the bottom, back up
    // through 1 of ink, r at the top, and so on.
    let r = ((1.33_f64 - 1.0) / 2.33).powi(2);
    let (once, round) = ((-0.5 * sigma).exp(), (r * (-sigma).exp()).powi(2));
    let escaped = tally.flux_escaped.value()[0] / count as f64;
    // Up: what the bottom reflects goes through all of the ink and out at the top.
    let up = once * r * (-sigma).exp() * (1.0 - r) / (1.0 - round);
    assert!(tally.balances() && tally.too_deep == 0);
    let error = (up / count as f64).sqrt();
    assert_agrees("up", escaped, up, error, 1e-6);
    // Each path ends with what it carries on the floor or above it; the rest was absorbed on the way.
    let landed = tally.absorbed as f64 / count as f64;
    assert_agrees("paths that land", landed, 1.0 / (1.0 + r), (0.25 / count as f64).sqrt(), 1e-6);
}

/// A fifth solid around the same point is ignored, and every path that enters it is counted.
pub fn a_fifth_solid_is_counted<T: TestBackend>() {
    let through = |solids: u32| {
        let mut builder = SceneBuilder::new();
        let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
        builder.quad("floor", [[-1.0, -1.5, 1.0], [1.0, -1.5, 1.0], [1.0, -1.5, -1.0], [-1.0, -1.5, -1.0]], black);
        for i in 0..solids {
            let half = 1.0 - 0.15 * f64::from(i);
            // Of one index, so that nothing is reflected between them.
            let ior = if i == 0 { 1.0 + 1e-6 } else { 1.0 + 2e-6 };
            let desc = MaterialDesc::glass(format!("solid {i}"), ior).with_priority(i);
            let material = builder.material(desc);
            let (positions, triangles) = shapes::cuboid([-half; 3], [half; 3]);
            builder.mesh("solid", positions, triangles, material);
        }
        builder.light("light", LightDesc::Point { position: [0.0, 1.4, 0.0], intensity: [1.0; 3] });
        let scene = builder.build().unwrap();
        let mut rays: Vec<PhotonRay> =
            (0..1000).map(|i| ray(scene.units().point([f64::from(i) * 1e-4, 1.4, 0.05]).into(), Vec3::NEG_Y)).collect();
        let (_, tally) = follow::<T>(&scene, &Settings { max_bounces: 64, ..Settings::default() }, &mut rays);
        assert!(tally.balances());
        tally
    };
    assert_eq!(through(4).too_deep, 0);
    let five = through(5);
    assert_eq!(five.too_deep, 1000);
    assert_eq!(five.absorbed, 1000, "they reach the floor all the same");
}

/// The feature is derived, what lacks it is refused, and a scene has 255 media at most.
pub fn nesting_is_required_where_it_is<T: TestBackend>() {
    let scene = glass_over_water(0.1, 1, 0).build().unwrap();
    let apart = glass_over_water(-0.1, 1, 0).build().unwrap();
    let media = |scene: &photon_scene::Scene| Requirements::of(&scene.view(), &glow()).media;
    assert_eq!(media(&scene), MediaFeatures::NESTED);
    assert_eq!(media(&apart), MediaFeatures::NONE);
    let mut required = Requirements::of(&scene.view(), &glow());
    required.media = MediaFeatures::NONE;
    let view = View { camera: scene.camera(None, 4, 4).unwrap(), width: 4, height: 4 };
    let refused = Pipeline::with_requirements(T::make(1), &scene.view(), view, glow(), required);
    assert!(matches!(refused.map(drop), Err(Error::InvalidSetting { .. })));
    assert!(T::make(1).prepare(&scene.view(), &required).is_err());

    let many = |count: u32| {
        let mut builder = SceneBuilder::new();
        for i in 0..count {
            let low = f64::from(i) * 2.0;
            // Every second one is like the first.
            let ior = 1.1 + if i % 2 == 0 { 0.0 } else { f64::from(i) * 1e-3 };
            solid(&mut builder, "solid", ior, 0, [low, 0.0, 0.0], [low + 1.0, 1.0, 1.0]);
        }
        builder.build()
    };
    assert_eq!(many(508).unwrap().view().media.len(), 256, "the vacuum, and equal ones share a place");
    assert!(matches!(many(510).map(drop), Err(SceneError::TooMany { .. })));
}
