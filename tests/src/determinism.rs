//! Determinism: the same seed gives the same bits, however the work is distributed.

use photon_core::{
    Area, Backend, Bandwidth, Budget, CausticPhotons, Direct, Error, Indirect, MapKind, Pipeline, Plan, Render,
    Requirements, Scheduling, Settings, Stage, View, render,
};
use photon_scene::Scene;

use crate::harness::{TestBackend, film, trace};

fn scene() -> Scene {
    photon_scene::builtin("cornell-glass").unwrap().build().unwrap()
}

fn settings() -> Settings {
    let caustic_photons = CausticPhotons::Aimed(2000);
    Settings {
        photons: 6000,
        indirect: Indirect::Gather,
        gather_rays: 2,
        camera_samples: 2,
        seed: 3,
        caustic_photons,
        ..Settings::default()
    }
}

/// Photons, in order, and tallies: with one thread or seven, static or dynamic scheduling, one batch or many.
pub fn photons_do_not_depend_on_sharing<T: TestBackend>() {
    let scene = scene();
    let of = |threads, scheduling, batches: &[u32]| {
        trace::<T>(threads, &scene, &Settings { scheduling, ..settings() }, batches)
    };
    let expected = of(1, Scheduling::Static, &[9000]);
    assert!(expected.0.values().all(|photons| !photons.is_empty()));
    for (threads, scheduling, batches) in [
        (1, Scheduling::Dynamic, vec![9000]),
        (2, Scheduling::Static, vec![9000]),
        (3, Scheduling::Dynamic, vec![9000]),
        (7, Scheduling::Static, vec![1, 4095, 4904]),
        (7, Scheduling::Dynamic, vec![5000, 4000]),
    ] {
        assert!(of(threads, scheduling, &batches) == expected, "{threads} {scheduling:?} {batches:?}");
    }
}

/// Whole images with one, two, three and seven threads.
pub fn pictures_do_not_depend_on_threads<T: TestBackend>() {
    let scene = scene();
    let picture = |threads: usize| {
        let view = View { camera: scene.camera(None, 24, 24).unwrap(), width: 24, height: 24 };
        let mut renderer = Pipeline::new(T::make(threads), &scene.view(), view, settings()).unwrap();
        render(&mut renderer, Budget::passes(2), &mut ()).unwrap();
        renderer.film().unwrap().pixels
    };
    let expected = picture(1);
    for threads in [2, 3, 7] {
        assert!(picture(threads) == expected, "{threads}");
    }
}

/// Whole images, including radii from the pilot, in batches of a few hundred paths, in one batch larger than all
/// paths, and in the default ones.
pub fn pictures_do_not_depend_on_batches<T: TestBackend>() {
    let scene = scene();
    let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    let of = |renderer: Result<Pipeline<T::On>, Error>| {
        let mut renderer = renderer.unwrap();
        render(&mut renderer, Budget::passes(2), &mut ()).unwrap();
        renderer.film().unwrap().pixels
    };
    let expected = of(Pipeline::new(T::make(2), &scene.view(), view, settings()));
    let within = |batch| Pipeline::in_batches(T::make(2), &scene.view(), view, settings(), batch);
    for batch in [777, 6000, u32::MAX] {
        assert!(of(within(batch)) == expected, "batches of {batch}");
    }
    assert!(matches!(within(0), Err(Error::InvalidSetting { name: "batch", .. })));
}

/// A forecast between passes reads the film; what is returned afterwards is that of all passes, also after a restart.
pub fn forecasts_change_nothing<T: TestBackend>() {
    let scene = photon_scene::builtin("cornell").unwrap().build().unwrap();
    let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    let settings = Settings { photons: 2000, errors: true, seed: 5, ..Settings::default() };
    let films = |forecasts: bool| {
        let mut renderer = Pipeline::new(T::make(2), &scene.view(), view, settings.clone()).unwrap();
        let look = |renderer: &mut Pipeline<T::On>| {
            if forecasts {
                renderer.model(0.95).unwrap();
                renderer.model(0.9).unwrap();
            }
        };
        let mut films = Vec::new();
        for seed in [5, 6] {
            for passes in [0..8, 8..9] {
                for index in passes {
                    renderer.pass(index, &mut ()).unwrap();
                }
                look(&mut renderer);
                films.push(renderer.film().unwrap());
                look(&mut renderer);
            }
            if seed == 5 {
                renderer.restart(&scene.view(), 6).unwrap();
            }
        }
        renderer.take().unwrap();
        films.push(renderer.film().unwrap());
        films
    };
    let plain = films(false);
    assert!(plain == films(true));
    assert!(plain.iter().map(|film| film.passes).eq([8, 9, 8, 9, 0]) && plain[0] != plain[2]);
}

