//! Decoding of texels, in f64.

use photon_core::{TexelFormat, Texture};

use crate::color::srgb_to_linear;

/// Reads linear colours from an image.
pub(super) struct Decoder<'a> {
    image: &'a Texture,
    /// Values of the bytes.
    values: [f64; 256],
}

impl<'a> Decoder<'a> {
    pub(super) fn new(image: &'a Texture) -> Self {
        let curve = if image.format == TexelFormat::Srgb8 { srgb_to_linear } else { |value| value };
        Self { image, values: std::array::from_fn(|byte| curve(byte as f64 / 255.0)) }
    }

    /// Red, green and blue of the texel at column `x` of row `y`, which must exist.
    pub(super) fn color(&self, x: usize, y: usize) -> [f64; 3] {
        let index = y * self.image.width as usize + x;
        if self.image.format.is_float() {
            return std::array::from_fn(|channel| f64::from(f32::from_bits(self.image.texels[4 * index + channel])));
        }
        let [r, g, b, _] = self.image.texels[index].to_le_bytes();
        [r, g, b].map(|byte| self.values[usize::from(byte)])
    }
}
