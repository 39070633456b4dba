//! Every number: the tables of each scene, the comparison with a path tracer, and the CSV.

use std::fmt::Write as _;
use std::path::Path;

use crate::records::{Body, Note, Part, Row, Sweep};
use crate::tables::{head, scenes, sweeps, time};

/// Truths beside an unbiased path tracer.
pub(crate) fn tracer(parts: &[Part]) -> String {
    let mut text = String::new();
    for part in parts {
        let Body::Tracer(rows) = &part.body else { continue };
        if text.is_empty() {
            let _ = writeln!(
                text,
                "\n### Truths beside a path tracer\n\n{}, unbiased, by `tests/mitsuba/check.py`; pixel by pixel. *Mean difference* is the\ntracer's less ours, over what errors are measured by, with z as if pixels were independent. *Expected* is its own\nnoise, by the spread of its runs, and what the reference claims of itself. Of `integrating-sphere` it is the light that\nwas scattered before. Spot light by way of a mirror (`ring`) and parallel light by way of water (`pool`) is what a path tracer\ncannot find.",
                part.device
            );
            let columns = ["scene", "truth", "paths a pixel", "mean difference", "z", "relMSE", "expected"];
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

/// What the pictures in `docs/images` show, for those that are there.
pub(crate) fn pictures(folder: &Path) -> String {
    let mut text = String::new();
    for scene in ["cornell", "cornell-glass", "ring", "two-rooms"] {
        let name = format!("accuracy-{scene}.png");
        if !folder.join("images").join(&name).exists() {
            continue;
        }
        if text.is_empty() {
            text += "\n### Pictures\n\nThe truth, then 16 passes, radii × 0.5, without the loss at the ends of surfaces, the paper and 64\npasses; below them the signed difference, red where too bright and blue where too dark, full at a half, and\nFLIP (Andersson et al. 2020), by `tests/mitsuba/pictures.py`.\n";
        }
        let _ = write!(text, "\n![{scene}](images/{name})\n");
    }
    text
}

/// Every row of every scene.
pub(crate) fn every_row(parts: &[Part]) -> String {
    let mut text = String::new();
    for scene in scenes(parts) {
        let here: Vec<(&Part, &Sweep)> = sweeps(parts).into_iter().filter(|(_, sweep)| sweep.scene == scene).collect();
        let Some(&(_, first)) = here.first() else { continue };
        let _ = writeln!(text, "\n## {scene}\n\n{}", truth(&here));
        let mut names = vec!["knob".to_owned(), "value".to_owned(), "passes".to_owned()];
        for (part, _) in &here {
            names.extend(["time", "relMSE", "bias²", "variance"].map(|name| format!("{name}, {}", part.backend)));
        }
        text += &head(&names, 2);
        for row in &first.rows {
            let _ = write!(text, "| {} | {} | {} |", row.knob, row.value, row.passes);
            for (_, sweep) in &here {
                let same = |r: &&Row| (&r.knob, &r.value, r.passes) == (&row.knob, &row.value, row.passes);
                let Some(Row { summary: s, .. }) = sweep.rows.iter().find(same) else {
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
        Note::Constant(radiance) => format!("Truth: {radiance:.6} everywhere."),
        Note::Reference { passes, photons, error, bias } => {
            let rows = here.iter().flat_map(|(_, sweep)| &sweep.rows);
            let least = rows.map(|row| row.summary.error).fold(f64::INFINITY, f64::min);
            format!(
                "Truth: a run of {passes} passes and {:.0} million paths, which claims a relMSE of {error:.1e} for itself, {:.1} % of the\nleast below; {:.0} % of it is squared bias, told by its first sixteenth and the rest.",
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
