//! `OpenEXR`: the first layer with colours, or with a luminance.

use std::io::Cursor;

use exr::compression::Compression;
use exr::error::Error;
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, read};

use super::header::Header;
use super::{Image, ImageError, check_density, check_size, dwa};

/// Deflate packs up to 1032 bytes into one, and a channel takes at least two bytes of each texel.
const DENSEST: u64 = 516;
/// Bytes of the decoder itself.
const OVERHEAD: u64 = 256 << 10;

/// Texels while a file is read.
struct Pixels {
    width: usize,
    texels: Vec<[f32; 4]>,
}

impl Pixels {
    fn new(size: Vec2<usize>) -> Self {
        Self { width: size.width(), texels: vec![[0.0; 4]; size.area()] }
    }

    fn set(&mut self, at: Vec2<usize>, texel: [f32; 4]) {
        let index = at.y() * self.width + at.x();
        if let Some(place) = self.texels.get_mut(index) {
            *place = texel;
        }
    }

    fn image(self, size: Vec2<usize>) -> Result<Image, ImageError> {
        Ok(Image::of_floats(check_size(size.width() as u64, size.height() as u64, 4)?, self.texels))
    }
}

/// Refuses what the decoder does not support, and B44, in which damaged files make it panic.
fn check_compression(compression: Compression) -> Result<(), ImageError> {
    match compression {
        Compression::Uncompressed
        | Compression::RLE
        | Compression::ZIP1
        | Compression::ZIP16
        | Compression::PIZ
        | Compression::PXR24
        | Compression::DWAA(_)
        | Compression::DWAB(_) => Ok(()),
        other => Err(ImageError::new(format!("is an OpenEXR file with {other}; save it with ZIP or PIZ"))),
    }
}

fn damaged(why: Error) -> ImageError {
    ImageError::new(format!("cannot be decoded as OpenEXR: {why}"))
}

/// The layers of a file of `length` bytes, with sizes that were checked.
fn open(file: &[u8], length: u64) -> Result<MetaData, ImageError> {
    let meta = MetaData::read_from_buffered(Cursor::new(file), false).map_err(damaged)?;
    for header in &meta.headers {
        let size = check_size(header.layer_size.width() as u64, header.layer_size.height() as u64, 4)?;
        check_density(size, length, DENSEST)?;
        check_compression(header.compression)?;
    }
    Ok(meta)
}

/// That of the largest layer.
pub(super) fn header(file: &[u8], length: u64) -> Result<Header, ImageError> {
    let meta = open(file, length)?;
    let area = |header: &&exr::meta::header::Header| header.layer_size.area();
    let largest = meta.headers.iter().max_by_key(area).ok_or_else(|| ImageError::new("has no layers"))?;
    let size = [largest.layer_size.width() as u32, largest.layer_size.height() as u32];
    // Blocks have up to 256 lines.
    let block = u64::from(size[0]) * 256 * largest.channels.bytes_per_pixel as u64;
    Ok(Header { size, words: 4, decoding: Header::floats(size) + 3 * block + OVERHEAD, is_by_rows: false })
}

pub(super) fn decode(file: &[u8]) -> Result<Image, ImageError> {
    let meta = open(file, file.len() as u64)?;
    dwa::check(file, &meta.headers)?;
    let has = |name: &str| {
        let named = |channel: &exr::meta::attribute::ChannelDescription| channel.name.eq_case_insensitive(name);
        meta.headers.iter().any(|header| header.channels.list.iter().any(named))
    };
    if ["R", "G", "B"].into_iter().all(has) {
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .rgba_channels(
                |size, _| Pixels::new(size),
                |pixels: &mut Pixels, at, (r, g, b, a): (f32, f32, f32, f32)| pixels.set(at, [r, g, b, a]),
            )
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(file))
            .map_err(damaged)?;
        return image.layer_data.channel_data.pixels.image(image.layer_data.size);
    }
    if !has("Y") {
        return Err(ImageError::new("is an OpenEXR file without the channels R, G and B, or Y"));
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("Y")
        .collect_pixels(
            |size, _| Pixels::new(size),
            |pixels: &mut Pixels, at, (grey,): (f32,)| pixels.set(at, [grey, grey, grey, 1.0]),
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(file))
        .map_err(damaged)?;
    image.layer_data.channel_data.pixels.image(image.layer_data.size)
}
