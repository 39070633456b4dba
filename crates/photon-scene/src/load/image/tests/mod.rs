//! Images of each format, whole, damaged and oversized.

mod damage;
mod formats;
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
    use exr::prelude::*;
    let width = channels[0].1.len();
    let list: SmallVec<[AnyChannel<FlatSamples>; 4]> = channels
        .iter()
        .map(|(name, values)| AnyChannel::new(Text::new_or_panic(name), FlatSamples::F32(values.to_vec())))
        .collect();
    let layer = Layer::new((width, 1), LayerAttributes::default(), Encoding::SMALL_LOSSLESS, AnyChannels::sort(list));
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}
