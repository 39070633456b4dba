//! Channels with a sample for two texels along an axis, such as the chroma that OpenEXR's own writer stores: the decoder
//! unpacks their blocks, but does not place their samples.

use std::io::Cursor;
use std::ops::Range;

use exr::block::chunk::{Chunk, CompressedBlock};
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::f16;

use super::colors::Source;
use super::window::Window;
use super::{Found, ImageError, Pixels, damaged};

/// Whether a channel of the layer has fewer samples than texels.
pub(super) fn is_coarse(header: &Header) -> bool {
    header.channels.list.iter().any(|channel| channel.sampling.area() != 1)
}

/// Refuses all but a sample for each texel or for two, along each axis, of a picture that is a whole number of them.
pub(super) fn check(header: &Header) -> Result<(), ImageError> {
    if !is_coarse(header) {
        return Ok(());
    }
    header.data_window().validate(None).map_err(damaged)?;
    let (at, size) = (header.own_attributes.layer_position, header.layer_size);
    let is_whole =
        |at: i32, size: usize, step: usize| step == 1 || step == 2 && at.rem_euclid(2) == 0 && size.is_multiple_of(2);
    let is_read = |channel: &ChannelDescription| {
        let step = channel.sampling;
        is_whole(at.x(), size.width(), step.x()) && is_whole(at.y(), size.height(), step.y())
    };
    let others: Vec<String> = header
        .channels
        .list
        .iter()
        .filter(|&channel| !is_read(channel))
        .map(|channel| channel.name.to_string())
        .collect();
    if !others.is_empty() {
        let names = others.join(" and ");
        return Err(ImageError::new(format!(
            "is an OpenEXR file whose channels {names} have neither a sample for each texel nor one for every second; save it \
             with R, G and B"
        )));
    }
    let is_dwa = matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_));
    if is_dwa || header.blocks != BlockDescription::ScanLines {
        return Err(ImageError::new(
            "is an OpenEXR file with chroma for every second texel in tiles or with DWA; save it in lines with ZIP or PIZ",
        ));
    }
    Ok(())
}

/// Reads the channels of `source`, with samples between those that are stored by linear interpolation.
pub(super) fn read(file: &[u8], headers: &[Header], source: &Source<'_>) -> Result<Found, ImageError> {
    let header = source.header;
    let size = header.layer_size;
    let mut pixels = Pixels::new(size);
    pixels.texels.fill([0.0, 0.0, 0.0, 1.0]);
    let named = source.names.iter().enumerate().chain(source.alpha.iter().map(|alpha| (3, alpha)));
    let components: Vec<_> = header
        .channels
        .list
        .iter()
        .map(|channel| named.clone().find(|(_, name)| **name == channel.name).map(|(component, _)| component))
        .collect();
    let mut rest_of_file = Cursor::new(file);
    let meta = MetaData::read_from_buffered(&mut rest_of_file, false).map_err(damaged)?;
    let chunks: usize = meta.headers.iter().map(|header| header.chunk_count).sum();
    // The table of their offsets comes before them.
    rest_of_file.set_position(rest_of_file.position() + 8 * chunks as u64);
    let mut missing = size.height();
    for _ in 0..chunks {
        let chunk = Chunk::read(&mut rest_of_file, &meta).map_err(damaged)?;
        if !headers.get(chunk.layer_index).is_some_and(|of| std::ptr::eq(of, header)) {
            continue;
        }
        let CompressedBlock::ScanLine(block) = chunk.compressed_block else {
            return Err(ImageError::new("cannot be decoded as OpenEXR: a block is not one of lines"));
        };
        let lines = lines_of(header, block.y_coordinate)?;
        missing = missing.saturating_sub(lines.len());
        let values = unpack(header, block.compressed_pixels_le, &lines)?;
        let mut rest = &values[..];
        for y in lines {
            for (channel, component) in header.channels.list.iter().zip(&components) {
                let step = channel.sampling;
                if !y.is_multiple_of(step.y()) {
                    continue;
                }
                let length = size.width() / step.x() * channel.sample_type.bytes_per_sample();
                let (line, after) = rest.split_at(length);
                rest = after;
                if let Some(component) = *component {
                    let row = &mut pixels.texels[y * size.width()..][..size.width()];
                    let texels = row.iter_mut().step_by(step.x());
                    texels.zip(samples(line, channel.sample_type)).for_each(|(texel, value)| texel[component] = value);
                }
            }
        }
    }
    if missing > 0 {
        return Err(ImageError::new(format!("cannot be decoded as OpenEXR: {missing} of its lines are missing")));
    }
    for (channel, component) in header.channels.list.iter().zip(&components) {
        if let Some(component) = *component {
            interpolate(&mut pixels, component, channel.sampling);
        }
    }
    if source.names.len() == 1 {
        pixels.texels.iter_mut().for_each(|texel| *texel = [texel[0], texel[0], texel[0], texel[3]]);
    }
    Ok(Found { texels: pixels.texels, window: Window { at: header.own_attributes.layer_position, size } })
}

