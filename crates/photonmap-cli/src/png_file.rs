//! PNG output.

use std::path::Path;

use photon_core::Film;

use crate::atomic_write;
use crate::fault::Fault;
use crate::tonemap::{self, ToneMap};

/// Writes the picture, tone-mapped, 8 bits, sRGB. The file is written atomically.
///
/// # Errors
/// [`Fault::Failure`] if the file cannot be written.
pub fn write(path: &Path, film: &Film, curve: ToneMap, exposure: f32) -> Result<(), Fault> {
    let bytes: Vec<u8> =
        film.beauty().into_iter().flat_map(|c| tonemap::map(curve, exposure, c).map(tonemap::encode)).collect();
    write_bytes(path, film.width, film.height, &bytes)
}

/// Writes RGB of 8 bits, sRGB, row by row. The file is written atomically.
///
/// # Errors
/// [`Fault::Failure`] if the file cannot be written.
pub fn write_bytes(path: &Path, width: u32, height: u32, bytes: &[u8]) -> Result<(), Fault> {
    atomic_write::write(path, |file| {
        let mut encoder = png::Encoder::new(file, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(bytes)?;
        Ok(writer.finish()?)
    })
}
