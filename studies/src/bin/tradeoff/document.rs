//! The text around the tables.

use std::fmt::Write as _;
use std::path::Path;

use crate::records::{Body, Part};
use crate::{answers, details, indices, presets, tables};

const HEAD: &str = include_str!("head.md");
const READING: &str = include_str!("reading.md");
const CLAIMS: &str = include_str!("claims.md");

/// The document on the coverage of confidence intervals.
pub(crate) fn claims(parts: &[Part]) -> String {
    let mut text = format!("{CLAIMS}\n## Results\n");
    for table in [tables::fields(parts), tables::rates(parts), tables::claims(parts), answers::asked(parts)] {
        text += &table;
    }
    text
}

/// The document of that name, in the folder with its pictures.
pub(crate) fn markdown(parts: &[Part], folder: &Path, name: &str) -> String {
    let mut text = format!("{HEAD}\n{READING}\n## Results\n\n");
    for backend in tables::backends(parts) {
        let mut here: Vec<&Part> = parts.iter().filter(|part| part.backend == backend).collect();
        here.sort_by(|a, b| a.device.cmp(&b.device));
        here.dedup_by(|a, b| a.device == b.device);
        for part in here {
            let _ = writeln!(text, "- **{backend}**: {}", part.device);
        }
    }
    let mut sizes: Vec<String> = Vec::new();
    for part in parts {
        if let Body::Sweep(sweep) = &part.body {
            let size = format!(
                "{0} × {0} pixels, {1} seeds per row, {2} paths per pass",
                sweep.size, sweep.seeds, sweep.photons
            );
            if !sizes.contains(&size) {
                sizes.push(size);
            }
        }
    }
    if !sizes.is_empty() {
        let _ = writeln!(text, "\nSweeps: {}. Baseline: 16 passes with default settings.", sizes.join("; "));
    }
    for table in [
        tables::merits(parts),
        presets::table(parts),
        indices::table(parts),
        answers::ways(parts),
        tables::fronts(parts),
        details::pictures(folder),
        details::tracer(parts),
    ] {
        text += &table;
    }
    text += &details::truths(parts);
    let _ = writeln!(
        text,
        "\n### All rows\n\nEvery setting of every scene, with time, relMSE, squared bias and variance, is in\n[{name}-rows.csv]({name}-rows.csv)."
    );
    text
}
