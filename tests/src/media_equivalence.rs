//! Media that scatter light, on two backends with the same seeds: pictures layer by layer, and what became of paths.

use photon_core::glam::Vec3;
use photon_core::phase::{Mie, Phase};
use photon_core::{
    Film, GridTables, Indirect, Layer, Medium, PassEnd, PhotonMoments, Pipeline, Render as _, SceneView, Settings,
    Tally, View,
};
use photon_scene::{AmbientMedium, LightDesc, MaterialDesc, Scene, builtin, shapes};

use crate::equivalence::share;
use crate::harness::TestBackend;

/// Coloured fog around solids, and a denser medium inside the first of them.
fn media(scene: &Scene, anisotropy: f32) -> Vec<Medium> {
    let mut media = scene.view().media.to_vec();
    let fog = Medium { scattering: [0.6, 0.4, 0.2], absorption: [0.05, 0.1, 0.2], anisotropy, ..media[0] };
    let inside = Medium { scattering: [4.0, 2.0, 1.0], absorption: [0.0, 0.3, 0.6], ..media[1] }
        .with_phase(Phase::Mie(Mie::droplets(20.0)));
    (media[0], media[1]) = (fog, inside);
    media
}

/// A scene in a box of fog that a wall of the box divides, with a denser ball that sticks out of it, and a sun.
fn bounded(name: &str) -> Scene {
    let mut builder = builtin(name).unwrap();
    let (low, high) = builder.bounds().unwrap();
    let at = |share: f64| std::array::from_fn(|axis| low[axis] + share * (high[axis] - low[axis]));
    let extent = high[0] - low[0];
    let middle: [f64; 3] = at(0.5);
    let fog = AmbientMedium::new([0.4 / extent; 3], [0.1 / extent; 3]);
    builder.medium(fog.with_bounds(low, [middle[0], high[1], high[2] + 2.0 * extent]));
    let smoke = MaterialDesc::boundary("smoke", [0.5 / extent; 3])
        .with_scattering([3.0 / extent, 2.0 / extent, 1.0 / extent], 0.4);
    let smoke = builder.material(smoke.with_priority(1));
    let (positions, triangles) = shapes::icosphere(2, at(0.45), 0.2 * extent);
    builder.mesh("smoke", positions, triangles, smoke);
    builder.light("sun", LightDesc::Directional { direction: [0.3, -0.5, -1.0], irradiance: [1.0; 3] });
    builder.build().unwrap()
}

fn picture<T: TestBackend>(scene: &Scene, media: &[Medium], settings: &Settings) -> (Film, Tally) {
    picture_of::<T>(scene, &SceneView { media, ..scene.view() }, settings)
}

fn picture_of<T: TestBackend>(scene: &Scene, shown: &SceneView<'_>, settings: &Settings) -> (Film, Tally) {
    let view = View { camera: scene.camera(None, 32, 32).unwrap(), width: 32, height: 32 };
    let mut renderer: Pipeline<T::On> = Pipeline::new(T::make(2), shown, view, settings.clone()).unwrap();
    let PassEnd::Done(report) = renderer.pass(0, &mut ()).unwrap() else { panic!("the pass ended early") };
    (renderer.film().unwrap(), report.tally)
}

/// For each layer, the share of the pixels that differ by at most 1 % of the mean of the picture.
fn alike(a: &Film, b: &Film) -> [f64; 4] {
    let beauty = a.beauty();
    let mean = beauty.iter().flatten().sum::<f32>() / (3 * beauty.len()) as f32;
    Layer::ALL.map(|layer| {
        let values = |film: &Film| -> Vec<Vec3> {
            film.pixels.iter().map(|pixel| Vec3::from(pixel.layers[layer as usize].map(|c| c as f32))).collect()
        };
        share(&values(a), &values(b), |a, b| a.distance(*b) <= 0.01 * mean)
    })
}

