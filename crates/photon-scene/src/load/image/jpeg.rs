//! JPEG.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::halve::{Halving, Rows};
use super::header::Header;
use super::{Image, ImageError, MAX_SIDE, check_density, check_size};
use crate::error::bytes_text;

/// A progressive file needs a bit for each block of 64 texels.
const DENSEST: u64 = 512;
/// Bytes of the decoder for each texel: colours.
const COLORS: u64 = 4;
/// The same with the coefficients of progressive files.
const COEFFICIENTS: u64 = 12;
/// Largest number of bytes of the decoder.
const MOST: u64 = 2 << 30;
/// Bytes of the decoder itself.
const OVERHEAD: u64 = 256 << 10;

/// A decoder after the header, and the size.
type Opened<'a> = (JpegDecoder<ZCursor<&'a [u8]>>, [u32; 2]);

fn open(file: &[u8], length: u64) -> Result<Opened<'_>, ImageError> {
    let options = DecoderOptions::default()
        .set_max_width(MAX_SIDE as usize)
        .set_max_height(MAX_SIDE as usize)
        .set_strict_mode(true)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(file), options);
    decoder.decode_headers().map_err(|why| ImageError::damaged("JPEG", &why))?;
    let unreadable = || ImageError::new("cannot be decoded as JPEG: it has no header");
    let (width, height) = decoder.dimensions().ok_or_else(unreadable)?;
    let size = check_size(width as u64, height as u64, 1)?;
    check_density(size, length, DENSEST)?;
    let needed = decoding(&decoder, size);
    if needed > MOST {
        let [width, height] = size;
        return Err(ImageError::new(format!(
            "is a progressive JPEG of {width} × {height} texels, which takes {} to decode, more than {}; save it as a \
             baseline JPEG, or smaller",
            bytes_text(needed),
            bytes_text(MOST)
        )));
    }
    if matches!(decoder.input_colorspace(), Some(ColorSpace::CMYK | ColorSpace::YCCK)) {
        return Err(ImageError::new("is a JPEG in CMYK, a colour space of printers; convert it to RGB"));
    }
    Ok((decoder, size))
}

/// Bytes of the decoder.
fn decoding(decoder: &JpegDecoder<ZCursor<&[u8]>>, size: [u32; 2]) -> u64 {
    let is_baseline = decoder.info().is_some_and(|info| info.sof.is_sequential_dct());
    // Whole blocks of up to 32 × 32 texels.
    let texels: u64 = size.iter().map(|&side| u64::from(side).next_multiple_of(32)).product();
    texels * if is_baseline { COLORS } else { COEFFICIENTS } + OVERHEAD
}

pub(super) fn header(file: &[u8], length: u64) -> Result<Header, ImageError> {
    let (decoder, size) = open(file, length)?;
    Ok(Header { size, words: 1, decoding: decoding(&decoder, size), is_by_rows: true })
}

pub(super) fn decode(file: &[u8], halving: Option<Halving>) -> Result<Image, ImageError> {
    let (mut decoder, size) = open(file, file.len() as u64)?;
    let data = decoder.decode().map_err(|why| ImageError::damaged("JPEG", &why))?;
    let texels = size[0] as usize * size[1] as usize;
    let channels = data.len() / texels;
    let mut rows = Rows::new(size, halving);
    if (1..=4).contains(&channels) && channels * texels == data.len() {
        rows.append(&data, channels);
    }
    rows.finish(size)
        .map_err(|_| ImageError::new(format!("cannot be decoded as JPEG: {} bytes for {texels} texels", data.len())))
}
