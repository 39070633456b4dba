//! Limits the memory of all textures of a scene together: larger ones are halved.

use std::collections::{BTreeMap, BTreeSet};

use photon_core::{TexelFormat, Texture};

use super::MAX_WORDS;
use crate::builder::SceneBuilder;
use crate::color::{linear_to_srgb, srgb_to_linear};
use crate::report::LoadReport;

/// The textures that were halved, by index.
#[derive(Debug, Default)]
pub(in crate::load) struct Room {
    halved: BTreeSet<usize>,
}

impl Room {
    /// Halves the largest textures of the scene until all of them take up at most 1 GiB; to be called after each new
    /// one, so that never much more is taken. Returns whether any was halved: the caller should forget the originals.
    pub(in crate::load) fn make(&mut self, builder: &mut SceneBuilder) -> bool {
        self.make_within(builder, MAX_WORDS)
    }

    fn make_within(&mut self, builder: &mut SceneBuilder, most: u64) -> bool {
        let mut halved = false;
        while words(builder) > most {
            let images = builder.textures.iter().map(|desc| &desc.image);
            let largest = images.map(|image| image.width.max(image.height)).max().unwrap_or(0);
            if largest <= 1 {
                break;
            }
            halved = true;
            // Textures that share their texels go on doing so.
            let mut halves: BTreeMap<(usize, u32), Texture> = BTreeMap::new();
            for (index, desc) in builder.textures.iter_mut().enumerate() {
                let image = &mut desc.image;
                if image.width.max(image.height) > largest / 2 {
                    let key = (image.texels.as_ptr() as usize, image.format as u32);
                    let half = halves.entry(key).or_insert_with(|| half(image));
                    let (texels, width, height) = (half.texels.clone(), half.width, half.height);
                    *image = Texture { texels, width, height, ..image.clone() };
                    self.halved.insert(index);
                }
            }
        }
        halved
    }

    /// Says in the report what was halved.
    pub(in crate::load) fn report(&self, builder: &SceneBuilder, report: &mut LoadReport) {
        if self.halved.is_empty() {
            return;
        }
        let images = self.halved.iter().filter_map(|&index| builder.textures.get(index)).map(|desc| &desc.image);
        let largest = images.map(|image| image.width.max(image.height)).max().unwrap_or(0);
        let text = format!(
            "{} textures are reduced to at most {largest} texels on a side, so that all textures together take up at most \
             1 GiB; use smaller images, or fewer",
            self.halved.len()
        );
        report.approximated("the file", text);
    }
}

/// Memory of all textures in words; shared texels count once.
fn words(builder: &SceneBuilder) -> u64 {
    let mut seen = BTreeSet::new();
    let images = builder.textures.iter().map(|desc| &desc.image);
    let unique = images.filter(|image| seen.insert(image.texels.as_ptr() as usize));
    unique.map(|image| image.texels.len() as u64).sum()
}

/// The image with half as many columns and rows, rounded up: means of linear colours.
fn half(image: &Texture) -> Texture {
    let (width, height) = (image.width.div_ceil(2), image.height.div_ceil(2));
    let channels = Channels::new(image.format);
    let mut texels = Vec::with_capacity(width as usize * height as usize * image.format.words());
    for row in 0..height {
        for column in 0..width {
            let mut sum = [0.0; 4];
            let mut count = 0.0;
            for y in 2 * row..image.height.min(2 * row + 2) {
                for x in 2 * column..image.width.min(2 * column + 2) {
                    let index = y as usize * image.width as usize + x as usize;
                    let texel = channels.read(&image.texels, index);
                    sum = std::array::from_fn(|channel| sum[channel] + texel[channel]);
                    count += 1.0;
                }
            }
            channels.write(&mut texels, sum.map(|part: f64| part / count));
        }
    }
    Texture { texels: texels.into(), width, height, ..image.clone() }
}

/// Decodes and encodes texels.
struct Channels {
    format: TexelFormat,
    /// Linear values of the bytes of a colour.
    values: [f64; 256],
}