/// For each of the error statistics, biases by two radii and the distribution of photons, the share of the pixels that differ by at
/// most 1 % of its mean.
fn alike_errors(a: &Film, b: &Film) -> [f64; 5] {
    let values = |film: &Film| -> Vec<[f64; 5]> {
        let errors = film.errors.as_ref().expect("the settings ask for errors");
        errors
            .iter()
            .map(|error| {
                let sum = |of: fn(&PhotonMoments) -> f64| error.photon_moments.values().map(of).sum::<f64>();
                [error.bias, error.narrow, sum(|m| m.power), sum(|m| m.slope[0]), sum(|m| m.quadrupole[1])]
            })
            .collect()
    };
    let (a, b) = (values(a), values(b));
    std::array::from_fn(|part| {
        let bound = 0.01 * a.iter().map(|values| values[part].abs()).sum::<f64>() / a.len() as f64;
        share(&a, &b, |a, b| (a[part] - b[part]).abs() <= bound)
    })
}

/// At least 99 % of the pixels of each layer are alike, and of their error statistics if no path differs; counts of paths differ by
/// at most one in 500. Fog of another phase function is not alike.
pub fn pictures_of_fog_are_alike<A: TestBackend, B: TestBackend>() {
    let settings = Settings { photons: 20_000, seed: 4, shadow_rays: 2, errors: true, ..Settings::default() };
    for (name, indirect) in [("cornell-glass", Indirect::Map), ("gloss", Indirect::Gather)] {
        let settings = Settings { indirect, ..settings.clone() };
        let is_bounded = name == "gloss";
        let scene = if is_bounded { bounded(name) } else { builtin(name).unwrap().build().unwrap() };
        let media = |anisotropy: f32| {
            if is_bounded {
                let changed = |medium: &Medium| Medium { anisotropy, ..*medium };
                scene.view().media.iter().map(changed).collect()
            } else {
                media(&scene, anisotropy)
            }
        };
        let (a, left) = picture::<A>(&scene, &media(0.5), &settings);
        let (b, right) = picture::<B>(&scene, &media(0.5), &settings);
        let (shares, of_errors) = (alike(&a, &b), alike_errors(&a, &b));
        eprintln!("{name}: {shares:.4?} of the pixels, {of_errors:.4?} of their errors, {left:?} {right:?}");
        assert!(shares.iter().all(|&share| share >= 0.99), "{name}: {shares:?}");
        // Error statistics show single photons, which differ where devices divide in other ways than the processor: then paths
        // do. `segments.rs` compares those of the same photons.
        let counts = |of: &Tally| [of.absorbed, of.escaped, of.truncated, of.surfaces];
        if counts(&left) == counts(&right) {
            assert!(of_errors.iter().all(|&share| share >= 0.99), "{name}: {of_errors:?}");
        }
        assert!(left.balances() && right.balances() && left.emitted == right.emitted);
        for (a, b) in [
            (left.absorbed, right.absorbed),
            (left.escaped, right.escaped),
            (left.truncated, right.truncated),
            (left.surfaces, right.surfaces),
        ] {
            assert!(a.abs_diff(b) <= a / 500 + 3, "{name}: {left:?} {right:?}");
        }
        let (other, _) = picture::<A>(&scene, &media(-0.5), &settings);
        let shares = alike(&a, &other);
        assert!(alike_errors(&a, &other).iter().all(|&share| share < 0.9), "{name}");
        assert!(shares[Layer::Direct as usize] < 0.9 && shares[Layer::Indirect as usize] < 0.95, "{name}: {shares:?}");
    }
}

/// A grid of densities likewise; the homogeneous medium in its place is not alike.
pub fn pictures_of_a_cloud_are_alike<A: TestBackend, B: TestBackend>() {
    let settings = Settings { photons: 6_000, seed: 4, indirect: Indirect::Map, shadow_rays: 2, ..Settings::default() };
    let scene = builtin("cloud").unwrap().build().unwrap();
    let (a, left) = picture_of::<A>(&scene, &scene.view(), &settings);
    let (b, right) = picture_of::<B>(&scene, &scene.view(), &settings);
    let shares = alike(&a, &b);
    eprintln!("{shares:.4?} of the pixels, {left:?} {right:?}");
    assert!(shares.iter().all(|&share| share >= 0.99), "{shares:?}");
    assert!(left.balances() && right.balances() && left.emitted == right.emitted);
    assert!(left.surfaces.abs_diff(right.surfaces) <= left.surfaces / 500 + 3, "{left:?} {right:?}");
    let homogeneous = SceneView { grids: GridTables::default(), ..scene.view() };
    let (other, _) = picture_of::<A>(&scene, &homogeneous, &settings);
    assert!(alike(&a, &other)[Layer::Indirect as usize] < 0.9);
}
