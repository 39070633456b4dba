//! Media with grids of densities: closed forms, and what is the same as a homogeneous medium.

use std::f64::consts::PI;

use photon_core::{Direct, Indirect, Layer, PassEnd, Pipeline, Render as _, Settings, Tally, View};
use photon_scene::{CameraDesc, GridDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, Surface, shapes};

use crate::harness::{TestBackend, direct_settings};
use crate::media::cases;
use crate::stats::{assert_agrees, moments, standard_error};

fn camera(builder: &mut SceneBuilder, position: [f64; 3], direction: [f64; 3], half_height: f64) {
    let projection = Projection::Orthographic { half_height };
    builder.camera("ray", CameraDesc::new(position, direction, [0.0, 1.0, 0.0], projection));
}

/// A box with this medium at density 1, and densities.
fn add_box(builder: &mut SceneBuilder, bounds: [[f64; 3]; 2], coefficients: [f64; 2], grid: Option<GridDesc>) {
    let [scattering, absorption] = coefficients.map(|coefficient| [coefficient; 3]);
    let boundary = MaterialDesc::boundary("body", absorption).with_scattering(scattering, 0.0);
    add_body(builder, bounds, boundary, grid);
}

/// A box of this material.
fn add_body(builder: &mut SceneBuilder, [low, high]: [[f64; 3]; 2], mut desc: MaterialDesc, grid: Option<GridDesc>) {
    desc.grid = grid;
    let material = builder.material(desc);
    let (positions, triangles) = shapes::cuboid(low, high);
    builder.mesh("body", positions, triangles, material);
}

/// Means over the pixels of the first channel, of each pass, and the tally of all.
fn per_pass<T: TestBackend>(scene: &Scene, settings: &Settings, passes: u32, size: u32) -> (Vec<f64>, Tally) {
    let view = View { camera: scene.camera(None, size, size).unwrap(), width: size, height: size };
    let mut settings = settings.clone();
    settings.photons = settings.photons.div_ceil(T::ONE_OF);
    let mut renderer: Pipeline<T::On> = Pipeline::new(T::make(2), &scene.view(), view, settings).unwrap();
    let (mut found, mut before, mut tally) = (Vec::new(), 0.0, Tally::default());
    for pass in 0..passes {
        let PassEnd::Done(report) = renderer.pass(pass, &mut ()).unwrap() else { panic!("the pass ended early") };
        tally = report.tally;
        let film = renderer.film().unwrap();
        let of = |layer: Layer| film.pixels.iter().map(|pixel| pixel.layers[layer as usize][0]).sum::<f64>();
        let sum = Layer::ALL.map(of).iter().sum::<f64>() / film.pixels.len() as f64 * film.units.radiance_to_user();
        found.push(sum - std::mem::replace(&mut before, sum));
    }
    (found, tally)
}

fn assert_mean(what: &str, values: &[f64], truth: f64, relative: f64) {
    let error = standard_error(values);
    assert!(error < 0.05 * truth, "{what}: too noisy, {} ± {error}", moments(values).0);
    assert_agrees(what, moments(values).0, truth, error, relative * truth);
}

/// Densities that rise evenly along x from 0 to 1 in a box.
fn slope(cells: u32, low: [f64; 3], high: [f64; 3]) -> GridDesc {
    let densities: Vec<f32> = (0..cells).map(|cell| (cell as f32 + 0.5) / cells as f32).collect();
    GridDesc::new([cells, 1, 1], densities).with_box(low, high)
}

