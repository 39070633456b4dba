//! Textures of a file: decoded for the scene, and their means for what the scene has no texture for.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use gltf::json::Root;
use gltf::json::material::AlphaMode;
use gltf::json::texture::{MagFilter, WrappingMode};
use gltf::json::validation::Checked;
use photon_core::{Filter, TexelFormat, Wrap};

use super::buffers::Buffers;
use super::fault::{Fault, label, name_or_number};
use super::mean::Mean;
use super::specular_glossiness::{self, SpecularGlossiness};
use super::survey::Survey;
use super::uri;
use crate::builder::SceneBuilder;
use crate::extras::{self, ImageExtras, agreeing_floats};
use crate::load::image::{Halving, Image, ImageError, Plan, Room};
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
    /// How often images are halved.
    plan: Plan,
    /// The place in the plan of each image that materials use.
    planned: BTreeMap<usize, usize>,
    /// Images that are not decoded under a limit on memory, and why.
    refused: BTreeMap<usize, ImageError>,
    /// Images that are base colours of materials whose alpha is in use.
    covering: BTreeSet<usize>,
    /// The first image with the same data as each.
    first: Vec<usize>,
    /// Set while only the uses of images are recorded.
    pub(super) survey: Option<Survey>,
}

/// What is known of an image.
#[derive(Clone, Default)]
struct Entry {
    mean: Option<Result<Mean, String>>,
    /// Kept once it is part of the scene; textures share it.
    image: Option<Rc<Image>>,
    /// The same with bytes that are numbers, not colours, if it is halved: then the means differ.
    numbers: Option<Rc<Image>>,
}

impl Entry {
    fn forget(&mut self) {
        (self.image, self.numbers) = (None, None);
    }
}

impl<'a> Textures<'a> {
    pub(super) fn new(root: &'a Root, buffers: &'a Buffers<'a>) -> Self {
        let images = root.images.iter().map(|_| RefCell::default()).collect();
        let mut textures = Self {
            root,
            buffers,
            images,
            added: RefCell::default(),
            made: RefCell::default(),
            room: RefCell::default(),
            plan: Plan::default(),
            planned: BTreeMap::new(),
            refused: BTreeMap::new(),
            covering: BTreeSet::new(),
            first: first_of_equal(root),
            survey: None,
        };
        let used = root.materials.iter().filter(|material| has_coverage(material)).flat_map(base_colors);
        textures.covering = used.filter_map(|texture| textures.data_of(root.textures.get(texture)?)).collect();
        textures
    }

