//! Blocks of passes: any order of rendering gives the same bits, and an observer stops them at any event.

use std::ops::{ControlFlow, Range};

use photon_core::{
    BlockOutcome, Blocks, Budget, CausticPhotons, Error, ErrorTarget, Event, Film, PassSet, Pipeline, Render, Settings,
    View, render, render_blocks, render_blocks_in_parallel,
};

use crate::harness::TestBackend;

/// The renderer of all checks, since some backends take seconds to make one.
fn pipeline<T: TestBackend>() -> Pipeline<T::On> {
    let scene = photon_scene::builtin("cornell-glass").unwrap().build().unwrap();
    let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    let caustic_photons = CausticPhotons::Aimed(2000);
    let settings = Settings { caustic_photons, ..settings() };
    Pipeline::in_batches(T::make(2), &scene.view(), view, settings, 1500).unwrap()
}

fn settings() -> Settings {
    Settings { photons: 3000, errors: true, seed: 5, ..Settings::default() }
}

/// An observer that asks to stop at the event with this number alone, and counts events.
fn once(number: u32, events: &mut u32) -> impl FnMut(&Event<'_>) -> ControlFlow<()> {
    move |_| {
        *events += 1;
        if *events == number { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// All checks with one renderer.
pub fn films_of_blocks<T: TestBackend>() {
    let mut renderer = pipeline::<T>();
    blocks_add_up(&mut renderer);
    single_passes_add_up(&mut renderer);
    a_break_said_once_stops(&mut renderer);
    radii_are_restored(&mut renderer);
    a_target_ends_blocks::<T>(&mut renderer);
    renderers_share_blocks::<T>(renderer);
}

/// The film of blocks that are added to `film`, and whether the observer stopped them at event `stop_at`.
fn blocks(
    renderer: &mut dyn Render,
    passes: Range<u32>,
    grain: u32,
    mut film: Option<Film>,
    stop_at: u32,
) -> (Film, bool) {
    let (blocks, mut events) = (Blocks::new(passes, grain).unwrap(), 0);
    let results = render_blocks(renderer, &blocks, &mut film, &mut once(stop_at, &mut events), &mut |_| Ok(()));
    (film.unwrap(), results.unwrap().outcome.cancelled)
}

/// Blocks in one run, rendered in another order, and in a run that was stopped and continued: the same film, errors
/// included. Added backwards, or in blocks of another size, the sums differ in some bits.
fn blocks_add_up(renderer: &mut dyn Render) {
    let mut run = |passes, grain, film, stop_at| blocks(renderer, passes, grain, film, stop_at);
    let expected = run(0..6, 2, None, 0).0;
    assert_eq!((expected.passes, &expected.contains), (6, &PassSet::of(5, 0..6)));
    assert!(expected.errors.is_some() && !expected.cut);

    let [middle, first, last] = [2..4, 0..2, 4..6].map(|passes| run(passes, 2, None, 0).0);
    let sum = |films: [&Film; 3]| {
        let mut sum = films[0].clone();
        films[1..].iter().for_each(|film| sum.merge(film).unwrap());
        sum
    };
    assert!(sum([&first, &middle, &last]) == expected, "rendered in another order");
    let backwards = sum([&last, &middle, &first]);
    assert!(
        backwards.contains == expected.contains && backwards.pixels != expected.pixels,
        "sums depend on their order"
    );
    assert!(run(0..6, 3, None, 0).0.pixels != expected.pixels, "sums depend on the grain");

    // Stopped within the second block, then continued. A pass has two batches of each kind of paths, and its end.
    let (film, stopped) = run(0..6, 2, None, 14);
    assert!(stopped && film.contains == PassSet::of(5, 0..2));
    let rest = Blocks::new(0..6, 2).unwrap().remaining(&film.contains, 5).unwrap().unwrap();
    assert!(run(rest.passes(), 2, Some(film), 0).0 == expected, "continued");
    let twice = Blocks::new(4..8, 2).unwrap();
    assert!(matches!(
        render_blocks(renderer, &twice, &mut Some(expected.clone()), &mut (), &mut |_| Ok(())),
        Err(Error::PassTwice { seed: 5, .. })
    ));
}

/// Sums of single passes on the host are those of one run: bitwise with sums in f64, and nearly with others.
fn single_passes_add_up(renderer: &mut dyn Render) {
    render(renderer, Budget::passes(4), &mut ()).unwrap();
    let run = renderer.take().unwrap();
    assert!(renderer.film().unwrap().pixels.iter().all(|pixel| pixel.hits == 0 && pixel.layers == [[0.0; 3]; 4]));
    let (film, _) = blocks(renderer, 0..4, 1, None, 0);
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
fn a_break_said_once_stops(renderer: &mut dyn Render) {
    const PASSES: u32 = 3;
    let mut events = 0;
    render(renderer, Budget::passes(PASSES), &mut once(0, &mut events)).unwrap();
    renderer.take().unwrap();
    let each = events / PASSES;
    assert!(each >= 5 && events == PASSES * each, "two batches of each kind of paths, and the end of a pass: {events}");
    for number in 1..=events {
        let mut said = 0;
        let outcome = render(renderer, Budget::passes(PASSES), &mut once(number, &mut said)).unwrap();
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
fn radii_are_restored(renderer: &mut dyn Render) {
    let radii = renderer.radii();
    let (expected, _) = blocks(renderer, 0..1, 1, None, 0);
    let wider: Vec<f32> = radii.iter().map(|radius| 2.0 * radius).collect();
    renderer.set_radii(&wider).unwrap();
    assert!(blocks(renderer, 0..1, 1, None, 0).0.pixels != expected.pixels);
    let mut wrong = radii.clone();
    wrong[0] = f32::NAN;
    for wrong in [wrong, radii[1..].to_vec()] {
        assert!(matches!(renderer.set_radii(&wrong), Err(Error::InvalidInput { what: "radius", .. })));
    }
    renderer.set_radii(&radii).unwrap();
    assert!(blocks(renderer, 0..1, 1, None, 0).0 == expected);
}

/// A target error ends the render at the same pass, with the same bits: without interruption, continued after one, and on
/// two devices. A film that has reached it gets no more passes.
fn a_target_ends_blocks<T: TestBackend>(renderer: &mut dyn Render) {
    let until =
        |target| Blocks::new(0..48, 2).unwrap().with_target(ErrorTarget::new(target, 0.9, &settings()).unwrap());
    let look = ErrorTarget::new(1e-6, 0.9, &settings()).unwrap();
    let run = |renderer: &mut dyn Render, target, film: &mut Option<Film>, stop_at| {
        let mut events = 0;
        let mut observer = once(stop_at, &mut events);
        render_blocks(renderer, &until(target), film, &mut observer, &mut |_| Ok(())).unwrap()
    };
    // The error after 16, 24 and 48 passes; the target lies between the first two.
    let mut film = None;
    let mut errors = Vec::new();
    let mut after_block = |film: &Film| {
        if [16, 24, 48].contains(&film.passes) {
            errors.push(look.forecast(film, 48, 1.0).unwrap().error);
        }
        Ok(())
    };
    let BlockOutcome { outcome, .. } =
        render_blocks(renderer, &until(1e-6), &mut film, &mut (), &mut after_block).unwrap();
    assert_eq!((outcome.passes, outcome.cancelled), (48, false), "a target that is out of reach");
    assert!(!outcome.reached.unwrap().is_reached() && errors[1] < errors[0] && errors[2] < errors[1], "{errors:?}");
    assert_eq!((outcome.predicted.unwrap().passes, outcome.reached.unwrap().passes), (8, 48));

    let target = 0.5 * (errors[0] + errors[1]);
    let mut expected = None;
    let BlockOutcome { outcome, .. } = run(renderer, target, &mut expected, 0);
    assert_eq!((outcome.passes, outcome.cancelled), (24, false));
    assert!(outcome.reached.unwrap().is_reached());

    // Interrupted once between two examinations: 7 passes with 5 events each, and a forecast.
    let mut film = None;
    let stopped = run(renderer, target, &mut film, 57).outcome;
    let passes = film.as_ref().unwrap().passes;
    assert!(stopped.cancelled && passes > 8 && passes < 16, "{passes}");
    let rest = until(target).remaining(&film.as_ref().unwrap().contains, 5).unwrap().unwrap();
    let rest = render_blocks(renderer, &rest, &mut film, &mut (), &mut |_| Ok(())).unwrap().outcome;
    assert!(film == expected && rest.passes == 24 - passes, "continued");
    // Nothing more to do.
    let rest = until(target).remaining(&film.as_ref().unwrap().contains, 5).unwrap().unwrap();
    let rest = render_blocks(renderer, &rest, &mut film, &mut (), &mut |_| Ok(())).unwrap().outcome;
    assert!(film == expected && rest.passes == 0 && !rest.cancelled && rest.reached.unwrap().is_reached());

    let mut both: Vec<Box<dyn Render>> = vec![Box::new(pipeline::<T>()), Box::new(pipeline::<T>())];
    let mut film = None;
    let BlockOutcome { outcome, .. } =
        render_blocks_in_parallel(&mut both, &until(target), &mut film, &mut (), &mut |_| Ok(())).unwrap();
    assert!(film == expected, "on two devices");
    assert_eq!((outcome.passes, outcome.cancelled), (24, false));
    assert!(!both.iter_mut().any(|renderer| renderer.film().unwrap().passes > 0), "none is left behind");
}

/// Two renderers render the film of one, with the radii of the first; renderers with other passes are refused.
fn renderers_share_blocks<T: TestBackend>(mut one: Pipeline<T::On>) {
    let (expected, _) = blocks(&mut one, 0..6, 1, None, 0);
    let mut two = pipeline::<T>();
    let wider: Vec<f32> = two.radii().iter().map(|radius| 2.0 * radius).collect();
    two.set_radii(&wider).unwrap();
    let mut both: Vec<Box<dyn Render>> = vec![Box::new(one), Box::new(two)];
    let six = Blocks::new(0..6, 1).unwrap();
    let mut film = None;
    let results = render_blocks_in_parallel(&mut both, &six, &mut film, &mut (), &mut |_| Ok(())).unwrap();
    assert!(film == Some(expected), "the film of one");
    assert_eq!((results.outcome.passes, results.outcome.cancelled), (6, false));

    let scene = photon_scene::builtin("cornell-glass").unwrap().build().unwrap();
    let view = View { camera: scene.camera(None, 16, 16).unwrap(), width: 16, height: 16 };
    let fewer = Settings { photons: 2999, ..settings() };
    both[1] = Box::new(Pipeline::new(T::make(2), &scene.view(), view, fewer).unwrap());
    for mut renderers in [both, Vec::new()] {
        let error = render_blocks_in_parallel(&mut renderers, &six, &mut None, &mut (), &mut |_| Ok(())).unwrap_err();
        assert!(matches!(error, Error::InvalidSetting { name: "renderers", .. }), "{error}");
    }
}
