//! Settings that a pipeline chooses for the time that there is.

use photon_core::{
    Area, Bandwidth, Candidate, Choice, Film, Goal, Indirect, Open, Pipeline, Render, Settings, TransportBackend,
};
use photon_scene::Scene;

use crate::harness::{self, TestBackend, renderer};

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
    assert_eq!(hasty.candidates.len(), 12);
    // In years, each pixel finds its own radius.
    let patient = check(ALL, 1e8);
    assert_eq!((patient.radius_factor, patient.bandwidth), (1.0, Bandwidth::PerPixel), "{patient:?}");
    let radius = check(Open { radius_factor: true, ..NONE }, 1e8);
    assert!(
        radius.radius_factor < hasty.radius_factor && radius.area == Area::Surface && radius.candidates.len() == 5,
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
