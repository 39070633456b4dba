//! Textures as glTF: PNG, and beside it the floats of images that have them.

use std::collections::BTreeMap;

use photon_core::{Filter, TexelFormat, Texture, Wrap};
use serde_json::{Value, json};

use super::{File, single};
use crate::describe::{AlphaMode, MaterialDesc};
use crate::error::SceneError;
use crate::extras::{Extras, ImageExtras, fallback};
use crate::parameter::{Encoding, TEXTURES, TextureParameter};
use crate::shading::{uniform, uniform_alpha};
use crate::texture::{TextureDesc, TextureId, TextureRef, TexturesDesc};

/// The textures of a file.
#[derive(Default)]
pub(super) struct Textures {
    pub(super) textures: Vec<Value>,
    pub(super) samplers: Vec<Value>,
    pub(super) images: Vec<Value>,
    indices: BTreeMap<TextureId, usize>,
    /// Images by address and format: textures may share them.
    shared: BTreeMap<(usize, u32), usize>,
    /// Whether `KHR_texture_transform` is used.
    pub(super) has_transforms: bool,
}

impl File {
    /// The references of a material to its textures.
    pub(super) fn textures(
        &mut self,
        desc: &MaterialDesc,
        all: &[TextureDesc],
    ) -> Result<Vec<(&'static TextureParameter, Value)>, SceneError> {
        let mut infos = Vec::new();
        check_alpha(desc, all)?;
        // The alpha of a material is that of its base colour.
        let alpha = desc.textures.alpha.filter(|_| desc.alpha_mode != AlphaMode::Opaque);
        let textures = TexturesDesc { base_color: desc.textures.base_color.or(alpha), ..desc.textures };
        for parameter in TEXTURES.iter().filter(|texture| !texture.gltf.is_empty()) {
            let Some(used) = parameter.of(&textures) else { continue };
            let texture = self.texture(used.texture, parameter, &all[used.texture.0 as usize])?;
            let mut info = json!({ "index": texture, "texCoord": used.uv_set });
            if used.transform != TextureRef::IDENTITY {
                info["extensions"] = json!({ "KHR_texture_transform": transform(&used, desc)? });
                self.images.has_transforms = true;
            }
            match parameter.field {
                "normal" => info["scale"] = json!(desc.textures.normal_scale as f32),
                "clearcoat_normal" => info["scale"] = json!(desc.textures.clearcoat_normal_scale as f32),
                _ => {}
            }
            infos.push((parameter, info));
        }
        Ok(infos)
    }

    fn texture(&mut self, id: TextureId, of: &TextureParameter, desc: &TextureDesc) -> Result<usize, SceneError> {
        let refused = |why: &str, hint| SceneError::Export { what: format!("texture '{}', {why}", desc.name), hint };
        let is_linear = desc.image.format == TexelFormat::Linear8;
        let is_data = of.encoding == Encoding::Linear;
        if is_data && desc.image.format == TexelFormat::Srgb8 {
            let why = format!("a {} texture in sRGB", of.field.replace('_', "-"));
            return Err(refused(&why, "glTF has linear ones: convert it"));
        }
        if of.encoding == Encoding::Srgb && is_linear {
            return Err(refused("a colour of linear bytes", "glTF has colours in sRGB: convert it, or use floats"));
        }
        if let Some(&known) = self.images.indices.get(&id) {
            return Ok(known);
        }
        let key = (desc.image.texels.as_ptr() as usize, desc.image.format as u32);
        let image = match self.images.shared.get(&key) {
            Some(&known) => known,
            None => {
                let image = self.image(desc, is_data)?;
                self.images.images.push(image);
                let index = self.images.images.len() - 1;
                self.images.shared.insert(key, index);
                index
            }
        };
        let mut wrap = [0; 2];
        for (code, mode) in wrap.iter_mut().zip(desc.image.wrap) {
            *code = match mode {
                Wrap::Repeat => 10_497,
                Wrap::Mirror => 33_648,
                Wrap::Clamp => 33_071,
                other => return Err(refused(&format!("a wrap mode {other:?}"), "glTF has repeat, mirror and clamp")),
            };
        }
        let filter = if desc.image.filter == Filter::Nearest { 9728 } else { 9729 };
        let sampler = json!({ "wrapS": wrap[0], "wrapT": wrap[1], "magFilter": filter });
        let known = self.images.samplers.iter().position(|known| *known == sampler);
        let sampler = known.unwrap_or_else(|| {
            self.images.samplers.push(sampler);
            self.images.samplers.len() - 1
        });
        self.images.textures.push(json!({ "name": desc.name, "sampler": sampler, "source": image }));
        self.images.indices.insert(id, self.images.textures.len() - 1);
        Ok(self.images.textures.len() - 1)
    }

