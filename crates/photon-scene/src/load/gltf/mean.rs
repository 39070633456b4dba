//! Mean colours of images.

use crate::color::srgb_to_linear;
use crate::load::image::Image;

/// Mean of the values of an image, in both interpretations that glTF has for them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mean {
    /// As colours: each texel is converted from sRGB to linear before averaging.
    pub(super) color: [f64; 3],
    /// As linear values.
    pub(super) plain: [f64; 3],
    /// Mean alpha; 1 if there is none.
    pub(super) alpha: f64,
    /// Whether all texels are equal, so that nothing is lost.
    pub(super) is_uniform: bool,
}

impl Mean {
    pub(super) fn of(image: &Image) -> Self {
        if image.is_float { of_floats(image) } else { of_bytes(image) }
    }
}

fn of_bytes(image: &Image) -> Mean {
    // Histogram of the values of red, green, blue and alpha.
    let mut counts = [[0_u64; 256]; 4];
    for word in image.texels.iter() {
        for (count, byte) in counts.iter_mut().zip(word.to_le_bytes()) {
            count[usize::from(byte)] += 1;
        }
    }
    let texels = image.texels.len().max(1) as f64;
    let of = |channel: usize, curve: fn(f64) -> f64| {
        let values = counts[channel].iter().enumerate();
        values.map(|(value, &count)| curve(value as f64 / 255.0) * count as f64).sum::<f64>() / texels
    };
    Mean {
        color: std::array::from_fn(|channel| of(channel, srgb_to_linear)),
        plain: std::array::from_fn(|channel| of(channel, |value| value)),
        alpha: of(3, |value| value),
        is_uniform: counts.iter().all(|channel| channel.iter().filter(|&&count| count > 0).count() <= 1),
    }
}

fn of_floats(image: &Image) -> Mean {
    let texels = image.texels.as_chunks::<4>().0;
    let of = |channel: usize| {
        let values = texels.iter().map(|texel| f64::from(f32::from_bits(texel[channel])));
        values.sum::<f64>() / texels.len().max(1) as f64
    };
    let color = [of(0), of(1), of(2)];
    let is_uniform = texels.iter().all(|texel| texel == &texels[0]);
    Mean { color, plain: color, alpha: of(3), is_uniform }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(color: png::ColorType, depth: png::BitDepth, width: u32, data: &[u8]) -> Mean {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        Mean::of(&Image::decode(&bytes).unwrap())
    }

    #[test]
    fn the_mean_is_taken_of_linear_colours() {
        let mean = png(png::ColorType::Rgba, png::BitDepth::Eight, 2, &[255, 0, 188, 255, 0, 0, 188, 0]);
        // 188/255 is the sRGB code nearest to a linear value of one half.
        assert!((mean.color[0] - 0.5).abs() < 1e-12 && mean.color[1] == 0.0, "{mean:?}");
        assert!((mean.color[2] - 0.5).abs() < 0.005, "{mean:?}");
        assert!((mean.plain[2] - 188.0 / 255.0).abs() < 1e-12 && (mean.alpha - 0.5).abs() < 1e-12);
        assert!(!mean.is_uniform);
    }

    #[test]
    fn grey_and_16_bits_are_read() {
        let mean = png(png::ColorType::Grayscale, png::BitDepth::Sixteen, 1, &[0x80, 0x80]);
        assert!(mean.plain.iter().all(|value| (value - 128.0 / 255.0).abs() < 1e-12));
        assert!(mean.alpha == 1.0 && mean.is_uniform);
    }
}
