//! The error at which a render in blocks ends.

use std::time::Instant;

use crate::error::{Error, Result};
use crate::film::Film;
use crate::film::forecast::{ErrorModel, Forecast};
use crate::pipeline::render::Outcome;
use crate::radius::schedule::Schedule;
use crate::settings::Settings;
use crate::settings::budget::{Budget, Plan};

/// The error at which a render in blocks ends.
///
/// The film is examined at fixed numbers of passes, which depend on the grain alone ([`ErrorTarget::next_look`]), and only
/// when it has exactly these passes. The number of passes is therefore a function of scene, settings, grain and target: it
/// depends neither on devices, workers and processes, nor on interruptions.
///
/// Unlike with [`Budget::Error`], derived radii are not adapted to the target: those of a film are fixed before its first
/// pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorTarget {
    target: f64,
    share_of_pixels: f64,
    alpha: f64,
    second_radius_noise: f64,
}

impl ErrorTarget {
    /// Number of passes before the film is examined for the first time, and the least number between two examinations.
    const LEAST: u32 = 8;

    /// Number of passes after which some pixel must have an error estimate.
    pub(super) const GIVE_UP: u32 = 256;

    /// Target and share as in [`Budget::Error`], for films of these settings.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] if target or share is out of range, or the settings do not estimate errors.
    pub fn new(target: f64, share_of_pixels: f64, settings: &Settings) -> Result<Self> {
        Plan::from(Budget::Error { target, share_of_pixels }).validate()?;
        if !settings.errors {
            return Err(no_estimates());
        }
        let second_radius_noise = settings.kernel.second_radius_noise();
        Ok(Self { target, share_of_pixels, alpha: settings.alpha, second_radius_noise })
    }

    /// The smallest number of passes, `passes` or more, at which the film is examined: 8, 16 and so on to 128, then whenever
    /// a sixteenth more has been added; each rounded up to whole blocks of `grain` passes.
    #[must_use]
    pub fn next_look(passes: u32, grain: u32) -> u32 {
        let whole = |passes: u32| passes.checked_next_multiple_of(grain.max(1)).unwrap_or(u32::MAX);
        let mut look = whole(Self::LEAST);
        while look < passes {
            look = whole(look.saturating_add((look / 16).max(Self::LEAST)));
        }
        look
    }

    /// The present error of a film, and a forecast up to `possible` passes in total that take `seconds_per_pass` each; `None`
    /// if no pixel has an error estimate, or the film has no error statistics.
    #[must_use]
    pub fn forecast(&self, film: &Film, possible: u32, seconds_per_pass: f64) -> Option<Forecast> {
        let mut schedule = Schedule::new(self.alpha);
        film.contains.ranges().flat_map(|(_, passes)| passes).for_each(|index| schedule.add(index));
        let intervals = film.confidence_intervals()?;
        let model = ErrorModel::new(&intervals, schedule, self.share_of_pixels, self.second_radius_noise)?;
        Some(model.forecast(Some(self.target), seconds_per_pass, possible.max(film.passes)))
    }

    /// [`ErrorTarget::forecast`] if the film of blocks of `grain` passes is to be examined now; rendering ends if
    /// [`Forecast::is_reached`].
    ///
    /// # Errors
    /// [`Error::InvalidSetting`] if the film has no error statistics, or still no pixel with an estimate after hundreds of
    /// passes.
    pub fn examine(&self, film: &Film, grain: u32, possible: u32, seconds_per_pass: f64) -> Result<Option<Forecast>> {
        if Self::next_look(film.passes, grain) != film.passes {
            return Ok(None);
        }
        if film.errors.is_none() {
            return Err(no_estimates());
        }
        let forecast = self.forecast(film, possible, seconds_per_pass);
        if forecast.is_none() && film.passes >= Self::GIVE_UP {
            let hint = "no pixel has an error estimate after hundreds of passes: more photons are needed";
            return Err(Error::InvalidSetting { name: "target-error", value: "set".into(), hint });
        }
        Ok(forecast)
    }
}

fn no_estimates() -> Error {
    let hint = "it needs error estimates: enable Settings::errors";
    Error::InvalidSetting { name: "target-error", value: "set".into(), hint }
}

