//! Out of memory and device lost at each step of a render: the result is a typed error, no message of the
//! validation layer, and the image of the completed passes.

#![expect(clippy::unwrap_used, reason = "test code")]

use backend_vulkan::{Vulkan, low_level};
use photon_core::{Direct, Error, Film, Indirect, PassEnd, Pipeline, Render, Result, Settings, View};
use photon_scene::{Scene, builtin};

fn settings() -> Settings {
    Settings {
        photons: 400,
        max_bounces: 8,
        direct: Direct::Photons,
        indirect: Indirect::Gather,
        gather_rays: 1,
        camera_samples: 3,
        ..Settings::default()
    }
}

fn start(on: Vulkan, scene: &Scene) -> Result<Pipeline<Vulkan>> {
    let view = View { camera: scene.camera(None, 4, 4).unwrap(), width: 4, height: 4 };
    Pipeline::new(on, &scene.view(), view, settings())
}

/// Renders two passes; returns the number of completed passes, the error, and the film.
fn render(on: Vulkan, scene: &Scene) -> (u32, Option<Error>, Option<Film>) {
    let mut renderer = match start(on, scene) {
        Ok(renderer) => renderer,
        Err(error) => return (0, Some(error), None),
    };
    for pass in 0..2 {
        match renderer.pass(pass, &mut ()) {
            Ok(PassEnd::Done(_)) => {}
            Ok(other) => panic!("{other:?}"),
            Err(error) => return (pass, Some(error), renderer.film().ok()),
        }
    }
    (2, None, renderer.film().ok())
}

/// A render without faults: its allocations and submissions, and its film after one pass and after two.
struct Whole {
    work: (u64, u64),
    films: [Film; 2],
}

fn whole(scene: &Scene) -> Option<Whole> {
    let on = low_level::for_tests()?;
    let mut renderer = start(on, scene).unwrap();
    renderer.pass(0, &mut ()).unwrap();
    renderer.pass(1, &mut ()).unwrap();
    let work = low_level::work_so_far(renderer.backend());
    // Once more, reading the film after the first pass.
    let mut renderer = start(low_level::for_tests()?, scene).unwrap();
    let films = [0, 1].map(|pass| {
        renderer.pass(pass, &mut ()).unwrap();
        renderer.film().unwrap()
    });
    Some(Whole { work, films })
}

/// Numbers from 0 to below `count`: all of them, or a few pseudo-random ones if there are many.
fn steps(count: u64) -> Vec<u64> {
    let most = std::env::var("PHOTON_FAULTS").ok().and_then(|most| most.parse().ok()).unwrap_or(4_u64);
    if count <= most {
        return (0..count).collect();
    }
    // The last, the first, and pseudo-random ones in between.
    (0..most).map(|i| if i == 0 { count - 1 } else { (i * i * 40_503 + i) % count }).collect()
}

fn check(scene: &Scene, whole: &Whole, fault: impl Fn(&Vulkan), expected: impl Fn(&Error) -> bool) {
    let on = low_level::for_tests().unwrap();
    fault(&on);
    let (passes, error, film) = render(on, scene);
    let error = error.unwrap();
    assert!(expected(&error), "{error:?}");
    // If there is memory left to read the film, it holds the first pass.
    if let (1, Some(film)) = (passes, film) {
        assert!(film.pixels == whole.films[0].pixels, "the film differs from the first pass");
    }
}

#[test]
fn memory_that_runs_out_at_any_step_is_an_error() {
    let scene = builtin("cornell-glass").unwrap().build().unwrap();
    let Some(whole) = whole(&scene) else { return };
    assert!(whole.work.0 > 20, "{:?}", whole.work);
    for at in steps(whole.work.0) {
        let expected = |error: &Error| matches!(error, Error::OutOfMemory { .. });
        check(&scene, &whole, |on| low_level::inject_faults(on, Some(at), None), expected);
    }
}

#[test]
fn a_device_that_is_lost_at_any_step_is_an_error() {
    let scene = builtin("cornell-glass").unwrap().build().unwrap();
    let Some(whole) = whole(&scene) else { return };
    assert!(whole.work.1 > 10, "{:?}", whole.work);
    for at in steps(whole.work.1) {
        let expected = |error: &Error| matches!(error, Error::DeviceLost);
        check(&scene, &whole, |on| low_level::inject_faults(on, None, Some(at)), expected);
    }
}

/// Out of memory in the second pass: the film is that of the first.
#[test]
fn what_earlier_passes_gave_is_kept() {
    let scene = builtin("cornell-glass").unwrap().build().unwrap();
    let Some(whole) = whole(&scene) else { return };
    let mut renderer = start(low_level::for_tests().unwrap(), &scene).unwrap();
    renderer.pass(0, &mut ()).unwrap();
    let (allocations, _) = low_level::work_so_far(renderer.backend());
    low_level::inject_faults(renderer.backend(), Some(allocations + 1), None);
    let error = renderer.pass(1, &mut ()).unwrap_err();
    assert!(matches!(error, Error::OutOfMemory { .. }), "{error:?}");
    low_level::inject_faults(renderer.backend(), None, None);
    assert!(renderer.film().unwrap().pixels == whole.films[0].pixels);
    // Rendering can continue.
    renderer.pass(1, &mut ()).unwrap();
    assert!(renderer.film().unwrap().pixels == whole.films[1].pixels);
}

/// The checks can fail: without an injected fault there is no error.
#[test]
fn without_faults_there_is_no_error() {
    let scene = builtin("cornell").unwrap().build().unwrap();
    if let Some(on) = low_level::for_tests() {
        let (passes, error, film) = render(on, &scene);
        assert!(passes == 2 && error.is_none() && film.is_some(), "{error:?}");
    }
}
