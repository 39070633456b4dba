//! PNG output.

use std::io::Write;
use std::path::Path;

use photon_core::{Display, DisplayImage, Film, parallel};

use crate::atomic_write;
use crate::fault::Fault;
use crate::tonemap::ToneMap;

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

    /// The picture with other colours of as many pixels, for example denoised ones.
    #[must_use]
    pub fn of(film: &Film, mut colours: Vec<[f32; 3]>, transparent: bool) -> Self {
        let alpha = transparent.then(|| film.alpha());
        for (colour, alpha) in colours.iter_mut().zip(alpha.iter().flatten()) {
            *colour = Display::straight(*colour, *alpha);
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
    let Picture { width, height, colours, alpha } = picture;
    let transparent = alpha.is_some();
    let display = Display { exposure, tone_map: curve.into(), transparent };
    let opacity = |i: usize| alpha.as_ref().map_or(1.0, |alpha| alpha[i]);
    let pixels = parallel::collect(colours.len(), |i| display.pixel_of_straight(colours[i], opacity(i)));
    encode_pixels(to, (*width, *height), &pixels, transparent)
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
    atomic_write::write(path, |file| encode_pixels(file, (image.width, image.height), &image.pixels, transparent))
}

/// Encodes pixels as [`Display::pixel`] makes them, without their opacity unless the picture is `transparent`.
fn encode_pixels(
    to: impl Write,
    size: (u32, u32),
    pixels: &[[u8; 4]],
    transparent: bool,
) -> Result<(), atomic_write::Failure> {
    if transparent {
        return encode_colour(to, size, png::ColorType::Rgba, pixels.as_flattened());
    }
    let bytes: Vec<u8> = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
    encode_colour(to, size, png::ColorType::Rgb, &bytes)
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