/// The lines of the block whose first line is `y` in the coordinates of the file, from the layer's first line.
fn lines_of(header: &Header, y: i32) -> Result<Range<usize>, ImageError> {
    let above = i64::from(y) - i64::from(header.own_attributes.layer_position.y());
    let (height, lines) = (header.layer_size.height(), header.compression.scan_lines_per_block());
    match usize::try_from(above) {
        Ok(first) if first < height && first.is_multiple_of(lines) => Ok(first..height.min(first + lines)),
        _ => Err(ImageError::new(format!("cannot be decoded as OpenEXR: a block starts at line {y}, where none does"))),
    }
}

/// The samples of a block, line by line, of each line channel by channel. The decoder expects as many bytes as all channels
/// have with a sample for each texel, by a number of bytes of a texel, which therefore becomes the number that there are.
fn unpack(header: &Header, packed: Vec<u8>, lines: &Range<usize>) -> Result<Vec<u8>, ImageError> {
    let size = Vec2(header.layer_size.width(), lines.len());
    let of_channel = |channel: &ChannelDescription| {
        let step = channel.sampling;
        lines.clone().filter(|y| y.is_multiple_of(step.y())).count()
            * (size.width() / step.x())
            * channel.sample_type.bytes_per_sample()
    };
    let bytes: usize = header.channels.list.iter().map(of_channel).sum();
    if !bytes.is_multiple_of(size.area()) {
        return Err(ImageError::new(
            "is an OpenEXR file whose chroma is stored in a way that is not read; save it with R, G and B",
        ));
    }
    let mut counted = header.clone();
    counted.channels.bytes_per_pixel = bytes / size.area();
    let at =
        Vec2(header.own_attributes.layer_position.x(), header.own_attributes.layer_position.y() + lines.start as i32);
    let section = IntegerBounds::new(at, size);
    let found =
        header.compression.decompress_image_section_from_le(&counted, packed, section, false).map_err(damaged)?;
    if found.len() == bytes {
        Ok(found)
    } else {
        Err(ImageError::new("cannot be decoded as OpenEXR: a block is too short"))
    }
}

fn samples(line: &[u8], kind: SampleType) -> Vec<f32> {
    let words = |bytes: &[u8]| bytes.first_chunk().copied().unwrap_or_default();
    let halves = |bytes: &[u8]| f16::from_ne_bytes(bytes.first_chunk().copied().unwrap_or_default()).to_f32();
    match kind {
        SampleType::F16 => line.chunks_exact(2).map(halves).collect(),
        SampleType::F32 => line.chunks_exact(4).map(|bytes| f32::from_ne_bytes(words(bytes))).collect(),
        SampleType::U32 => line.chunks_exact(4).map(|bytes| u32::from_ne_bytes(words(bytes)) as f32).collect(),
    }
}

/// Fills every second column and row of a component: with the mean of its neighbours, the last with the one before it.
fn interpolate(pixels: &mut Pixels, component: usize, step: Vec2<usize>) {
    let width = pixels.width;
    if step.x() == 2 {
        for row in pixels.texels.chunks_exact_mut(width).step_by(step.y()) {
            for x in (1..width).step_by(2) {
                let after = row[if x + 1 < width { x + 1 } else { x - 1 }][component];
                row[x][component] = 0.5 * (row[x - 1][component] + after);
            }
        }
    }
    if step.y() == 2 {
        let height = pixels.texels.len() / width;
        for y in (1..height).step_by(2) {
            let next = if y + 1 < height { y + 1 } else { y - 1 };
            for x in 0..width {
                let [above, below] = [y - 1, next].map(|y| pixels.texels[y * width + x][component]);
                pixels.texels[y * width + x][component] = 0.5 * (above + below);
            }
        }
    }
}