/// Requirements that include more than the scene needs change no bit; requirements that include less are an error.
pub fn wider_requirements_change_nothing<T: TestBackend>() {
    for name in ["cornell", "ring", "cornell-glass", "textures", "gloss", "sky", "many-lights"] {
        let scene = photon_scene::builtin(name).unwrap().build().unwrap();
        let settings = Settings { photons: 5000, caustic_photons: CausticPhotons::Aimed(2000), ..Settings::default() };
        let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
        let derived = Requirements::of(&scene.view(), &settings);
        let picture = |required| {
            let on = T::make(2);
            let mut renderer = Pipeline::with_requirements(on, &scene.view(), view, settings.clone(), required)?;
            render(&mut renderer, Budget::passes(2), &mut ())?;
            Ok::<_, Error>((renderer.film()?.pixels, renderer.facts().memory))
        };
        let (least, memory) = picture(derived).unwrap();
        let (most, _) = picture(Requirements::everything(&settings)).unwrap();
        assert!(least == most, "{name}");
        let caustic = memory.iter().any(|(label, _)| label.contains("caustic"));
        assert_eq!(caustic, derived.maps[MapKind::Caustic], "{name}: {memory:?}");
        let mut less = derived;
        less.features = photon_core::Features::NONE;
        assert!(matches!(picture(less), Err(Error::MissingFeatures { .. })), "{name}");
    }
}

/// Passes depend only on their index: merging two films of two passes each gives a film of four, up to the rounding
/// of sums in f64.
pub fn passes_merge<T: TestBackend>() {
    let scene = scene();
    let of = |first: u32, passes: u32| {
        let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
        let mut renderer = Pipeline::new(T::make(2), &scene.view(), view, settings()).unwrap();
        render(&mut renderer, Plan { first, ..Budget::Passes(passes).into() }, &mut ()).unwrap();
        renderer.film().unwrap()
    };
    let whole = of(0, 4);
    let mut merged = of(2, 2);
    merged.merge(&of(0, 2)).unwrap();
    assert_eq!(merged.passes, 4);
    for (a, b) in whole.pixels.iter().zip(&merged.pixels) {
        for (a, b) in a.layers.iter().flatten().zip(b.layers.iter().flatten()) {
            assert!((a - b).abs() <= 1e-12 * a.abs(), "{a} {b}");
        }
    }
    assert!(of(1, 1).pixels != of(0, 1).pixels);
}

/// A backend that has rendered one scene renders another as a fresh backend would, including its memory report; and
/// the first one again.
pub fn one_backend_renders_again<T: TestBackend>() {
    let other = photon_scene::builtin("cornell").unwrap().build().unwrap();
    let kept = Settings { errors: true, photons: 3000, ..Settings::default() };
    let first = (scene(), settings());
    let jobs = [&first, &(other, kept), &first];
    let picture = |on: T::On, (scene, settings): &(Scene, Settings)| {
        let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
        let mut renderer = Pipeline::new(on, &scene.view(), view, settings.clone()).unwrap();
        render(&mut renderer, Budget::passes(2), &mut ()).unwrap();
        let (film, facts) = (renderer.film().unwrap(), renderer.facts());
        (film.pixels, facts.memory, renderer.into_backend().unwrap())
    };
    let mut on = T::make(2);
    for job in jobs {
        let (fresh, fresh_memory, _) = picture(T::make(2), job);
        let (pixels, memory, back) = picture(on, job);
        assert!(pixels == fresh);
        assert_eq!(memory, fresh_memory);
        on = back;
    }
}

/// A pipeline restarted with another seed gives the same bits as one created with that seed, whatever it caches
/// from pass to pass.
pub fn a_restart_is_a_fresh_start<T: TestBackend>() {
    let [glass, cornell, ring] = ["cornell-glass", "cornell", "ring"]
        .map(|name| photon_scene::builtin(name).expect("a built-in scene").build().unwrap());
    let kept = Settings { errors: true, photons: 3000, ..Settings::default() };
    let per_pixel = Settings { bandwidth: Bandwidth::PerPixel, ..kept.clone() };
    let beforehand = Settings { irradiance_every: Some(4), ..settings() };
    // More photons than fit: how many fit depends on the photons of this seed.
    let capped = Settings { memory: Some(8 << 20), photons: 200_000, ..Settings::default() };
    // From the ninth pass on, pixels have individual radii.
    let cases = [
        (&glass, settings(), 2),
        (&cornell, kept, 2),
        (&cornell, per_pixel, 10),
        (&cornell, beforehand, 2),
        (&cornell, capped, 2),
    ];
    for (scene, settings, passes) in cases {
        let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
        let make =
            |seed| Pipeline::new(T::make(2), &scene.view(), view, Settings { seed, ..settings.clone() }).unwrap();
        let draw = |pipeline: &mut Pipeline<T::On>| {
            render(pipeline, Budget::passes(passes), &mut ()).unwrap();
            let film = pipeline.film().unwrap();
            (film.pixels, film.errors, pipeline.facts().photons)
        };
        let expected = draw(&mut make(12));
        let mut pipeline = make(11);
        assert!(draw(&mut pipeline) != expected);
        pipeline.restart(&scene.view(), 12).unwrap();
        assert!(draw(&mut pipeline) == expected);
        assert!(settings.memory.is_none() || expected.2 < settings.photons, "{}", expected.2);
        let other = pipeline.restart(&ring.view(), 12);
        assert!(matches!(other, Err(Error::InvalidInput { what: "scene", .. })));
    }
}

