//! Pictures for the screen.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use photon_core::Film;

use crate::fault::Fault;
use crate::tonemap::{self, ToneMap};

/// Writes the picture, tone-mapped, 8 bits, sRGB. The file appears whole or not at all.
///
/// # Errors
/// [`Fault::Failure`] if the file cannot be written.
pub fn write(path: &Path, film: &Film, curve: ToneMap, exposure: f32) -> Result<(), Fault> {
    let bytes: Vec<u8> =
        film.beauty().into_iter().flat_map(|c| tonemap::map(curve, exposure, c).map(tonemap::encode)).collect();
    write_bytes(path, film.width, film.height, &bytes)
}

/// Writes RGB of 8 bits, sRGB, row by row. The file appears whole or not at all.
///
/// # Errors
/// [`Fault::Failure`] if the file cannot be written.
pub fn write_bytes(path: &Path, width: u32, height: u32, bytes: &[u8]) -> Result<(), Fault> {
    let partial = partial(path);
    let save = || -> Result<(), Box<dyn std::error::Error>> {
        let mut encoder = png::Encoder::new(BufWriter::new(File::create(&partial)?), width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(bytes)?;
        writer.finish()?;
        std::fs::rename(&partial, path)?;
        Ok(())
    };
    save().map_err(|why| Fault::writing(path, why))
}

/// Where a file is written before it gets its name.
pub(crate) fn partial(path: &Path) -> std::path::PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    path.with_file_name(name)
}
