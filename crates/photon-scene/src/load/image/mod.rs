//! Images from files: the format is determined by the first bytes, and the size is checked before memory is allocated.
//!
//! | format | texels |
//! |---|---|
//! | PNG, JPEG, WebP | bytes; 16 bits are rounded to 8, palettes and greys expanded |
//! | OpenEXR, Radiance HDR | 32-bit floats, linear |
//!
//! Colour profiles and gamma are ignored, as glTF prescribes.

mod bytes;
mod channels;
mod dwa;
mod exr;
mod halve;
mod hdr;
mod header;
mod jpeg;
mod plan;
mod png;
mod room;
mod webp;

pub(super) use self::halve::Halving;
pub(super) use self::header::{Found, Header};
pub(super) use self::plan::{Plan, Wanted};
pub(super) use self::room::Room;

use std::path::Path;
use std::sync::Arc;

use photon_core::{FileKind, TexelFormat};

use super::budget::Budget;
use crate::color::srgb_to_linear;
use crate::error::SceneError;
use crate::texture::TextureDesc;

/// Largest width and height.
const MAX_SIDE: u64 = 65_536;
/// Largest size in memory, in words of 32 bits: 1 GiB.
const MAX_WORDS: u64 = 1 << 28;

/// Why the bytes of an image cannot be used: the predicate of a sentence about it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ImageError(Cause);

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
enum Cause {
    #[error("{0}")]
    Damage(String),
    #[error("{0}")]
    OtherKind(FileKind),
}

impl ImageError {
    fn new(why: impl Into<String>) -> Self {
        Self(Cause::Damage(why.into()))
    }

    /// A decoder's message.
    fn damaged(format: &str, why: &dyn std::fmt::Debug) -> Self {
        let why = format!("{why:?}");
        Self::new(format!("cannot be decoded as {format}: {}", why.trim_matches('"').trim_end_matches("\\n")))
    }
}

/// An image read from a file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Image {
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row from the top left: one word a texel, red in the lowest byte, then green, blue and alpha; or the bits
    /// of four `f32` if [`Self::is_float`].
    pub texels: Arc<[u32]>,
    /// Whether texels are linear floats, finite and ≥ 0. Otherwise bytes, whose encoding depends on their purpose.
    pub is_float: bool,
    /// Number of texels with values that were negative or not finite: NaN and negative ones became 0, infinite ones the
    /// largest finite number.
    pub repaired: u64,
    /// Whether its values had 16 bits, and were rounded to 8.
    pub is_rounded: bool,
    /// Texels that are not those of the file: each the predicate of a sentence about the image.
    pub remarks: Vec<String>,
}

impl Image {
    /// Decodes a PNG, JPEG, WebP, `OpenEXR` or Radiance HDR file.
    ///
    /// # Errors
    /// An unknown format, an image of more than 65536 texels on one side, 1 GiB of memory (`WebP`: 256 MiB) or than the
    /// file can hold, or damaged data.
    pub fn decode(bytes: &[u8]) -> Result<Self, ImageError> {
        Self::decode_halved(bytes, None)
    }

    /// As [`Self::decode`], reduced.
    pub(in crate::load) fn decode_halved(bytes: &[u8], halving: Option<Halving>) -> Result<Self, ImageError> {
        match Format::of(bytes) {
            Format::Png => png::decode(bytes, halving),
            Format::Jpeg => jpeg::decode(bytes, halving),
            Format::WebP => webp::decode(bytes, halving),
            Format::Exr => exr::decode(bytes).map(|image| image.halve(halving)),
            Format::Hdr => hdr::decode(bytes).map(|image| image.halve(halving)),
            Format::Other => Err(not_read(bytes)),
        }
    }

    /// Linear red, green and blue of all texels; bytes are decoded from sRGB.
    #[must_use]
    pub fn linear_rgb(&self) -> Vec<[f32; 3]> {
        if self.is_float {
            let texels = self.texels.chunks_exact(4);
            return texels.map(|texel| [texel[0], texel[1], texel[2]].map(f32::from_bits)).collect();
        }
        let values: [f32; 256] = std::array::from_fn(|byte| srgb_to_linear(byte as f64 / 255.0) as f32);
        let color = |word: &u32| {
            let [r, g, b, _] = word.to_le_bytes();
            [r, g, b].map(|byte| values[usize::from(byte)])
        };
        self.texels.iter().map(color).collect()
    }

    /// The image as a texture; bytes are encoded as `bytes` says.
    #[must_use]
    pub fn texture(&self, name: impl Into<String>, bytes: TexelFormat) -> TextureDesc {
        let format = if self.is_float { TexelFormat::Float32 } else { bytes };
        TextureDesc::from_words(name, [self.width, self.height], format, Arc::clone(&self.texels))
    }

    /// An image of bytes.
    fn of_bytes([width, height]: [u32; 2], words: Vec<u32>) -> Self {
        Self {
            width,
            height,
            texels: words.into(),
            is_float: false,
            repaired: 0,
            is_rounded: false,
            remarks: Vec::new(),
        }
    }

