//! Blocks of passes: any distribution over renderers gives the same bits, and an observer stops them at any event.

use std::ops::ControlFlow;

use photon_core::{
    Blocks, Budget, CausticPhotons, Error, Event, Film, PassSet, Pipeline, Render, Settings, View, render,
    render_blocks,
};
use photon_scene::Scene;

use crate::harness::TestBackend;

fn scene() -> Scene {
    photon_scene::builtin("cornell-glass").unwrap().build().unwrap()
}

fn pipeline<T: TestBackend>(scene: &Scene, settings: &Settings) -> Pipeline<T::On> {
    let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    Pipeline::in_batches(T::make(2), &scene.view(), view, settings.clone(), 1500).unwrap()
}

fn settings() -> Settings {
    let caustic_photons = CausticPhotons::Aimed(2000);
    Settings { photons: 3000, caustic_photons, errors: true, seed: 5, ..Settings::default() }
}

/// An observer that asks to stop at the event with this number alone, and counts events.
fn once(number: u32, events: &mut u32) -> impl FnMut(&Event<'_>) -> ControlFlow<()> {
    move |_| {
        *events += 1;
        if *events == number { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Blocks in one run, by two renderers, and in a run that was stopped and continued: the same film, errors included.
/// Backwards, or in blocks of another size, the sums differ in some bits.
pub fn blocks_add_up<T: TestBackend>() {
    let (scene, settings) = (scene(), settings());
    let mut one = pipeline::<T>(&scene, &settings);
    let mut run = |passes: std::ops::Range<u32>, grain, film: Option<Film>, stop_at| {
        let (mut film, mut events) = (film, 0);
        let blocks = Blocks::new(passes, grain).unwrap();
        let results = render_blocks(&mut one, &blocks, &mut film, &mut once(stop_at, &mut events), &mut |_| Ok(()));
        (film, results.unwrap())
    };
    let expected = run(0..6, 2, None, 0).0.unwrap();
    assert_eq!((expected.passes, &expected.contains), (6, &PassSet::of(5, 0..6)));
    assert!(expected.errors.is_some() && !expected.cut);

    let mut two = pipeline::<T>(&scene, &settings);
    let mut by_two = [0..2, 2..4, 4..6].map(|passes| {
        let on_second = passes.start == 2;
        if on_second {
            let mut film = None;
            render_blocks(&mut two, &Blocks::new(passes, 2).unwrap(), &mut film, &mut (), &mut |_| Ok(())).unwrap();
            film.unwrap()
        } else {
            run(passes, 2, None, 0).0.unwrap()
        }
    });
    let backwards = by_two.iter().rev().fold(None::<Film>, |sum, film| match sum {
        Some(mut sum) => sum.merge(film).map(|()| Some(sum)).unwrap(),
        None => Some(film.clone()),
    });
    let [first, rest @ ..] = &mut by_two;
    rest.iter().for_each(|film| first.merge(film).unwrap());
    assert!(*first == expected, "by two renderers");
    let backwards = backwards.unwrap();
    assert_eq!(backwards.contains, expected.contains);
    assert!(backwards.pixels != expected.pixels, "sums depend on their order");
    assert!(run(0..6, 3, None, 0).0.unwrap().pixels != expected.pixels, "sums depend on the grain");

    // Stopped within the second block, then continued. A pass has two batches of each kind of paths, and its end.
    let (film, stopped) = run(0..6, 2, None, 14);
    assert!(stopped.outcome.cancelled);
    let film = film.unwrap();
    assert_eq!(film.contains, PassSet::of(5, 0..2));
    let rest = Blocks::new(0..6, 2).unwrap().remaining(&film.contains, 5).unwrap().unwrap();
    let (film, _) = run(rest.passes(), 2, Some(film), 0);
    assert!(film.unwrap() == expected, "continued");
    assert!(matches!(
        render_blocks(&mut one, &Blocks::new(4..8, 2).unwrap(), &mut Some(expected.clone()), &mut (), &mut |_| Ok(())),
        Err(Error::PassTwice { seed: 5, .. })
    ));
}

/// Sums of single passes on the host are those of one run: bitwise with sums in f64, and nearly with others.
pub fn single_passes_add_up<T: TestBackend>() {
    let (scene, settings) = (scene(), settings());
    let mut renderer = pipeline::<T>(&scene, &settings);
    render(&mut renderer, Budget::passes(4), &mut ()).unwrap();
    let run = renderer.take().unwrap();
    assert!(renderer.film().unwrap().pixels.iter().all(|pixel| pixel.hits == 0 && pixel.layers == [[0.0; 3]; 4]));
    let mut film = None;
    render_blocks(&mut renderer, &Blocks::new(0..4, 1).unwrap(), &mut film, &mut (), &mut |_| Ok(())).unwrap();
    let film = film.unwrap();
    if renderer.facts().backend == "cpu" {
        assert!(film == run);
    }
    for (a, b) in film.pixels.iter().zip(&run.pixels) {
        for (a, b) in a.layers.iter().flatten().zip(b.layers.iter().flatten()) {
            assert!((a - b).abs() <= 1e-12 * a.abs(), "{a} {b}");
        }
    }
}

/// An observer that asks to stop once, at whichever event, stops the render with that pass; a first pass that it cuts
/// short is marked.
pub fn a_break_said_once_stops<T: TestBackend>() {
    const PASSES: u32 = 3;
    let (scene, settings) = (scene(), settings());
    let mut renderer = pipeline::<T>(&scene, &settings);
    let mut events = 0;
    render(&mut renderer, Budget::passes(PASSES), &mut once(0, &mut events)).unwrap();
    renderer.take().unwrap();
    let each = events / PASSES;
    assert!(each >= 5 && events == PASSES * each, "two batches of each kind of paths, and the end of a pass: {events}");
    for number in 1..=events {
        let mut said = 0;
        let outcome = render(&mut renderer, Budget::passes(PASSES), &mut once(number, &mut said)).unwrap();
        let film = renderer.take().unwrap();
        let pass = (number - 1) / each;
        assert!(outcome.passes <= pass + 1, "event {number}: {} passes", outcome.passes);
        assert_eq!(outcome.passes, film.passes);
        assert_eq!(outcome.cancelled, outcome.passes < PASSES, "event {number}");
        // Only the first pass is kept if it is cut short; the last batch of all does not cut it.
        assert_eq!(film.cut, number + 1 < each, "event {number}");
    }
}

/// Radii can be replaced by those of another renderer, so that a film can be continued; impossible ones are refused.
pub fn radii_are_restored<T: TestBackend>() {
    let (scene, settings) = (scene(), settings());
    let mut first = pipeline::<T>(&scene, &settings);
    let radii = first.radii();
    let mut second = pipeline::<T>(&scene, &Settings { radius_factor: 2.0, ..settings });
    assert!(second.radii() != radii);
    second.set_radii(&radii).unwrap();
    let film = |renderer: &mut Pipeline<T::On>| {
        render(renderer, Budget::passes(1), &mut ()).unwrap();
        renderer.take().unwrap()
    };
    assert!(film(&mut first) == film(&mut second));
    let mut wrong = radii.clone();
    wrong[0] = f32::NAN;
    for wrong in [wrong, radii[1..].to_vec()] {
        assert!(matches!(second.set_radii(&wrong), Err(Error::InvalidInput { what: "radius", .. })));
    }
}
