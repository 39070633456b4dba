//! Settings that a pipeline chooses for the time that there is.

use photon_core::{
    Area, Bandwidth, Candidate, CausticPhotons, Choice, Direct, Film, Goal, Indirect, Open, Pipeline, Render, Settings,
    TransportBackend,
};
use photon_scene::{LightDesc, MaterialDesc, Scene};

use crate::harness::{self, TestBackend, renderer};
use crate::lens::halves;

const SIZE: u32 = 24;
const ALL: Open = Open { photons: false, area: true, radius_factor: true, bandwidth: true, gather_rays: true };
const NONE: Open = Open { photons: false, area: false, radius_factor: false, bandwidth: false, gather_rays: false };

fn scene() -> Scene {
    photon_scene::builtin("textures").unwrap().build().unwrap()
}

fn settings() -> Settings {
    Settings { photons: 6000, seed: 5, area: Area::Surface, ..Settings::default() }
}

/// Enough passes for radii of pixels to be computed.
fn film<B: TransportBackend>(renderer: &mut Pipeline<B>) -> Film {
    (0..9).for_each(|pass| {
        renderer.pass(pass, &mut ()).unwrap();
    });
    renderer.film().unwrap()
}

/// Radii are not enlarged where photons are aimed at caustics that few pixels show, as in `textures`.
pub fn wide_radii_are_left_out_for_small_caustics<T: TestBackend>() {
    let factors = |scene: &Scene, settings: Settings| {
        let mut renderer = renderer::<T>(scene, &settings, SIZE);
        let open = Open { radius_factor: true, ..NONE };
        let choice = renderer.choose(&scene.view(), Goal::Time(0.0), open).unwrap().unwrap();
        let mut factors: Vec<f64> = choice.candidates.iter().map(|candidate| candidate.radius_factor).collect();
        factors.sort_by(f64::total_cmp);
        factors
    };
    let all = [0.5, 0.7, 1.0, 1.4, 2.0];
    assert_eq!(factors(&scene(), settings()), all[..3]);
    let shared = Settings { caustic_photons: CausticPhotons::Shared, ..settings() };
    assert_eq!(factors(&scene(), shared), all);
    let ring = photon_scene::builtin("ring").unwrap().build().unwrap();
    assert_eq!(factors(&ring, settings()), all, "a fifth of the pixels have caustics");
}

/// After a choice, pictures are those of a pipeline that was made with the chosen settings, bit by bit.
pub fn chosen_settings_make_the_same_bits<T: TestBackend>() {
    let scene = scene();
    let chosen = |open: Open, seconds: f64| {
        let mut renderer = renderer::<T>(&scene, &settings(), SIZE);
        let choice = renderer.choose(&scene.view(), Goal::Time(seconds), open).unwrap().unwrap();
        (choice, film(&mut renderer))
    };
    let check = |open: Open, seconds: f64| -> Choice {
        let (choice, found) = chosen(open, seconds);
        let Choice { area, radius_factor, bandwidth, .. } = choice;
        let errors = bandwidth == Bandwidth::PerPixel;
        let given = Settings { area, radius_factor, bandwidth, errors, ..settings() };
        let expected = film(&mut renderer::<T>(&scene, &given, SIZE));
        assert!(found.pixels == expected.pixels && found.errors == expected.errors, "{given:?}");
        let other = Settings { radius_factor: 1.1 * radius_factor, ..given };
        assert!(found.pixels != film(&mut renderer::<T>(&scene, &other, SIZE)).pixels, "other radii go unnoticed");
        let errors: Vec<f64> = choice.candidates.iter().map(|candidate| candidate.error).collect();
        assert!(errors.is_sorted() && errors.iter().all(|error| error.is_finite() && *error > 0.0), "{errors:?}");
        assert!(choice.candidates.iter().all(|candidate| candidate.seconds > 0.0), "{choice:?}");
        choice
    };
    // In no time there is one pass, whatever it takes: areas of surfaces have less bias.
    let hasty = check(ALL, 0.0);
    assert!(hasty.area == Area::Surface && hasty.bandwidth == Bandwidth::Shared, "{hasty:?}");
    assert_eq!(hasty.candidates.len(), 8);
    // In years, each pixel finds its own radius.
    let patient = check(ALL, 1e8);
    assert_eq!((patient.radius_factor, patient.bandwidth), (1.0, Bandwidth::PerPixel), "{patient:?}");
    let radius = check(Open { radius_factor: true, ..NONE }, 1e8);
    assert!(
        radius.radius_factor < hasty.radius_factor && radius.area == Area::Surface && radius.candidates.len() == 3,
        "{radius:?}"
    );
    let area = check(Open { area: true, ..NONE }, 1e8);
    assert!(area.radius_factor == 1.0 && area.candidates.len() == 2, "{area:?}");
    // More paths have smaller radii, which is worth their time if there is enough of it. Fewer would be less than 16 384.
    let paths = |seconds: f64| {
        let mut renderer = renderer::<T>(&scene, &settings(), SIZE);
        renderer.choose(&scene.view(), Goal::Time(seconds), Open { photons: true, ..NONE }).unwrap().unwrap()
    };
    let (few, more) = (paths(0.0), paths(1e8));
    assert_eq!([few.photons, more.photons], [1, 4].map(|times| times * settings().photons), "{few:?}, {more:?}");
    assert_eq!([few.candidates.len(), more.candidates.len()], [2, 2]);
}

