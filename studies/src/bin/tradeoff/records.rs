//! Result files, to which later runs and other machines can add.

use std::path::{Path, PathBuf};

use photonmap_cli::atomic_write;
use photonmap_cli::fault::Fault;
use serde::{Deserialize, Serialize};

use crate::indices::IndexRow;
use crate::presets::PresetRow;

/// One result file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Part {
    /// Short name of the backend.
    pub(crate) backend: String,
    /// Name of its device.
    pub(crate) device: String,
    pub(crate) body: Body,
}

/// The kind of results.
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
    /// Paths per pass of the baseline setting.
    pub(crate) photons: u32,
    pub(crate) truth: Note,
    pub(crate) rows: Vec<Row>,
}

/// How a reference was made.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Note {
    Constant(f64),
    Reference {
        passes: u32,
        photons: u64,
        /// Its own estimate of its relMSE: noise plus squared bias.
        error: f64,
        /// The squared bias.
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
    /// Median seconds per pass.
    pub(crate) seconds: f64,
    /// Minimum seconds per pass.
    pub(crate) fastest: f64,
    /// Paths emitted by each run.
    pub(crate) photons: u64,
    /// Mean over pixels and runs of `(x − y)²/(y² + ȳ²/100)`.
    pub(crate) error: f64,
    /// Its standard error over runs.
    pub(crate) error_error: f64,
    /// The part of it that is common to all runs (squared bias), corrected for the remaining variance.
    pub(crate) bias: f64,
    /// The part that differs between runs (variance).
    pub(crate) variance: f64,
    /// Coverage of confidence intervals, if errors were estimated.
    pub(crate) claims: Option<Claims>,
}

/// Coverage of confidence intervals.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Claims {
    /// Fraction of the pixels that have an interval.
    pub(crate) claimed: f64,
    /// Fraction of these whose interval contains the true value.
    pub(crate) covered: f64,
    /// Lowest fraction of one run.
    pub(crate) worst: f64,
    /// Fraction of all pixels that an interval from noise alone would cover.
    pub(crate) by_noise: f64,
    /// Median of half-width over the root mean square error of the pixel; 0 without intervals.
    pub(crate) sharpness: f64,
}

/// Coverage in a scene with a known result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ClaimRow {
    pub(crate) scene: String,
    pub(crate) passes: u32,
    pub(crate) seeds: u32,
    pub(crate) pixels: u32,
    pub(crate) claims: Claims,
}

/// Result of an error target or a time budget.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct AskedRow {
    pub(crate) scene: String,
    pub(crate) asked: String,
    /// How a time budget is used; `None` for an error target.
    pub(crate) way: Option<String>,
    pub(crate) predicted: String,
    pub(crate) took: String,
    /// Estimated error at the end.
    pub(crate) reached: Option<f64>,
    /// relMSE.
    pub(crate) error: Option<f64>,
    pub(crate) claimed: f64,
    /// Fraction of intervals that hold, where that can be measured.
    pub(crate) covered: Option<f64>,
}

/// Coverage in a field with a known result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FieldRow {
    pub(crate) field: String,
    /// Whether the light has an edge in it, so that no interval may be given.
    pub(crate) broken: bool,
    pub(crate) passes: u32,
    pub(crate) alpha: f64,
    pub(crate) films: u32,
    pub(crate) pixels: u32,
    pub(crate) claims: Claims,
}

/// How fast a quantity falls with passes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RateRow {
    pub(crate) field: String,
    pub(crate) alpha: f64,
    pub(crate) of: String,
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) slope: f64,
    pub(crate) error: f64,
    /// Theoretical slope for the same passes.
    pub(crate) theory: f64,
    /// Passes and measured values, for the plot.
    pub(crate) points: Vec<(f64, f64)>,
}

/// A reference compared with an unbiased path tracer's picture; written by `tests/mitsuba/check.py`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct TracerRow {
    pub(crate) scene: String,
    /// Kind of reference: a closed form, or the backend of a long run.
    pub(crate) reference: String,
    /// Paths per pixel.
    pub(crate) samples: u32,
    /// Mean over pixels of the tracer's value minus ours, over the scale of relMSE.
    pub(crate) mean: f64,
    /// The same divided by its standard error.
    pub(crate) z: f64,
    /// relMSE between the two.
    pub(crate) difference: f64,
    /// The part of it that is the path tracer's noise, from the spread of its runs.
    pub(crate) noise: f64,
    /// The reference's own estimate of its error.
    pub(crate) claimed: f64,
}

/// A long run, as reference for other runs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Reference {
    pub(crate) scene: String,
    pub(crate) size: u32,
    pub(crate) backend: String,
    pub(crate) note: Note,
    pub(crate) seconds: f64,
    pub(crate) pixels: Vec<[f32; 3]>,
}

/// Pictures of one scene with several settings, beside the reference, for `tests/mitsuba/pictures.py`.
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

/// Reads a record.
pub(crate) fn read<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<T, Fault> {
    let text = std::fs::read_to_string(path).map_err(|why| Fault::input(format!("{}: {why}", path.display())))?;
    serde_json::from_str(&text).map_err(|why| Fault::input(format!("{}: not of this program: {why}", path.display())))
}

/// All result files in a folder, in order of their names.
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
