//! Light emitted under a clearcoat against closed forms: `L (1 − c E(cos))` leaves the surface.

use std::f64::consts::PI;

use photon_core::glam::DVec3;
use photon_core::{Direct, EnvironmentMap, Estimator, Features, Filter, Indirect, Settings};
use photon_scene::{MaterialDesc, SceneBuilder, TextureDesc, TextureRef, TexturesDesc, VertexAttributes, shapes};

use crate::clearcoat::columns;
use crate::direct::{floor, irradiance};
use crate::gloss_reference::albedo;
use crate::harness::{TestBackend, direct_settings, look_at_point, per_pass, trace, watts};
use crate::stats::{agrees, assert_agrees, moments, standard_error};
use crate::stripes::{self, VIEW};

/// E of a clearcoat at 257 cosines, interpolated.
struct Albedo(Vec<f64>);

impl Albedo {
    fn new(roughness: f64) -> Self {
        let of = |k: i32| albedo(roughness * roughness, (f64::from(k) / 256.0).max(1e-3), 0.04);
        Self((0..=256).map(of).collect())
    }

    fn at(&self, cosine: f64) -> f64 {
        let at = cosine * 256.0;
        let first = (at as usize).min(255);
        self.0[first] + (self.0[first + 1] - self.0[first]) * (at - first as f64)
    }

    /// `2 ∫ E cos^n d cos`, with n = 1 its mean over the light of a Lambertian emitter.
    fn moment(&self, power: impl Fn(f64) -> f64) -> f64 {
        let at = |k: i32| (f64::from(k) + 0.5) / 1024.0;
        (0..1024).map(|k| power(self.at(at(k))) * 2.0 * at(k)).sum::<f64>() / 1024.0
    }
}

fn glowing(emission: f64) -> MaterialDesc {
    MaterialDesc::emissive("glowing", [0.0; 3], [emission; 3])
}

/// Emitting stripes as the camera sees them: weights, roughnesses, textures, normals of their own, two sides; and under an
/// even sky of radiance 1, where a black surface that emits 1 shows 1, whatever its clearcoat.
pub fn seen_by_the_camera<T: TestBackend>() {
    let (texel, scale) = ([166, 128, 238, 255], 0.7);
    let make = |sky: bool| {
        let mut builder = SceneBuilder::new();
        let texels = [[255, 102, 0, 255], [153, 204, 0, 255]];
        let halves = builder.texture(TextureDesc::linear8("halves", 2, 1, &texels).filtered(Filter::Nearest));
        let halves = TextureRef::new(halves);
        let textured = TexturesDesc::default().with_clearcoat(halves).with_clearcoat_roughness(halves);
        let tilted = TextureRef::new(builder.texture(TextureDesc::linear8("tilted", 1, 1, &[texel])));
        let bumpy = TexturesDesc::default().with_clearcoat_normal(tilted, scale);
        let below = TexturesDesc::default().with_normal(tilted).with_normal_scale(scale);
        let uvs = vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
        let plain = VertexAttributes::default().with_uvs(vec![uvs]);
        let mut both = glowing(1.0).with_clearcoat(1.0, 0.4);
        both.emits_both_sides = true;
        let descs = vec![
            (1, glowing(1.0).with_clearcoat(1.0, 0.4), plain.clone()),
            (2, glowing(1.0).with_clearcoat(1.0, 1.0).with_textures(textured), plain.clone()),
            (1, glowing(1.0).with_clearcoat(1.0, 0.4).with_textures(bumpy), plain.clone()),
            (1, glowing(1.0).with_clearcoat(1.0, 0.4).with_textures(below), plain.clone()),
            (1, glowing(1.0), plain.clone()),
            (1, both, plain.clone()),
            (1, glowing(0.0).with_clearcoat(1.0, 0.4), plain),
        ];
        stripes::add_with(&mut builder, descs, false);
        if sky {
            builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
        }
        builder.build().unwrap()
    };
    let dark = make(false);
    assert!(Features::of(&dark.view()).contains(Features::COATED_LIGHTS));
    let o = VIEW.normalize_or_zero();
    let [x, y, z] = [texel[0], texel[1], texel[2]].map(|byte| 2.0 * f64::from(byte) / 255.0 - 1.0);
    let normal = DVec3::new(x * scale, z, -y * scale).normalize_or_zero();
    let (smooth, rough) = (Albedo::new(0.4), Albedo::new(0.8));
    let even = 1.0 - smooth.at(o.y);
    let expected = [even, even, 1.0 - 0.6 * rough.at(o.y), 1.0 - smooth.at(o.dot(normal)), even, 1.0, even, 0.0];
    let settings = direct_settings(Direct::Nee, 0.1);
    for (column, (values, expected)) in columns::<T>(&dark, &settings, 1).iter().zip(expected).enumerate() {
        // The error of the albedo table.
        assert_agrees(&format!("column {column}"), values[0], expected, 0.0, 2.5e-3);
        assert!(column == 5 || !agrees(values[0], 1.0, 0.0, 2.5e-3), "column {column}: {}", values[0]);
    }
    // Normals of their own lose some light by the cosine that counts.
    let bright = columns::<T>(&make(true), &settings, 32);
    for column in [0, 1, 2, 4, 5, 6] {
        let values = &bright[column];
        assert_agrees(&format!("sky, {column}"), moments(values).0, 1.0, standard_error(values), 3e-3);
    }
}

