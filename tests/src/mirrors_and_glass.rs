//! Scenes of mirrors and smooth glass alone: camera paths find all the light, and no photons are traced.

use photon_core::{Budget, EnvironmentMap, Error, Indirect, Pipeline, Render, Settings, View, render};
use photon_scene::{CameraDesc, LightDesc, MaterialDesc, Projection, SceneBuilder, Surface, shapes};

use crate::harness::TestBackend;
use crate::stats::assert_agrees;

const SIZE: u32 = 24;
const PASSES: u32 = 12;

/// A ball of radius 1 in front of a camera that sees it and its surroundings.
fn ball(material: MaterialDesc) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let material = builder.material(material);
    let (positions, triangles) = shapes::icosphere(4, [0.0; 3], 1.0);
    builder.mesh("ball", positions, triangles, material);
    let projection = Projection::Orthographic { half_height: 1.2 };
    builder.camera("eye", CameraDesc::new([0.0, 0.0, 4.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], projection));
    builder
}

fn settings() -> Settings {
    Settings { photons: 5000, errors: true, max_bounces: 64, ..Settings::default() }
}

fn renderer<T: TestBackend>(builder: SceneBuilder, settings: &Settings) -> Result<Pipeline<T::On>, Error> {
    let scene = builder.build().unwrap();
    let view = View { camera: scene.camera(None, SIZE, SIZE).unwrap(), width: SIZE, height: SIZE };
    Pipeline::new(T::make(2), &scene.view(), view, settings.clone())
}

/// A mirror of reflectance ρ in an even environment L is L ρ in every pixel that it fills; glass that absorbs nothing is L
/// in every pixel, in expectation, whichever paths Fresnel's equations choose. By maps and by final gathering.
pub fn in_an_even_environment<T: TestBackend>() {
    for indirect in [Indirect::Map, Indirect::Gather] {
        let settings = Settings { indirect, ..settings() };
        let mut builder = ball(MaterialDesc::mirror("chrome", [0.8, 0.5, 0.25]));
        builder.environment(EnvironmentMap::constant([2.0; 3]).unwrap());
        let mut mirror = renderer::<T>(builder, &settings).unwrap();
        let required = mirror.facts().required;
        assert!(!required.maps.any() && !required.shadow_rays && !required.final_gather, "{required:?}");
        let mut unlit = ball(MaterialDesc::mirror("chrome", [0.5; 3]));
        unlit.environment(EnvironmentMap::constant([2.0; 3]).unwrap());
        let needs = photon_core::explain(&unlit.build().unwrap().view(), &settings);
        let why = |what: &str| needs.iter().find(|need| need.what == what).unwrap();
        for what in ["shadow rays", "final gathering", "map of scattered photons"] {
            assert!(!why(what).needed && why(what).why.contains("camera paths find the light"), "{what}");
        }
        for pass in 0..PASSES {
            mirror.pass(pass, &mut ()).unwrap();
        }
        let film = mirror.film().unwrap();
        let beauty = film.beauty();
        let centre = beauty[(SIZE / 2 * SIZE + SIZE / 2) as usize];
        for (found, truth) in centre.into_iter().zip([1.6, 1.0, 0.5]) {
            assert!((found - truth).abs() < 1e-4, "{centre:?}");
        }
        assert!((beauty[0][0] - 2.0).abs() < 1e-4, "beside the ball: {:?}", beauty[0]);
        // Without photons there is no bias: every pixel has an interval.
        let intervals = film.confidence_intervals().unwrap();
        assert!(intervals.iter().all(|interval| interval.flags.is_empty() && interval.bias == 0.0));

        let mut builder = ball(MaterialDesc::glass("glass", 1.5));
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
        // Flat triangles reflect light totally that a smooth ball would let out: with 64 bounces 0.2 % is still inside.
        let mut glass = renderer::<T>(builder, &Settings { max_bounces: 4096, ..settings }).unwrap();
        for pass in 0..PASSES {
            glass.pass(pass, &mut ()).unwrap();
        }
        let film = glass.film().unwrap();
        let pixels = film.beauty();
        let mean = pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / pixels.len() as f64;
        let errors = film.standard_error();
        // Standard error of a mean of independent pixels: √(Σ s²)/n.
        let error = errors.iter().map(|&s| f64::from(s).powi(2)).sum::<f64>().sqrt() / errors.len() as f64;
        assert_agrees("glass in even light", mean, 1.0, error, 1e-4);
    }
}

