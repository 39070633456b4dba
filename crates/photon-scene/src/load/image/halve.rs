//! Halves images: means of linear colours, row by row, so that a large image need not be in memory.

use photon_core::{TexelFormat, Texture};

use super::channels::Channels;
use super::{Image, bytes};

/// How an image is reduced while it is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::load) struct Halving {
    /// How often; 0 for an image that is read as it is.
    pub(in crate::load) times: u32,
    /// Encoding of an image of bytes.
    pub(in crate::load) bytes: TexelFormat,
    /// Whether the mean of colours is weighted by alpha, for a base colour whose alpha is in use.
    pub(in crate::load) weighs: bool,
}

/// A width or height that was halved `times` times, each time rounded up.
pub(in crate::load) fn halved(side: u32, times: u32) -> u32 {
    (0..times).fold(side, |side, _| side.div_ceil(2))
}

/// The image with half as many columns and rows, rounded up; with `weighs`, means are weighted by alpha.
pub(super) fn half(image: &Texture, weighs: bool) -> Texture {
    let (width, height) = (image.width.div_ceil(2), image.height.div_ceil(2));
    let channels = Channels::new(image.format, weighs);
    let words = image.format.words();
    let mut texels = Vec::with_capacity(width as usize * height as usize * words);
    for rows in image.texels.chunks(2 * image.width as usize * words) {
        let (above, below) = rows.split_at(image.width as usize * words);
        channels.half_row(above, Some(below).filter(|below| !below.is_empty()), &mut texels);
    }
    Texture { texels: texels.into(), width, height, ..image.clone() }
}

impl Image {
    /// The image, halved.
    pub(in crate::load) fn halve(self, halving: Option<Halving>) -> Self {
        let Some(Halving { times, bytes, weighs }) = halving else { return self };
        (0..times).fold(self, |image, _| {
            let Texture { width, height, texels, .. } = half(&image.texture("", bytes).image, weighs);
            Self { width, height, texels, ..image }
        })
    }
}

/// Collects the rows of an image of bytes, halved.
pub(super) struct Rows {
    channels: Channels,
    stages: Vec<Stage>,
    width: usize,
    size: [u32; 2],
    words: Vec<u32>,
    /// Number of texels before halving.
    count: usize,
    /// Scratch memory.
    row: Vec<u32>,
}

/// The row that waits for the one below it.
#[derive(Default)]
struct Stage {
    above: Option<Vec<u32>>,
}

impl Rows {
    /// For an image of that size. With `halving`, memory was checked to be available, and is allocated at once; otherwise it
    /// grows with the data.
    pub(super) fn new(size: [u32; 2], halving: Option<Halving>) -> Self {
        let times = halving.map_or(0, |halving| halving.times);
        let small = size.map(|side| halved(side, times));
        let capacity = halving.map_or(0, |_| small[0] as usize * small[1] as usize);
        Self {
            channels: halving.map_or_else(
                || Channels::new(TexelFormat::Linear8, false),
                |halving| Channels::new(halving.bytes, halving.weighs),
            ),
            stages: (0..times).map(|_| Stage::default()).collect(),
            width: size[0] as usize,
            size: small,
            words: Vec::with_capacity(capacity),
            count: 0,
            row: Vec::new(),
        }
    }

    /// Adds whole rows of so many channels.
    pub(super) fn append(&mut self, bytes: &[u8], channels: usize) {
        if self.stages.is_empty() {
            bytes::append(&mut self.words, bytes, channels);
            self.count = self.words.len();
            return;
        }
        for row in bytes.chunks(self.width * channels) {
            let mut words = std::mem::take(&mut self.row);
            words.clear();
            bytes::append(&mut words, row, channels);
            self.count += words.len();
            // Its length is checked by `finish`.
            if words.len() == self.width {
                self.push(0, &words);
            }
            self.row = words;
        }
    }

    /// A row of the stage `at`.
    fn push(&mut self, at: usize, row: &[u32]) {
        match self.stages.get_mut(at) {
            None => self.words.extend_from_slice(row),
            Some(stage) => match stage.above.take() {
                None => stage.above = Some(row.to_vec()),
                Some(above) => self.join(at, &above, Some(row)),
            },
        }
    }

    fn join(&mut self, at: usize, above: &[u32], below: Option<&[u32]>) {
        let mut half = Vec::with_capacity(above.len().div_ceil(2));
        self.channels.half_row(above, below, &mut half);
        self.push(at + 1, &half);
    }