/// The number of gather rays is chosen by its forecasts, and makes the bits of a pipeline that was made with it.
pub fn gather_rays_make_the_same_bits<T: TestBackend>() {
    let scene = scene();
    let gathers = |gather_rays: u32| Settings { indirect: Indirect::Gather, gather_rays, ..settings() };
    let mut renderer = renderer::<T>(&scene, &gathers(2), SIZE);
    let choice = renderer.choose(&scene.view(), Goal::Time(10.0), ALL).unwrap().unwrap();
    let rays: Vec<u32> = choice.candidates.iter().filter_map(|candidate| candidate.gather_rays).collect();
    assert!(rays.len() == 3 && rays.contains(&1) && choice.gather_rays == Some(rays[0]), "{choice:?}");
    assert_eq!((choice.radius_factor, choice.bandwidth), (1.0, Bandwidth::Shared));
    // More rays have less noise in a pass: the error is that noise over the number of passes.
    let noise = |rays: u32| {
        let of = choice.candidates.iter().find(|candidate| candidate.gather_rays == Some(rays)).unwrap();
        of.direct_error * (10.0 / of.seconds).floor().max(1.0)
    };
    assert!(noise(16) < noise(4) && noise(4) < noise(1), "{choice:?}");
    let found = film(&mut renderer);
    let expected = film(&mut harness::renderer::<T>(&scene, &gathers(rays[0]), SIZE));
    assert!(found.pixels == expected.pixels, "{choice:?}");
    assert!(found.pixels != film(&mut harness::renderer::<T>(&scene, &gathers(2), SIZE)).pixels, "2 rays go unnoticed");
}

/// Settings can also be chosen for as long as a number of passes takes, and for the time until an error is reached.
pub fn passes_and_errors_are_times<T: TestBackend>() {
    let scene = scene();
    let choice = |goal: Goal| {
        let mut renderer = renderer::<T>(&scene, &settings(), SIZE);
        renderer.choose(&scene.view(), goal, Open { bandwidth: false, ..ALL }).unwrap().unwrap()
    };
    for passes in [1, 50, 4000] {
        let choice = choice(Goal::Passes(passes));
        let present = |each: &&Candidate| each.area == Area::Surface && each.radius_factor == 1.0;
        let present = choice.candidates.iter().find(present).unwrap();
        // As radii shrink, passes become faster: the time of a pass depends on their number, which is rounded.
        let found = choice.seconds / present.seconds;
        assert!((found / f64::from(passes) - 1.0).abs() < 0.03, "{found} of {passes} passes: {choice:?}");
    }
    let error = |error: f64| choice(Goal::Error { error, most_seconds: 1e5 });
    let least = |choice: &Choice| choice.candidates[0].error.sqrt();
    let (easy, usual, none) = (error(100.0), error(0.05), error(1e-9));
    assert!(easy.seconds < 0.1 && none.seconds == 1e5 && least(&none) > 1e-9, "{easy:?} {none:?}");
    // Times differ from trial to trial, but not by a factor of a hundred.
    let before = choice(Goal::Time(usual.seconds / 100.0));
    assert!(least(&usual) <= 0.05 && usual.seconds < 1e5 && least(&before) > 0.05, "{usual:?} {before:?}");
}

