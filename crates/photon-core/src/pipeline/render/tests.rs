//! The loop over passes, with a renderer that does nothing.

use super::*;
use crate::pipeline::blocks::render_block;

/// A renderer whose passes do nothing, with errors that decrease as expected.
struct Idle {
    passes: u32,
    tells: bool,
    rescales: bool,
    /// How often it was asked for its error model.
    models: u32,
}

impl Idle {
    fn new(tells: bool) -> Self {
        Self { passes: 0, tells, rescales: false, models: 0 }
    }
}

impl Render for Idle {
    fn pass(&mut self, index: u32, _observer: &mut dyn Observer) -> Result<PassEnd> {
        self.passes += 1;
        Ok(PassEnd::Done(PassReport { index, paths: 100, ..PassReport::default() }))
    }
    fn film(&mut self) -> Result<Film> {
        Film::new(1, 1, crate::Units::default())
    }
    fn take(&mut self) -> Result<Film> {
        self.film()
    }
    fn model(&mut self, share: f64) -> Result<Option<ErrorModel>> {
        self.models += 1;
        let noise = f64::from(self.passes).sqrt().recip();
        let interval = crate::ConfidenceInterval {
            value: 1.0,
            standard_error: noise,
            bias: 0.0,
            bias_error: 0.0,
            bounded: 0.0,
            photons: 1000.0,
            half_width: 2.0 * noise,
            flags: crate::Flags::default(),
            allowed: crate::Flags::default(),
        };
        Ok(if self.tells {
            ErrorModel::new(&vec![interval; 10_000], crate::Schedule::of(self.passes, 1.0), share, 0.5)
        } else {
            None
        })
    }
    fn rescales(&self) -> bool {
        self.rescales
    }
    fn facts(&self) -> Facts {
        unreachable!("not used by these tests")
    }
}

/// No pass begins that is expected to end too late.
#[test]
fn times_are_kept() {
    let is_over_after = |seconds: u64, plan: Plan| {
        let mut clock = Clock::new();
        clock.begun = Instant::now().checked_sub(Duration::from_secs(seconds)).unwrap();
        clock.add(Duration::from_secs(10));
        is_over(&plan, &Outcome { passes: 1, ..Outcome::default() }, &clock)
    };
    let second = Duration::from_secs;
    let asked = Plan::from(Budget::Time(second(100)));
    let most = Plan { most_time: Some(second(100)), ..Plan::from(Budget::Passes(9)) };
    assert_eq!([80, 89, 91].map(|seconds| is_over_after(seconds, asked)), [false, false, true]);
    assert_eq!([80, 89, 91].map(|seconds| is_over_after(seconds, most)), [false, false, true]);
}

#[test]
fn the_first_pass_and_forecasts_are_no_measure_of_a_pass() {
    let pass = |all: &[u64]| {
        let mut clock = Clock::new();
        all.iter().for_each(|&seconds| clock.add(Duration::from_secs(seconds)));
        clock.pass().as_secs()
    };
    assert_eq!((pass(&[]), pass(&[5]), pass(&[5, 2]), pass(&[5, 2, 2, 2, 1, 9])), (0, 5, 2, 2));
    // Early passes are forgotten.
    assert_eq!(pass(&[[5; 100].as_slice(), &[3; 40]].concat()), 3);
    // What happens between two passes belongs to none.
    let mut clock = Clock::new();
    clock.pass_begun = Instant::now().checked_sub(Duration::from_secs(20)).unwrap();
    clock.begin_pass();
    clock.end_pass(0.0);
    assert!(clock.pass() < Duration::from_secs(10));
    // Nor do kernels that a pass waited for.
    let mut clock = Clock::new();
    clock.pass_begun = Instant::now().checked_sub(Duration::from_secs(20)).unwrap();
    clock.end_pass(15.0);
    assert!((5..7).contains(&clock.pass().as_secs()));
}

fn passes(plan: impl Into<Plan>) -> u32 {
    render(&mut Idle::new(true), plan, &mut ()).unwrap().passes
}

#[test]
fn budgets_are_spent_and_no_more() {
    assert_eq!(passes(Budget::Passes(5)), 5);
    assert_eq!(passes(Budget::Photons(301)), 4);
    assert_eq!(passes(Plan { most_passes: Some(3), ..Budget::Photons(1000).into() }), 3);
    // The first pass always runs.
    assert_eq!(passes(Budget::Time(Duration::ZERO)), 1);
    assert_eq!(passes(Plan { most_time: Some(Duration::ZERO), ..Budget::Passes(9).into() }), 1);
}

