//! PNG.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, DecodingError, Reader, Transformations};

use super::halve::{Halving, Rows};
use super::header::Header;
use super::{Image, ImageError, bytes, check_density, check_size};

/// Deflate packs up to 1032 bytes into one, each with up to 8 texels.
const DENSEST: u64 = 8256;
/// Bytes of the decoder itself.
const OVERHEAD: u64 = 256 << 10;

fn damaged(why: DecodingError) -> ImageError {
    let why = why.to_string();
    let why = if why.starts_with("CRC") { "a checksum is wrong" } else { &why };
    ImageError::new(format!("cannot be decoded as PNG: {why}"))
}

/// A reader after the header, and the size.
type Opened<'a> = (Reader<Cursor<&'a [u8]>>, [u32; 2]);

fn open(file: &[u8]) -> Result<Opened<'_>, ImageError> {
    let mut decoder = Decoder::new(Cursor::new(file));
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    let reader = decoder.read_info().map_err(damaged)?;
    let info = reader.info();
    let size = check_size(info.width.into(), info.height.into(), 1)?;
    Ok((reader, size))
}

/// Channels of a row after expansion, and whether they have 16 bits.
fn layout(reader: &Reader<Cursor<&[u8]>>) -> (usize, bool) {
    let (color, depth) = reader.output_color_type();
    let channels = match color {
        ColorType::Grayscale | ColorType::Indexed => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb => 3,
        ColorType::Rgba => 4,
    };
    (channels, depth == BitDepth::Sixteen)
}

pub(super) fn header(file: &[u8], length: u64) -> Result<Header, ImageError> {
    let (reader, size) = open(file)?;
    check_density(size, length, DENSEST)?;
    let (channels, is_wide) = layout(&reader);
    let texel = channels as u64 * if is_wide { 3 } else { 1 };
    let [width, height] = size.map(u64::from);
    // The whole image if it is interlaced; otherwise some rows, and the window of Deflate.
    let held = if reader.info().interlaced { width * height * texel } else { 0 };
    Ok(Header { size, words: 1, decoding: held + 32 * width * texel + OVERHEAD, is_by_rows: true })
}

pub(super) fn decode(file: &[u8], halving: Option<Halving>) -> Result<Image, ImageError> {
    let (mut reader, size) = open(file)?;
    let (channels, is_wide) = layout(&reader);
    let mut rows = Rows::new(size, halving);
    let mut add = |row: &[u8]| match is_wide {
        true => rows.append(&bytes::narrow(row), channels),
        false => rows.append(row, channels),
    };
    if reader.info().interlaced {
        // Rows of an interlaced image are scattered.
        check_density(size, file.len() as u64, DENSEST)?;
        let length = reader.output_buffer_size().ok_or_else(|| ImageError::new("is too large"))?;
        let mut whole = vec![0; length];
        reader.next_frame(&mut whole).map_err(damaged)?;
        add(&whole);
    } else {
        // Row by row, so that a short file does not take the memory of a large image.
        while let Some(row) = reader.next_row().map_err(damaged)? {
            add(row.data());
        }
    }
    let image = rows.finish(size).map_err(|count| {
        let needed = size[0] as usize * size[1] as usize;
        ImageError::new(format!("cannot be decoded as PNG: it has {count} of {needed} texels"))
    })?;
    Ok(Image { is_rounded: is_wide, ..image })
}