/// A pipeline that goes on with other settings gives the same bits as one created with them, and has the same memory: with
/// other stages and photon maps, more paths, other aimed paths, and direct light by photons, for which the scene is prepared again.
pub fn other_settings_are_a_fresh_start<T: TestBackend>() {
    let [glass, ring, lights] = ["cornell-glass", "ring", "many-lights"]
        .map(|name| photon_scene::builtin(name).expect("a built-in scene").build().unwrap());
    let view = |scene: &Scene| View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    let draw = |pipeline: &mut Pipeline<T::On>| {
        render(pipeline, Budget::passes(2), &mut ()).unwrap();
        let (film, facts) = (pipeline.film().unwrap(), pipeline.facts());
        (film.pixels, film.errors, pipeline.radii(), (facts.photons, facts.aimed, facts.required, facts.memory))
    };
    let seconds = |pipeline: &Pipeline<T::On>, stage| pipeline.facts().setup.get(stage).to_bits();
    let auto = Settings { photons: 3000, seed: 3, ..Settings::default() };
    // Whether the scene is kept, and whether it is searched for mirrors and glass as before.
    let of_glass = [
        (Settings { photons: 7000, errors: true, ..auto.clone() }, true, true),
        (Settings { bandwidth: Bandwidth::PerPixel, errors: true, area: Area::Surface, ..auto.clone() }, true, true),
        (settings(), true, false),
        (Settings { caustic_photons: CausticPhotons::Aimed(500), ..settings() }, true, true),
        (Settings { direct: Direct::Photons, ..auto.clone() }, false, false),
        (Settings { memory: Some(100 << 20), ..auto.clone() }, false, true),
        (Settings { direct: Direct::None, indirect: Indirect::None, ..auto.clone() }, false, false),
    ];
    let of_lights = [(Settings { direct: Direct::Photons, ..auto.clone() }, false, true), (auto.clone(), false, true)];
    for (scene, cases) in [(&glass, of_glass.as_slice()), (&lights, of_lights.as_slice())] {
        let mut pipeline = Pipeline::new(T::make(2), &scene.view(), view(scene), auto.clone()).unwrap();
        let mut last = draw(&mut pipeline);
        for (settings, keeps_scene, keeps_cells) in cases {
            let mut fresh = Pipeline::new(T::make(2), &scene.view(), view(scene), settings.clone()).unwrap();
            let expected = draw(&mut fresh);
            assert!(expected.0 != last.0, "the settings change nothing: {settings:?}");
            let before = [Stage::Bvh, Stage::Project].map(|stage| seconds(&pipeline, stage));
            pipeline = pipeline.with_settings(&scene.view(), settings.clone()).unwrap();
            let after = [Stage::Bvh, Stage::Project].map(|stage| seconds(&pipeline, stage));
            assert_eq!([before[0] == after[0], before[1] == after[1]], [*keeps_scene, *keeps_cells], "{settings:?}");
            last = draw(&mut pipeline);
            assert!(last.0 == expected.0 && last.1 == expected.1, "{settings:?}");
            assert_eq!((&last.2, &last.3), (&expected.2, &expected.3));
        }
        // The seconds for the scene remain those of the first time.
        let before = [Stage::Prepare, Stage::Bvh, Stage::Project].map(|stage| seconds(&pipeline, stage));
        pipeline.restart(&scene.view(), 4).unwrap();
        assert_eq!([Stage::Prepare, Stage::Bvh, Stage::Project].map(|stage| seconds(&pipeline, stage)), before);
        let other = pipeline.with_settings(&ring.view(), auto.clone()).map(drop);
        assert!(matches!(other, Err(Error::InvalidInput { what: "scene", .. })));
    }
}

/// S31: a buffer that is too small reports the size it needs; one that may grow gives the same image as one that
/// was large enough.
pub fn s31_full_photon_buffers<T: TestBackend>() {
    let scene = scene();
    let expected = film::<T>(&scene, &settings(), 1, 16);
    let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    let with = |capacity| {
        let limited = Settings { photon_capacity: Some(capacity), ..settings() };
        let mut renderer = Pipeline::new(T::make(2), &scene.view(), view, limited)?;
        render(&mut renderer, Budget::passes(1), &mut ())?;
        renderer.film()
    };
    match with(100) {
        Err(Error::CapacityExceeded { needed, capacity, .. }) => {
            assert_eq!(capacity, 100);
            assert!(needed > 100);
        }
        other => panic!("{other:?}"),
    }
    assert!(with(100_000).unwrap().pixels == expected.pixels);
    // A capacity that can never be filled is not allocated.
    assert!(with(u64::MAX).unwrap().pixels == expected.pixels);
    // The buffer itself: elements that do not fit are counted, and downloading it is then an error.
    let mut on = T::make(1);
    let buffer = on.upload::<u32>("words", &[1, 2, 3]).unwrap();
    assert_eq!(on.fill(&buffer).unwrap().length, 3);
}
