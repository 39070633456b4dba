//! PNG.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, DecodingError, Transformations};

use super::{Image, ImageError, bytes, check_density, check_size};

/// Deflate packs up to 1032 bytes into one, each with up to 8 texels.
const DENSEST: u64 = 8256;

pub(super) fn decode(file: &[u8]) -> Result<Image, ImageError> {
    let damaged = |why: DecodingError| ImageError::new(format!("cannot be decoded as PNG: {why}"));
    let mut decoder = Decoder::new(Cursor::new(file));
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let info = reader.info();
    let (is_interlaced, size) = (info.interlaced, check_size(info.width.into(), info.height.into(), 1)?);
    let (color, depth) = reader.output_color_type();
    let channels = match color {
        ColorType::Grayscale | ColorType::Indexed => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb => 3,
        ColorType::Rgba => 4,
    };
    let is_wide = depth == BitDepth::Sixteen;
    let mut words = Vec::new();
    let mut add = |row: &[u8]| match is_wide {
        true => bytes::append(&mut words, &bytes::narrow(row), channels),
        false => bytes::append(&mut words, row, channels),
    };
    if is_interlaced {
        // Rows of an interlaced image are scattered.
        check_density(size, file.len(), DENSEST)?;
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
    let needed = size[0] as usize * size[1] as usize;
    if words.len() != needed {
        return Err(ImageError::new(format!("cannot be decoded as PNG: it has {} of {needed} texels", words.len())));
    }
    Ok(Image { is_rounded: is_wide, ..Image::of_bytes(size, words) })
}
