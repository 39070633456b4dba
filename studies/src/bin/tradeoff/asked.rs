//! Measures results for error targets and time budgets.

use std::time::Duration;

use photon_core::{Area, Bandwidth, Budget, Outcome, Plan, Settings};
use photonmap_cli::fault::Fault;

use crate::engine::{Engine, Subject};
use crate::measure::{self, Run};
use crate::records::AskedRow;
use crate::truth::Truth;

/// Seconds after which an error target is given up.
const PATIENCE: Duration = Duration::from_secs(20);

/// How `render --time --errors` uses the time.
pub(crate) const DEFAULT_WAY: &str = "surface, radii per pixel";

/// A target, in words and as a plan; the way in which a time budget is used, and the settings.
fn plans(base: &Settings) -> Vec<(String, Option<String>, Settings, Plan)> {
    let plain = Settings { errors: true, seed: 77, ..base.clone() };
    let mut plans = Vec::new();
    for target in [0.2, 0.1, 0.05] {
        let until = Budget::Error { target, share_of_pixels: 0.95 };
        let plan = Plan { most_time: Some(PATIENCE), ..until.into() };
        plans.push((format!("error of {:.0} %", 100.0 * target), None, plain.clone(), plan));
    }
    // A time budget can be used in several ways. Radii are adapted to it if there are error estimates.
    for seconds in [1, 5] {
        for (name, area, bandwidth, errors) in [
            ("surface, radii adapted", Area::Surface, Bandwidth::Shared, true),
            ("disc, radii adapted", Area::Disc, Bandwidth::Shared, true),
            (DEFAULT_WAY, Area::Surface, Bandwidth::PerPixel, true),
            ("disc, radii per pixel", Area::Disc, Bandwidth::PerPixel, true),
            ("surface, radii as they are", Area::Surface, Bandwidth::Shared, false),
            ("disc, radii as they are", Area::Disc, Bandwidth::Shared, false),
        ] {
            let settings = Settings { area, bandwidth, errors, ..plain.clone() };
            let plan = Budget::Time(Duration::from_secs(seconds)).into();
            plans.push((format!("{seconds} s"), Some(name.to_owned()), settings, plan));
        }
    }
    plans
}

/// The results of one scene.
pub(crate) fn rows(
    engine: &mut Engine,
    subject: &Subject,
    base: &Settings,
    truth: &Truth,
) -> Result<Vec<AskedRow>, Fault> {
    plans(base)
        .into_iter()
        .map(|(asked, way, settings, plan)| {
            // Kernels are compiled before the measurement starts.
            engine.film(subject, &settings, Budget::Passes(9))?;
            let (film, details) = engine.film(subject, &settings, plan)?;
            let run = Run::new(&film, details.seconds, details.outcome.paths);
            let row = row(subject, (asked, way), &details.outcome, &run, truth);
            crate::progress(&format!("{}: {}: {}, {}", row.scene, row.asked, row.predicted, row.took));
            Ok(row)
        })
        .collect()
}

fn row(
    subject: &Subject,
    (asked, way): (String, Option<String>),
    outcome: &Outcome,
    run: &Run,
    truth: &Truth,
) -> AskedRow {
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
    let claims = measure::claims(std::slice::from_ref(run), &|pixel| truth.at(pixel));
    AskedRow {
        error: Some(measure::error(run, truth)),
        scene: subject.name.clone(),
        asked,
        way,
        predicted,
        took: format!("{} passes, {:.2} s", outcome.passes, run.seconds),
        reached: outcome.reached.as_ref().map(|forecast| forecast.error),
        claimed: claims.claimed,
        covered: (truth.judges(outcome.paths) && claims.claimed > 0.0).then_some(claims.covered),
    }
}
