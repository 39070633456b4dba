//! Images that MTL files refer to.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use photon_core::{TexelFormat, Texture};

use super::map::Map;
use super::survey::Survey;
use crate::builder::SceneBuilder;
use crate::load::gltf::leaves_folder;
use crate::load::image::{Halving, Image, Room, load_image_halved};
use crate::report::LoadReport;
use crate::shading::uniform_alpha;
use crate::texture::{TextureDesc, TextureId, TextureRef};

/// The images of all materials, each decoded once.
#[derive(Default)]
pub(super) struct Images {
    /// By path, and whether its bytes are numbers, not colours. They are decoded separately only when halved, since averaging
    /// depends on the encoding.
    decoded: HashMap<(PathBuf, bool), Result<Image, String>>,
    added: HashMap<(PathBuf, bool, bool), TextureId>,
    /// Those of metal and roughness, by the paths of `map_Pr` and `map_Pm`, and whether they are clamped.
    pub(super) combined: HashMap<(Option<PathBuf>, Option<PathBuf>, bool), TextureId>,
    /// Images that became alpha, by path and whether they are clamped.
    alphas: HashMap<(PathBuf, bool), TextureId>,
    pub(super) room: Room,
    pub(super) survey: Survey,
}

impl Images {
    /// None yet; they are halved or refused as `survey` says.
    pub(super) fn new(survey: Survey) -> Self {
        Self { survey, ..Self::default() }
    }

    /// Adds the texture of a statement of the material `subject` to the scene; `None`, reported, if there is none.
    pub(super) fn add(
        &mut self,
        folder: &Path,
        (keyword, map): (&str, &Map),
        bytes: TexelFormat,
        subject: &str,
        builder: &mut SceneBuilder,
        report: &mut LoadReport,
    ) -> Option<TextureRef> {
        let path = folder.join(&map.file);
        let clamped = map.wrap()[0] == photon_core::Wrap::Clamp;
        let key = (path.clone(), bytes == TexelFormat::Linear8, clamped);
        if !map.others.is_empty() {
            report.left_out(subject, format!("the options {} of its {keyword}", map.others.join(", ")));
        }
        let texture = match self.added.get(&key) {
            Some(known) => *known,
            None => match self.decode(&path, bytes, &map.file) {
                Ok(image) => {
                    if image.is_rounded {
                        report.note(subject, format!("the 16 bits of its {keyword} {} are rounded to 8", map.file));
                    }
                    if image.repaired > 0 {
                        let text = format!(
                            "{} texels of its {keyword} {} are negative or not finite",
                            image.repaired, map.file
                        );
                        report.approximated(subject, text);
                    }
                    for remark in &image.remarks {
                        report.approximated(subject, format!("its {keyword} {} {remark}", map.file));
                    }
                    let texture = builder.texture(image.texture(&map.file, bytes).wrapped(map.wrap()));
                    if bytes != TexelFormat::Linear8 && self.survey.covering.contains(&path) {
                        self.room.weigh(texture);
                    }
                    self.make_room(builder);
                    self.added.insert(key, texture);
                    texture
                }
                Err(why) => {
                    report.left_out(subject, format!("its texture {keyword} {}: {why}", map.file));
                    return None;
                }
            },
        };
        Some(TextureRef { texture, uv_set: 0, transform: map.transform() })
    }

    /// Keeps all textures of the scene within the memory that they may take up.
    pub(super) fn make_room(&mut self, builder: &mut SceneBuilder) {
        if self.room.make(builder) {
            self.decoded.clear();
        }
    }

    /// The same of `map_d`, the alpha of a material: the alpha of its image if that is not 1 everywhere, else the mean of
    /// its channels, as the numbers that they are.
    pub(super) fn add_alpha(
        &mut self,
        folder: &Path,
        map: &Map,
        subject: &str,
        builder: &mut SceneBuilder,
        report: &mut LoadReport,
    ) -> Option<TextureRef> {
        let used = self.add(folder, ("map_d", map), TexelFormat::Srgb8, subject, builder, report)?;
        let desc = &builder.textures[used.texture.0 as usize];
        if uniform_alpha(&desc.image) != Some(1.0) {
            return Some(used);
        }
        let key = (folder.join(&map.file), map.wrap()[0] == photon_core::Wrap::Clamp);
        let texture = match self.alphas.get(&key) {
            Some(known) => *known,
            None => {
                let name = format!("{} as alpha", desc.name);
                let texture = TextureDesc::new(name, means_as_alpha(&desc.image));
                let texture = builder.texture(texture);
                self.make_room(builder);
                self.alphas.insert(key, texture);
                texture
            }
        };
        Some(TextureRef { texture, ..used })
    }

    pub(super) fn decode(&mut self, path: &Path, bytes: TexelFormat, name: &str) -> Result<&Image, String> {
        if leaves_folder(name) {
            return Err("it is outside the folder of the scene; put it into that folder or below it".to_owned());
        }
        let times = self.survey.planned.get(path).map(|&place| self.survey.plan.times(place));
        let differs = bytes == TexelFormat::Linear8 && times.is_some_and(|times| times > 0);
        let decoded = self.decoded.entry((path.to_owned(), differs)).or_insert_with(|| {
            if !path.is_file() {
                return Err("the file does not exist; put it where the scene expects it".to_owned());
            }
            if let Some(why) = self.survey.refused.get(path) {
                return Err(format!("{}: the image {why}", path.display()));
            }
            let weighs = bytes != TexelFormat::Linear8 && self.survey.covering.contains(path);
            let halving = times.map(|times| Halving { times, bytes, weighs });
            load_image_halved(path, halving).map_err(|error| error.to_string())
        });
        decoded.as_ref().map_err(Clone::clone)
    }
}

/// Whether some texels of a texture are not opaque.
pub(in crate::load) fn has_alpha(builder: &SceneBuilder, used: TextureRef) -> bool {
    uniform_alpha(&builder.textures[used.texture.0 as usize].image) != Some(1.0)
}

/// White texels, whose alpha is the mean of the channels.
fn means_as_alpha(image: &Texture) -> Texture {
    let texels = if image.format.is_float() {
        let mean = |texel: &[u32; 4]| texel[..3].iter().map(|&word| f32::from_bits(word).min(1.0)).sum::<f32>() / 3.0;
        let texels = image.texels.as_chunks().0.iter();
        texels.flat_map(|texel| [1.0, 1.0, 1.0, mean(texel)].map(f32::to_bits)).collect()
    } else {
        let mean = |word: u32| {
            let [r, g, b, _] = word.to_le_bytes().map(u32::from);
            (2 * (r + g + b) + 3) / 6
        };
        image.texels.iter().map(|&word| 0x00FF_FFFF | mean(word) << 24).collect()
    };
    Texture { texels, ..image.clone() }
}
