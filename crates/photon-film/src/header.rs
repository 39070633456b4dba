//! `film.json`: what a film file contains and where it comes from.

use std::path::Path;

use photon_core::{Film, FilmTally, PassSet, Render};
use serde::{Deserialize, Serialize};

use crate::error::{FilmFileError, shown};
use crate::key::{FilmKey, SCENE};
use crate::tally::StoredTally;

/// The format that this version writes, and the newest that it reads. Films of format 1 have no counts of photons.
pub const FORMAT: u32 = 2;

/// Name of the description in the zip.
pub(crate) const NAME: &str = "film.json";

/// A film file without its pixels.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FilmInfo {
    /// What the passes depend on.
    pub key: FilmKey,
    /// The passes.
    pub contains: PassSet,
    /// Whether the sums are those of a single render, bit by bit: false after a merge in which they were added in another
    /// order, and with passes of several backends.
    pub in_order: bool,
    /// Whether there are error statistics.
    pub errors: bool,
    /// [`Film::clamp`].
    pub clamp: bool,
    /// Name of the scene, for the reader.
    pub scene: String,
    /// The programs and devices that rendered it.
    pub makers: Vec<Maker>,
    /// What the photons of the passes did.
    pub tally: FilmTally,
}

impl FilmInfo {
    /// The description of a film that has no passes yet.
    #[must_use]
    pub fn new(key: FilmKey, scene: &str) -> Self {
        let (contains, tally, scene) = (PassSet::default(), FilmTally::default(), scene.to_owned());
        Self { key, contains, in_order: true, errors: false, clamp: false, scene, makers: Vec::new(), tally }
    }

    /// Compares the key with that of a render of the scene with this name: [`FilmKey::check`].
    ///
    /// # Errors
    /// [`FilmFileError::OtherKey`] names the first part that differs, scenes by their names too.
    pub fn check(&self, expected: &FilmKey, scene: &str, path: &Path) -> Result<(), FilmFileError> {
        let named = |name: &str, key: &FilmKey| format!("{}, digest {}", shown(name), key.scene_digest());
        self.key.check(expected, path).map_err(|error| match error {
            FilmFileError::OtherKey { path, what, .. } if what == SCENE => {
                let (found, expected) = (named(&self.scene, &self.key), named(scene, expected));
                FilmFileError::OtherKey { path, what, found, expected }
            }
            other => other,
        })
    }

    /// Adds a maker, or the seconds to one that is known.
    pub fn add_maker(&mut self, maker: &Maker) {
        let same = |known: &&mut Maker| (&known.backend, &known.device) == (&maker.backend, &maker.device);
        match self.makers.iter_mut().find(|known| known.program == maker.program && same(known)) {
            Some(known) => known.seconds += maker.seconds,
            None => self.makers.push(maker.clone()),
        }
    }
}

/// The devices of renderers, in words.
#[must_use]
pub fn device_names(renderers: &[Box<dyn Render>]) -> String {
    let all: Vec<String> = renderers.iter().map(|renderer| renderer.facts().device).collect();
    match all.as_slice() {
        [device] => device.clone(),
        [first, others @ ..] if others.iter().all(|other| other == first) => format!("{} × {first}", all.len()),
        _ => all.join(", "),
    }
}

/// Who rendered passes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Maker {
    /// Program and version.
    pub program: String,
    /// Short name of the backend.
    pub backend: String,
    /// Description of the device.
    pub device: String,
    /// Seconds of rendering.
    pub seconds: f64,
}

impl Maker {
    /// A maker that has rendered for this many seconds.
    #[must_use]
    pub fn new(program: &str, backend: &str, device: &str, seconds: f64) -> Self {
        Self { program: program.to_owned(), backend: backend.to_owned(), device: device.to_owned(), seconds }
    }
}

/// The contents of `film.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Header {
    pub(crate) format: u32,
    pub(crate) scene: String,
    pub(crate) key: FilmKey,
    pub(crate) passes: Vec<Passes>,
    pub(crate) pass_count: u32,
    pub(crate) in_order: bool,
    pub(crate) errors: bool,
    pub(crate) clamp: bool,
    /// Factor from the mean over passes to W/(m²·sr), for readers of the arrays.
    pub(crate) radiance_factor: f64,
    /// Names of the arrays in the zip; others are 0 everywhere.
    pub(crate) arrays: Vec<String>,
    pub(crate) makers: Vec<Maker>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) tally: Option<StoredTally>,
}

/// A range of passes of a seed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Passes {
    seed: u64,
    first: u32,
    end: u32,
}

impl Header {
    /// The description of a film; `arrays` are still missing.
    pub(crate) fn new(info: &FilmInfo, contains: &PassSet) -> Self {
        Self {
            format: FORMAT,
            scene: info.scene.clone(),
            key: info.key.clone(),
            passes: contains
                .ranges()
                .map(|(seed, range)| Passes { seed, first: range.start, end: range.end })
                .collect(),
            pass_count: u32::try_from(contains.count()).unwrap_or(u32::MAX),
            in_order: info.in_order,
            errors: info.errors,
            clamp: info.clamp,
            radiance_factor: info.key.units().radiance_to_user(),
            arrays: Vec::new(),
            makers: info.makers.clone(),
            tally: StoredTally::new(&info.tally),
        }
    }

    /// Checks what can be checked without the arrays.
    pub(crate) fn info(&self) -> Result<FilmInfo, String> {
        let mut contains = PassSet::default();
        for &Passes { seed, first, end } in &self.passes {
            if first >= end {
                return Err(format!("passes {first}..{end} are none"));
            }
            contains.merge(&PassSet::of(seed, first..end)).map_err(|error| error.to_string())?;
        }
        if contains.is_empty() || contains.count() != u64::from(self.pass_count) {
            return Err(format!("it says {} passes, but lists {}", self.pass_count, contains.count()));
        }
        self.key.validate()?;
        let tally = self.tally.as_ref().map_or(Ok(FilmTally::default()), StoredTally::read)?;
        if tally.passes > self.pass_count {
            return Err(format!("it counts the photons of {} passes, but has {}", tally.passes, self.pass_count));
        }
        Ok(FilmInfo {
            key: self.key.clone(),
            contains,
            in_order: self.in_order,
            errors: self.errors,
            clamp: self.clamp,
            scene: self.scene.clone(),
            makers: self.makers.clone(),
            tally,
        })
    }
}

/// An empty film for the pixels of a file.
pub(crate) fn empty_film(info: &FilmInfo) -> photon_core::Result<Film> {
    let (width, height) = info.key.size();
    let mut film = Film::new(width, height, info.key.units())?;
    if info.errors {
        let mut errors = Vec::new();
        let bytes = (film.pixels.len() * size_of::<photon_core::ErrorPixel>()) as u64;
        let refused = |_| photon_core::Error::OutOfMemory { label: "film: errors", bytes };
        errors.try_reserve_exact(film.pixels.len()).map_err(refused)?;
        errors.resize(film.pixels.len(), photon_core::ErrorPixel::default());
        film.errors = Some(errors);
    }
    film.clamp = info.clamp;
    film.passes = u32::try_from(info.contains.count()).unwrap_or(u32::MAX);
    film.camera_samples = info.key.camera_samples();
    film.contains = info.contains.clone();
    film.tally = info.tally.clone();
    Ok(film)
}