/// An area light in a mirror, and nothing else: L ρ. A point light cannot be seen in one, which is an error.
pub fn a_light_in_a_mirror<T: TestBackend>() {
    let scene = |light: LightDesc| {
        let mut builder = SceneBuilder::new();
        let mirror = builder.material(MaterialDesc::mirror("mirror", [0.5; 3]));
        builder.quad("mirror", [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]], mirror);
        builder.light("light", light);
        let projection = Projection::Orthographic { half_height: 0.5 };
        builder.camera("eye", CameraDesc::new([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], projection));
        builder
    };
    let point = scene(LightDesc::Point { position: [0.0, 0.0, 2.0], intensity: [1.0; 3] });
    let refused = renderer::<T>(point, &settings()).err().unwrap();
    assert!(matches!(refused, Error::NoReceiver), "{refused}");
    let mut builder = ball(MaterialDesc::mirror("mirror", [0.5; 3]));
    let glowing = builder.material(MaterialDesc::emissive("light", [0.0; 3], [3.0; 3]));
    let (positions, mut triangles) = shapes::icosphere(4, [0.0; 3], 5.0);
    // The inside shines.
    triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    builder.mesh("shell", positions, triangles, glowing);
    let mut shell = renderer::<T>(builder, &settings()).unwrap();
    shell.pass(0, &mut ()).unwrap();
    let beauty = shell.film().unwrap().beauty();
    let centre = beauty[(SIZE / 2 * SIZE + SIZE / 2) as usize];
    assert!((centre[0] - 1.5).abs() < 1e-4 && (beauty[0][0] - 3.0).abs() < 1e-4, "{centre:?} {:?}", beauty[0]);
}

/// A solid whose surface lets every path pass.
fn smoke() -> MaterialDesc {
    MaterialDesc::new("smoke", Surface::Dielectric { ior: 1.0, absorption: [0.1; 3], tint: [1.0; 3], roughness: 0.0 })
}

/// Paths that are cut at the maximum length, counted exactly: around the camera is a ball whose surface lets every path go
/// on, and at the limit all of them are lost. Where the limit is one surface higher, an index of 1 loses none.
pub fn cut_paths_are_counted<T: TestBackend>() {
    let rough = Surface::Dielectric { ior: 1.5, absorption: [0.0; 3], tint: [1.0; 3], roughness: 0.4 };
    let pixels = u64::from(SIZE * SIZE);
    for (material, max_bounces, lost) in [
        (MaterialDesc::mirror("mirror", [1.0; 3]), 1, pixels),
        (MaterialDesc::mirror("mirror", [1.0; 3]), 5, pixels),
        // Nothing is missed where hardly any light is left.
        (MaterialDesc::mirror("dark mirror", [0.01; 3]), 1, pixels),
        (MaterialDesc::mirror("dark mirror", [0.01; 3]), 5, 0),
        (MaterialDesc::metal("metal", [1.0; 3], 0.5), 1, pixels),
        (MaterialDesc::thin("pane", 1.5), 1, pixels),
        (MaterialDesc::new("rough glass", rough), 1, pixels),
        (smoke(), 1, pixels),
        (smoke(), 2, 0),
        (MaterialDesc::lambert("white", [0.5; 3]), 1, 0),
    ] {
        let what = format!("{} and {max_bounces} surfaces", material.name);
        let mut builder = ball(material);
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
        let projection = Projection::Orthographic { half_height: 0.3 };
        builder.camera("inside", CameraDesc::new([0.0; 3], [0.1, 0.2, -1.0], [0.0, 1.0, 0.0], projection));
        let scene = builder.build().unwrap();
        let view = View { camera: scene.camera(Some("inside"), SIZE, SIZE).unwrap(), width: SIZE, height: SIZE };
        let settings = Settings { max_bounces, photons: 100, ..Settings::default() };
        let mut renderer = Pipeline::new(T::make(2), &scene.view(), view, settings).unwrap();
        let outcome = render(&mut renderer, Budget::passes(2), &mut ()).unwrap();
        assert_eq!(outcome.truncated_camera_paths, 2 * lost, "{what}");
        assert_eq!(renderer.film().unwrap().tally.truncated_camera_paths, 2 * lost, "film of {what}");
    }
}

/// Rays of final gathering likewise: a floor and a light in a ball of index 1, from which no ray gets out with one surface.
pub fn cut_gather_rays_are_counted<T: TestBackend>() {
    const RAYS: u32 = 8;
    for (max_bounces, lost) in [(1, u64::from(RAYS * SIZE * SIZE)), (2, 0)] {
        let mut builder = ball(smoke());
        let floor = builder.material(MaterialDesc::lambert("floor", [0.5; 3]));
        let corners = [[-0.4, -0.4, 0.0], [0.4, -0.4, 0.0], [0.4, 0.4, 0.0], [-0.4, 0.4, 0.0]];
        builder.quad("floor", corners, floor);
        builder.light("light", LightDesc::Point { position: [0.0, 0.0, 0.5], intensity: [1.0; 3] });
        let projection = Projection::Orthographic { half_height: 0.3 };
        builder.camera("inside", CameraDesc::new([0.0, 0.0, 0.4], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], projection));
        let scene = builder.build().unwrap();
        let view = View { camera: scene.camera(Some("inside"), SIZE, SIZE).unwrap(), width: SIZE, height: SIZE };
        let settings = Settings {
            max_bounces,
            photons: 100,
            indirect: Indirect::Gather,
            gather_rays: RAYS,
            ..Settings::default()
        };
        let mut renderer = Pipeline::new(T::make(2), &scene.view(), view, settings).unwrap();
        let outcome = render(&mut renderer, Budget::passes(2), &mut ()).unwrap();
        assert_eq!(outcome.truncated_camera_paths, 2 * lost, "{max_bounces} surfaces");
    }
}
