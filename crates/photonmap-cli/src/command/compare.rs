//! `photonmap compare`

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::exr_file::{self, Picture};
use crate::fault::Fault;
use crate::outputs::Outputs;
use crate::relmse::relmse;
use crate::tonemap::{self, ToneMap};
use crate::{atomic_write, difference, flip, png_file, stdout};

/// Compare two pictures: relative mean square error, FLIP, and a picture of the signed difference.
///
/// relMSE is the mean over pixels of (x − y)² / (y² + ȳ²/100), with y the reference and ȳ its mean. FLIP (Andersson et
/// al. 2020) is the difference that a viewer sees when the tone-mapped pictures alternate, from 0 to 1.
#[derive(Clone, Debug, Args)]
pub struct CompareArgs {
    /// The reference picture.
    #[arg(value_name = "A.exr")]
    reference: PathBuf,
    /// The picture to compare with it.
    #[arg(value_name = "B.exr")]
    picture: PathBuf,
    /// Write the signed difference: grey for none, brighter where B is brighter than A.
    #[arg(short, long, value_name = "FILE.png")]
    output: Option<PathBuf>,
    /// Gain of the difference picture: differences of the mean of A divided by this are white or black.
    #[arg(long, value_name = "G", default_value_t = 10.0)]
    gain: f32,
    /// Write the FLIP of each pixel, black for 0 and white for 1.
    #[arg(long, value_name = "FILE.png")]
    flip_map: Option<PathBuf>,
    /// Exposure for FLIP, in stops.
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f32,
    /// Tone curve for FLIP.
    #[arg(long, value_enum, default_value_t = ToneMap::Neutral)]
    tonemap: ToneMap,
    /// Pixels per degree of the viewer's field of view, for FLIP.
    #[arg(long, value_name = "N", default_value_t = flip::PIXELS_PER_DEGREE)]
    pixels_per_degree: f64,
    /// Write the figures in JSON, null for infinity; `-` for standard output.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Reads both pictures, prints the figures, and writes the requested files.
///
/// # Errors
/// [`Fault::Input`] for files that cannot be read, sizes that differ, pixels that are not finite, and options out of
/// range; [`Fault::Failure`] if a file cannot be written.
pub fn run(args: &CompareArgs) -> Result<(), Fault> {
    check(args)?;
    let (a, b) = (read(&args.reference)?, read(&args.picture)?);
    if (a.width, a.height) != (b.width, b.height) {
        return Err(Fault::input(format!(
            "{} has {}x{} pixels, but {} has {}x{}; only pictures of one size can be compared",
            args.reference.display(),
            a.width,
            a.height,
            args.picture.display(),
            b.width,
            b.height
        )));
    }
    let shown = |picture: &Picture| -> Vec<[f32; 3]> {
        picture.pixels.iter().map(|&pixel| tonemap::map(args.tonemap, args.exposure, pixel)).collect()
    };
    let map = flip::map(&shown(&a), &shown(&b), a.width, args.pixels_per_degree);
    let flip_mean = map.iter().sum::<f64>() / map.len() as f64;
    let flip_max = map.iter().fold(0.0_f64, |most, &value| most.max(value));
    let mean = |picture: &Picture| {
        picture.pixels.iter().flatten().map(|&c| f64::from(c)).sum::<f64>() / (3 * picture.pixels.len()) as f64
    };
    let error = relmse(&a.pixels, &b.pixels);
    let (mean_a, mean_b) = (mean(&a), mean(&b));

    let mut outputs = Outputs::default();
    if let Some(path) = &args.output {
        let shades = difference::signed(&a.pixels, &b.pixels, args.gain);
        outputs.file(path, png_file::write_bytes(path, a.width as u32, a.height as u32, &shades));
    }
    if let Some(path) = &args.flip_map {
        let shades: Vec<u8> = map.iter().flat_map(|&value| [(255.0 * value + 0.5) as u8; 3]).collect();
        outputs.file(path, png_file::write_bytes(path, a.width as u32, a.height as u32, &shades));
    }
    let figures = serde_json::json!({
        "relmse": error,
        "flip_mean": flip_mean,
        "flip_max": flip_max,
        "mean_a": mean_a,
        "mean_b": mean_b,
    });
    if let Some(path) = &args.json {
        outputs.report(path, &figures);
    }
    if args.json.as_deref().is_some_and(stdout::is_meant) {
        return outputs.result();
    }
    let mut text = String::new();
    let _ = writeln!(text, "relMSE  {error:.4e}");
    let _ = writeln!(text, "FLIP    {flip_mean:.5} mean, {flip_max:.5} greatest");
    let _ = writeln!(text, "mean    {mean_a:.6e} and {mean_b:.6e}");
    if outputs.any() {
        let _ = writeln!(text, "wrote {outputs}");
    }
    outputs.keep(stdout::write(text.as_bytes()));
    outputs.result()
}

fn check(args: &CompareArgs) -> Result<(), Fault> {
    let numbers = [("--gain", f64::from(args.gain)), ("--pixels-per-degree", args.pixels_per_degree)];
    for (name, value) in numbers {
        // Beyond, filters have more weights than any picture has pixels.
        if !(value > 0.0 && value <= 1e4) {
            return Err(Fault::input(format!("{name} is {value}, but must be above 0 and at most 10000")));
        }
    }
    if !args.exposure.is_finite() {
        return Err(Fault::input(format!("--exposure is {}, but must be finite", args.exposure)));
    }
    let pictures = [&args.output, &args.flip_map];
    for path in pictures.into_iter().flatten() {
        if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
            return Err(Fault::input(format!("{}: the name of this picture ends in .png", path.display())));
        }
        atomic_write::check(path)?;
    }
    args.json.iter().try_for_each(|path| Outputs::check_report(path))
}

/// Reads a picture whose pixels are all finite.
fn read(path: &Path) -> Result<Picture, Fault> {
    let picture = exr_file::read(path)?;
    match picture.pixels.iter().position(|pixel| pixel.iter().any(|c| !c.is_finite())) {
        None => Ok(picture),
        Some(at) => Err(Fault::input(format!(
            "{}: the pixel in column {} and row {} is {:?}, which cannot be compared",
            path.display(),
            at % picture.width,
            at / picture.width,
            picture.pixels[at]
        ))),
    }
}
