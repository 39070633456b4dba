//! MTL: the materials of OBJ files.

mod entry;
mod glossy;
mod images;
mod map;
mod metallic_roughness;
mod survey;
mod translate;

use self::entry::Entry;
use self::images::Images;
pub(super) use self::images::has_alpha;
use self::map::Map;
use self::translate::Translation;
use super::budget::{Budget, Shortage};
use super::gltf::leaves_folder;
use super::obj::{parts, spellings, statements};
use super::read_within;
use super::text::text_of;
use crate::builder::SceneBuilder;
use crate::describe::MaterialDesc;
use crate::error::SceneError;
use crate::report::LoadReport;
use crate::texture::TextureRef;
use photon_core::TexelFormat;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// All materials of the MTL files that an OBJ file refers to.
#[derive(Default)]
pub(super) struct Library {
    entries: Vec<Entry>,
    /// The last of each name.
    by_name: HashMap<String, usize>,
    /// The files that have been read, without symbolic links.
    files: HashSet<PathBuf>,
}

impl Library {
    /// Reads the files that a statement `mtllib names` refers to, each once. Those that do not exist or are not in the folder
    /// of the OBJ file or below are reported.
    pub(super) fn open(
        &mut self,
        obj: &Path,
        names: &str,
        budget: &Budget,
        report: &mut LoadReport,
    ) -> Result<(), SceneError> {
        let beside = |name: &str| obj.parent().unwrap_or(Path::new("")).join(name.replace('\\', "/"));
        let is_file = |name: &str| !leaves_folder(name) && beside(name).is_file();
        if names.is_empty() {
            report.left_out("the file", "a statement 'mtllib' without the name of a file");
        }
        // One name with spaces in it, or several names.
        let whole = spellings(names).into_iter().find(|name| is_file(name));
        let names = whole.map_or_else(|| names.split_whitespace().collect(), |name| vec![name]);
        for name in names {
            if is_file(name) {
                let path = beside(name);
                let known = path.canonicalize().unwrap_or_else(|_| path.clone());
                if self.files.insert(known) {
                    self.parse(&path, budget, report)?;
                }
            } else {
                let why = if leaves_folder(name) { "is outside the folder of the scene" } else { "does not exist" };
                let text = format!("{why}; its materials become diffuse grey 0.5; put it beside the OBJ file");
                report.left_out(format!("material file '{name}'"), text);
            }
        }
        Ok(())
    }

    /// Index of the material of that name; the last definition counts.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        spellings(name).into_iter().find_map(|name| self.by_name.get(name)).copied()
    }

    /// Converts each material to the renderer's model, and adds its textures to the scene; losses are reported.
    ///
    /// # Errors
    /// Textures that do not fit into memory.
    pub(super) fn describe(
        &self,
        builder: &mut SceneBuilder,
        report: &mut LoadReport,
        budget: &Budget,
    ) -> Result<Vec<MaterialDesc>, Shortage> {
        let mut images = Images::new(survey::plan(self, budget)?);
        let describe = |material| Translation { material, images: &mut images, builder, report }.describe();
        let descs = self.entries.iter().map(describe).collect();
        images.survey.plan.report(report);
        images.room.report(builder, report);
        Ok(descs)
    }

    fn parse(&mut self, path: &Path, budget: &Budget, report: &mut LoadReport) -> Result<(), SceneError> {
        // The text, and the names and statements that are kept verbatim, most of them twice.
        let text = text_of(path, read_within(path, budget, 5)?)?;
        let folder = Arc::new(path.parent().unwrap_or(Path::new("")).to_owned());
        // The material that statements belong to, and the first that belongs to none.
        let (mut current, mut stray, mut strays) = (None, 0, 0);
        for (statement, line) in statements(&text) {
            let (keyword, rest) = parts(&statement);
            if keyword.eq_ignore_ascii_case("newmtl") && !rest.is_empty() {
                let bytes = (size_of::<Entry>() + size_of::<MaterialDesc>()) as u64;
                budget.take(bytes, || format!("material '{rest}'")).map_err(|why| why.in_file(path))?;
                let [name, bare] = spellings(rest);
                if self.by_name.insert(name.to_owned(), self.entries.len()).is_some() {
                    let text = "is defined more than once; the last definition counts";
                    report.approximated(format!("material '{name}'"), text);
                }
                self.by_name.entry(bare.to_owned()).or_insert(self.entries.len());
                current = Some(self.entries.len());
                self.entries.push(Entry { name: rest.to_owned(), folder: Arc::clone(&folder), ..Entry::default() });
            } else if !matches!(keyword, "" | "#") {
                if keyword.eq_ignore_ascii_case("newmtl") {
                    current = None;
                }
                match current {
                    Some(entry) => self.entries[entry].add(keyword, rest, line),
                    None if strays == 0 => (stray, strays) = (line, 1),
                    None => strays += 1,
                }
            }
        }
        if strays > 0 {
            let text =
                format!("{strays} statements without 'newmtl' and a name before them, the first in line {stray}");
            report.left_out(format!("material file '{}'", path.display()), text);
        }
        Ok(())
    }
}

/// Adds images that a file at `path` in another format names to the scene, as textures of a base colour; those that cannot be
/// read are `None`, and reported.
///
/// # Errors
/// Textures that do not fit into memory.
pub(super) fn images_alone(
    path: &Path,
    names: &[String],
    subject: &str,
    builder: &mut SceneBuilder,
    report: &mut LoadReport,
    budget: &Budget,
) -> Result<Vec<Option<TextureRef>>, Shortage> {
    let folder = Arc::new(path.parent().unwrap_or(Path::new("")).to_owned());
    let entry = |name: &String| {
        let (name, folder, map) = (name.clone(), Arc::clone(&folder), Map::plain(name));
        Entry { name, folder, diffuse_map: Some(map), ..Entry::default() }
    };
    let library = Library { entries: names.iter().map(entry).collect(), ..Library::default() };
    let mut images = Images::new(survey::plan(&library, budget)?);
    let maps = library.entries.iter().filter_map(|entry| entry.diffuse_map.as_ref());
    let mut add = |map| images.add(&folder, ("file", map), TexelFormat::Srgb8, subject, builder, report);
    let textures = maps.map(&mut add).collect();
    images.survey.plan.report(report);
    images.room.report(builder, report);
    Ok(textures)
}
