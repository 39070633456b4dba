//! The candidates for presets: settings of a picture, by the time that a picture of a given size takes.
//!
//! The error of a pixel depends on the photons of a pass and not on the number of pixels, while the time
//! depends on both. So errors are measured on small pictures, whose reference is accurate, with as many photons as
//! a larger one would have, and times on the larger one.

use std::fmt::Write as _;

use photon_core::{Area, Bandwidth, Settings};
use photonmap_cli::fault::Fault;
use serde::{Deserialize, Serialize};

use crate::engine::{Engine, Subject};
use crate::measure::{self, Run};
use crate::records::{Body, Part};
use crate::tables;
use crate::truth::Truth;

/// Width and height of the picture that is timed.
const SIDE: u32 = 192;
/// Number of its passes, in each of [`SEEDS`] runs.
const TIMED: u32 = 16;
const SEEDS: u32 = 3;
/// Paths per pass and pixel.
const PER_PIXEL: [u32; 3] = [1, 2, 4];
const PASSES: [u32; 3] = [4, 64, 256];
/// Radii per pixel are determined after eight passes.
const KINDS: [(Area, Bandwidth); 4] = [
    (Area::Disc, Bandwidth::Shared),
    (Area::Surface, Bandwidth::Shared),
    (Area::Disc, Bandwidth::PerPixel),
    (Area::Surface, Bandwidth::PerPixel),
];

/// One candidate.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PresetRow {
    pub(crate) scene: String,
    /// Treatment of boundaries of surfaces, and of radii.
    pub(crate) kind: String,
    pub(crate) per_pixel: u32,
    pub(crate) passes: u32,
    /// Seconds, for the larger picture.
    pub(crate) seconds: f64,
    /// relMSE, and its standard error over seeds.
    pub(crate) error: f64,
    pub(crate) error_error: f64,
}

/// All candidates of one scene; `base` has the settings that the scene requires.
pub(crate) fn rows(
    engine: &mut Engine,
    subject: &Subject,
    base: &Settings,
    truth: &Truth,
) -> Result<Vec<PresetRow>, Fault> {
    let larger = Subject::new(&subject.name, SIDE)?;
    let mut rows = Vec::new();
    for (area, bandwidth) in KINDS {
        for per_pixel in PER_PIXEL {
            let own = bandwidth == Bandwidth::PerPixel;
            let photons = per_pixel * SIDE * SIDE;
            let settings = Settings { photons, area, bandwidth, errors: own, ..base.clone() };
            let mut times = Vec::new();
            engine.films(&larger, (&settings, TIMED), SEEDS, |_, details| times.push(details.seconds))?;
            times.sort_unstable_by(f64::total_cmp);
            let pass = times[times.len() / 2] / f64::from(TIMED);
            for passes in PASSES {
                if own && passes < 8 {
                    continue;
                }
                let mut runs: Vec<Run> = Vec::new();
                engine.films(subject, (&settings, passes), SEEDS, |film, details| {
                    runs.push(Run::new(film, details.seconds, details.outcome.paths));
                })?;
                let summary = measure::summarise(&runs, truth);
                rows.push(PresetRow {
                    scene: subject.name.clone(),
                    kind: format!(
                        "{}, {}",
                        if area == Area::Disc { "disc" } else { "surface" },
                        if own { "per pixel" } else { "shared" }
                    ),
                    per_pixel,
                    passes,
                    seconds: pass * f64::from(passes),
                    error: summary.error,
                    error_error: summary.error_error,
                });
            }
        }
        crate::progress(&format!("{}: presets: {area:?}, {bandwidth:?}", subject.name));
    }
    Ok(rows)
}

/// The table: error of each relative to that of the plainest in the same time.
pub(crate) fn table(parts: &[Part]) -> String {
    fn of(part: &Part) -> &[PresetRow] {
        if let Body::Presets(rows) = &part.body { rows } else { &[] }
    }
    let all: Vec<(&str, &PresetRow)> =
        parts.iter().flat_map(|part| of(part).iter().map(|row| (part.backend.as_str(), row))).collect();
    let mut scenes: Vec<&str> = all.iter().map(|(_, row)| row.scene.as_str()).collect();
    scenes.sort_unstable();
    scenes.dedup();
    let Some((_, first)) = all.first() else { return String::new() };
    let backends = tables::backends(parts);
    let mut text = format!(
        "\n### Candidates for the presets\n\nTimes are for pictures of {SIDE} × {SIDE} pixels; errors for small pictures with the same number of photons, {SEEDS} seeds each. For each\nbackend: time relative to the first row with the same number of passes, and relMSE relative to what that row would reach in the same\ntime, as above: below 1 it pays.\n"
    );
    let mut columns = vec!["passes".to_owned(), "area, radii".to_owned(), "paths per pixel".to_owned()];
    for backend in &backends {
        columns.extend([format!("time, {backend}"), format!("error, {backend}")]);
        columns.extend(scenes.iter().map(|scene| format!("{scene}, {backend}")));
    }
    text += &tables::head(&columns, 2);
    let mut keys: Vec<(u32, &str, u32)> = Vec::new();
    for (_, row) in all.iter().filter(|(_, row)| row.scene == first.scene) {
        let key = (row.passes, row.kind.as_str(), row.per_pixel);
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    keys.sort_by_key(|key| key.0);
    for &(passes, kind, per_pixel) in &keys {
        let _ = write!(text, "| {passes} | {kind} | {per_pixel} |");
        for backend in &backends {
            let find = |scene: &str, (kind, per_pixel): (&str, u32)| {
                let same = |row: &PresetRow| {
                    (row.scene.as_str(), row.passes, row.kind.as_str(), row.per_pixel)
                        == (scene, passes, kind, per_pixel)
                };
                all.iter().find(|(name, row)| name == backend && same(row)).map(|(_, row)| *row)
            };
            let ratios: Vec<Option<(f64, f64)>> = scenes
                .iter()
                .map(|scene| {
                    let (row, plain) = (find(scene, (kind, per_pixel))?, find(scene, ("disc, shared", PER_PIXEL[0]))?);
                    let time = row.seconds / plain.seconds;
                    Some((time, row.error / plain.error * time.powf(2.0 / 3.0)))
                })
                .collect();
            let found: Vec<(f64, f64)> = ratios.iter().copied().flatten().collect();
            let mean = |of: fn(&(f64, f64)) -> f64| {
                (found.iter().map(|pair| of(pair).ln()).sum::<f64>() / found.len().max(1) as f64).exp()
            };
            let _ = write!(text, " ×{:.2} | ×{:.2} |", mean(|pair| pair.0), mean(|pair| pair.1));
            for ratio in ratios {
                let _ = match ratio {
                    Some((_, error)) => write!(text, " ×{error:.2} |"),
                    None => write!(text, " – |"),
                };
            }
        }
        text.push('\n');
    }
    text
}
