//! JPEG.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::{Image, ImageError, MAX_SIDE, bytes, check_density, check_size};

/// A progressive file needs a bit for each block of 64 texels.
const DENSEST: u64 = 512;

pub(super) fn decode(file: &[u8]) -> Result<Image, ImageError> {
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
    check_density(size, file.len(), DENSEST)?;
    if matches!(decoder.input_colorspace(), Some(ColorSpace::CMYK | ColorSpace::YCCK)) {
        return Err(ImageError::new("is a JPEG in CMYK, a colour space of printers; convert it to RGB"));
    }
    let data = decoder.decode().map_err(|why| ImageError::damaged("JPEG", &why))?;
    let texels = size[0] as usize * size[1] as usize;
    let channels = data.len() / texels;
    if !(1..=4).contains(&channels) || channels * texels != data.len() {
        return Err(ImageError::new(format!("cannot be decoded as JPEG: {} bytes for {texels} texels", data.len())));
    }
    let mut words = Vec::with_capacity(texels);
    bytes::append(&mut words, &data, channels);
    Ok(Image::of_bytes(size, words))
}
