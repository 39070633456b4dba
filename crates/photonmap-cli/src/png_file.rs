//! PNG output.

use std::io::Write;
use std::path::Path;

use photon_core::{DisplayImage, Film, parallel};

use crate::atomic_write;
use crate::fault::Fault;
use crate::tonemap::{self, ToneMap};

/// A picture to be tone-mapped.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Linear RGB, row by row from the top, not premultiplied.
    pub colours: Vec<[f32; 3]>,
    /// Opacity of each pixel, `[0, 1]`, for a picture with a transparent background.
    pub alpha: Option<Vec<f32>>,
}

impl Picture {
    /// The picture of a film, with alpha if the background is `transparent`.
    #[must_use]
    pub fn new(film: &Film, transparent: bool) -> Self {
        Self::of(film, film.beauty(), transparent)
    }

    /// The same with other colours of as many pixels, for example denoised ones.
    #[must_use]
    pub fn of(film: &Film, mut colours: Vec<[f32; 3]>, transparent: bool) -> Self {
        let alpha = transparent.then(|| film.alpha());
        for (colour, alpha) in colours.iter_mut().zip(alpha.iter().flatten()) {
            *colour = colour.map(|part| if *alpha > 0.0 { part / alpha } else { 0.0 });
        }
        Self { width: film.width, height: film.height, colours, alpha }
    }
}

/// Writes the picture, tone-mapped, 8 bits, sRGB; alpha is linear. The file is written atomically.
///
/// # Errors
/// [`Fault::Failure`] if the file cannot be written.
pub fn write(path: &Path, picture: &Picture, curve: ToneMap, exposure: f32) -> Result<(), Fault> {
    atomic_write::write(path, |file| encode(file, picture, curve, exposure))
}

/// Writes the bytes of such a file to any destination.
///
/// # Errors
/// Those of the destination.
pub fn encode(to: impl Write, picture: &Picture, curve: ToneMap, exposure: f32) -> Result<(), atomic_write::Failure> {
    let colours = &picture.colours;
    let colours = parallel::collect(colours.len(), |i| tonemap::map(curve, exposure, colours[i]).map(tonemap::encode));
    let (bytes, color): (Vec<u8>, _) = match &picture.alpha {
        None => (colours.into_flattened(), png::ColorType::Rgb),
        Some(alpha) => {
            let opacity = alpha.iter().map(|alpha| (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
            (colours.into_iter().zip(opacity).flat_map(|([r, g, b], a)| [r, g, b, a]).collect(), png::ColorType::Rgba)
        }
    };
    encode_colour(to, (picture.width, picture.height), color, &bytes)
}

/// Writes RGB of 8 bits, sRGB, row by row. The file is written atomically.
///
/// # Errors
/// [`Fault::Failure`] if the file cannot be written.
pub fn write_bytes(path: &Path, width: u32, height: u32, bytes: &[u8]) -> Result<(), Fault> {
    atomic_write::write(path, |file| encode_colour(file, (width, height), png::ColorType::Rgb, bytes))
}

/// Writes a picture that is shown already, with its opacity if the background is `transparent`. The file is written
/// atomically.
///
/// # Errors
/// [`Fault::Failure`] if the file cannot be written.
pub fn write_image(path: &Path, image: &DisplayImage, transparent: bool) -> Result<(), Fault> {
    let (bytes, color): (Vec<u8>, _) = if transparent {
        (image.pixels.as_flattened().to_vec(), png::ColorType::Rgba)
    } else {
        (image.pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect(), png::ColorType::Rgb)
    };
    atomic_write::write(path, |file| encode_colour(file, (image.width, image.height), color, &bytes))
}

fn encode_colour(
    to: impl Write,
    (width, height): (u32, u32),
    color: png::ColorType,
    bytes: &[u8],
) -> Result<(), atomic_write::Failure> {
    let mut encoder = png::Encoder::new(to, width, height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    Ok(writer.finish()?)
}
