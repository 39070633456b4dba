//! Images that MTL files refer to.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use photon_core::TexelFormat;

use super::map::Map;
use crate::builder::SceneBuilder;
use crate::load::gltf::leaves_folder;
use crate::load::image::{Image, Room, load_image};
use crate::report::LoadReport;
use crate::texture::{TextureId, TextureRef};

/// The images of all materials, each decoded once.
#[derive(Default)]
pub(super) struct Images {
    decoded: HashMap<PathBuf, Result<Image, String>>,
    added: HashMap<(PathBuf, bool, bool), TextureId>,
    /// Those of metal and roughness, by the paths of `map_Pr` and `map_Pm`, and whether they are clamped.
    pub(super) combined: HashMap<(Option<PathBuf>, Option<PathBuf>, bool), TextureId>,
    pub(super) room: Room,
}

impl Images {
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
            None => match self.decode(&path, &map.file) {
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
                    let texture = builder.texture(image.texture(&map.file, bytes).wrapped(map.wrap()));
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

    pub(super) fn decode(&mut self, path: &Path, name: &str) -> Result<&Image, String> {
        if leaves_folder(name) {
            return Err("it is outside the folder of the scene; put it into that folder or below it".to_owned());
        }
        let decoded = self.decoded.entry(path.to_owned()).or_insert_with(|| {
            if !path.is_file() {
                return Err("the file does not exist; put it where the scene expects it".to_owned());
            }
            load_image(path).map_err(|error| error.to_string())
        });
        decoded.as_ref().map_err(Clone::clone)
    }
}
