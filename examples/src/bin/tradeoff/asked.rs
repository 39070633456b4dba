//! What comes of asking for an error, or for a time.

use std::time::Duration;

use photon_core::{Budget, Film, Outcome, Plan, Settings};
use photon_examples::fault::Fault;

use crate::engine::{Engine, Subject};
use crate::records::AskedRow;
use crate::truth::Truth;

/// Seconds after which an error is given up.
const PATIENCE: Duration = Duration::from_secs(20);

/// What is asked for.
fn plans() -> Vec<Plan> {
    let error = |target| Plan { most_time: Some(PATIENCE), ..Budget::Error { target, share_of_pixels: 0.95 }.into() };
    let time = |seconds| Budget::Time(Duration::from_secs(seconds)).into();
    vec![error(0.2), error(0.1), error(0.05), time(1), time(5)]
}

/// The lines of one scene.
pub(crate) fn rows(
    engine: &mut Engine,
    subject: &Subject,
    base: &Settings,
    truth: &Truth,
) -> Result<Vec<AskedRow>, Fault> {
    let settings = Settings { errors: true, seed: 77, ..base.clone() };
    // Whatever is compiled for the first time is not what is timed.
    engine.film(subject, &settings, Budget::Passes(2))?;
    plans()
        .into_iter()
        .map(|plan| {
            let (film, told) = engine.film(subject, &settings, plan)?;
            let row = row(subject, (plan, &told.outcome, told.seconds), &film, truth);
            crate::progress(&format!("{}: {}: {}, {}", row.scene, row.asked, row.predicted, row.took));
            Ok(row)
        })
        .collect()
}

fn row(subject: &Subject, (plan, outcome, seconds): (Plan, &Outcome, f64), film: &Film, truth: &Truth) -> AskedRow {
    let asked = match plan.until {
        Budget::Error { target, .. } => format!("error of {:.0} %", 100.0 * target),
        Budget::Time(time) => format!("{} s", time.as_secs()),
        Budget::Passes(_) | Budget::Photons(_) => String::new(),
    };
    let predicted = outcome.predicted.as_ref().map_or_else(
        || "–".to_owned(),
        |forecast| match (forecast.passes_least, forecast.passes_needed, forecast.seconds_needed()) {
            (Some(least), ..) if least > forecast.passes_possible => {
                format!("out of reach: {least} passes at least; {:.1} %", 100.0 * forecast.error_possible_least)
            }
            (Some(least), Some(most), Some(seconds)) => {
                format!(
                    "{least} to {most} passes, {:.1} to {seconds:.1} s",
                    f64::from(least) * forecast.seconds_per_pass
                )
            }
            (Some(least), None, _) => format!("{least} passes or more, perhaps out of reach"),
            _ if forecast.target.is_some() => "out of reach".to_owned(),
            _ => format!("{:.1} to {:.1} %", 100.0 * forecast.error_possible_least, 100.0 * forecast.error_possible),
        },
    );
    let claims = film.claims().unwrap_or_default();
    let standing = || claims.iter().enumerate().filter(|(_, claim)| claim.flags.is_empty());
    let held = standing().filter(|(pixel, claim)| (claim.value - truth.at(*pixel)).abs() <= claim.half_width).count();
    let count = standing().count();
    AskedRow {
        scene: subject.name.clone(),
        asked,
        predicted,
        took: format!("{} passes, {seconds:.2} s", outcome.passes),
        reached: outcome.reached.as_ref().map(|forecast| forecast.error),
        claimed: count as f64 / claims.len().max(1) as f64,
        covered: (truth.judges(outcome.paths) && count > 0).then(|| held as f64 / count as f64),
    }
}