/// Side of pictures with an edge in the middle of one column of pixels; trials render all of their pixels.
const EDGE_SIZE: u32 = 39;

/// The forecast noise of one pass that is not by photons, in a picture of a screen with these materials left and right of an edge.
fn noise_at_edge<T: TestBackend>(materials: [MaterialDesc; 2], lit: bool, settings: &Settings) -> f64 {
    let mut builder = halves(materials);
    if lit {
        builder.light("point light", LightDesc::Point { position: [0.0; 3], intensity: [100.0; 3] });
    }
    let scene = builder.build().unwrap();
    let mut renderer = renderer::<T>(&scene, settings, EDGE_SIZE);
    let choice = renderer.choose(&scene.view(), Goal::Passes(1), ALL).unwrap().unwrap();
    let present =
        |each: &&Candidate| (each.area, each.radius_factor, each.bandwidth) == (Area::Surface, 1.0, Bandwidth::Shared);
    let present = choice.candidates.iter().find(present).unwrap();
    assert!(present.error >= present.direct_error, "{present:?}");
    present.direct_error
}

/// Camera rays of one column of 39 pixels meet an edge of light in their middle, and there is no other noise: in each of two passes
/// a pixel is bright or dark. k of these pixels differ between the passes. The variance of these is 1/2 and their weight, by
/// their mean 1/2 and that of the picture, is 1/(1/4 + 1/400) or nearly so: the error of one pass is 0.99 · 2k/39².
///
/// With photons alone, the same noise comes from an edge between colours: without the photons at the points that each pass sees,
/// nothing would differ.
pub fn noise_of_camera_paths_is_forecast<T: TestBackend>() {
    let dark = MaterialDesc::lambert("dark", [0.02; 3]);
    let bright = MaterialDesc::emissive("bright", [0.5; 3], [1.0; 3]);
    let pixels = f64::from(EDGE_SIZE);
    let differ = 0.5 * pixels * pixels * noise_at_edge::<T>([bright, dark.clone()], false, &settings());
    // k has the mean 39/2 and the standard deviation √39/2. The mean radiance is within 10 % of 1/2.
    assert!((differ - 0.5 * pixels).abs() < 4.5 * 0.5 * pixels.sqrt(), "{differ}");
    assert!((differ / differ.round() - 0.99).abs() < 0.002, "{differ}");
    let by_photons = Settings { direct: Direct::Photons, photons: 30_000, ..settings() };
    let differ_in_color = |left: f64| {
        let left = MaterialDesc::lambert("left", [left; 3]);
        0.5 * pixels * pixels * noise_at_edge::<T>([left, dark.clone()], true, &by_photons)
    };
    // Photons make the radiance of these pixels uncertain by some per cent, and so the weights.
    let found = differ_in_color(0.8);
    assert!((found - 0.5 * pixels).abs() < 4.5 * 0.5 * pixels.sqrt() + 0.2 * 0.5 * pixels, "{found}");
    assert!(differ_in_color(0.02) < 0.2 * found, "{found}");
}

/// Nothing is chosen, and no bit changes, where there is nothing to choose.
pub fn nothing_to_choose_changes_nothing<T: TestBackend>() {
    let scene = scene();
    let none = |settings: &Settings, open: Open| {
        let mut chooser = renderer::<T>(&scene, settings, SIZE);
        assert_eq!(chooser.choose(&scene.view(), Goal::Time(1.0), open).unwrap(), None, "{settings:?}");
        let expected = film(&mut renderer::<T>(&scene, settings, SIZE));
        assert!(film(&mut chooser).pixels == expected.pixels, "{settings:?}");
        // Nor after the first pass.
        assert_eq!(chooser.choose(&scene.view(), Goal::Time(1.0), ALL).unwrap(), None);
    };
    none(&settings(), NONE);
    // With final gathering its rays alone may be chosen, and without it they may not.
    none(&Settings { indirect: Indirect::Gather, gather_rays: 1, ..settings() }, Open { gather_rays: false, ..ALL });
    none(&settings(), Open { gather_rays: true, ..NONE });
    let given = Settings { area: Area::Disc, radius_factor: 0.9, errors: true, ..settings() };
    none(&Settings { bandwidth: Bandwidth::PerPixel, ..given }, ALL);
}
