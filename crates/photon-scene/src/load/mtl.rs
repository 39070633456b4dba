//! MTL: the materials of OBJ files.

mod glossy;
mod images;
mod map;
mod metallic_roughness;
mod survey;
mod translate;

use self::images::Images;
use self::map::Map;
use self::translate::Translation;
use super::budget::{Budget, Shortage};
use super::{read_within, text_of};
use crate::builder::SceneBuilder;
use crate::describe::MaterialDesc;
use crate::error::SceneError;
use crate::report::LoadReport;
use std::path::{Path, PathBuf};

/// All materials of the MTL files that an OBJ file refers to.
#[derive(Default)]
pub(super) struct Library {
    entries: Vec<Entry>,
}

/// A material as defined in its file.
#[derive(Default)]
struct Entry {
    name: String,
    /// Folder of its file, where paths start.
    folder: PathBuf,
    /// `Ka`
    ambient: Option<[f64; 3]>,
    /// `Kd`
    diffuse: Option<[f64; 3]>,
    /// `Ks`
    specular: Option<[f64; 3]>,
    /// `Ke`
    emissive: Option<[f64; 3]>,
    /// `Tf`
    filter: Option<[f64; 3]>,
    /// `Ns`
    shininess: Option<f64>,
    /// `Ni`
    ior: Option<f64>,
    /// `d`, or 1 − `Tr`.
    dissolve: Option<f64>,
    /// Whether that is a `Tr` of 1, which some programs write for opaque materials.
    is_tr_one: bool,
    /// `Pr`
    roughness: Option<f64>,
    /// `Pm`
    metallic: Option<f64>,
    /// `illum`
    illumination: Option<u8>,
    /// `map_Kd`
    diffuse_map: Option<Map>,
    /// `map_Ke`
    emissive_map: Option<Map>,
    /// `norm`
    normal_map: Option<Map>,
    /// `map_Pr`
    roughness_map: Option<Map>,
    /// `map_Pm`
    metallic_map: Option<Map>,
    /// `map_d`
    dissolve_map: Option<Map>,
    /// The keyword and arguments of other texture statements.
    textures: Vec<String>,
    /// Other statements, verbatim.
    others: Vec<String>,
}

impl Library {
    /// Reads the files that a statement `mtllib names` refers to; missing files are reported.
    pub(super) fn open(
        &mut self,
        obj: &Path,
        names: &str,
        budget: &Budget,
        report: &mut LoadReport,
    ) -> Result<(), SceneError> {
        let beside = |name: &str| obj.parent().unwrap_or(Path::new("")).join(name.replace('\\', "/"));
        // One name with spaces in it, or several names.
        let whole = beside(names);
        let paths = if whole.is_file() { vec![whole] } else { names.split_whitespace().map(beside).collect() };
        for path in paths {
            if path.is_file() {
                self.entries.extend(parse(&path, budget)?);
            } else {
                let text = "does not exist; its materials become diffuse grey 0.5; put it beside the OBJ file";
                report.left_out(format!("material file '{}'", path.display()), text);
            }
        }
        Ok(())
    }

    /// Index of the material of that name; the last definition counts.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.entries.iter().rposition(|entry| entry.name == name)
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
}

fn parse(path: &Path, budget: &Budget) -> Result<Vec<Entry>, SceneError> {
    // The text, and the statements that are kept verbatim.
    let text = text_of(read_within(path, budget, 2)?);
    let mut entries: Vec<Entry> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        let fault = |hint: &str| SceneError::Content {
            path: path.to_owned(),
            line: Some(index as u64 + 1),
            what: format!("'{line}' is invalid"),
            hint: hint.to_owned(),
        };
        if keyword == "newmtl" {
            if rest.is_empty() {
                return Err(fault("a name must follow"));
            }
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            entries.push(Entry { name: rest.to_owned(), folder, ..Entry::default() });
        } else if !keyword.is_empty() && !keyword.starts_with('#') {
            let entry = entries.last_mut().ok_or_else(|| fault("'newmtl' and a name must come before it"))?;
            entry.statement(keyword, rest).map_err(fault)?;
        }
    }
    Ok(entries)
}

impl Entry {
    /// Parses one statement; the error is the hint.
    fn statement(&mut self, keyword: &str, rest: &str) -> Result<(), &'static str> {
        match keyword {
            "Ka" | "Kd" | "Ks" | "Ke" | "Tf" => {
                if rest.starts_with("spectral") || rest.starts_with("xyz") {
                    self.others.push(format!("{keyword} {rest}"));
                    return Ok(());
                }
                let place = match keyword {
                    "Ka" => &mut self.ambient,
                    "Kd" => &mut self.diffuse,
                    "Ks" => &mut self.specular,
                    "Ke" => &mut self.emissive,
                    _ => &mut self.filter,
                };
                *place = Some(color(rest).ok_or("one number, or three, must follow")?);
            }
            "Ns" => self.shininess = Some(number(rest)?),
            "Ni" => self.ior = Some(number(rest)?),
            "Pr" => self.roughness = Some(number(rest)?),
            "Pm" => self.metallic = Some(number(rest)?),
            // A halo varies the opacity with the angle; its number is the opacity at the rim.
            "d" => {
                self.dissolve = Some(share(rest.trim_start_matches("-halo"))?);
                self.is_tr_one = false;
            }
            "Tr" => {
                let transparency = share(rest)?;
                self.is_tr_one = self.dissolve.is_none() && transparency == 1.0;
                self.dissolve = self.dissolve.or(Some(1.0 - transparency));
            }
            "illum" => {
                let model = number(rest)?;
                if !(0.0..=10.0).contains(&model) || model.fract() != 0.0 {
                    return Err("an illumination model is a whole number from 0 to 10");
                }
                self.illumination = Some(model as u8);
            }
            "map_Kd" => self.diffuse_map = Some(Map::parse(rest)?),
            "map_Ke" => self.emissive_map = Some(Map::parse(rest)?),
            "norm" => self.normal_map = Some(Map::parse(rest)?),
            "map_Pr" => self.roughness_map = Some(Map::parse(rest)?),
            "map_Pm" => self.metallic_map = Some(Map::parse(rest)?),
            "map_d" => self.dissolve_map = Some(Map::parse(rest)?),
            "bump" | "disp" | "decal" | "refl" => self.textures.push(format!("{keyword} {rest}")),
            _ if keyword.starts_with("map_") => self.textures.push(format!("{keyword} {rest}")),
            _ => self.others.push(format!("{keyword} {rest}")),
        }
        Ok(())
    }
}

fn number(rest: &str) -> Result<f64, &'static str> {
    rest.split_whitespace().next().and_then(|word| word.parse().ok()).ok_or("a number must follow")
}

/// A share of the light; what rounding adds is cut off.
fn share(rest: &str) -> Result<f64, &'static str> {
    let share = number(rest)?;
    if !(-1e-3..=1.001).contains(&share) {
        return Err("a number from 0 to 1 must follow");
    }
    Ok(share.clamp(0.0, 1.0))
}

/// Three numbers, or one number for all channels.
fn color(rest: &str) -> Option<[f64; 3]> {
    let words = rest.split_whitespace().take_while(|word| !word.starts_with('#'));
    let numbers: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
    match numbers?[..] {
        [grey] => Some([grey; 3]),
        [red, green, blue] => Some([red, green, blue]),
        _ => None,
    }
}
