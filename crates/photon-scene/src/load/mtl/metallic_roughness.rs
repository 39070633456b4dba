//! `map_Pr` and `map_Pm` of MTL, combined into one texture: roughness in green, metal in blue.

use std::path::Path;

use photon_core::{TexelFormat, Wrap};

use super::images::Images;
use super::map::Map;
use crate::builder::SceneBuilder;
use crate::load::image::Image;
use crate::report::LoadReport;
use crate::texture::{TextureDesc, TextureRef};

impl Images {
    /// Adds the texture of metal and roughness of the material `subject` to the scene; `None` without any that can be
    /// read. Two images must agree in size, coordinates and wrap mode, otherwise `map_Pm` is left out and reported.
    pub(super) fn add_metallic_roughness(
        &mut self,
        folder: &Path,
        [roughness, metallic]: [Option<&Map>; 2],
        subject: &str,
        builder: &mut SceneBuilder,
        report: &mut LoadReport,
    ) -> Option<TextureRef> {
        let mut read = |keyword: &str, map: Option<&Map>| self.image(folder, (keyword, map?), subject, report);
        let rough = read("map_Pr", roughness).zip(roughness);
        let mut metal = read("map_Pm", metallic).zip(metallic);
        if let (Some((a, a_map)), Some((b, b_map))) = (&rough, &metal) {
            let of = |image: &Image, map: &Map| (image.width, image.height, map.transform(), map.wrap());
            if of(a, a_map) != of(b, b_map) {
                let text = format!(
                    "its texture map_Pm {}: its size and options must be those of map_Pr {}",
                    b_map.file, a_map.file
                );
                report.left_out(subject, text);
                metal = None;
            }
        }
        let (image, map) = rough.as_ref().or(metal.as_ref())?;
        let file = |used: &Option<(Image, &Map)>| used.as_ref().map(|(_, map)| folder.join(&map.file));
        let key = (file(&rough), file(&metal), map.wrap()[0] == Wrap::Clamp);
        let texture = match self.combined.get(&key) {
            Some(known) => *known,
            None => {
                let part = |used: &Option<(Image, &Map)>, channel: usize, at: usize| {
                    used.as_ref().map_or(255, |(image, _)| byte(image, channel, at))
                };
                let texel = |at: usize| u32::from_le_bytes([0, part(&rough, 1, at), part(&metal, 2, at), 255]);
                let count = image.width as usize * image.height as usize;
                let texels: Vec<u32> = (0..count).map(texel).collect();
                let size = [image.width, image.height];
                let desc = TextureDesc::from_words(&map.file, size, TexelFormat::Linear8, texels.into());
                let texture = builder.texture(desc.wrapped(map.wrap()));
                self.make_room(builder);
                self.combined.insert(key, texture);
                texture
            }
        };
        Some(TextureRef { texture, uv_set: 0, transform: map.transform() })
    }

    /// The image of a statement; `None`, reported, if there is none.
    fn image(
        &mut self,
        folder: &Path,
        (keyword, map): (&str, &Map),
        subject: &str,
        report: &mut LoadReport,
    ) -> Option<Image> {
        if !map.others.is_empty() {
            report.left_out(subject, format!("the options {} of its {keyword}", map.others.join(", ")));
        }
        match self.decode(&folder.join(&map.file), TexelFormat::Linear8, &map.file) {
            Ok(image) => Some(image.clone()),
            Err(why) => {
                report.left_out(subject, format!("its texture {keyword} {}: {why}", map.file));
                None
            }
        }
    }
}

/// A channel of a texel as a byte; all channels of grey images are equal.
fn byte(image: &Image, channel: usize, at: usize) -> u8 {
    if image.is_float {
        let value = f32::from_bits(image.texels[4 * at + channel]);
        (value.min(1.0) * 255.0 + 0.5) as u8
    } else {
        image.texels[at].to_le_bytes()[channel]
    }
}