/// A point light inside a body whose density rises along the view, seen from within: P2 with the densities of every place, integrated
/// numerically; columns of a slope are means of its ends.
pub fn airlight_in_a_slope<T: TestBackend>() {
    let (low, high) = ([-1.0, -2.0, -2.0], [11.0, 2.0, 2.0]);
    let (scattering, absorption, power) = (0.12, 0.12, 100.0);
    let mut builder = SceneBuilder::new();
    let black = builder.material(MaterialDesc::lambert("wall", [0.0; 3]));
    let x = 10.0;
    builder.quad("wall", [[x, -0.3, 0.3], [x, 0.3, 0.3], [x, 0.3, -0.3], [x, -0.3, -0.3]], black);
    builder.light("point", LightDesc::Point { position: [5.0, 1.0, 0.0], intensity: [power / (4.0 * PI); 3] });
    add_box(&mut builder, [low, high], [scattering, absorption], Some(slope(240, low, high)));
    camera(&mut builder, [0.0; 3], [1.0, 0.0, 0.0], 1e-3);
    let scene = builder.build().unwrap();
    let density = |x: f64| (x + 1.0) / 12.0;
    let steps = 20_000;
    let radiance = |density: &dyn Fn(f64) -> f64| {
        let at = |step: i32| {
            let t = x * (f64::from(step) + 0.5) / f64::from(steps);
            let squared = (t - 5.0).powi(2) + 1.0;
            let column = 0.5 * (t * (density(0.0) + density(t)) + squared.sqrt() * (density(t) + density(5.0)));
            scattering * density(t) * power * (-(scattering + absorption) * column).exp() / (16.0 * PI * PI * squared)
        };
        (0..steps).map(at).sum::<f64>() * x / f64::from(steps)
    };
    let expected = radiance(&density);
    let settings = Settings { shadow_rays: 8, ..direct_settings(Direct::Nee, 0.1) };
    let (found, _) = per_pass::<T>(&scene, &settings, 24, 8);
    assert_mean("airlight in a slope", &found, expected, 1e-4);
    // The comparison sees the homogeneous medium of the mean density.
    assert!((radiance(&|_| 0.5) / expected - 1.0).abs() > 0.02, "{expected}");
}

/// P18: through a body that absorbs 4x on 0…1 an even wall has e⁻² of its radiance.
pub fn slopes_let_light_through<T: TestBackend>() {
    let (low, high) = ([0.0, -1.0, -1.0], [1.0, 1.0, 1.0]);
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::emissive("wall", [0.0; 3], [1.0; 3]));
    builder.quad("wall", [[2.0, -2.0, 2.0], [2.0, 2.0, 2.0], [2.0, 2.0, -2.0], [2.0, -2.0, -2.0]], wall);
    add_box(&mut builder, [low, high], [0.0, 4.0], Some(slope(64, low, high)));
    // Something that light is seen on.
    let grey = builder.material(MaterialDesc::lambert("floor", [0.5; 3]));
    builder.quad("floor", [[1.2, -2.1, 2.0], [2.0, -2.1, 2.0], [2.0, -2.1, -2.0], [1.2, -2.1, -2.0]], grey);
    camera(&mut builder, [-1.0, 0.1, 0.2], [1.0, 0.0, 0.0], 1e-3);
    let scene = builder.build().unwrap();
    let (found, _) = per_pass::<T>(&scene, &direct_settings(Direct::Nee, 0.1), 1, 4);
    // Sums of 64 parts, each rounded.
    assert!((found[0] / (-2.0_f64).exp() - 1.0).abs() < 4e-6, "{found:?}");
}

/// P13: a cloud that absorbs nothing in even light looks like the light, and every path is accounted for.
pub fn clouds_in_even_light<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let light = builder.material(MaterialDesc::emissive("shell", [0.0; 3], [1.0; 3]));
    let (positions, triangles) = shapes::flip(shapes::icosphere(3, [0.0; 3], 1.5));
    builder.mesh("shell", positions, triangles, light);
    // Dense and empty parts, which vary little within the radius of estimates.
    let densities: Vec<f32> = (0..125).map(|cell| (cell * 7 % 5) as f32 / 4.0).collect();
    let bounds = [[-0.8; 3], [0.8; 3]];
    let grid = GridDesc::new([5; 3], densities).with_box(bounds[0], bounds[1]);
    // Thick: photons are stored where they collide.
    add_box(&mut builder, bounds, [8.0, 0.0], Some(grid));
    camera(&mut builder, [-1.2, 0.01, 0.02], [1.0, 0.0, 0.0], 0.1);
    let scene = builder.build().unwrap();
    let indirect = Indirect::Map;
    let settings =
        Settings { photons: 60_000, max_bounces: 400, caustics: true, indirect, ..direct_settings(Direct::Nee, 0.04) };
    let (found, tally) = per_pass::<T>(&scene, &settings, 16, 8);
    assert!(tally.balances(), "{tally:?}");
    assert_mean("cloud in even light", &found, 1.0, 1e-2);
}

