//! Limits the memory of all textures of a scene together: larger ones are halved.

use std::collections::{BTreeMap, BTreeSet};

use photon_core::Texture;

use super::MAX_WORDS;
use super::halve::half;
use crate::builder::SceneBuilder;
use crate::report::LoadReport;
use crate::texture::TextureId;

/// The textures that were halved, by index.
#[derive(Debug, Default)]
pub(in crate::load) struct Room {
    halved: BTreeSet<usize>,
    /// The base colours whose alpha is in use, by index: their means are weighted by alpha.
    weighed: BTreeSet<usize>,
}

impl Room {
    /// The texture is a base colour whose alpha is in use.
    pub(in crate::load) fn weigh(&mut self, texture: TextureId) {
        self.weighed.insert(texture.0 as usize);
    }

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
            let address = |image: &Texture| (image.texels.as_ptr() as usize, image.format as u32);
            let weighed = self.weighed.iter().filter_map(|&index| builder.textures.get(index));
            let weighed: BTreeSet<_> = weighed.map(|desc| address(&desc.image)).collect();
            // Textures that share their texels go on doing so.
            let mut halves: BTreeMap<(usize, u32), Texture> = BTreeMap::new();
            for (index, desc) in builder.textures.iter_mut().enumerate() {
                let image = &mut desc.image;
                if image.width.max(image.height) > largest / 2 {
                    let key = address(image);
                    let half = halves.entry(key).or_insert_with(|| half(image, weighed.contains(&key)));
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
        // A base colour with alpha, beside the same image without.
        for (is_weighed, mean) in [(false, 0x8080_8080), (true, 0x80FF_FFFF)] {
            let (mut builder, mut room) = (SceneBuilder::new(), Room::default());
            let texture = builder.texture(TextureDesc::linear8("leaf", 2, 1, &[[255; 4], [0; 4]]));
            if is_weighed {
                room.weigh(texture);
            }
            room.make_within(&mut builder, 1);
            assert_eq!(builder.textures[0].image.texels[..], [mean]);
        }
        // Nothing is left to halve.
        assert!(!room.make_within(&mut builder, 0));
    }

    /// V9: 64 × 4096² texels within 1 GiB, at a scale of 1/32 and texture by texture, as a loader adds them: never more than
    /// one more than fits, and in the end all are halved once, to the mean of black and white in linear light.
    #[test]
    fn many_are_halved_as_they_are_added() {
        let most = MAX_WORDS >> 10;
        let (mut builder, mut room) = (SceneBuilder::new(), Room::default());
        let columns: Vec<[u8; 4]> = (0..128 * 128).map(|at| [(at % 2 * 255) as u8; 4]).collect();
        for at in 0..64 {
            builder.texture(TextureDesc::srgb8(at.to_string(), 128, 128, &columns));
            assert!(words(&builder) <= most + 128 * 128);
            room.make_within(&mut builder, most);
        }
        assert_eq!(words(&builder), most);
        for desc in &builder.textures {
            assert_eq!((desc.image.width, desc.image.height), (64, 64));
            assert!(desc.image.texels.iter().all(|&word| word == u32::from_le_bytes([188, 188, 188, 128])));
        }
        let mut report = LoadReport::default();
        room.report(&builder, &mut report);
        assert!(report.to_string().contains("64 textures are reduced to at most 64 texels"), "{report}");
    }
}