#[test]
fn an_error_ends_it_as_soon_as_it_is_reached() {
    let budget = Budget::Error { target: 0.1, share_of_pixels: 0.95 };
    // 1.96²/0.1² = 384 passes, and a little more for Student's t.
    let outcome = render(&mut Idle::new(true), budget, &mut ()).unwrap();
    assert!((384..=412).contains(&outcome.passes), "{}", outcome.passes);
    let (predicted, reached) = (outcome.predicted.unwrap(), outcome.reached.unwrap());
    assert_eq!(predicted.passes, 8);
    let needed = predicted.passes_needed.unwrap();
    // A variance with 7 degrees of freedom is predicted e^(1/7) larger, since its logarithm is that
    // much too low on average; and with 10 000 pixels by at most e^(2 √(0.33/10 000)).
    assert!((443..=456).contains(&needed), "{needed}");
    assert!(reached.is_reached() && reached.error <= 0.1 && !predicted.is_reached());
    // An unreachable target is predicted as such, and the limit is kept.
    let plan = Plan { most_passes: Some(100), ..budget.into() };
    let outcome = render(&mut Idle::new(true), plan, &mut ()).unwrap();
    let predicted = outcome.predicted.unwrap();
    assert_eq!((outcome.passes, predicted.passes_possible), (100, 100));
    assert!(!predicted.is_reachable() && (predicted.error_possible - 0.214).abs() < 0.002, "{predicted:?}");
}

/// In a second or less, a forecast on which nothing depends is left for the end.
#[test]
fn forecasts_of_short_renders_are_made_at_the_end() {
    let limited = |until: Budget| Plan { most_passes: Some(50), ..until.into() };
    let time = limited(Budget::Time(Duration::from_secs(900)));
    for (plan, rescales, models, first) in
        [(time, false, 1, 50), (time, true, 2, 8), (limited(Budget::Passes(50)), false, 2, 8)]
    {
        let mut idle = Idle { rescales, ..Idle::new(true) };
        let outcome = render(&mut idle, plan, &mut ()).unwrap();
        assert_eq!((idle.models, outcome.predicted.unwrap().passes), (models, first), "{plan:?}");
        assert_eq!((outcome.passes, outcome.reached.unwrap().passes), (50, 50));
    }
}

#[test]
fn an_error_that_nobody_tells_is_refused() {
    let budget = Budget::Error { target: 0.1, share_of_pixels: 0.95 };
    assert!(render(&mut Idle::new(false), budget, &mut ()).is_err());
}

/// A pass that waits until it is abandoned is so shortly after the time, unless it is the first; the render was not cancelled.
#[test]
fn a_pass_that_takes_too_long_is_abandoned() {
    /// With the number of passes in its film.
    struct Slow(u32);
    impl Render for Slow {
        fn pass(&mut self, index: u32, observer: &mut dyn Observer) -> Result<PassEnd> {
            let Some(condition) = observer.stop_condition() else {
                assert_eq!(index, 0);
                self.0 = 1;
                return Ok(PassEnd::Done(PassReport { index, paths: 100, ..PassReport::default() }));
            };
            while !condition.is_met() {
                std::thread::sleep(Duration::from_millis(1));
            }
            Ok(PassEnd::Cancelled)
        }
        fn film(&mut self) -> Result<Film> {
            Ok(Film { passes: self.0, ..Film::new(1, 1, crate::Units::default())? })
        }
        fn take(&mut self) -> Result<Film> {
            self.film()
        }
        fn facts(&self) -> Facts {
            unreachable!("not used by these tests")
        }
    }
    struct Asked(bool);
    impl Observer for Asked {
        fn on_event(&mut self, _: &Event<'_>) -> ControlFlow<()> {
            ControlFlow::Continue(())
        }
        fn stop_condition(&self) -> Option<StopCondition> {
            let asked = self.0;
            Some(StopCondition::new(move || asked))
        }
    }
    let time = Duration::from_millis(40);
    for (mut observer, cancelled) in [(Asked(false), false), (Asked(true), true)] {
        let begun = Instant::now();
        let outcome = render(&mut Slow(0), Budget::Time(time), &mut observer).unwrap();
        assert_eq!((outcome.passes, outcome.cancelled), (1, cancelled));
        assert!(cancelled || begun.elapsed() >= time);
    }
    let until = Plan { most_time: Some(time), ..Budget::Passes(9).into() };
    assert!(!render(&mut Slow(0), until, &mut ()).unwrap().cancelled);
    // A block of one pass is whole if it is the first, and otherwise none.
    for is_first in [true, false] {
        let block = render_block(&mut Slow(0), 0..1, is_first, &mut Asked(true)).unwrap();
        assert_eq!(block.map(|film| film.passes), is_first.then_some(1));
    }
}
