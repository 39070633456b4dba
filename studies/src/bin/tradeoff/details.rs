//! The full results: the tables of each scene, the comparison with a path tracer, and the CSV.

use std::fmt::Write as _;
use std::path::Path;

use crate::csv_tables;
use crate::records::{Body, Note, Part, Row, Sweep};
use crate::tables::{backends, head, scenes, sweeps, time};

/// References compared with an unbiased path tracer.
pub(crate) fn tracer(parts: &[Part]) -> String {
    let mut text = String::new();
    for part in parts {
        let Body::Tracer(rows) = &part.body else { continue };
        if text.is_empty() {
            let _ = writeln!(
                text,
                "\n### References against a path tracer\n\nCompared pixel by pixel with {}, an unbiased path tracer, by `tests/mitsuba/check.py`. *Mean difference* is the path\ntracer minus ours, relative to the radiance that errors are divided by; *z* treats pixels as independent. *Expected* is\nthe path tracer's own variance plus the estimated error of our reference. For `integrating-sphere` only indirect light is\ncompared. `ring` (spot light seen through a mirror) and `pool` (parallel light through water) are missing, because a path\ntracer cannot sample their light paths.",
                part.device
            );
            let columns = ["scene", "reference", "paths per pixel", "mean difference", "z", "relMSE", "expected"];
            text += &head(&columns.map(str::to_owned), 2);
        }
        for row in rows {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {:.2} % | {:.1} | {:.2e} | {:.2e} |",
                row.scene,
                row.reference,
                row.samples,
                100.0 * row.mean,
                row.z,
                row.difference,
                row.noise + row.claimed
            );
        }
    }
    text
}

/// Captions of the pictures in `docs/images`, beside the folder of the document, as far as they exist.
pub(crate) fn pictures(folder: &Path) -> String {
    let mut text = String::new();
    for scene in ["cornell", "cornell-glass", "ring", "two-rooms"] {
        let name = format!("accuracy-{scene}.png");
        if !folder.join("../images").join(&name).exists() {
            continue;
        }
        if text.is_empty() {
            text += "\n### Pictures\n\nLeft to right: the reference, 16 passes, radii × 0.5, area correction, the paper's estimator and 64 passes.\nBelow each: the signed difference (red too bright, blue too dark, saturated at one half) and\nFLIP (Andersson et al. 2020), computed by `tests/mitsuba/pictures.py`.\n";
        }
        let _ = write!(text, "\n![{scene}](../images/{name})\n");
    }
    text
}

/// Every row of every scene, as CSV.
pub(crate) fn every_row(parts: &[Part]) -> String {
    let names = backends(parts);
    let mut columns = ["scene", "knob", "value", "passes"].map(str::to_owned).to_vec();
    for name in &names {
        columns.extend(["time", "relMSE", "bias²", "variance"].map(|column| format!("{column}, {name}")));
    }
    let mut text = head(&columns, 2).trim_start().to_owned();
    for scene in scenes(parts) {
        let here: Vec<(&Part, &Sweep)> = sweeps(parts).into_iter().filter(|(_, sweep)| sweep.scene == scene).collect();
        let Some(&(_, first)) = here.first() else { continue };
        for row in &first.rows {
            let _ = write!(text, "| {scene} | {} | {} | {} |", row.knob, row.value, row.passes);
            for name in &names {
                let sweep = here.iter().find(|(part, _)| part.backend == *name).map(|(_, sweep)| sweep);
                let same = |r: &&Row| (&r.knob, &r.value, r.passes) == (&row.knob, &row.value, row.passes);
                let Some((sweep, Row { summary: s, .. })) =
                    sweep.and_then(|sweep| Some((sweep, sweep.rows.iter().find(same)?)))
                else {
                    text += " – | – | – | – |";
                    continue;
                };
                let near = if floor(&sweep.truth) > 0.01 * s.error { " †" } else { "" };
                let _ = write!(
                    text,
                    " {} | {:.2e} ± {:.0e}{near} | {:.1e} | {:.1e} |",
                    time(s.seconds),
                    s.error,
                    s.error_error,
                    s.bias,
                    s.variance
                );
            }
            text.push('\n');
        }
    }
    csv_tables::csv(&text.lines().collect::<Vec<_>>())
}

/// The references against which the errors of each scene are measured.
pub(crate) fn truths(parts: &[Part]) -> String {
    let mut text = String::from("\n### Reference of each scene\n\n");
    for scene in scenes(parts) {
        let here: Vec<(&Part, &Sweep)> = sweeps(parts).into_iter().filter(|(_, sweep)| sweep.scene == scene).collect();
        let _ = writeln!(text, "- `{scene}`: {}", truth(&here));
    }
    text
}

fn floor(truth: &Note) -> f64 {
    match truth {
        Note::Constant(_) => 0.0,
        Note::Reference { error, .. } => *error,
    }
}

fn truth(here: &[(&Part, &Sweep)]) -> String {
    let Some((_, sweep)) = here.first() else { return String::new() };
    match &sweep.truth {
        Note::Constant(radiance) => format!("closed form, {radiance:.6} everywhere."),
        Note::Reference { passes, photons, error, bias } => {
            let rows = here.iter().flat_map(|(_, sweep)| &sweep.rows);
            let least = rows.map(|row| row.summary.error).fold(f64::INFINITY, f64::min);
            format!(
                "a run of {passes} passes and {:.0} million paths, with an estimated relMSE of {error:.1e}, which is {:.1} % of the
smallest relMSE measured against it; {:.0} % of it is squared bias, estimated from the difference between its first sixteenth and the rest.",
                *photons as f64 / 1e6,
                100.0 * error / least,
                100.0 * bias / error
            )
        }
    }
}

/// Every row of every scene and backend.
pub(crate) fn csv(parts: &[Part]) -> String {
    let mut text = String::from(
        "backend,scene,knob,value,passes,photons,seconds,fastest,relmse,relmse_error,bias_squared,variance,claimed,covered,sharpness\n",
    );
    for (part, sweep) in sweeps(parts) {
        for row in &sweep.rows {
            let s = &row.summary;
            let claims = s
                .claims
                .map_or_else(|| ",,".to_owned(), |c| format!("{:.4},{:.4},{:.3}", c.claimed, c.covered, c.sharpness));
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{:.5},{:.5},{:.4e},{:.1e},{:.4e},{:.4e},{claims}",
                part.backend,
                sweep.scene,
                row.knob,
                row.value.replace(',', ";"),
                row.passes,
                s.photons,
                s.seconds,
                s.fastest,
                s.error,
                s.error_error,
                s.bias,
                s.variance
            );
        }
    }
    text
}
