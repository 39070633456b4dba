//! Cost of each index: build time and query time, over the number of photons per pass.

use std::fmt::Write as _;

use photon_core::{IndexKind, Settings, Stage, Tally};
use photonmap_cli::fault::Fault;
use serde::{Deserialize, Serialize};

use crate::engine::{Engine, Subject};
use crate::records::{Body, Part};
use crate::tables::{head, time};

/// Width and height of the picture that queries the index.
const SIDE: u32 = 192;
/// Paths per pass.
const PATHS: [u32; 3] = [20_000, 100_000, 500_000];
const PASSES: u32 = 2;
const SEEDS: u32 = 3;

/// One index, filled by that many paths.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct IndexRow {
    pub(crate) scene: String,
    pub(crate) index: String,
    pub(crate) paths: u32,
    /// Number of photons stored in the maps, mean of the passes.
    pub(crate) photons: u64,
    /// Seconds per pass: building the index of all maps.
    pub(crate) build: f64,
    /// Seconds per pass: radiance estimates from all maps at every pixel.
    pub(crate) query: f64,
}

/// All indices of one scene, with the fixed-radius estimator.
pub(crate) fn rows(engine: &mut Engine, name: &str, base: &Settings) -> Result<Vec<IndexRow>, Fault> {
    let subject = Subject::new(name, SIDE)?;
    let mut rows = Vec::new();
    for paths in PATHS {
        for (index, called) in [(IndexKind::Morton, "Morton"), (IndexKind::Median, "median"), (IndexKind::Vvh, "VVH")] {
            let settings = Settings { photons: paths, index, ..base.clone() };
            let (mut builds, mut queries, mut photons) = (Vec::new(), Vec::new(), 0);
            engine.films(&subject, (&settings, PASSES), SEEDS, |_, details| {
                let seconds = |stage| details.outcome.seconds.get(stage) / f64::from(PASSES);
                builds.push(seconds(Stage::Build));
                queries.push(seconds(Stage::Estimate));
                let stored = |tally: &Tally| tally.stored.values().sum::<u64>();
                photons = (stored(&details.outcome.tally) + stored(&details.outcome.aimed)) / u64::from(PASSES);
            })?;
            let median = |mut times: Vec<f64>| {
                times.sort_unstable_by(f64::total_cmp);
                times[times.len() / 2]
            };
            let (build, query) = (median(builds), median(queries));
            rows.push(IndexRow { scene: name.to_owned(), index: called.to_owned(), paths, photons, build, query });
        }
        crate::progress(&format!("{name}: indices of {paths} paths"));
    }
    Ok(rows)
}

/// All rows, with their backends.
pub(crate) fn all(parts: &[Part]) -> Vec<(&str, &IndexRow)> {
    let mut found = Vec::new();
    for part in parts {
        if let Body::Indices(rows) = &part.body {
            found.extend(rows.iter().map(|row| (part.backend.as_str(), row)));
        }
    }
    found
}

/// The table.
pub(crate) fn table(parts: &[Part]) -> String {
    let rows = all(parts);
    if rows.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "\n### Build and query time per index\n\nPer pass, all maps together: building the index, and estimating radiance for the pixels of a picture of {SIDE} × {SIDE} with the\nradius estimator (larger maps have smaller radii). Medians of {SEEDS} runs of {PASSES} passes.\n"
    );
    let columns = ["scene", "backend", "device", "index", "paths", "photons", "build", "query"];
    text += &head(&columns.map(str::to_owned), 4);
    for part in parts {
        let Body::Indices(rows) = &part.body else { continue };
        for row in rows {
            let IndexRow { scene, index, paths, photons, build, query } = row;
            let (backend, device, build, query) = (&part.backend, &part.device, time(*build), time(*query));
            let _ = writeln!(
                text,
                "| {scene} | {backend} | {device} | {index} | {paths} | {photons} | {build} | {query} |"
            );
        }
    }
    text
}

/// Every row.
pub(crate) fn csv(parts: &[Part]) -> String {
    let mut text = String::from("backend,scene,index,paths,photons,build_seconds,query_seconds\n");
    for (backend, row) in all(parts) {
        let IndexRow { scene, index, paths, photons, build, query } = row;
        let _ = writeln!(text, "{backend},{scene},{index},{paths},{photons},{build:.6},{query:.6}");
    }
    text
}
