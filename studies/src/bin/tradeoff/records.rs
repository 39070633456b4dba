//! What was measured, in files that later runs and other machines can add to.

use std::path::{Path, PathBuf};

use photonmap_cli::atomic_write;
use photonmap_cli::fault::Fault;
use serde::{Deserialize, Serialize};

use crate::indices::IndexRow;
use crate::presets::PresetRow;

/// One file of results.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Part {
    /// Short name of the backend.
    pub(crate) backend: String,
    /// Its device in words.
    pub(crate) device: String,
    pub(crate) body: Body,
}

/// What kind of results.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Body {
    Sweep(Sweep),
    Claims(Vec<ClaimRow>),
    Asked(Vec<AskedRow>),
    Fields(Vec<FieldRow>),
    Rates(Vec<RateRow>),
    Tracer(Vec<TracerRow>),
    Presets(Vec<PresetRow>),
    Indices(Vec<IndexRow>),
}

/// Every setting of one scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Sweep {
    pub(crate) scene: String,
    pub(crate) size: u32,
    pub(crate) seeds: u32,
    /// Paths per pass of the middle setting.
    pub(crate) photons: u32,
    pub(crate) truth: Note,
    pub(crate) rows: Vec<Row>,
}

/// What a truth is made of.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Note {
    Constant(f64),
    Reference {
        passes: u32,
        photons: u64,
        /// The relMSE that it claims of itself: noise, and squared bias.
        error: f64,
        /// The latter.
        bias: f64,
    },
}

/// Several runs of one setting.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) knob: String,
    pub(crate) value: String,
    pub(crate) passes: u32,
    #[serde(flatten)]
    pub(crate) summary: Summary,
}

/// What runs with different seeds have in common.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Summary {
    /// Median seconds of the passes.
    pub(crate) seconds: f64,
    /// The fewest.
    pub(crate) fastest: f64,
    /// Paths emitted by each run.
    pub(crate) photons: u64,
    /// Mean over pixels and runs of `(x − y)²/(y² + ȳ²/100)`.
    pub(crate) error: f64,
    /// Its standard error over runs.
    pub(crate) error_error: f64,
    /// The part of it that the mean of all runs has too; what is left of the variance is taken off.
    pub(crate) bias: f64,
    /// The part that runs differ by.
    pub(crate) variance: f64,
    /// Claims, if errors were told.
    pub(crate) claims: Option<Claims>,
}

/// How claims did.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Claims {
    /// Share of the pixels of which something is claimed.
    pub(crate) claimed: f64,
    /// Share of these whose truth is within the claim.
    pub(crate) covered: f64,
    /// Lowest share of one run.
    pub(crate) worst: f64,
    /// Share of all pixels whose truth is within what noise alone would claim.
    pub(crate) by_noise: f64,
    /// Median of claim over the root mean square of the pixel's errors; 0 where nothing is claimed.
    pub(crate) sharpness: f64,
}

/// Claims about a scene whose answer is known.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ClaimRow {
    pub(crate) scene: String,
    pub(crate) passes: u32,
    pub(crate) seeds: u32,
    pub(crate) pixels: u32,
    pub(crate) claims: Claims,
}

/// What came of asking for something.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct AskedRow {
    pub(crate) scene: String,
    pub(crate) asked: String,
    /// How a time is spent; `None` for an error.
    pub(crate) way: Option<String>,
    pub(crate) predicted: String,
    pub(crate) took: String,
    /// Error claimed at the end.
    pub(crate) reached: Option<f64>,
    /// relMSE.
    pub(crate) error: Option<f64>,
    pub(crate) claimed: f64,
    /// Share of claims that hold, where that can be told.
    pub(crate) covered: Option<f64>,
}

/// Claims in a field of known truth.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FieldRow {
    pub(crate) field: String,
    /// Whether light ends in it, so that nothing may be claimed.
    pub(crate) broken: bool,
    pub(crate) passes: u32,
    pub(crate) alpha: f64,
    pub(crate) films: u32,
    pub(crate) pixels: u32,
    pub(crate) claims: Claims,
}

/// How fast something falls with passes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RateRow {
    pub(crate) field: String,
    pub(crate) alpha: f64,
    pub(crate) of: String,
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) slope: f64,
    pub(crate) error: f64,
    /// For as many passes.
    pub(crate) theory: f64,
    /// Passes and what was found, for the plot.
    pub(crate) points: Vec<(f64, f64)>,
}

/// A truth beside an unbiased path tracer's picture; `tests/mitsuba/check.py` writes it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct TracerRow {
    pub(crate) scene: String,
    /// What the truth is: a closed form, or the backend of a reference.
    pub(crate) reference: String,
    /// Paths per pixel.
    pub(crate) samples: u32,
    /// Mean over pixels of the tracer's less ours, over what errors are measured by.
    pub(crate) mean: f64,
    /// That over its standard error.
    pub(crate) z: f64,
    /// relMSE between the two.
    pub(crate) difference: f64,
    /// How much of it is the path tracer's noise, by the spread of its runs.
    pub(crate) noise: f64,
    /// What the reference claims of itself.
    pub(crate) claimed: f64,
}

/// A long run, for whoever has to judge others by it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Reference {
    pub(crate) scene: String,
    pub(crate) size: u32,
    pub(crate) backend: String,
    pub(crate) note: Note,
    pub(crate) seconds: f64,
    pub(crate) pixels: Vec<[f32; 3]>,
}

/// Pictures of one scene by several settings, beside the truth, for `tests/mitsuba/pictures.py`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Pictures {
    pub(crate) scene: String,
    pub(crate) size: u32,
    pub(crate) backend: String,
    pub(crate) truth: Vec<[f32; 3]>,
    pub(crate) shots: Vec<Shot>,
}

/// One of them; linear RGB, top row first.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Shot {
    pub(crate) name: String,
    pub(crate) seconds: f64,
    pub(crate) pixels: Vec<[f32; 3]>,
}

/// Writes a record.
pub(crate) fn write<T: Serialize>(path: &Path, record: &T) -> Result<(), Fault> {
    let text = serde_json::to_string(record).map_err(Fault::failure)?;
    atomic_write::write_bytes(path, text.as_bytes())
}

/// Reads one back.
pub(crate) fn read<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<T, Fault> {
    let text = std::fs::read_to_string(path).map_err(|why| Fault::input(format!("{}: {why}", path.display())))?;
    serde_json::from_str(&text).map_err(|why| Fault::input(format!("{}: not of this program: {why}", path.display())))
}

/// All parts in a folder, in order of their names.
pub(crate) fn parts(folder: &Path) -> Result<Vec<Part>, Fault> {
    let fault = |why: std::io::Error| Fault::input(format!("{}: {why}", folder.display()));
    let mut names: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fault)? {
        let path = entry.map_err(fault)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with("part-") && name.ends_with(".json") {
            names.push(path);
        }
    }
    names.sort();
    names.iter().map(|path| read(path)).collect()
}
