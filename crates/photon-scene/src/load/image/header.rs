//! Sizes of images from the start of their files.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use super::halve::halved;
use super::{Format, ImageError, exr, hdr, jpeg, not_read, png, webp};
use crate::error::bytes_text;

/// So many bytes at the start of a file usually hold its header.
const START: u64 = 64 << 10;
/// A header that does not end within so many bytes, of previews and colour profiles, is not looked for.
const MOST: u64 = 16 << 20;

/// What is known of an image's file: the header and the length in bytes, or why it has no header.
pub(in crate::load) type Found = Result<(Header, u64), ImageError>;

/// The size of an image, and what decoding it takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Header {
    /// Texels in a row, and rows.
    pub(crate) size: [u32; 2],
    /// Words of 32 bits for each texel.
    pub(in crate::load) words: u64,
    /// Bytes that a decoder needs besides the file and the decoded image.
    pub(super) decoding: u64,
    /// Whether it is halved row by row; otherwise the whole image is in memory first.
    pub(super) is_by_rows: bool,
}

impl Header {
    /// Reads the header of a file of `length` bytes that starts with `start`.
    pub(in crate::load) fn read(start: &[u8], length: u64) -> Result<Self, ImageError> {
        match Format::of(start) {
            Format::Png => png::header(start, length),
            Format::Jpeg => jpeg::header(start, length),
            Format::WebP => webp::header(start),
            Format::Exr => exr::header(start, length),
            Format::Hdr => hdr::header(start),
            Format::Other => Err(not_read(start)),
        }
    }

    /// Reads the header of a file, and its length; of most files only the first [`START`] bytes are read, of none more than
    /// [`MOST`] or `left`. `None` for a file that cannot be opened; an error, its reason, for one that is no image, or whose
    /// header is too far from its start.
    pub(in crate::load) fn of_file(path: &Path, left: u64) -> Option<Found> {
        let length = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?.len();
        let mut file = File::open(path).ok()?;
        let mut start = Vec::new();
        file.by_ref().take(START.min(left)).read_to_end(&mut start).ok()?;
        let mut header = Self::read(&start, length);
        let is_image = Format::of(&start) != Format::Other;
        // An image with more than that before its header.
        let most = MOST.min(left).min(length);
        if header.is_err() && is_image && most > start.len() as u64 {
            start.reserve_exact(most as usize - start.len());
            file.take(most - start.len() as u64).read_to_end(&mut start).ok()?;
            header = Self::read(&start, length);
        }
        if header.is_err() && is_image && length > most {
            let why = format!("has no header within its first {}, and memory is limited", bytes_text(most));
            return Some(Err(ImageError::new(why)));
        }
        Some(header.map(|header| (header, length)))
    }

    /// Bytes of a whole image of floats while its texels are put together.
    pub(super) fn floats(size: [u32; 2]) -> u64 {
        16 * u64::from(size[0]) * u64::from(size[1])
    }

    /// That of an image of floats, for which the image with this header stands.
    pub(in crate::load) fn with_floats(&self) -> Self {
        let decoding = self.decoding(0) + 2 * self.bytes(0) + Self::floats(self.size);
        Self { size: self.size, words: 4, decoding, is_by_rows: false }
    }

    /// Bytes that decoding it takes, with its texels and their colours as three floats.
    pub(crate) fn with_colors(&self) -> u64 {
        self.decoding(0) + self.bytes(0) + 12 * u64::from(self.size[0]) * u64::from(self.size[1])
    }

    /// Bytes of its texels, halved so many times.
    pub(in crate::load) fn bytes(&self, times: u32) -> u64 {
        self.size.iter().map(|&side| u64::from(halved(side, times))).product::<u64>() * self.words * 4
    }

    /// Bytes that are needed to decode it and halve it so many times, without those of the file and of the result.
    pub(in crate::load) fn decoding(&self, times: u32) -> u64 {
        // Texels are collected, then copied to where textures share them.
        let collected = match (self.is_by_rows, times) {
            (true, _) => self.bytes(times),
            (false, 0) => 0,
            (false, _) => self.bytes(0),
        };
        self.decoding + collected
    }
}
