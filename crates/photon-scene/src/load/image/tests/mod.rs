//! Images of each format, whole, damaged and oversized.

mod damage;
mod formats;
mod openexr;
mod radiance;

/// The reason for which an image is refused.
#[track_caller]
fn refused(bytes: &[u8]) -> String {
    super::Image::decode(bytes).expect_err("an error").to_string()
}

/// A PNG of 8 or 16 bits.
fn png(color: png::ColorType, depth: png::BitDepth, [width, height]: [u32; 2], data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    bytes
}

/// An `OpenEXR` file with channels of those names and values, all of one row.
fn exr(channels: &[(&str, &[f32])]) -> Vec<u8> {
    let width = channels[0].1.len();
    exr_within(channels, ((0, 0), (width, 1)), ((0, 0), (width, 1)))
}

/// The same with a data and a display window, each of a position and a size.
fn exr_within(
    channels: &[(&str, &[f32])],
    (at, size): ((i32, i32), (usize, usize)),
    (shown_at, shown_size): ((i32, i32), (usize, usize)),
) -> Vec<u8> {
    use exr::prelude::*;
    let list: SmallVec<[AnyChannel<FlatSamples>; 4]> = channels
        .iter()
        .map(|(name, values)| AnyChannel::new(Text::new_or_panic(name), FlatSamples::F32(values.to_vec())))
        .collect();
    let attributes = LayerAttributes { layer_position: at.into(), ..LayerAttributes::default() };
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(list));
    let window = IntegerBounds::new(shown_at, shown_size);
    let image = Image::empty(ImageAttributes::new(window)).with_layer(layer);
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}
