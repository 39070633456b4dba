//! Textures of a file: decoded for the scene, and their means for what the scene has no texture for.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use gltf::json::Root;
use gltf::json::texture::{MagFilter, WrappingMode};
use gltf::json::validation::Checked;
use photon_core::{Filter, TexelFormat, Wrap};

use super::buffers::Buffers;
use super::fault::{Fault, label, name_or_number};
use super::mean::Mean;
use super::uri;
use crate::builder::SceneBuilder;
use crate::extras::{self, ImageExtras, agreeing_floats};
use crate::load::image::{Image, Room};
use crate::report::LoadReport;
use crate::texture::{TextureDesc, TextureId};

/// The textures of a file, whose images are decoded on first use.
pub(super) struct Textures<'a> {
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    images: Vec<RefCell<Entry>>,
    /// The textures of the scene, by number and encoding of bytes.
    added: RefCell<BTreeMap<(usize, bool), TextureId>>,
    /// Textures that were made from those of the file, by number and the bits of the factor.
    made: RefCell<BTreeMap<(usize, u64), TextureId>>,
    room: RefCell<Room>,
}

/// What is known of an image.
#[derive(Clone, Default)]
struct Entry {
    mean: Option<Result<Mean, String>>,
    /// Kept once it is part of the scene; textures share it.
    image: Option<Rc<Image>>,
}

impl<'a> Textures<'a> {
    pub(super) fn new(root: &'a Root, buffers: &'a Buffers<'a>) -> Self {
        let images = root.images.iter().map(|_| RefCell::default()).collect();
        Self { root, buffers, images, added: RefCell::default(), made: RefCell::default(), room: RefCell::default() }
    }

    /// Name of a texture in messages: its number, and its own name or that of its image.
    pub(super) fn name(&self, texture: usize) -> String {
        label("texture", texture, self.given_name(texture))
    }

    /// The name of a texture in the scene.
    fn plain_name(&self, texture: usize) -> String {
        name_or_number("texture", texture, self.given_name(texture))
    }

    fn given_name(&self, texture: usize) -> Option<&str> {
        let found = self.root.textures.get(texture);
        let image = found.and_then(|found| self.root.images.get(self.source(found)?));
        found.and_then(|texture| texture.name.as_deref()).or_else(|| {
            let uri = image.and_then(|image| image.uri.as_deref());
            image.and_then(|image| image.name.as_deref()).or(uri.filter(|uri| !uri.starts_with("data:")))
        })
    }

    /// The mean of a texture that the scene may get, or the reason why there is none: an image that cannot be read only loses
    /// its pattern and is no error. The image is kept for [`Self::add`], unless it is of one colour.
    ///
    /// # Errors
    ///
    /// A reference to a texture or an image that the file does not have.
    pub(super) fn mean_and_image(&self, texture: usize, user: &str) -> Result<Result<Mean, String>, Fault> {
        let image = match self.image_of(texture, user)? {
            Ok(image) => image,
            Err(why) => return Ok(Err(why)),
        };
        let mut entry = self.images[image].borrow_mut();
        if let Some(mean) = &entry.mean {
            return Ok(mean.clone());
        }
        let decoded = self.decode(image);
        let mean = decoded.as_ref().map(Mean::of).map_err(Clone::clone);
        entry.mean = Some(mean.clone());
        // Images of which only the mean is needed do not take up memory.
        let is_kept = mean.as_ref().is_ok_and(|mean| !mean.is_uniform);
        entry.image = decoded.ok().filter(|_| is_kept).map(Rc::new);
        Ok(mean)
    }

    /// Adds a texture to the scene; `bytes` is the encoding of an image of bytes.
    ///
    /// # Errors
    ///
    /// As [`Self::mean_and_image`].
    pub(super) fn add(
        &self,
        texture: usize,
        bytes: TexelFormat,
        user: &str,
        builder: &mut SceneBuilder,
    ) -> Result<Result<TextureId, String>, Fault> {
        let key = (texture, bytes == TexelFormat::Linear8);
        if let Some(known) = self.added.borrow().get(&key) {
            return Ok(Ok(*known));
        }
        let image = match self.image(texture, user)? {
            Ok(image) => image,
            Err(why) => return Ok(Err(why)),
        };
        let desc = image.texture(self.plain_name(texture), bytes);
        let id = self.place(texture, desc, builder)?;
        self.added.borrow_mut().insert(key, id);
        Ok(Ok(id))
    }

    /// Adds a texture of bytes that is made from the image of a texture of the file and a factor, with its sampler; `make`
    /// gives a texel for each of the image.
    ///
    /// # Errors
    ///
    /// As [`Self::mean_and_image`].
    pub(super) fn add_made(
        &self,
        texture: usize,
        user: &str,
        (factor, make): (f64, impl Fn(&Image, f64) -> Vec<u32>),
        builder: &mut SceneBuilder,
    ) -> Result<Result<TextureId, String>, Fault> {
        let key = (texture, factor.to_bits());
        if let Some(known) = self.made.borrow().get(&key) {
            return Ok(Ok(*known));
        }
        let image = match self.image(texture, user)? {
            Ok(image) => image,
            Err(why) => return Ok(Err(why)),
        };
        let (name, size) = (self.plain_name(texture), [image.width, image.height]);
        let desc = TextureDesc::from_words(&name, size, TexelFormat::Linear8, make(&image, factor).into());
        let id = self.place(texture, desc, builder)?;
        self.made.borrow_mut().insert(key, id);
        Ok(Ok(id))
    }

