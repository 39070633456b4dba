//! Mean colours of textures, which replace the textures.

use std::cell::OnceCell;
use std::io::Cursor;

use gltf::json::Root;

use super::buffers::Buffers;
use super::fault::{Fault, label};
use super::uri;

/// Images of more pixels than this are not read: a few bytes can cause hours of decoding.
const MAX_PIXELS: u64 = 1 << 28;

/// Mean of the values of an image, in `[0, 1]`, in both interpretations that glTF has for them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mean {
    /// As colours: each pixel is converted from sRGB to linear before averaging.
    pub(super) color: [f64; 3],
    /// As linear values.
    pub(super) plain: [f64; 3],
    /// Mean alpha; 1 if there is none.
    pub(super) alpha: f64,
    /// Whether all pixels are equal, so that nothing is lost.
    pub(super) is_uniform: bool,
}

/// The textures of a file, decoded on first use.
pub(super) struct Textures<'a> {
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    means: Vec<OnceCell<Result<Mean, String>>>,
}

impl<'a> Textures<'a> {
    pub(super) fn new(root: &'a Root, buffers: &'a Buffers<'a>) -> Self {
        let means = root.images.iter().map(|_| OnceCell::new()).collect();
        Self { root, buffers, means }
    }

    /// Name of a texture in messages: its own name, or that of its image.
    pub(super) fn name(&self, texture: usize) -> String {
        let found = self.root.textures.get(texture);
        let image = found.and_then(|texture| self.root.images.get(texture.source.value()));
        let name = found.and_then(|texture| texture.name.as_deref()).or_else(|| {
            let uri = image.and_then(|image| image.uri.as_deref());
            image.and_then(|image| image.name.as_deref()).or(uri.filter(|uri| !uri.starts_with("data:")))
        });
        label("texture", texture, name)
    }

    /// The mean of a texture, or the reason why there is none: an image that cannot be read only loses its
    /// pattern and is no error.
    ///
    /// # Errors
    ///
    /// A reference to a texture or an image that the file does not have.
    pub(super) fn mean(&self, texture: usize, user: &str) -> Result<Result<Mean, String>, Fault> {
        let textures = &self.root.textures;
        let found = textures.get(texture).ok_or_else(|| Fault::dangling(user, "texture", texture, textures.len()))?;
        let image = found.source.value();
        // The parser's marker for a texture whose image is in an extension.
        if image == u32::MAX as usize {
            return Ok(Err("its image is of a kind that cannot be read".to_owned()));
        }
        let cell = self
            .means
            .get(image)
            .ok_or_else(|| Fault::dangling(&self.name(texture), "image", image, self.means.len()))?;
        Ok(cell.get_or_init(|| self.decode(image)).clone())
    }

    fn decode(&self, index: usize) -> Result<Mean, String> {
        let image = &self.root.images[index];
        match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                let bytes =
                    uri::read(uri, self.buffers.folder()).map_err(|(why, hint)| format!("its image {why}; {hint}"))?;
                mean_of_png(&bytes)
            }
            (None, Some(view)) => {
                let bytes = self.buffers.view(view.value(), &format!("image {index}"));
                mean_of_png(bytes.map_err(|fault| fault.to_string())?)
            }
            (None, None) => Err("its image has no data".to_owned()),
        }
    }
}

fn mean_of_png(bytes: &[u8]) -> Result<Mean, String> {
    if !bytes.starts_with(b"\x89PNG") {
        let kind = if bytes.starts_with(b"\xff\xd8") { "a JPEG" } else { "not a PNG" };
        return Err(format!("its image is {kind}, and only PNG is read; convert it"));
    }
    count_values(bytes).map(|counts| mean(&counts)).map_err(|error| format!("its image cannot be decoded: {error}"))
}

/// Histogram of the values of red, green, blue and alpha. Integers, so that the mean
/// does not depend on the order of the pixels.
type Counts = [[u64; 256]; 4];

fn count_values(bytes: &[u8]) -> Result<Counts, png::DecodingError> {
    use png::ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb, Rgba};
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info()?;
    let info = reader.info();
    if u64::from(info.width) * u64::from(info.height) > MAX_PIXELS {
        return Err(png::DecodingError::LimitsExceeded);
    }
    // The channel of a pixel that holds red, green, blue and alpha.
    let (width, channels): (usize, [Option<usize>; 4]) = match reader.output_color_type().0 {
        Grayscale | Indexed => (1, [Some(0), Some(0), Some(0), None]),
        GrayscaleAlpha => (2, [Some(0), Some(0), Some(0), Some(1)]),
        Rgb => (3, [Some(0), Some(1), Some(2), None]),
        Rgba => (4, [Some(0), Some(1), Some(2), Some(3)]),
    };
    let mut counts: Counts = [[0; 256]; 4];
    while let Some(row) = reader.next_row()? {
        for pixel in row.data().chunks_exact(width) {
            for (count, channel) in counts.iter_mut().zip(channels) {
                count[usize::from(channel.map_or(255, |channel| pixel[channel]))] += 1;
            }
        }
    }
    Ok(counts)
}

fn mean(counts: &Counts) -> Mean {
    let of = |channel: usize, curve: fn(f64) -> f64| {
        let pixels: u64 = counts[channel].iter().sum();
        let sum: f64 =
            counts[channel].iter().enumerate().map(|(value, &count)| curve(value as f64 / 255.0) * count as f64).sum();
        sum / pixels.max(1) as f64
    };
    Mean {
        color: std::array::from_fn(|channel| of(channel, srgb_to_linear)),
        plain: std::array::from_fn(|channel| of(channel, |value| value)),
        alpha: of(3, |value| value),
        is_uniform: counts.iter().all(|channel| channel.iter().filter(|&&count| count > 0).count() <= 1),
    }
}

/// Converts sRGB to linear (IEC 61966-2-1).
fn srgb_to_linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(color: png::ColorType, depth: png::BitDepth, width: u32, height: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    #[test]
    fn the_mean_is_taken_of_linear_colours() {
        let half_black = png(png::ColorType::Rgba, png::BitDepth::Eight, 2, 1, &[255, 0, 188, 255, 0, 0, 188, 0]);
        let mean = mean_of_png(&half_black).unwrap();
        // 188/255 is the sRGB code nearest to a linear value of one half.
        assert!((mean.color[0] - 0.5).abs() < 1e-12 && mean.color[1] == 0.0, "{mean:?}");
        assert!((mean.color[2] - 0.5).abs() < 0.005, "{mean:?}");
        assert!((mean.plain[2] - 188.0 / 255.0).abs() < 1e-12 && (mean.alpha - 0.5).abs() < 1e-12);
    }

    #[test]
    fn grey_and_16_bits_are_read() {
        let grey = png(png::ColorType::Grayscale, png::BitDepth::Sixteen, 1, 1, &[0x80, 0x80]);
        let mean = mean_of_png(&grey).unwrap();
        assert!(mean.plain.iter().all(|value| (value - 128.0 / 255.0).abs() < 1e-12));
        assert_eq!(mean.alpha, 1.0);
    }

    #[test]
    fn other_images_and_cut_ones_are_refused() {
        let whole = png(png::ColorType::Grayscale, png::BitDepth::Eight, 8, 8, &[7; 64]);
        assert!(mean_of_png(&whole).is_ok());
        for length in 0..whole.len() - 16 {
            assert!(mean_of_png(&whole[..length]).is_err(), "{length}");
        }
        assert!(mean_of_png(b"\xff\xd8\xff").unwrap_err().contains("JPEG"));
    }
}
