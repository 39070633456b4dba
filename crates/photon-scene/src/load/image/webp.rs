//! WebP, lossy and lossless.

use std::io::Cursor;

use image_webp::{DecodingError, WebPDecoder};

use super::halve::{Halving, Rows};
use super::header::Header;
use super::{Image, ImageError, check_size};

/// Bytes of the decoder for each texel: colours, and lossless ones once more.
const DECODING: u64 = 12;
/// Bytes of the decoder itself.
const OVERHEAD: u64 = 256 << 10;

fn damaged(why: DecodingError) -> ImageError {
    ImageError::new(format!("cannot be decoded as WebP: {why}"))
}

/// A decoder after the header, and the size.
type Opened<'a> = (WebPDecoder<Cursor<&'a [u8]>>, [u32; 2]);

fn open(file: &[u8]) -> Result<Opened<'_>, ImageError> {
    let decoder = WebPDecoder::new(Cursor::new(file)).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    // Stricter than for other formats: the length of a file says nothing about the size of its image.
    let size = check_size(width.into(), height.into(), 4)?;
    if decoder.is_animated() {
        return Err(ImageError::new("is an animated WebP; export one frame of it"));
    }
    Ok((decoder, size))
}

pub(super) fn header(file: &[u8]) -> Result<Header, ImageError> {
    let (_, size) = open(file)?;
    let texels = u64::from(size[0]) * u64::from(size[1]);
    Ok(Header { size, words: 1, decoding: texels * DECODING + OVERHEAD, is_by_rows: true })
}

pub(super) fn decode(file: &[u8], halving: Option<Halving>) -> Result<Image, ImageError> {
    let (mut decoder, size) = open(file)?;
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let texels = size[0] as usize * size[1] as usize;
    let mut data = vec![0; texels * channels];
    decoder.read_image(&mut data).map_err(damaged)?;
    let mut rows = Rows::new(size, halving);
    rows.append(&data, channels);
    rows.finish(size).map_err(|_| ImageError::new("cannot be decoded as WebP: it is truncated"))
}