/// Examines the film of a render in blocks when it is due.
pub(super) struct Looks {
    target: Option<ErrorTarget>,
    grain: u32,
    /// Number of passes of the film if all are rendered.
    possible: u32,
    begun: Instant,
    /// Number of passes of the film at the beginning.
    found: u32,
}

impl Looks {
    /// For a film that has `found` passes already, to which up to `more` are added.
    pub(super) fn new(target: Option<ErrorTarget>, grain: u32, found: u32, more: u32) -> Self {
        Self { target, grain, possible: found.saturating_add(more), begun: Instant::now(), found }
    }

    /// Whether the film that was found has reached the target, which `outcome` then says. Nothing is predicted of it, since
    /// the duration of its passes is not known.
    ///
    /// # Errors
    /// Those of [`ErrorTarget::examine`].
    pub(super) fn found_reached(&self, film: Option<&Film>, outcome: &mut Outcome) -> Result<bool> {
        let (Some(target), Some(film)) = (self.target, film) else { return Ok(false) };
        let forecast = target.examine(film, self.grain, self.possible, 0.0)?;
        outcome.reached = forecast.filter(Forecast::is_reached);
        Ok(outcome.reached.is_some())
    }

    /// The forecast if there is a target and the film is to be examined, which is also put into `outcome`.
    ///
    /// # Errors
    /// Those of [`ErrorTarget::examine`].
    pub(super) fn at(&self, film: &Film, outcome: &mut Outcome) -> Result<Option<Forecast>> {
        let Some(target) = self.target else { return Ok(None) };
        let passes = f64::from(film.passes.saturating_sub(self.found).max(1));
        let seconds = self.begun.elapsed().as_secs_f64() / passes;
        let forecast = target.examine(film, self.grain, self.possible, seconds)?;
        outcome.predicted = outcome.predicted.or(forecast);
        outcome.reached = forecast.or(outcome.reached);
        Ok(forecast)
    }

    /// Puts the error of the film at the end into `outcome`, unless that is known.
    pub(super) fn end(&self, film: Option<&Film>, outcome: &mut Outcome) {
        if let (Some(target), Some(film)) = (self.target, film)
            && outcome.reached.is_none_or(|reached| reached.passes != film.passes)
        {
            let passes = f64::from(film.passes.saturating_sub(self.found).max(1));
            let forecast = target.forecast(film, self.possible, self.begun.elapsed().as_secs_f64() / passes);
            outcome.reached = forecast.filter(|_| film.passes >= ErrorTarget::LEAST);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn films_are_examined_at_numbers_that_depend_on_the_grain_alone() {
        let looks = |grain: u32, most: u32| {
            let next = |&passes: &u32| Some(ErrorTarget::next_look(passes + 1, grain));
            std::iter::successors(Some(ErrorTarget::next_look(0, grain)), next)
                .take_while(|&passes| passes <= most)
                .collect::<Vec<_>>()
        };
        assert_eq!(looks(1, 40), [8, 16, 24, 32, 40]);
        assert_eq!(looks(3, 40), [9, 18, 27, 36]);
        assert_eq!(looks(20, 100), [20, 40, 60, 80, 100]);
        let late = looks(16, 10_000);
        assert!(late.windows(2).all(|pair| pair[1] > pair[0] && pair[1].is_multiple_of(16)));
        // At most a sixteenth and a block too late.
        assert!(late.windows(2).all(|pair| pair[1] - pair[0] <= pair[0] / 16 + 24));
        assert_eq!(ErrorTarget::next_look(u32::MAX, 1), u32::MAX);
    }

    #[test]
    fn targets_need_error_estimates_and_sense() {
        let settings = Settings { errors: true, ..Settings::default() };
        assert!(ErrorTarget::new(0.1, 0.95, &settings).is_ok());
        for (target, share) in [(0.0, 0.5), (f64::NAN, 0.5), (0.1, 0.0), (0.1, 1.5)] {
            assert!(ErrorTarget::new(target, share, &settings).is_err(), "{target} {share}");
        }
        let text = ErrorTarget::new(0.1, 0.95, &Settings::default()).unwrap_err().to_string();
        assert!(text.contains("errors"), "{text}");
    }
}