    /// An image of floats, four for each texel; invalid ones are replaced.
    fn of_floats([width, height]: [u32; 2], mut values: Vec<[f32; 4]>) -> Self {
        let mut repaired = 0;
        for texel in &mut values {
            let valid = texel.map(|value| if value >= 0.0 { value.min(f32::MAX) } else { 0.0 });
            repaired += u64::from(valid != *texel);
            // Zeros without a sign, so that equal values have equal bits.
            *texel = valid.map(|value| value + 0.0);
        }
        let words = values.as_flattened().iter().map(|value| value.to_bits()).collect();
        Self { width, height, texels: words, is_float: true, repaired, is_rounded: false, remarks: Vec::new() }
    }
}

/// Reads an image from a file: PNG, JPEG, WebP, `OpenEXR` or Radiance HDR, whatever its name.
///
/// # Errors
/// [`SceneError::Read`] if the file cannot be read, [`SceneError::Content`] with the reasons of [`Image::decode`].
pub fn load_image(path: &Path) -> Result<Image, SceneError> {
    load_image_halved(path, None)
}

/// The header of an image whose colours are used as floats, and the length of its file; `None` for a file that cannot be opened.
///
/// # Errors
/// An image whose header cannot be read, or whose floats would take more than 1 GiB.
pub(crate) fn image_header(path: &Path, budget: &Budget) -> Result<Option<(Header, u64)>, SceneError> {
    let found = Header::of_file(path, budget.left().unwrap_or(u64::MAX));
    // Without a limit, decoding it says why, and may find a header that is far from the start.
    let found = found.filter(|found| found.is_ok() || budget.left().is_some());
    let found = found.transpose().map_err(|why| of_file(path, &why))?;
    if let Some((header, _)) = &found {
        let [width, height] = header.size.map(u64::from);
        check_size(width, height, 4).map_err(|why| of_file(path, &why))?;
    }
    Ok(found)
}

/// As [`load_image`], reduced.
pub(super) fn load_image_halved(path: &Path, halving: Option<Halving>) -> Result<Image, SceneError> {
    Image::decode_halved(&super::read(path)?, halving).map_err(|why| of_file(path, &why))
}

/// The error of the file at `path`.
fn of_file(path: &Path, why: &ImageError) -> SceneError {
    if let Cause::OtherKind(kind) = why.0 {
        return SceneError::OtherKind { path: path.to_owned(), kind };
    }
    SceneError::Content {
        path: path.to_owned(),
        line: None,
        what: format!("the image {why}"),
        hint: "convert it, or export it again".to_owned(),
    }
}

/// The format of a file by its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Png,
    Jpeg,
    WebP,
    Exr,
    Hdr,
    /// One that is not read.
    Other,
}

impl Format {
    fn of(bytes: &[u8]) -> Self {
        match FileKind::of(bytes).and_then(|kind| kind.extension) {
            Some("png") => Self::Png,
            Some("jpg") => Self::Jpeg,
            Some("webp") => Self::WebP,
            Some("exr") => Self::Exr,
            Some("hdr") => Self::Hdr,
            _ => Self::Other,
        }
    }
}

/// The error of a file that is no image that is read.
fn not_read(bytes: &[u8]) -> ImageError {
    match FileKind::of(bytes) {
        Some(kind) => ImageError(Cause::OtherKind(kind)),
        None => ImageError::new("is of an unknown format; only PNG, JPEG, WebP, OpenEXR and Radiance HDR are read"),
    }
}

/// The remark on an image with these primaries and white, four pairs of x and y; `None` for those of Rec. 709, with
/// any of the whites that go with them.
fn primaries_remark(primaries: &[f32]) -> Option<String> {
    const REC_709: [f32; 8] = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290];
    let is_near = primaries.len() == REC_709.len() && primaries.iter().zip(REC_709).all(|(a, b)| (a - b).abs() < 0.025);
    let text = || format!("has primaries of its own, {primaries:?}, and is read as if they were those of Rec. 709");
    (!is_near).then(text)
}

/// Checks a size from a header; `words` is the number of words for each texel.
fn check_size(width: u64, height: u64, words: u64) -> Result<[u32; 2], ImageError> {
    let sides = 1..=MAX_SIDE;
    // The product of two sides within the limit does not overflow.
    if sides.contains(&width) && sides.contains(&height) && width * height * words <= MAX_WORDS {
        return Ok([width as u32, height as u32]);
    }
    Err(ImageError::new(format!(
        "has {width} × {height} texels; it must have between 1 and {MAX_SIDE} on each side, and take up at most 1 GiB"
    )))
}

/// Checks that a file of `bytes` bytes can hold an image of that size at all, if it holds at most `densest` texels in
/// each: a few bytes cannot take up a gigabyte.
fn check_density([width, height]: [u32; 2], bytes: u64, densest: u64) -> Result<(), ImageError> {
    if u64::from(width) * u64::from(height) <= densest.saturating_mul(bytes) {
        return Ok(());
    }
    Err(ImageError::new(format!("promises {width} × {height} texels, more than its {bytes} bytes can hold")))
}

#[cfg(test)]
mod tests;
