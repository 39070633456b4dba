//! Decides from headers, before any image is decoded, how often each is halved so that all fit into memory.

use super::MAX_WORDS;
use super::halve::halved;
use super::header::Header;
use crate::error::bytes_text;
use crate::load::budget::{Budget, Shortage};
use crate::report::LoadReport;

/// Images are not reduced below this many texels on their shorter side: tables of one row stay whole.
const LEAST_SIDE: u32 = 64;

/// Without a limit on memory, images are halved rather than that they take more than this while one is decoded.
const PEAK: u64 = 2 << 30;

/// An image that materials use.
#[derive(Clone, Debug)]
pub(in crate::load) struct Wanted {
    pub(in crate::load) header: Header,
    /// Length of its file, which is in memory while it is decoded.
    pub(in crate::load) file: u64,
    /// Whether its bytes are used as colours and as numbers. Both share the texels of a whole image, but halving it, an
    /// average, depends on the encoding.
    pub(in crate::load) encodings: u64,
    /// Further textures of the same format that are made of it.
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
        let copies = self.copies + if times == 0 { self.encodings.min(1) } else { self.encodings };
        bytes * copies + bytes / self.header.words * self.made
    }

    /// Further bytes while it is decoded.
    fn decoding(&self, times: u32) -> u64 {
        self.file + self.header.decoding(times)
    }

    /// All bytes that it needs alone.
    fn needed(&self, times: u32) -> u64 {
        self.kept(times).saturating_add(self.decoding(times))
    }

    /// How often it is halved at most, if `left` bytes are left: never if decoding it to halve it takes more.
    fn most(&self, left: u64) -> u32 {
        let side = |times| self.header.size.into_iter().map(|side| halved(side, times)).min().unwrap_or(0);
        let most = (0..).find(|&times| side(times) <= LEAST_SIDE).unwrap_or(0);
        if self.needed(most) > left { 0 } else { most }
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
            2 => " and another".to_owned(),
            count => format!(" and {} others", count - 1),
        };
        format!("{texture} of {material}{others} ({})", self.text(0))
    }
}

/// Bytes of all images that stay, and the largest number of further bytes while one is decoded.
fn totals(images: &[Wanted], times: &[u32]) -> (u64, u64) {
    let of = |what: fn(&Wanted, u32) -> u64| images.iter().zip(times).map(move |(image, &times)| what(image, times));
    (of(Wanted::kept).sum(), of(Wanted::decoding).max().unwrap_or(0))
}

/// What an error adds to the textures if the rest of the scene takes memory too.
fn beside(reserved: u64) -> String {
    match reserved {
        0 => String::new(),
        _ => format!(" beside {} of geometry,", bytes_text(reserved)),
    }
}

/// How often each image is halved.
#[derive(Clone, Debug, Default)]
pub(in crate::load) struct Plan {
    images: Vec<Wanted>,
    times: Vec<u32>,
    /// Whether they were halved for the fixed limit alone.
    is_fixed: bool,
}

