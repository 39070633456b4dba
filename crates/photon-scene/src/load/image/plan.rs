//! Decides from headers, before any image is decoded, how often each is halved so that all fit into memory.

use super::MAX_WORDS;
use super::halve::halved;
use super::header::Header;
use crate::load::budget::{Budget, Shortage};
use crate::report::LoadReport;

/// Images are not reduced below this many texels on their longer side.
const LEAST_SIDE: u32 = 64;

/// An image that materials use.
#[derive(Clone, Debug)]
pub(in crate::load) struct Wanted {
    pub(in crate::load) header: Header,
    /// Length of its file, which is in memory while it is decoded.
    pub(in crate::load) file: u64,
    /// How many copies of its texels are kept: one for each encoding.
    pub(in crate::load) copies: u64,
    /// Further textures of bytes that are made of it.
    pub(in crate::load) made: u64,
    /// The materials that use it and the name of the texture, as in `(material 'wood', texture 3 'wood.png')`.
    pub(in crate::load) users: Vec<(String, String)>,
}

impl Wanted {
    /// Bytes that stay.
    fn kept(&self, times: u32) -> u64 {
        let bytes = self.header.bytes(times);
        bytes * self.copies + bytes / self.header.words * self.made
    }

    /// Further bytes while it is decoded.
    fn decoding(&self, times: u32) -> u64 {
        self.file + self.header.decoding(times)
    }

    fn side(&self, times: u32) -> u32 {
        self.header.size.into_iter().map(|side| halved(side, times)).max().unwrap_or(0)
    }

    /// How often it is halved at most.
    fn most(&self) -> u32 {
        (0..).find(|&times| self.side(times) <= LEAST_SIDE).unwrap_or(0)
    }

    fn text(&self, times: u32) -> String {
        let [width, height] = self.header.size.map(|side| halved(side, times));
        format!("{width} × {height} texels")
    }

    /// The image with its materials, for errors.
    fn subject(&self) -> String {
        let (material, texture) = self.users.first().cloned().unwrap_or_default();
        let others = match self.users.len() {
            0 | 1 => String::new(),
            count => format!(" and {} others", count - 1),
        };
        format!("{texture} of {material}{others} ({})", self.text(0))
    }
}

/// How often each image is halved.
#[derive(Clone, Debug, Default)]
pub(in crate::load) struct Plan {
    images: Vec<Wanted>,
    times: Vec<u32>,
}

impl Plan {
    /// Halves the largest images until all that stays, and the one that takes most to decode, fit into what is left of
    /// `budget`; all that stays is taken from it.
    pub(in crate::load) fn new(images: Vec<Wanted>, budget: &Budget) -> Result<Self, Shortage> {
        let left = budget.left().unwrap_or(u64::MAX);
        // One image that cannot be decoded, whatever happens to the others.
        let alone = |image: &&Wanted| image.kept(image.most()).saturating_add(image.decoding(image.most())) > left;
        if let Some(image) = images.iter().find(alone) {
            let needed = image.kept(image.most()) + image.decoding(image.most());
            return Err(budget.shortage(format!("{}, while it is decoded,", image.subject()), needed));
        }
        let mut times = vec![0; images.len()];
        loop {
            let of = |what: fn(&Wanted, u32) -> u64| {
                images.iter().zip(&times).map(move |(image, &times)| what(image, times))
            };
            let (kept, decoding) = (of(Wanted::kept).sum::<u64>(), of(Wanted::decoding).max().unwrap_or(0));
            if kept.saturating_add(decoding) <= left && kept <= 4 * MAX_WORDS {
                budget.take(kept, || "the textures".to_owned())?;
                return Ok(Self { images, times });
            }
            let halvable = images.iter().zip(&times).filter(|(image, times)| **times < image.most());
            let Some(largest) = halvable.map(|(image, &times)| image.side(times)).max() else {
                // The first of those that are equal.
                let largest = images.iter().rev().max_by_key(|image| image.kept(0));
                let subject = largest.map(Wanted::subject).unwrap_or_default();
                let count = images.len();
                let object = format!(
                    "{subject}, the largest of {count}, with the others and reduced to at most {LEAST_SIDE} texels on a side,"
                );
                return Err(budget.shortage(object, kept.saturating_add(decoding)));
            };
            for (image, times) in images.iter().zip(&mut times) {
                if image.side(*times) > largest / 2 && *times < image.most() {
                    *times += 1;
                }
            }
        }
    }

