//! WebP, lossy and lossless.

use std::io::Cursor;

use image_webp::{DecodingError, WebPDecoder};

use super::{Image, ImageError, bytes, check_size};

pub(super) fn decode(file: &[u8]) -> Result<Image, ImageError> {
    let damaged = |why: DecodingError| ImageError::new(format!("cannot be decoded as WebP: {why}"));
    let mut decoder = WebPDecoder::new(Cursor::new(file)).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    // Stricter than for other formats: the length of a file says nothing about the size of its image.
    let size = check_size(width.into(), height.into(), 4)?;
    if decoder.is_animated() {
        return Err(ImageError::new("is an animated WebP; export one frame of it"));
    }
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let texels = size[0] as usize * size[1] as usize;
    let mut data = vec![0; texels * channels];
    decoder.read_image(&mut data).map_err(damaged)?;
    let mut words = Vec::with_capacity(texels);
    bytes::append(&mut words, &data, channels);
    Ok(Image::of_bytes(size, words))
}
