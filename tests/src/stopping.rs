//! Passes that are stopped in the middle.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use photon_core::{
    Blocks, CausticPhotons, Direct, Event, Film, Indirect, Layer, Observer, PassEnd, Pipeline, Render as _, Settings,
    StopCondition, render_blocks,
};
use photon_scene::builtin;

use crate::harness::{TestBackend, renderer};

/// A condition that is met from test number `first` on, from 0, and the number of tests so far.
struct Counting {
    condition: StopCondition,
    tests: Arc<AtomicU64>,
}

impl Counting {
    fn from(first: u64) -> Self {
        let tests = Arc::new(AtomicU64::new(0));
        let counted = Arc::clone(&tests);
        let condition = StopCondition::new(move || counted.fetch_add(1, Ordering::SeqCst) >= first);
        Self { condition, tests }
    }
}

impl Observer for Counting {
    fn on_event(&mut self, _: &Event<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn stop_condition(&self) -> Option<StopCondition> {
        Some(self.condition.clone())
    }
}

/// A renderer whose passes have all stages of surfaces, or those of media.
fn pipeline<T: TestBackend>(name: &str) -> Pipeline<T::On> {
    let scene = builtin(name).unwrap().build().unwrap();
    let (caustic_photons, indirect) = match name {
        "fog" => (CausticPhotons::Shared, Indirect::Map),
        _ => (CausticPhotons::Aimed(1000), Indirect::Gather),
    };
    let settings = Settings {
        photons: 2000,
        camera_samples: 3,
        errors: true,
        caustic_photons,
        indirect,
        seed: 4,
        ..Settings::default()
    };
    renderer::<T>(&scene, &settings, 12)
}

/// The film has the passes before an abandoned one, wherever that ends, and the same pass has the same bits later.
pub fn abandoned_passes_leave_no_trace<T: TestBackend>() {
    for name in ["cornell-glass", "fog"] {
        let mut plain = pipeline::<T>(name);
        let expected: Vec<Film> = (0..2)
            .map(|pass| {
                plain.pass(pass, &mut ()).unwrap();
                plain.film().unwrap()
            })
            .collect();

        let mut stopped = pipeline::<T>(name);
        stopped.pass(0, &mut ()).unwrap();
        let (mut number, mut abandoned) = (0, 0);
        let tests = loop {
            let mut observer = Counting::from(number);
            match stopped.pass(1, &mut observer).unwrap() {
                PassEnd::Cancelled => {
                    abandoned += 1;
                    assert!(stopped.film().unwrap() == expected[0], "{name}: abandoned at test {number}");
                }
                _ => break observer.tests.load(Ordering::SeqCst),
            }
            // Close to each other at first, then further apart.
            number += 1 + number / 3;
        };
        assert!(abandoned > 5 && tests <= number, "{name}: abandoned {abandoned} times, {tests} tests");
        assert!(stopped.film().unwrap() == expected[1], "{name}: after {abandoned} abandoned passes");
    }
}

/// A later pass that is stopped between camera samples, or a first one before the second sample, leaves their number right.
pub fn films_know_their_camera_samples<T: TestBackend>() {
    let scene = builtin("cornell").unwrap().build().unwrap();
    let settings = Settings { photons: 1000, camera_samples: 5, seed: 4, ..Settings::default() };
    let mut renderer = renderer::<T>(&scene, &settings, 12);
    let stop_at = |least: u32| {
        move |event: &Event<'_>| match event {
            Event::Samples { taken, .. } if *taken >= least => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    };
    renderer.pass(0, &mut ()).unwrap();
    let whole = renderer.film().unwrap();
    for least in [1, 2] {
        // No event comes after the first sample if all are traced together.
        if renderer.pass(1, &mut stop_at(least)).unwrap() == PassEnd::Cancelled {
            assert!(renderer.film().unwrap() == whole);
        } else {
            assert_eq!(least, 2);
        }
    }
    renderer.take().unwrap();
    assert!(matches!(renderer.pass(2, &mut stop_at(1)).unwrap(), PassEnd::Last(_)));
    let cut = renderer.film().unwrap();
    assert_eq!((cut.passes, cut.camera_samples), (1, 1));
    assert!(cut.alpha().iter().all(|alpha| (0.0..=1.0).contains(alpha)));
}

/// Blocks that are in a film are kept when the next is abandoned, and the first one of an empty film is rendered.
pub fn blocks_before_an_abandoned_one_are_kept<T: TestBackend>() {
    let mut renderer = pipeline::<T>("cornell-glass");
    let blocks = Blocks::new(0..4, 1).unwrap();
    let mut film = None;
    let mut observer = Counting::from(0);
    let results = render_blocks(&mut renderer, &blocks, &mut film, &mut observer, &mut |_| Ok(())).unwrap();
    assert!(results.outcome.cancelled && results.unfinished.is_none());
    assert_eq!(film.unwrap().passes, 1);
}

/// The first pass of a film has fewer camera samples if the observer stops it between them. Its light is that of a pass of so many,
/// and not darker.
pub fn a_first_pass_may_have_fewer_samples<T: TestBackend>() {
    let scene = builtin("cornell").unwrap().build().unwrap();
    let settings = |camera_samples| Settings { photons: 1000, camera_samples, seed: 4, ..Settings::default() };
    assert_eq!(settings(1).direct, Direct::Nee);
    // So many pixels that a GPU, too, traces few samples together.
    let of = |samples, stop: bool| {
        let mut renderer = renderer::<T>(&scene, &settings(samples), 64);
        let mut observer = |event: &Event<'_>| match event {
            Event::Samples { taken, .. } if stop && *taken > 1 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let end = renderer.pass(0, &mut observer).unwrap();
        assert_eq!(matches!(end, PassEnd::Last(_)), stop);
        let film = renderer.film().unwrap();
        // Another pass does not fit to it.
        match renderer.pass(1, &mut observer) {
            Err(error) => assert!(stop && error.to_string().contains("fewer camera samples"), "{error}"),
            Ok(_) => assert!(!stop),
        }
        renderer.take().unwrap();
        renderer.pass(1, &mut ()).unwrap();
        film
    };
    let cut = of(100, true);
    assert!(cut.cut && cut.passes == 1 && (2..100).contains(&cut.camera_samples), "{}", cut.camera_samples);
    let whole = of(cut.camera_samples, false);
    assert!(!whole.cut);
    for layer in [Layer::Emission, Layer::Direct, Layer::Indirect] {
        assert!(cut.layer(layer) == whole.layer(layer), "{}", layer.name());
    }
}
