//! What comes of asking for an error, or for a time.

use std::fmt::Write as _;
use std::time::Duration;

use photon_core::{Budget, Film, Outcome, Plan};

use crate::truth::Truth;

/// Seconds after which an error is given up.
const PATIENCE: Duration = Duration::from_secs(10);

/// What is asked for.
pub(crate) fn plans() -> Vec<Plan> {
    let error = |target| Plan { most_time: Some(PATIENCE), ..Budget::Error { target, share_of_pixels: 0.95 }.into() };
    let time = |seconds| Budget::Time(Duration::from_secs(seconds)).into();
    vec![error(0.2), error(0.1), time(1), time(5)]
}

/// The lines of the table of one scene.
pub(crate) fn rows(scene: &str, answers: &[(Plan, Outcome, Film, f64)], truth: &Truth) -> String {
    let mut text = String::new();
    for (plan, outcome, film, seconds) in answers {
        let asked = match plan.until {
            Budget::Error { target, .. } => format!("error of {:.0} %", 100.0 * target),
            Budget::Time(time) => format!("{} s", time.as_secs()),
            Budget::Passes(_) | Budget::Photons(_) => String::new(),
        };
        let predicted = outcome.predicted.as_ref().map_or_else(
            || "–".to_owned(),
            |forecast| match (forecast.passes_needed, forecast.seconds_needed()) {
                (Some(passes), Some(seconds)) => format!("{passes} passes, {seconds:.1} s"),
                _ if forecast.target.is_some() => "out of reach".to_owned(),
                _ => format!("{:.1} %", 100.0 * forecast.error_possible),
            },
        );
        let error = outcome.reached.as_ref().map_or(f64::NAN, |forecast| forecast.error);
        let claims = film.claims().unwrap_or_default();
        let standing = || claims.iter().enumerate().filter(|(_, claim)| claim.flags.is_empty());
        let held =
            standing().filter(|(pixel, claim)| (claim.value - truth.at(*pixel)).abs() <= claim.half_width).count();
        let count = standing().count();
        let covered = if truth.judges(outcome.paths) {
            format!("{:.1} %", 100.0 * held as f64 / count.max(1) as f64)
        } else {
            "–".to_owned()
        };
        let _ = writeln!(
            text,
            "| {scene} | {asked} | {predicted} | {} passes, {seconds:.2} s | {:.1} % | {:.0} % | {covered} |",
            outcome.passes,
            100.0 * error,
            100.0 * count as f64 / claims.len().max(1) as f64
        );
    }
    text
}