/// Irradiance by shadow rays beside a wall that emits under a clearcoat, mostly at grazing angles: a quadrature over the wall.
pub fn light_of_a_wall<T: TestBackend>() {
    let coat = Albedo::new(0.3);
    let (at, low, high) = (0.8, 0.05, 1.0);
    for weight in [1.0, 0.5] {
        let mut builder = floor();
        let wall = builder.material(glowing(1.0).with_clearcoat(weight, 0.3));
        let (positions, triangles) =
            shapes::quad([[1.0, low, -1.0], [1.0, low, 1.0], [1.0, high, 1.0], [1.0, high, -1.0]]);
        builder.mesh("wall", positions, triangles, wall);
        let (found, error) = irradiance::<T>(builder, at, 16);
        let (mut truth, mut bare) = (0.0, 0.0);
        let n = 400;
        for k in 0..n * n {
            let part = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
            let point = DVec3::new(1.0, low + (high - low) * part(k / n), 2.0 * part(k % n) - 1.0);
            let gap = point - DVec3::new(at, 0.0, 0.0);
            let direction = gap.normalize_or_zero();
            let share = direction.y * direction.x / gap.length_squared() * 2.0 * (high - low) / f64::from(n * n);
            bare += share;
            truth += share * (1.0 - weight * coat.at(direction.x));
        }
        assert_agrees(&format!("weight {weight}"), found, truth, error, 2.5e-3 * truth);
        assert!(!agrees(found, bare, error, 2.5e-3 * bare), "{found} {bare}");
    }
}

/// Photons of a plate carry `π L A (1 − c Ē)` from each side. Standard error: that of `1 − c E` over the directions.
pub fn power_of_a_plate<T: TestBackend>() {
    let coat = Albedo::new(0.5);
    for (weight, both) in [(1.0, false), (0.6, true)] {
        let mut builder = SceneBuilder::new();
        let mut desc = glowing(2.0).with_clearcoat(weight, 0.5);
        desc.emits_both_sides = both;
        let plate = builder.material(desc);
        builder.quad("plate", [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.5, 0.0, 1.0], [1.5, 0.0, 0.0]], plate);
        let scene = builder.build().unwrap();
        let paths = 40_000;
        let (_, tally) = trace::<T>(2, &scene, &Settings::default(), &[paths]);
        let bare = 2.0 * PI * 1.5 * if both { 2.0 } else { 1.0 };
        let (mean, square) = (coat.moment(|e| 1.0 - weight * e), coat.moment(|e| (1.0 - weight * e).powi(2)));
        let error = bare * ((square - mean * mean) / f64::from(paths)).sqrt();
        let found = watts(&scene, &tally, &tally.flux_emitted);
        assert_agrees(&format!("weight {weight}"), found, bare * mean, error, 2.5e-3 * bare);
        assert!(!agrees(found, bare, error, 2.5e-3 * bare), "{found} {bare}");
    }
}

/// In a closed room whose walls are black, emit 1 and have a clearcoat, all that absorbs nothing shows 1, and so do the walls:
/// by shadow rays, by photons, by final gathering, and in the reflection of a metal. Without dimming it would be more.
pub fn furnace<T: TestBackend>() {
    for (metallic, roughness) in [(false, 0.0), (true, 0.5)] {
        let mut builder = SceneBuilder::new();
        let wall = builder.material(glowing(1.0).with_clearcoat(1.0, 0.6));
        let (positions, triangles) = shapes::flip(shapes::cuboid([-1.0; 3], [1.0; 3]));
        builder.mesh("room", positions, triangles, wall);
        let white = builder.material(match metallic {
            true => MaterialDesc::metal("metal", [1.0; 3], roughness),
            false => MaterialDesc::lambert("white", [1.0; 3]),
        });
        builder.quad("white", [[-0.8, 0.0, 0.8], [0.8, 0.0, 0.8], [0.8, 0.0, -0.8], [-0.8, 0.0, -0.8]], white);
        look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.2);
        let scene = builder.build().unwrap();
        let settings = || Settings {
            photons: 20_000,
            max_bounces: 512,
            alpha: 1.0,
            estimator: Estimator::Radius { radius: Some(0.2) },
            ..Settings::default()
        };
        let mut ways = vec![("shadow rays", settings())];
        if !metallic {
            ways.push(("photons", Settings { direct: Direct::Photons, ..settings() }));
            ways.push(("gather", Settings { indirect: Indirect::Gather, gather_rays: 4, ..settings() }));
        }
        for (way, settings) in ways {
            let values = per_pass::<T>(&scene, &settings, 24, 8);
            // The error of the table, for each reflection at a wall.
            let what = format!("{way}, metal: {metallic}");
            assert_agrees(&what, moments(&values).0, 1.0, standard_error(&values), 5e-3);
        }
    }
}