    /// The image, or the number of texels that it has if they are not all there.
    pub(super) fn finish(mut self, [width, height]: [u32; 2]) -> Result<Image, usize> {
        if self.count != width as usize * height as usize {
            return Err(self.count);
        }
        for at in 0..self.stages.len() {
            if let Some(above) = self.stages[at].above.take() {
                self.join(at, &above, None);
            }
        }
        Ok(Image::of_bytes(self.size, self.words))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::TextureDesc;

    #[test]
    fn means_are_of_linear_colours() {
        let image = |format, texels: Vec<u32>, width| Texture {
            format,
            ..TextureDesc::from_words("x", [width, 1], format, texels.into()).image
        };
        // The mean of black and white is 188 in sRGB, 128 in linear bytes; the third column is alone.
        let srgb = half(&image(TexelFormat::Srgb8, vec![0xFFFF_FFFF, 0, 0x0102_0304], 3), false);
        assert_eq!((srgb.width, &srgb.texels[..]), (2, &[0x80BC_BCBC, 0x0102_0304][..]));
        let linear = half(&image(TexelFormat::Linear8, vec![0xFFFF_FFFF, 0], 2), false);
        assert_eq!(linear.texels[..], [0x8080_8080]);
        let float = half(
            &image(TexelFormat::Float32, [1e30_f32, 0.0, 2.0, 1.0, 0.0, 0.0, 4.0, 0.0].map(f32::to_bits).to_vec(), 2),
            false,
        );
        assert_eq!(float.texels[..], [5e29_f32, 0.0, 3.0, 0.5].map(f32::to_bits));
    }

    /// With weights: of two opaque texels and a transparent one, the mean is that of the opaque ones, here of linear ½ and 1;
    /// alpha ⅓ of white and 1 of black give ¼ of white; of what is transparent, all count.
    #[test]
    fn hidden_colours_do_not_count() {
        let image = |format, texels: Vec<u32>| Texture {
            format,
            ..TextureDesc::from_words("x", [texels.len() as u32, 1], format, texels.into()).image
        };
        let black = 0x0000_0000;
        let srgb = |texels: [u32; 2]| half(&image(TexelFormat::Srgb8, texels.to_vec()), true).texels[0];
        assert_eq!(srgb([0xFFBC_BCBC, black]), 0x80BC_BCBC);
        // ¼ has the code 137.
        assert_eq!(srgb([0x55FF_FFFF, 0xFF00_0000]), 0xAA89_8989);
        assert_eq!(srgb([0x00FF_FFFF, black]), 0x00BC_BCBC);
        assert_eq!(srgb([0xFFFF_FFFF, 0xFF00_0000]), 0xFFBC_BCBC);
        let texels = [0.5_f32, 0.0, 1.0, 0.25, 1.0, 1.0, 0.0, 0.75].map(f32::to_bits);
        let float = TextureDesc::from_words("x", [2, 1], TexelFormat::Float32, texels.into()).image;
        assert_eq!(half(&float, true).texels[..], [0.875_f32, 0.75, 0.25, 0.5].map(f32::to_bits));
        // Twice: the weighted mean of weighted means is that of all.
        let row: Vec<u32> = [0xFF80_0000_u32, 0x0000_FF00, 0x00FF_FFFF, 0x00FF_FFFF].to_vec();
        let once = half(&image(TexelFormat::Linear8, row), true);
        assert_eq!(once.texels[..], [0x8080_0000, 0x00FF_FFFF]);
        assert_eq!(half(&once, true).texels[..], [0x4080_0000]);
        assert_eq!(half(&once, false).texels[..], [0x40C0_8080]);
    }

    /// Rows that are halved as they come give the same bits as the whole image halved, for odd sizes too.
    #[test]
    fn rows_are_halved_like_the_whole() {
        for (size, times) in [([8, 8], 1), ([7, 5], 1), ([7, 5], 2), ([13, 9], 3), ([1, 6], 2), ([3, 1], 4)] {
            for bytes in [TexelFormat::Srgb8, TexelFormat::Linear8] {
                let count = size[0] as usize * size[1] as usize;
                let data: Vec<u8> = (0..4 * count).map(|at| (at * at * 31 % 251) as u8).collect();
                let collect = |halving| {
                    let mut rows = Rows::new(size, halving);
                    rows.append(&data, 4);
                    rows.finish(size).unwrap()
                };
                let halving = Some(Halving { times, bytes, weighs: times == 2 });
                let (found, expected) = (collect(halving), collect(None).halve(halving));
                assert_eq!(found, expected, "{size:?} {times}");
                assert_eq!([found.width, found.height], size.map(|side| halved(side, times)));
                assert_ne!(found.texels, collect(None).texels);
            }
        }
    }

    #[test]
    fn missing_rows_are_counted() {
        for times in [0, 1] {
            let mut rows = Rows::new([4, 4], Some(Halving { times, bytes: TexelFormat::Srgb8, weighs: false }));
            rows.append(&[7; 12], 1);
            assert_eq!(rows.finish([4, 4]).unwrap_err(), 12);
        }
    }
}