/// An even grid of half the density, scaled twice, is the homogeneous medium, behind a boundary and in a solid: the same paths,
/// and the same pictures but for rounding; another density is not. Light that enters a solid leaves so many photons that searches
/// along segments pause on devices that end long loops.
pub fn even_grids_are_homogeneous<T: TestBackend>() {
    let bounds = [[-0.8; 3], [0.8; 3]];
    let clear = Surface::Dielectric { ior: 1.0, absorption: [0.2; 3], tint: [1.0; 3], roughness: 0.0 };
    let bodies = [MaterialDesc::boundary("body", [0.2; 3]), MaterialDesc::new("body", clear)];
    let render = |body: &MaterialDesc, grid: Option<GridDesc>| {
        let mut builder = SceneBuilder::new();
        let grey = builder.material(MaterialDesc::lambert("floor", [0.5; 3]));
        builder.quad("floor", [[-2.0, -1.0, 2.0], [2.0, -1.0, 2.0], [2.0, -1.0, -2.0], [-2.0, -1.0, -2.0]], grey);
        builder.light("point", LightDesc::Point { position: [0.3, 2.0, 0.4], intensity: [1.0; 3] });
        add_body(&mut builder, bounds, body.clone().with_scattering([1.0; 3], 0.0), grid);
        camera(&mut builder, [-3.0, 0.1, 0.2], [1.0, 0.0, 0.0], 1.0);
        let indirect = Indirect::Map;
        let settings = Settings { photons: 20_000, caustics: true, indirect, ..direct_settings(Direct::Nee, 0.1) };
        per_pass::<T>(&builder.build().unwrap(), &settings, 1, 16)
    };
    let even = |density: f32| {
        let grid = GridDesc::new([20, 9, 1], vec![density; 180]);
        // Beyond the body, whose faces round differently.
        Some(grid.with_box([-1.0; 3], [1.0; 3]).with_density_scale(2.0))
    };
    for body in cases::<T, _>(&bodies) {
        let ((homogeneous, plain), (gridded, with_grid)) = (render(body, None), render(body, even(0.5)));
        // In 40 passes columns, rounded sums, changed no picture by more than 6e-8, and the way of none of 800,000 paths.
        assert!((gridded[0] / homogeneous[0] - 1.0).abs() < 1e-6, "{gridded:?} {homogeneous:?}");
        let ends = |tally: Tally| [tally.absorbed, tally.escaped, tally.truncated, tally.surfaces];
        assert_eq!(ends(plain), ends(with_grid));
        let (thinner, _) = render(body, even(0.25));
        assert!((thinner[0] / homogeneous[0] - 1.0).abs() > 0.1, "{thinner:?} {homogeneous:?}");
    }
}

/// A thick grid of colours that absorb, whose photons are stored where they collide, scatters as much as the homogeneous medium,
/// whose photons are stored where they are expected to.
pub fn thick_grids_scatter_as_much<T: TestBackend>() {
    let bounds = [[-0.8; 3], [0.8; 3]];
    let body = MaterialDesc::boundary("body", [1.0, 2.0, 0.5]).with_scattering([6.0, 12.0, 9.0], 0.3);
    let render = |grid: Option<GridDesc>| {
        let mut builder = SceneBuilder::new();
        let grey = builder.material(MaterialDesc::lambert("floor", [0.5; 3]));
        builder.quad("floor", [[-2.0, -1.0, 2.0], [2.0, -1.0, 2.0], [2.0, -1.0, -2.0], [-2.0, -1.0, -2.0]], grey);
        // All of its light enters the body.
        let spot = LightDesc::Spot {
            position: [-2.3, 1.0, 0.4],
            direction: [2.3, -1.0, -0.4],
            intensity: [1.0; 3],
            inner_angle: 0.2,
            outer_angle: 0.3,
        };
        builder.light("spot", spot);
        add_body(&mut builder, bounds, body.clone(), grid);
        camera(&mut builder, [-3.0, 0.1, 0.2], [1.0, 0.0, 0.0], 0.6);
        let settings = Settings { photons: 20_000, indirect: Indirect::Map, ..direct_settings(Direct::None, 0.1) };
        per_pass::<T>(&builder.build().unwrap(), &settings, 16, 8).0
    };
    let even = GridDesc::new([20, 9, 5], vec![1.0; 900]).with_box([-1.0; 3], [1.0; 3]);
    let (homogeneous, gridded) = (render(None), render(Some(even)));
    let differences: Vec<f64> = homogeneous.iter().zip(&gridded).map(|(a, b)| a - b).collect();
    let (mean, _) = moments(&homogeneous);
    let error = standard_error(&differences);
    // Without the albedo, which is at least 0.86, it would be a seventh.
    assert!(error < 0.02 * mean, "too noisy: {mean} ± {error}");
    assert_agrees("difference", moments(&differences).0, 0.0, error, 0.0);
    assert!(homogeneous != gridded);
}
