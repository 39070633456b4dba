//! A15, A16: radii and the footprints of pixels.

use std::f64::consts::PI;

use photon_core::{Direct, Estimator, Film, Indirect, Layer, Render, Settings};
use photon_scene::{LightDesc, MaterialDesc, Scene, SceneBuilder};

use crate::harness::{TestBackend, look_at_point, renderer};
use crate::stats::{agrees, moments, standard_error};

const MIRROR: f64 = 0.9;
const FLOOR: f64 = 0.5;

/// Half the side of the picture.
const HALF: f64 = 0.2;

/// A beam that a mirror above directs at the floor, where it is less than 2 mm wide; a camera looks straight down on
/// 40 cm around it. If `glows`, there is a light source in the picture.
fn beam(glows: bool) -> Scene {
    let mut builder = SceneBuilder::new();
    let floor = builder.material(MaterialDesc::lambert("floor", [FLOOR; 3]));
    let mirror = builder.material(MaterialDesc::mirror("mirror", [MIRROR; 3]));
    builder.quad("floor", [[-1.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], floor);
    builder.quad("mirror", [[0.3, 2.0, -0.2], [0.7, 2.0, -0.2], [0.7, 2.0, 0.2], [0.3, 2.0, 0.2]], mirror);
    if glows {
        let tile = builder.material(MaterialDesc::emissive("tile", [0.0; 3], [1.0; 3]));
        builder.quad("tile", [[1.4, 0.01, 0.1], [1.6, 0.01, 0.1], [1.6, 0.01, 0.05], [1.4, 0.01, 0.05]], tile);
    }
    let (inner_angle, outer_angle) = (1e-4, 2e-4);
    let (position, direction) = ([0.0, 1.0, 0.0], [0.5, 1.0, 0.0]);
    builder.light("beam", LightDesc::Spot { position, direction, intensity: [1.0; 3], inner_angle, outer_angle });
    // Not at the centre of the picture, where four pixels meet.
    look_at_point(&mut builder, [1.504, 0.0, 0.007], [0.0, 1.0, 0.0], 1.0, HALF);
    builder.build().unwrap()
}

fn settings() -> Settings {
    Settings { photons: 2000, direct: Direct::None, indirect: Indirect::None, alpha: 1.0, ..Settings::default() }
}

/// The caustic layer of each of several passes, as a share of the light's power: its radiance times the area of a
/// pixel, summed over the picture.
fn found<T: TestBackend>(scene: &Scene, settings: &Settings, size: u32) -> Vec<f64> {
    let mut on = renderer::<T>(scene, settings, size);
    let view = scene.view();
    let side = f64::from(view.units.length(2.0 * HALF / f64::from(size)));
    let power = view.lights.iter().flat_map(|light| light.power).map(f64::from).sum::<f64>();
    let sum = |film: Film| film.pixels.iter().flat_map(|pixel| pixel.layers[Layer::Caustic as usize]).sum::<f64>();
    (0..300)
        .map(|pass| {
            on.pass(pass, &mut ()).unwrap();
            sum(on.take().unwrap()) * side * side / power
        })
        .collect()
}

/// A15: the light of a spot that is far narrower than a pixel is found: over the picture, radiance times area is ρ·a/π times
/// the power, with the reflectance ρ of the mirror and the albedo a of the floor. With the radius that the density of its
/// photons suggests, hardly any camera ray meets it.
pub fn a15_spots_narrower_than_a_pixel_are_found<T: TestBackend>() {
    let (scene, size) = (beam(false), 16);
    let expected = MIRROR * FLOOR / PI;
    // √(4 w²/(3 π r²)) = 1.3 in a pass, for the kernel of Epanechnikov and a radius r of half the width w.
    let is_found = |shares: &[f64]| {
        let (mean, error) = (moments(shares).0, standard_error(shares));
        error < 1.3 * expected / 300.0_f64.sqrt() && agrees(mean, expected, error, 0.0)
    };
    let shares = found::<T>(&scene, &settings(), size);
    assert!(is_found(&shares), "{} ± {} of {expected}", moments(&shares).0, standard_error(&shares));
    // 12 of 2000 photons in an ellipse of 0.7 by 0.8 mm: in 300 passes, less than one camera ray is expected to meet it.
    let narrow = Settings { estimator: Estimator::Radius { radius: Some(6e-5) }, ..settings() };
    assert!(!is_found(&found::<T>(&scene, &narrow, size)));
}

/// A16: the radius is half the width of a pixel where that is larger than the radius by density; elsewhere the picture
/// does not change it, not by a bit.
pub fn a16_radii_are_at_least_half_a_pixel<T: TestBackend>() {
    let scene = beam(false);
    // With 400, pixels are joined for the search.
    for size in [8, 16, 40, 400] {
        let radii = renderer::<T>(&scene, &settings(), size).radii();
        let half = 0.5 * scene.view().units.length(2.0 * HALF / f64::from(size));
        assert!((radii[0] / half - 1.0).abs() < 1e-5, "{size}: {radii:?} {half}");
    }
    // Joined pixels have a film of their own, which is not reported.
    let film = |estimator| {
        let facts = renderer::<T>(&beam(true), &Settings { estimator, ..settings() }, 200).facts();
        facts.memory.iter().find(|(label, _)| label == "film").map(|(_, bytes)| *bytes)
    };
    let of = |radius| film(Estimator::Radius { radius });
    assert!(of(None).is_some() && of(None) == of(Some(1.0)), "{:?} {:?}", of(None), of(Some(1.0)));
    let scene = photon_scene::builtin("cornell-glass").unwrap().build().unwrap();
    let settings = Settings { photons: 20_000, ..Settings::default() };
    let radii = |size| renderer::<T>(&scene, &settings, size).radii();
    let fine = radii(64);
    assert_eq!(fine, radii(128));
    let coarse = radii(4);
    assert!(coarse[0] > 2.0 * fine[0], "{coarse:?} {fine:?}");
    // A film is continued with the radii that are stored in it, and nothing of the pilot pass is in the picture.
    let scene = beam(true);
    let settings = Settings { photons: 2000, ..Settings::default() };
    let mut derived = renderer::<T>(&scene, &settings, 16);
    let given = Settings { estimator: Estimator::Radius { radius: Some(1.0) }, ..settings.clone() };
    let mut stored = renderer::<T>(&scene, &given, 16);
    stored.set_radii(&derived.radii()).unwrap();
    derived.pass(0, &mut ()).unwrap();
    stored.pass(0, &mut ()).unwrap();
    let (derived, stored) = (derived.film().unwrap(), stored.film().unwrap());
    assert_eq!(derived.pixels, stored.pixels);
    let emitted: f64 = derived.pixels.iter().flat_map(|pixel| pixel.layers[Layer::Emission as usize]).sum();
    assert!(emitted > 0.0);
}