    /// How often the image of that number is halved.
    pub(in crate::load) fn times(&self, image: usize) -> u32 {
        self.times.get(image).copied().unwrap_or(0)
    }

    /// Says in the report which images are halved: their number, and for each material its textures and their sizes.
    pub(in crate::load) fn report(&self, report: &mut LoadReport) {
        let reduced = self.images.iter().zip(&self.times).filter(|(_, times)| **times > 0);
        let mut materials: Vec<(&str, Vec<String>)> = Vec::new();
        let mut count = 0;
        for (image, &times) in reduced {
            count += 1;
            for (material, texture) in &image.users {
                let text = format!("{texture} from {} to {}", image.text(0), image.text(times));
                match materials.iter_mut().find(|(name, _)| name == material) {
                    Some((_, texts)) => texts.push(text),
                    None => materials.push((material, vec![text])),
                }
            }
        }
        if count == 0 {
            return;
        }
        let text = format!(
            "{count} of {} images of textures are reduced, so that all fit into the memory that loading may take; use smaller \
             images, or allow more memory",
            self.images.len()
        );
        report.approximated("the file", text);
        for (material, texts) in materials {
            report.approximated(material, format!("textures are reduced for want of memory: {}", texts.join(", ")));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::budget::LoadOptions;
    use std::path::Path;

    fn image(name: &str, size: [u32; 2]) -> Wanted {
        let header = Header { size, words: 1, decoding: 1000, is_by_rows: true };
        let users = vec![(format!("material '{name}'"), format!("texture '{name}.png'"))];
        Wanted { header, file: 24, copies: 1, made: 0, users }
    }

    fn plan(images: &[Wanted], bytes: u64) -> Result<Plan, String> {
        let budget = Budget::new(&LoadOptions::default().with_memory(Some(bytes)));
        let plan = Plan::new(images.to_vec(), &budget);
        plan.map_err(|why| why.in_file(Path::new("scene.gltf")).to_string())
    }

    /// By hand: 4 bytes a texel; 1024 bytes and one collected image while one is decoded.
    #[test]
    fn the_largest_are_halved_until_all_fit() {
        let images = [image("a", [256, 128]), image("b", [256, 256]), image("c", [128, 128])];
        let (a, b, c) = (4 << 15, 4 << 16, 4 << 14);
        let all = a + b + c + b + 1024;
        assert_eq!(plan(&images, all).unwrap().times, [0, 0, 0]);
        let halved = a / 4 + b / 4 + c + c + 1024;
        assert_eq!(plan(&images, all - 1).unwrap().times, [1, 1, 0]);
        assert_eq!(plan(&images, halved).unwrap().times, [1, 1, 0]);
        assert_eq!(plan(&images, halved - 1).unwrap().times, [2, 2, 1]);
        let least = a / 16 + b / 16 + c / 4 + c / 4 + 1024;
        assert_eq!(plan(&images, least).unwrap().times, [2, 2, 1]);
        let why = plan(&images, least - 1).unwrap_err();
        for part in ["scene.gltf", "texture 'b.png' of material 'b' (256 × 256 texels), the largest of 3"] {
            assert!(why.contains(part), "{part}: {why}");
        }
    }

    #[test]
    fn an_image_that_cannot_be_decoded_alone_is_named() {
        let mut large = image("large", [512, 512]);
        (large.header.is_by_rows, large.header.decoding) = (false, 1 << 20);
        let why = plan(&[image("small", [8, 8]), large], 2 << 20).unwrap_err();
        assert!(
            why.contains("texture 'large.png' of material 'large' (512 × 512 texels), while it is decoded, needs"),
            "{why}"
        );
        assert!(why.contains("2.0 MiB are left of the 2.0 MiB"), "{why}");
    }

    #[test]
    fn what_is_reduced_is_counted_and_named() {
        let images = [image("a", [256, 256]), image("b", [32, 32])];
        let mut report = LoadReport::default();
        plan(&images, 1 << 20).unwrap().report(&mut report);
        assert!(report.is_exact());
        plan(&images, 1 << 18).unwrap().report(&mut report);
        let text = report.to_string();
        assert!(text.contains("1 of 2 images") && !report.is_exact(), "{text}");
        let line = "approximated: material 'a': textures are reduced for want of memory: \
                    texture 'a.png' from 256 × 256 texels to 128 × 128 texels";
        assert!(text.contains(line) && !text.contains("'b'"), "{text}");
    }
}