    pub(super) fn root(&self) -> &'a Root {
        self.root
    }

    pub(super) fn buffers(&self) -> &'a Buffers<'a> {
        self.buffers
    }

    /// Halves images as `plan` says, and does not decode those that are refused; `planned` has the place of each image in
    /// the plan.
    pub(super) fn follow(&mut self, plan: Plan, planned: BTreeMap<usize, usize>, refused: BTreeMap<usize, ImageError>) {
        (self.plan, self.planned, self.refused) = (plan, planned, refused);
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
            image.and_then(|image| image.name.as_deref()).or(uri.filter(|uri| uri::data_of(uri).is_none()))
        })
    }

    /// The mean of a texture that the scene may get, or the reason why there is none: an image that cannot be read only loses
    /// its pattern and is no error. The image is kept for [`Self::add`], unless it is of one colour.
    ///
    /// # Errors
    ///
    /// A reference to a texture or an image that the file does not have.
    pub(super) fn mean_and_image(
        &self,
        texture: usize,
        bytes: TexelFormat,
        user: &str,
    ) -> Result<Result<Mean, String>, Fault> {
        let image = match self.image_of(texture, user)? {
            Ok(image) => image,
            Err(why) => return Ok(Err(why)),
        };
        if let Some(survey) = &self.survey {
            survey.record(image, bytes, self.name(texture));
            return Ok(Err(String::new()));
        }
        let mut entry = self.images[image].borrow_mut();
        if let Some(mean) = &entry.mean {
            return Ok(mean.clone());
        }
        let decoded = self.decode(image, bytes);
        let mean = decoded.as_ref().map(Mean::of).map_err(Clone::clone);
        entry.mean = Some(mean.clone());
        // Images of which only the mean is needed do not take up memory.
        let is_kept = mean.as_ref().is_ok_and(|mean| !mean.is_uniform);
        *self.place_of(image, bytes, &mut entry) = decoded.ok().filter(|_| is_kept).map(Rc::new);
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
        let image = match self.image(texture, bytes, user)? {
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
        let image = match self.image(texture, TexelFormat::Srgb8, user)? {
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
    fn image(&self, texture: usize, bytes: TexelFormat, user: &str) -> Result<Result<Rc<Image>, String>, Fault> {
        let index = match self.image_of(texture, user)? {
            Ok(index) => index,
            Err(why) => return Ok(Err(why)),
        };
        let mut entry = self.images[index].borrow_mut();
        let known = self.place_of(index, bytes, &mut entry);
        let image = known.clone().map_or_else(|| self.decode(index, bytes).map(Rc::new), Ok);
        *known = image.as_ref().ok().cloned();
        Ok(image)
    }

    /// How often an image is halved.
    fn times(&self, image: usize) -> u32 {
        self.planned.get(&image).map_or(0, |&place| self.plan.times(place))
    }

    fn place_of<'e>(&self, image: usize, bytes: TexelFormat, entry: &'e mut Entry) -> &'e mut Option<Rc<Image>> {
        let differs = bytes == TexelFormat::Linear8 && self.times(image) > 0;
        if differs { &mut entry.numbers } else { &mut entry.image }
    }

    /// Adds a texture with the sampler of one of the file, and makes room for it.
    fn place(&self, texture: usize, desc: TextureDesc, builder: &mut SceneBuilder) -> Result<TextureId, Fault> {
        let (wrap, filter) = self.sampler(texture)?;
        let weighs = desc.image.format != TexelFormat::Linear8
            && self.data_of(&self.root.textures[texture]).is_some_and(|image| self.covering.contains(&image));
        let id = builder.texture(desc.wrapped(wrap).filtered(filter));
        if weighs {
            self.room.borrow_mut().weigh(id);
        }
        if self.room.borrow_mut().make(builder) {
            self.images.iter().for_each(|entry| entry.borrow_mut().forget());
        }
        Ok(id)
    }

    /// Says in the report what was reduced to fit into memory.
    pub(super) fn report(&self, builder: &SceneBuilder, report: &mut LoadReport) {
        self.plan.report(report);
        self.room.borrow().report(builder, report);
    }

    /// What the report should say of a texture that could be read, but not exactly.
    pub(super) fn losses(&self, texture: usize) -> Vec<String> {
        let found = self.root.textures.get(texture);
        let sampler = found.and_then(|found| self.root.samplers.get(found.sampler?.value()));
        let mut losses = Vec::new();
        if sampler.is_some_and(|sampler| [sampler.wrap_s, sampler.wrap_t].contains(&Checked::Invalid)) {
            losses.push("its sampler has a wrap mode that glTF does not have; it is repeated".to_owned());
        }
        if sampler.is_some_and(|sampler| sampler.mag_filter == Some(Checked::Invalid)) {
            losses.push("its sampler has a magFilter that glTF does not have; it is filtered linearly".to_owned());
        }
        let data = found.and_then(|found| self.data_of(found));
        let Some(entry) = data.and_then(|image| self.images.get(image)).map(RefCell::borrow) else {
            return losses;
        };
        let Some(image) = entry.image.as_ref().or(entry.numbers.as_ref()) else { return losses };
        if image.is_rounded {
            losses.push("its 16 bits are rounded to 8".to_owned());
        }
        if image.repaired > 0 {
            losses.push(format!("{} of its texels are negative or not finite, and were replaced", image.repaired));
        }
        losses.extend(image.remarks.iter().map(|remark| format!("its image {remark}")));
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
        let floats = floats_of(image).and_then(|view| {
            let bytes = self.buffers.view(view, "an image").ok()?;
            agreeing_floats(&decoded.texels, bytes)
        });
        match floats {
            Some(floats) => Image { texels: floats.into(), is_float: true, ..decoded },
            None => decoded,
        }
    }

    /// Index of the image of a texture, or why there is none.
    pub(super) fn image_of(&self, texture: usize, user: &str) -> Result<Result<usize, String>, Fault> {
        let textures = &self.root.textures;
        let found = textures.get(texture).ok_or_else(|| Fault::dangling(user, "texture", texture, textures.len()))?;
        match self.source(found) {
            Some(image) if image < self.images.len() => Ok(Ok(self.first[image])),
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

    /// Index of the image that is decoded for a texture.
    fn data_of(&self, texture: &gltf::json::Texture) -> Option<usize> {
        self.first.get(self.source(texture)?).copied()
    }

    /// Index of the image: that of `EXT_texture_webp`, else the standard one.
    fn source(&self, texture: &gltf::json::Texture) -> Option<usize> {
        let webp =
            texture.extensions.as_ref().and_then(|all| all.others.get("EXT_texture_webp")?.get("source")?.as_u64());
        // The parser's marker for a texture without an image.
        let standard = Some(texture.source.value()).filter(|&source| source != u32::MAX as usize);
        webp.and_then(|source| usize::try_from(source).ok()).or(standard)
    }

    /// Decodes an image, halved as planned; one of floats first, which are beside it, and then halved.
    fn decode(&self, index: usize, bytes: TexelFormat) -> Result<Image, String> {
        let image = &self.root.images[index];
        let weighs = bytes != TexelFormat::Linear8 && self.covering.contains(&index);
        let planned = self.planned.get(&index).map(|&place| Halving { times: self.plan.times(place), bytes, weighs });
        let has_floats = floats_of(image).is_some();
        let halving = planned.filter(|_| !has_floats);
        let decoded = match (&image.uri, image.buffer_view) {
            _ if self.refused.contains_key(&index) => Err(self.refused[&index].clone()),
            (Some(uri), _) => {
                let bytes =
                    uri::read(uri, self.buffers.folder()).map_err(|(why, hint)| format!("its image {why}; {hint}"))?;
                Image::decode_halved(&bytes, halving)
            }
            (None, Some(view)) => {
                let bytes = self.buffers.view(view.value(), &format!("image {index}"));
                Image::decode_halved(bytes.map_err(|fault| fault.to_string())?, halving)
            }
            (None, None) => return Err("its image has no data".to_owned()),
        };
        let decoded = decoded.map(|decoded| match has_floats {
            true => self.with_floats(decoded, image).halve(planned),
            false => decoded,
        });
        decoded.map_err(|why| match image.uri.as_deref().filter(|uri| uri::data_of(uri).is_none()) {
            Some(uri) => format!("its image, {uri}, {why}"),
            None => format!("its image {why}"),
        })
    }
}

/// The first image with the same data as each: many names of one file are one image.
fn first_of_equal(root: &Root) -> Vec<usize> {
    let mut known = BTreeMap::new();
    let images = root.images.iter().enumerate();
    images
        .map(|(index, image)| {
            let (uri, view) = (image.uri.as_deref(), image.buffer_view.map(|view| view.value()));
            match (uri, view.filter(|_| uri.is_none())) {
                (None, None) => index,
                (uri, view) => *known.entry((uri, view, floats_of(image))).or_insert(index),
            }
        })
        .collect()
}

/// Whether parts of a surface of the material may be absent.
fn has_coverage(material: &gltf::json::Material) -> bool {
    !matches!(material.alpha_mode, Checked::Valid(AlphaMode::Opaque))
}

/// The textures of the base colour of a material.
fn base_colors(material: &gltf::json::Material) -> impl Iterator<Item = usize> {
    let standard = material.pbr_metallic_roughness.base_color_texture.as_ref().map(|info| info.index.value());
    let others = material.extensions.as_ref().map(|all| &all.others);
    let old = others.and_then(|all| SpecularGlossiness::read(all.get(specular_glossiness::NAME)?).diffuse_texture);
    standard.into_iter().chain(old.map(|slot| slot.texture))
}

/// The buffer view with floats that the extras of an image refer to.
pub(super) fn floats_of(image: &gltf::json::Image) -> Option<usize> {
    let extras = extras::read::<ImageExtras>(image.extras.as_deref().map(|raw| raw.get()));
    extras.ok().flatten().map(|extras| extras.floats)
}