impl Channels {
    fn new(format: TexelFormat) -> Self {
        let curve = if format == TexelFormat::Srgb8 { srgb_to_linear } else { |value| value };
        Self { format, values: std::array::from_fn(|byte| curve(byte as f64 / 255.0)) }
    }

    fn read(&self, texels: &[u32], index: usize) -> [f64; 4] {
        if self.format == TexelFormat::Float32 {
            return std::array::from_fn(|channel| f64::from(f32::from_bits(texels[4 * index + channel])));
        }
        let [r, g, b, a] = texels[index].to_le_bytes().map(usize::from);
        [self.values[r], self.values[g], self.values[b], a as f64 / 255.0]
    }

    fn write(&self, texels: &mut Vec<u32>, [r, g, b, a]: [f64; 4]) {
        let byte = |value: f64| (value * 255.0).round() as u8;
        let curve = |value| if self.format == TexelFormat::Srgb8 { linear_to_srgb(value) } else { value };
        match self.format {
            TexelFormat::Float32 => texels.extend([r, g, b, a].map(|part| (part as f32).to_bits())),
            _ => texels.push(u32::from_le_bytes([byte(curve(r)), byte(curve(g)), byte(curve(b)), byte(a)])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::TextureDesc;

    /// V9: the largest are halved first, in linear light, and shared texels stay shared.
    #[test]
    fn the_largest_are_halved_until_all_fit() {
        let mut builder = SceneBuilder::new();
        let large = TextureDesc::srgb8("large", 8, 8, &[[255, 0, 188, 10]; 64]);
        let mut again = large.clone();
        again.name = "again".to_owned();
        builder.texture(large);
        builder.texture(again);
        builder.texture(TextureDesc::linear8("small", 4, 2, &[[7; 4]; 8]));
        let mut room = Room::default();
        assert!(!room.make_within(&mut builder, 72) && room.halved.is_empty());
        assert!(room.make_within(&mut builder, 71));
        let sizes = |builder: &SceneBuilder| -> Vec<[u32; 2]> {
            builder.textures.iter().map(|desc| [desc.image.width, desc.image.height]).collect()
        };
        assert_eq!(sizes(&builder), [[4, 4], [4, 4], [4, 2]]);
        assert_eq!(builder.textures[0].image.texels[..], [u32::from_le_bytes([255, 0, 188, 10]); 16]);
        assert_eq!(builder.textures[0].image.texels.as_ptr(), builder.textures[1].image.texels.as_ptr());
        room.make_within(&mut builder, 5);
        assert_eq!(sizes(&builder), [[1, 1]; 3]);
        let mut report = LoadReport::default();
        room.report(&builder, &mut report);
        assert!(report.to_string().contains("3 textures are reduced to at most 1 texels"), "{report}");
        // Nothing is left to halve.
        assert!(!room.make_within(&mut builder, 0));
    }

    #[test]
    fn means_are_of_linear_colours() {
        let image = |format, texels: Vec<u32>, width| Texture {
            format,
            ..TextureDesc::from_words("x", [width, 1], format, texels.into()).image
        };
        // The mean of black and white is 188 in sRGB, 128 in linear bytes; the third column is alone.
        let srgb = half(&image(TexelFormat::Srgb8, vec![0xFFFF_FFFF, 0, 0x0102_0304], 3));
        assert_eq!((srgb.width, &srgb.texels[..]), (2, &[0x80BC_BCBC, 0x0102_0304][..]));
        let linear = half(&image(TexelFormat::Linear8, vec![0xFFFF_FFFF, 0], 2));
        assert_eq!(linear.texels[..], [0x8080_8080]);
        let float = half(&image(
            TexelFormat::Float32,
            [1e30_f32, 0.0, 2.0, 1.0, 0.0, 0.0, 4.0, 0.0].map(f32::to_bits).to_vec(),
            2,
        ));
        assert_eq!(float.texels[..], [5e29_f32, 0.0, 3.0, 0.5].map(f32::to_bits));
    }
}
