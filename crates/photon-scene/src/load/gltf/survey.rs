//! Which images the materials of a file use, before any is decoded: all are planned together.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use photon_core::TexelFormat;

use super::fault::{Fault, name_or_number};
use super::parameters;
use super::reserve;
use super::texture::{Textures, floats_of};
use super::uri;
use crate::builder::SceneBuilder;
use crate::load::image::{Found, Header, Plan, Wanted};
use crate::report::LoadReport;

/// The images that materials use, by number.
#[derive(Debug, Default)]
pub(super) struct Survey {
    images: RefCell<BTreeMap<usize, Uses>>,
    /// The material that is being read.
    material: RefCell<String>,
}

/// The uses of an image.
#[derive(Debug, Default)]
struct Uses {
    /// Whether its bytes are numbers, not colours.
    encodings: BTreeSet<bool>,
    /// Textures that are made of it.
    made: u64,
    /// Materials and the names of the textures.
    users: Vec<(String, String)>,
}

impl Survey {
    /// A material uses the image for a texture.
    pub(super) fn record(&self, image: usize, bytes: TexelFormat, texture: String) {
        let mut images = self.images.borrow_mut();
        let uses = images.entry(image).or_default();
        uses.encodings.insert(bytes == TexelFormat::Linear8);
        let user = (self.material.borrow().clone(), texture);
        if !uses.users.contains(&user) {
            uses.users.push(user);
        }
    }

    /// Another texture is made of the image.
    pub(super) fn record_made(&self, image: Option<usize>) {
        if let Some(image) = image {
            self.images.borrow_mut().entry(image).or_default().made += 1;
        }
    }
}

/// Plans the sizes of all images.
///
/// # Errors
///
/// The textures that do not fit; a buffer with images that does not fit or cannot be read.
pub(super) fn plan(textures: &mut Textures<'_>) -> Result<(), Fault> {
    let budget = textures.buffers().budget();
    textures.survey = Some(Survey::default());
    let root = textures.root();
    for (index, material) in root.materials.iter().enumerate() {
        let subject = format!("material '{}'", name_or_number("material", index, material.name.as_deref()));
        if let Some(survey) = &textures.survey {
            survey.material.replace(subject.clone());
        }
        let (mut builder, mut report) = (SceneBuilder::new(), LoadReport::default());
        parameters::read(root, index, textures, &subject, &mut builder, &mut report)?;
    }
    let uses = textures.survey.take().map(|survey| survey.images.into_inner()).unwrap_or_default();
    let (mut wanted, mut planned, mut refused) = (Vec::new(), BTreeMap::new(), BTreeMap::new());
    for (image, uses) in uses {
        match header(textures, image)? {
            None => {}
            // Decoding it says why, and may find a header that is far from the start.
            Some(Err(_)) if budget.left().is_none() => {}
            Some(Err(why)) => drop(refused.insert(image, why)),
            Some(Ok((header, file))) => {
                planned.insert(image, wanted.len());
                let encodings = uses.encodings.len() as u64;
                wanted.push(Wanted { header, file, encodings, copies: 0, made: uses.made, users: uses.users });
            }
        }
    }
    let geometry = budget.left().map_or(0, |_| reserve::geometry(root, textures.buffers()));
    textures.follow(Plan::new(wanted, geometry, budget)?, planned, refused);
    Ok(())
}

/// Header of an image, and the bytes of its file that are in memory while it is decoded, or why it has none. `None` for an
/// image that is not there: the material that uses it reports that.
fn header(textures: &Textures<'_>, index: usize) -> Result<Option<Found>, Fault> {
    let (image, buffers) = (&textures.root().images[index], textures.buffers());
    let left = buffers.budget().left().unwrap_or(u64::MAX);
    let found = match (&image.uri, image.buffer_view) {
        (Some(uri), _) if uri::data_of(uri).is_some() => {
            buffers.budget().check(uri.len() as u64, || format!("the data URI of image {index}"))?;
            let bytes = uri::read(uri, buffers.folder()).ok();
            let length = |bytes: &Vec<u8>| bytes.len() as u64;
            bytes.map(|bytes| Ok((Header::read(&bytes, length(&bytes))?, length(&bytes))))
        }
        (Some(uri), _) => uri::path(uri, buffers.folder()).ok().and_then(|path| Header::of_file(&path, left)),
        (None, Some(view)) => {
            let bytes = unless_short(buffers.view(view.value(), &format!("image {index}")))?;
            bytes.map(|bytes| Ok((Header::read(bytes, bytes.len() as u64)?, 0)))
        }
        (None, None) => None,
    };
    let Some(Ok((header, file))) = found else { return Ok(found) };
    if let Some(view) = floats_of(image) {
        // The floats are compared with the whole image first.
        unless_short(buffers.view(view, "an image"))?;
        return Ok(Some(Ok((header.with_floats(), file))));
    }
    Ok(Some(Ok((header, file))))
}

/// Only a lack of memory is an error.
fn unless_short<T>(result: Result<T, Fault>) -> Result<Option<T>, Fault> {
    match result {
        Err(fault) if fault.is_shortage() => Err(fault),
        other => Ok(other.ok()),
    }
}