    /// A PNG of the image, and its floats if it has some.
    fn image(&mut self, desc: &TextureDesc, is_linear: bool) -> Result<Value, SceneError> {
        let image = &desc.image;
        let is_float = image.format.is_float();
        let words: Vec<u32> = if is_float {
            image.texels.as_chunks().0.iter().map(|texel| fallback(texel, is_linear)).collect()
        } else {
            image.texels.to_vec()
        };
        let png = encode(image, &words).map_err(|why| SceneError::Export {
            what: format!("texture '{}' as PNG: {why}", desc.name),
            hint: "use a smaller image",
        })?;
        let view = self.view(png.into_iter());
        let mut value = json!({ "name": desc.name, "bufferView": view, "mimeType": "image/png" });
        if is_float {
            let floats = self.view(image.texels.iter().flat_map(|word| word.to_le_bytes()));
            value["extras"] = json!(Extras { photonmap: ImageExtras { floats } });
        }
        Ok(value)
    }
}

/// Whether the alpha of the base colour's texture is that of the material.
fn check_alpha(desc: &MaterialDesc, all: &[TextureDesc]) -> Result<(), SceneError> {
    if desc.alpha_mode == AlphaMode::Opaque {
        return Ok(());
    }
    let image = |used: TextureRef| &all[used.texture.0 as usize].image;
    let fine = match (desc.textures.base_color, desc.textures.alpha) {
        (Some(base), None) => uniform_alpha(image(base)) == Some(1.0),
        (None, Some(alpha)) => uniform(image(alpha)) == Some([1.0; 3]),
        (base, alpha) => base == alpha,
    };
    if fine {
        return Ok(());
    }
    Err(SceneError::Export {
        what: format!("material '{}', whose alpha is not that of its base colour's texture,", desc.name),
        hint: "glTF has both in one image: combine the images, and use the result for both",
    })
}

/// `KHR_texture_transform`: offset, rotation and scale of which the matrix is the product.
fn transform(used: &TextureRef, material: &MaterialDesc) -> Result<Value, SceneError> {
    let [[a, b, x], [c, d, y]] = used.transform;
    // The first column is (cos, −sin) times its scale, the second (sin, cos) times its own.
    let (first, second) = (a.hypot(c), b.hypot(d));
    let angle = if first > 0.0 { libm::atan2(-c, a) } else { libm::atan2(b, d) };
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let across = sin * b + cos * d;
    let is_close = |left: f64, right: f64| (left - right).abs() <= 1e-9 * (first + second);
    if !(is_close(across * sin, b) && is_close(across * cos, d)) {
        return Err(SceneError::Export {
            what: format!("the transform {:?} of a texture of material '{}'", used.transform, material.name),
            hint: "glTF has offset, rotation and scale; leave out the shear, or apply it to the texture coordinates",
        });
    }
    let what = || format!("a texture of material '{}'", material.name);
    let scale = [single(first, what)?, single(across, what)?];
    Ok(json!({ "offset": [single(x, what)?, single(y, what)?], "rotation": angle as f32, "scale": scale }))
}

fn encode(image: &Texture, words: &[u32]) -> Result<Vec<u8>, png::EncodingError> {
    let is_opaque = words.iter().all(|word| word >> 24 == 255);
    let channels = if is_opaque { 3 } else { 4 };
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes().into_iter().take(channels)).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, image.width, image.height);
    encoder.set_color(if is_opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(file)
}
