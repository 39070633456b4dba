use std::time::Duration;

use super::*;
use crate::film::pass_set::PassSet;
use crate::pipeline::render::{Facts, PassEnd};

/// Adds 1/(1 + index) in each pass: sums that depend on their order.
struct Fake {
    film: Film,
    /// Milliseconds for a pass.
    slow: u64,
    /// The pass in which it fails, and whether by a panic.
    fails: Option<(u32, bool)>,
}

fn empty() -> Film {
    Film::new(1, 1, crate::Units::default()).unwrap()
}

fn fake(slow: u64, fails: Option<(u32, bool)>) -> Box<dyn Render> {
    Box::new(Fake { film: empty(), slow, fails })
}

impl Render for Fake {
    fn pass(&mut self, index: u32, observer: &mut dyn Observer) -> Result<PassEnd> {
        thread::sleep(Duration::from_millis(self.slow));
        if let Some((_, panics)) = self.fails.filter(|(pass, _)| *pass == index) {
            assert!(!panics, "a renderer that panics");
            return Err(Error::DeviceLost);
        }
        if observer.on_event(&Event::Photons { pass: index, traced: 5, total: 10 }).is_break() {
            return Ok(PassEnd::Cancelled);
        }
        let mut pass = empty();
        pass.pixels[0].layers[0] = [1.0 / f64::from(1 + index); 3];
        (pass.passes, pass.contains) = (1, PassSet::of(0, index..index + 1));
        self.film.merge(&pass)?;
        let report = PassReport { index, paths: 10, ..PassReport::default() };
        let flow = observer.on_event(&Event::PassDone(&report));
        Ok(if flow.is_break() { PassEnd::Last(report) } else { PassEnd::Done(report) })
    }
    fn film(&mut self) -> Result<Film> {
        Ok(self.film.clone())
    }
    fn take(&mut self) -> Result<Film> {
        Ok(std::mem::replace(&mut self.film, empty()))
    }
    fn facts(&self) -> Facts {
        unreachable!("not used by these tests")
    }
}

fn render(
    mut renderers: Vec<Box<dyn Render>>,
    grain: u32,
    observer: &mut dyn Observer,
) -> (Option<Film>, Result<BlockOutcome>) {
    let (mut film, blocks) = (None, Blocks::new(0..60, grain).unwrap());
    let results = run(&mut renderers, &blocks, &mut film, observer, &mut |_| Ok(()));
    (film, results)
}

#[test]
fn any_number_of_devices_of_any_speed_gives_the_same_bits() {
    let alone = render(vec![fake(0, None)], 3, &mut ()).0.unwrap();
    for speeds in [vec![0, 0], vec![3, 0, 1], vec![0, 2, 2, 9]] {
        let mut events = 0;
        let mut observer = |_: &Event<'_>| {
            events += 1;
            ControlFlow::Continue(())
        };
        let (film, results) = render(speeds.iter().map(|slow| fake(*slow, None)).collect(), 3, &mut observer);
        let outcome = results.unwrap().outcome;
        assert!(film == Some(alone.clone()), "{speeds:?}");
        assert_eq!((outcome.passes, outcome.paths, outcome.cancelled, events), (60, 600, false, 120));
        assert_eq!(outcome.last.unwrap().index, 59);
    }
    assert!(render(vec![fake(0, None)], 4, &mut ()).0.unwrap().pixels != alone.pixels, "sums depend on the grain");
}

#[test]
fn a_request_to_stop_leaves_whole_blocks_without_gaps() {
    let mut passes = 0;
    let mut stop = |event: &Event<'_>| {
        passes += u32::from(matches!(event, Event::PassDone(_)));
        if passes == 25 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let (film, results) = render(vec![fake(2, None), fake(3, None), fake(1, None)], 3, &mut stop);
    let film = film.unwrap();
    assert!(results.unwrap().outcome.cancelled && film.passes < 60 && film.passes.is_multiple_of(3));
    assert_eq!(film.contains, PassSet::of(0, 0..film.passes));
    // Within the first block: there is no film.
    let (film, results) = render(vec![fake(1, None), fake(1, None)], 60, &mut |_: &Event<'_>| ControlFlow::Break(()));
    let unfinished = results.map_or(0, |results| results.unfinished.map_or(0, |film| film.passes));
    assert!(film.is_none() && unfinished < 60);
}

#[test]
fn the_blocks_before_a_failure_are_kept() {
    let (film, results) = render(vec![fake(0, Some((31, false))), fake(1, Some((31, false)))], 2, &mut ());
    let passes = film.map_or(0, |film| film.passes);
    assert!(matches!(results, Err(Error::DeviceLost)) && passes <= 30, "{passes}: {results:?}");
}

#[test]
fn a_panic_ends_the_render() {
    let panicked = std::panic::catch_unwind(|| {
        let _ = render(vec![fake(0, Some((3, true))), fake(0, Some((3, true)))], 1, &mut ());
    });
    assert!(panicked.is_err());
}