impl Plan {
    /// Halves the largest images until all that stays, and the one that takes most to decode, fit into what is left of
    /// `budget` besides `reserved` bytes of the rest of the scene; all that stays is taken from it. Without a limit, they fit
    /// into [`PEAK`], as far as halving helps.
    pub(in crate::load) fn new(images: Vec<Wanted>, reserved: u64, budget: &Budget) -> Result<Self, Shortage> {
        budget.check(reserved, || "the geometry".to_owned())?;
        let is_limited = budget.left().is_some();
        let left = budget.left().unwrap_or(PEAK).saturating_sub(reserved);
        let most: Vec<u32> = images.iter().map(|image| image.most(left)).collect();
        // One image that cannot be decoded, whatever happens to the others.
        let too_large = images.iter().zip(&most).find(|(image, most)| is_limited && image.needed(**most) > left);
        if let Some((image, &most)) = too_large {
            let needed = image.needed(most).saturating_add(reserved);
            return Err(
                budget.shortage(format!("{}, while it is decoded,{}", image.subject(), beside(reserved)), needed)
            );
        }
        let mut times = vec![0; images.len()];
        let mut is_fixed = true;
        loop {
            let (kept, decoding) = totals(&images, &times);
            let fits = kept.saturating_add(decoding) <= left;
            if fits && kept <= 4 * MAX_WORDS {
                break;
            }
            is_fixed &= fits || !is_limited;
            let halvable = || images.iter().zip(&times).zip(&most).filter(|((_, times), most)| times < most);
            let Some(largest) = halvable().map(|((image, &times), _)| image.header.bytes(times)).max() else {
                if fits || !is_limited {
                    // Too many small images for the fixed limit, which is kept while they are decoded.
                    break;
                }
                // The first of those that are equal.
                let largest = images.iter().rev().max_by_key(|image| image.kept(0));
                let subject = largest.map(Wanted::subject).unwrap_or_default();
                let count = images.len();
                let object = format!(
                    "{subject}, the largest of {count}, with the others and reduced to at most {LEAST_SIDE} texels on their \
                     shorter sides,{}",
                    beside(reserved)
                );
                return Err(budget.shortage(object, kept.saturating_add(decoding).saturating_add(reserved)));
            };
            // Those of about the largest size, so that they are halved together.
            for ((image, times), most) in images.iter().zip(&mut times).zip(&most) {
                if *times < *most && image.header.bytes(*times) > largest / 4 {
                    *times += 1;
                }
            }
        }
        // Halving an image that is decoded as a whole may save less than expected.
        for at in (0..images.len()).filter(|&at| !images[at].header.is_by_rows) {
            let halved = std::mem::take(&mut times[at]);
            let (kept, decoding) = totals(&images, &times);
            if kept.saturating_add(decoding) > left || kept > 4 * MAX_WORDS {
                times[at] = halved;
            }
        }
        budget.take(totals(&images, &times).0, || "the textures".to_owned())?;
        Ok(Self { images, times, is_fixed })
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
        let why = if self.is_fixed {
            "all textures together take up at most 1 GiB; use smaller images, or fewer"
        } else {
            "all fit into the memory that loading may take; use smaller images, or allow more memory"
        };
        let text = format!("{count} of {} images of textures are reduced, so that {why}", self.images.len());
        report.approximated("the file", text);
        for (material, texts) in materials {
            report.approximated(material, format!("textures are reduced: {}", texts.join(", ")));
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
        Wanted { header, file: 24, encodings: 1, copies: 0, made: 0, users }
    }

    fn plan(images: &[Wanted], bytes: u64) -> Result<Plan, String> {
        let budget = Budget::new(&LoadOptions::default().with_memory(Some(bytes)));
        let plan = Plan::new(images.to_vec(), 0, &budget);
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
        assert_eq!(plan(&images, halved - 1).unwrap().times, [1, 2, 1]);
        // 128 × 64 texels, and twice 64 × 64.
        let least = a / 4 + b / 16 + c / 4 + a / 4 + 1024;
        assert_eq!(plan(&images, least).unwrap().times, [1, 2, 1]);
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

    /// A row of colours takes 4 KiB: halving it would save nothing that matters.
    #[test]
    fn long_tables_stay_whole() {
        let images = [image("row", [1024, 1]), image("wood", [512, 512])];
        assert_eq!(plan(&images, 1 << 20).unwrap().times, [0, 1]);
    }

    /// 64 MiB of floats, which are all in memory before they are halved.
    #[test]
    fn an_image_that_is_smaller_whole_than_halved_stays_whole() {
        let mut large = image("sky", [2048, 2048]);
        (large.header.words, large.header.is_by_rows) = (4, false);
        assert_eq!((large.needed(0), large.needed(1)), ((64 << 20) + 1024, (80 << 20) + 1024));
        let images = [large, image("wood", [1024, 1024])];
        assert_eq!(plan(&images, 66 << 20).unwrap().times, [0, 2]);
        assert!(plan(&images[..1], 64 << 20).is_err());
    }

    /// By hand: a whole image of 4 MiB is shared, and two halved ones of 1 MiB each are not.
    #[test]
    fn encodings_share_a_whole_image() {
        let mut both = image("both", [1024, 1024]);
        both.encodings = 2;
        assert_eq!((both.kept(0), both.kept(1)), (4 << 20, 2 << 20));
        both.copies = 1;
        assert_eq!((both.kept(0), both.kept(1)), (8 << 20, 3 << 20));
    }

    /// 1.25 GiB in ample memory.
    #[test]
    fn the_fixed_limit_is_named_where_it_decides() {
        let images: Vec<Wanted> = (0..5).map(|at| image(&at.to_string(), [8192, 8192])).collect();
        for (memory, cause) in [(1 << 40, "at most 1 GiB"), (1 << 30, "allow more memory")] {
            let mut report = LoadReport::default();
            let plan = plan(&images, memory).unwrap();
            assert_eq!(plan.times, [1; 5]);
            plan.report(&mut report);
            assert!(report.to_string().contains(cause), "{report}");
        }
    }

    /// V9: 64 × 4096² texels are 4 GiB; halved once they are 1 GiB, the fixed limit.
    #[test]
    fn large_textures_are_halved_to_the_fixed_limit() {
        let images: Vec<Wanted> = (0..64).map(|at| image(&at.to_string(), [4096, 4096])).collect();
        let mut report = LoadReport::default();
        let plan = plan(&images, 1 << 40).unwrap();
        assert_eq!((plan.times.clone(), totals(&images, &plan.times).0), (vec![1; 64], 1 << 30));
        plan.report(&mut report);
        let text = report.to_string();
        assert!(text.contains("64 of 64 images of textures are reduced") && text.contains("1 GiB"), "{text}");
        assert_eq!(text.matches("from 4096 × 4096 texels to 2048 × 2048 texels").count(), 64);
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
        let line = "approximated: material 'a': textures are reduced: \
                    texture 'a.png' from 256 × 256 texels to 128 × 128 texels";
        assert!(text.contains(line) && !text.contains("'b'"), "{text}");
    }
}
