//! The words about the tables.

use std::fmt::Write as _;
use std::path::Path;

use crate::records::{Body, Part};
use crate::{answers, details, indices, presets, tables};

const HEAD: &str = include_str!("head.md");
const READING: &str = include_str!("reading.md");
const CLAIMS: &str = include_str!("claims.md");

/// Every row of every scene, a document of its own beside the one of that name.
pub(crate) fn rows(parts: &[Part], beside: &str) -> String {
    format!(
        "# Every row of every scene\n\nWhat it means is in [{beside}.md]({beside}.md).\n{}",
        details::every_row(parts)
    )
}

/// What films claim of themselves, a document of its own.
pub(crate) fn claims(parts: &[Part]) -> String {
    let mut text = format!("{CLAIMS}\n## Results\n");
    for table in [tables::fields(parts), tables::rates(parts), tables::claims(parts), answers::asked(parts)] {
        text += &table;
    }
    text
}

/// The document of that name, in the folder where its pictures are.
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
            let size =
                format!("{0} × {0} pixels, {1} seeds a row, {2} paths a pass", sweep.size, sweep.seeds, sweep.photons);
            if !sizes.contains(&size) {
                sizes.push(size);
            }
        }
    }
    if !sizes.is_empty() {
        let _ = writeln!(text, "\nSweeps: {}. Middle setting: 16 passes of the defaults.", sizes.join("; "));
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
    let _ = writeln!(text, "\n### Every row of every scene\n\nThey are in [{name}-rows.md]({name}-rows.md).");
    text
}