    /// The image of a texture, which is kept, or the reason why there is none.
    fn image(&self, texture: usize, user: &str) -> Result<Result<Rc<Image>, String>, Fault> {
        let index = match self.image_of(texture, user)? {
            Ok(index) => index,
            Err(why) => return Ok(Err(why)),
        };
        let known = self.images[index].borrow().image.clone();
        let image = known.map_or_else(|| self.decode(index).map(Rc::new), Ok);
        if let Ok(image) = &image {
            self.images[index].borrow_mut().image = Some(Rc::clone(image));
        }
        Ok(image)
    }

    /// Adds a texture with the sampler of one of the file, and makes room for it.
    fn place(&self, texture: usize, desc: TextureDesc, builder: &mut SceneBuilder) -> Result<TextureId, Fault> {
        let (wrap, filter) = self.sampler(texture)?;
        let id = builder.texture(desc.wrapped(wrap).filtered(filter));
        if self.room.borrow_mut().make(builder) {
            self.images.iter().for_each(|entry| entry.borrow_mut().image = None);
        }
        Ok(id)
    }

    /// Says in the report what was reduced for want of memory.
    pub(super) fn report(&self, builder: &SceneBuilder, report: &mut LoadReport) {
        self.room.borrow().report(builder, report);
    }

    /// What the report should say of an image that could be read, but not exactly.
    pub(super) fn losses(&self, texture: usize) -> Vec<String> {
        let source = self.root.textures.get(texture).and_then(|found| self.source(found));
        let image = source.and_then(|image| self.images.get(image)?.borrow().image.clone());
        let Some(image) = image else { return Vec::new() };
        let mut losses = Vec::new();
        if image.is_rounded {
            losses.push("its 16 bits are rounded to 8".to_owned());
        }
        if image.repaired > 0 {
            losses.push(format!("{} of its texels are negative or not finite, and were replaced", image.repaired));
        }
        losses
    }

    /// Wrap modes and filter of a texture that exists; without a sampler, it is repeated and filtered.
    fn sampler(&self, texture: usize) -> Result<([Wrap; 2], Filter), Fault> {
        let Some(index) = self.root.textures[texture].sampler else {
            return Ok(([Wrap::Repeat; 2], Filter::Linear));
        };
        let samplers = &self.root.samplers;
        let sampler = samplers
            .get(index.value())
            .ok_or_else(|| Fault::dangling(&self.name(texture), "sampler", index.value(), samplers.len()))?;
        let wrap = [sampler.wrap_s, sampler.wrap_t].map(|mode| match mode {
            Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
            Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
            Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
        });
        let filter = match sampler.mag_filter {
            Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
            _ => Filter::Linear,
        };
        Ok((wrap, filter))
    }

    /// The image with the floats that the extras refer to, if it is still the image that stands for them.
    fn with_floats(&self, decoded: Image, image: &gltf::json::Image) -> Image {
        let extras = extras::read::<ImageExtras>(image.extras.as_deref().map(|raw| raw.get()));
        let view = extras.ok().flatten().map(|extras| extras.floats);
        let floats = view.and_then(|view| {
            let bytes = self.buffers.view(view, "an image").ok()?;
            agreeing_floats(&decoded.texels, bytes)
        });
        match floats {
            Some(floats) => Image { texels: floats.into(), is_float: true, ..decoded },
            None => decoded,
        }
    }

    /// Index of the image of a texture, or why there is none.
    fn image_of(&self, texture: usize, user: &str) -> Result<Result<usize, String>, Fault> {
        let textures = &self.root.textures;
        let found = textures.get(texture).ok_or_else(|| Fault::dangling(user, "texture", texture, textures.len()))?;
        match self.source(found) {
            Some(image) if image < self.images.len() => Ok(Ok(image)),
            Some(image) => Err(Fault::dangling(&self.name(texture), "image", image, self.images.len())),
            None => {
                let extensions = found.extensions.iter().flat_map(|all| all.others.keys());
                let names: Vec<&str> = extensions.map(String::as_str).collect();
                let why = match names[..] {
                    [] => "it has no image".to_owned(),
                    _ => format!("its image is in {}, which cannot be read; export it as PNG", names.join(", ")),
                };
                Ok(Err(why))
            }
        }
    }

    /// Index of the image: that of `EXT_texture_webp`, else the standard one.
    fn source(&self, texture: &gltf::json::Texture) -> Option<usize> {
        let webp =
            texture.extensions.as_ref().and_then(|all| all.others.get("EXT_texture_webp")?.get("source")?.as_u64());
        // The parser's marker for a texture without an image.
        let standard = Some(texture.source.value()).filter(|&source| source != u32::MAX as usize);
        webp.and_then(|source| usize::try_from(source).ok()).or(standard)
    }

    fn decode(&self, index: usize) -> Result<Image, String> {
        let image = &self.root.images[index];
        let decoded = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                let bytes =
                    uri::read(uri, self.buffers.folder()).map_err(|(why, hint)| format!("its image {why}; {hint}"))?;
                Image::decode(&bytes)
            }
            (None, Some(view)) => {
                let bytes = self.buffers.view(view.value(), &format!("image {index}"));
                Image::decode(bytes.map_err(|fault| fault.to_string())?)
            }
            (None, None) => return Err("its image has no data".to_owned()),
        };
        let decoded = decoded.map(|decoded| self.with_floats(decoded, image));
        decoded.map_err(|why| match image.uri.as_deref().filter(|uri| !uri.starts_with("data:")) {
            Some(uri) => format!("its image, {uri}, {why}"),
            None => format!("its image {why}"),
        })
    }
}
