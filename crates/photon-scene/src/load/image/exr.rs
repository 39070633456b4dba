//! `OpenEXR`: the first layer with colours, or with a luminance, as far as its display window reaches.

mod coarse;
mod colors;
mod window;

use std::io::Cursor;

use exr::compression::Compression;
use exr::error::Error;
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::Text;
use exr::meta::header::Header as FileHeader;
use exr::prelude::{Layer, ReadChannels, ReadLayers, ReadSpecificChannel, SpecificChannels, read};

use self::colors::Source;
use self::window::{Placed, Window};
use super::header::Header;
use super::{Image, ImageError, check_density, check_size, dwa};

/// Deflate packs up to 1032 bytes into one, and a channel takes at least two bytes of each texel.
const DENSEST: u64 = 516;
/// Texels of the display window for each byte of the file, of which the data window may be a small part.
const SPARSEST: u64 = 16 * DENSEST;
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
}

/// A layer that was read.
struct Found {
    texels: Vec<[f32; 4]>,
    window: Window,
}

impl Found {
    fn of<C>(layer: Layer<SpecificChannels<Pixels, C>>) -> Self {
        let window = Window { at: layer.attributes.layer_position, size: layer.size };
        Self { texels: layer.channel_data.pixels.texels, window }
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
        check_density(size_of(header.layer_size)?, length, DENSEST)?;
        check_density(size_of(header.shared_attributes.display_window.size)?, length, SPARSEST)?;
        check_compression(header.compression)?;
    }
    Ok(meta)
}

fn size_of(size: Vec2<usize>) -> Result<[u32; 2], ImageError> {
    check_size(size.width() as u64, size.height() as u64, 4)
}

pub(super) fn header(file: &[u8], length: u64) -> Result<Header, ImageError> {
    let meta = open(file, length)?;
    let layer = colors::find(&meta.headers)?.header;
    let [data, size] = [layer.layer_size, layer.shared_attributes.display_window.size].map(size_of);
    let (data, size) = (data?, size?);
    // Blocks have up to 256 lines.
    let block = u64::from(data[0]) * 256 * layer.channels.bytes_per_pixel as u64;
    let placed = if data == size { 0 } else { Header::floats(size) };
    Ok(Header { size, words: 4, decoding: Header::floats(data) + placed + 3 * block + OVERHEAD, is_by_rows: false })
}

pub(super) fn decode(file: &[u8]) -> Result<Image, ImageError> {
    let meta = open(file, file.len() as u64)?;
    let source = colors::find(&meta.headers)?;
    let is_coarse = coarse::is_coarse(source.header);
    let found =
        if is_coarse { coarse::read(file, &meta.headers, &source) } else { read_plain(file, &meta.headers, &source) };
    let Found { mut texels, window: data } = found?;
    let attributes = &source.header.shared_attributes;
    if source.is_chroma {
        colors::from_chroma(&mut texels, attributes.chromaticities);
    }
    let shown = Window { at: attributes.display_window.position, size: attributes.display_window.size };
    let outside = if source.alpha.is_some() { 0.0 } else { 1.0 };
    let Placed { texels, mut remarks } = window::place(texels, data, shown, outside)?;
    remarks.extend(colors::remark(attributes.chromaticities));
    if source.has_others {
        remarks.push("has other layers of colours, which are left out".to_owned());
    }
    Ok(Image { remarks, ..Image::of_floats(size_of(shown.size)?, texels) })
}

/// Reads channels with a sample for each texel.
fn read_plain(file: &[u8], headers: &[FileHeader], source: &Source<'_>) -> Result<Found, ImageError> {
    dwa::check(file, headers)?;
    let alpha = source.alpha.clone().unwrap_or_else(|| Text::from("A"));
    let layers = read().no_deep_data().largest_resolution_level().specific_channels();
    let layer = match &source.names[..] {
        [r, g, b] => {
            let set = |pixels: &mut Pixels, at, (r, g, b, a): (f32, f32, f32, f32)| pixels.set(at, [r, g, b, a]);
            let channels = layers.required(r.clone()).required(g.clone()).required(b.clone()).optional(alpha, 1.0);
            let reader = channels.collect_pixels(|size, _| Pixels::new(size), set).first_valid_layer();
            reader
                .all_attributes()
                .non_parallel()
                .from_buffered(Cursor::new(file))
                .map(|image| Found::of(image.layer_data))
        }
        grey => {
            let set = |pixels: &mut Pixels, at, (y, a): (f32, f32)| pixels.set(at, [y, y, y, a]);
            let channels = layers.required(grey[0].clone()).optional(alpha, 1.0);
            let reader = channels.collect_pixels(|size, _| Pixels::new(size), set).first_valid_layer();
            reader
                .all_attributes()
                .non_parallel()
                .from_buffered(Cursor::new(file))
                .map(|image| Found::of(image.layer_data))
        }
    };
    layer.map_err(damaged)
}
