//! The statements of one material of an MTL file.

use std::path::PathBuf;
use std::sync::Arc;

use super::map::Map;
use crate::load::obj::{number, words};
use crate::report::ReportKind;

/// A material as defined in its file.
#[derive(Default)]
pub(super) struct Entry {
    pub(super) name: String,
    /// Folder of its file, where paths start.
    pub(super) folder: Arc<PathBuf>,
    /// `Ka`
    pub(super) ambient: Option<[f64; 3]>,
    /// `Kd`
    pub(super) diffuse: Option<[f64; 3]>,
    /// `Ks`
    pub(super) specular: Option<[f64; 3]>,
    /// `Ke`
    pub(super) emissive: Option<[f64; 3]>,
    /// `Tf`
    pub(super) filter: Option<[f64; 3]>,
    /// `Ns`
    pub(super) shininess: Option<f64>,
    /// `Ni`
    pub(super) ior: Option<f64>,
    /// `d`
    pub(super) opacity: Option<f64>,
    /// `Tr`
    pub(super) transparency: Option<f64>,
    /// `d`, or 1 − `Tr`.
    pub(super) dissolve: Option<f64>,
    /// Whether that is a `Tr` of 1, which some programs write for opaque materials.
    pub(super) is_tr_one: bool,
    /// `Pr`
    pub(super) roughness: Option<f64>,
    /// `Pm`
    pub(super) metallic: Option<f64>,
    /// `illum`
    pub(super) illumination: Option<u8>,
    /// `map_Kd`
    pub(super) diffuse_map: Option<Map>,
    /// `map_Ke`
    pub(super) emissive_map: Option<Map>,
    /// `norm`
    pub(super) normal_map: Option<Map>,
    /// `map_Pr`
    pub(super) roughness_map: Option<Map>,
    /// `map_Pm`
    pub(super) metallic_map: Option<Map>,
    /// `map_d`
    pub(super) dissolve_map: Option<Map>,
    /// The keyword and arguments of other texture statements.
    pub(super) textures: Vec<String>,
    /// Other statements, verbatim.
    pub(super) others: Vec<String>,
    /// Keywords that are read, with what followed.
    pub(super) given: Vec<(&'static str, String)>,
    /// Statements that are left out, or not taken as they are.
    pub(super) flaws: Vec<(ReportKind, String)>,
}

/// Fault of a statement.
enum Flaw {
    LeftOut(&'static str),
    Approximated(&'static str),
}

/// Statements that are read; other programs write some of them in lower case.
const KEYWORDS: &[&str] = &[
    "Ka", "Kd", "Ks", "Ke", "Tf", "Ns", "Ni", "Pr", "Pm", "d", "Tr", "illum", "map_Kd", "map_Ke", "norm", "map_Pr",
    "map_Pm", "map_d",
];

impl Entry {
    /// Takes in the statement of a line.
    pub(super) fn add(&mut self, keyword: &str, rest: &str, line: usize) {
        let known = KEYWORDS.iter().find(|known| known.eq_ignore_ascii_case(keyword)).copied();
        let earlier = known.and_then(|known| self.given.iter_mut().find(|(given, _)| *given == known));
        let is_changed =
            earlier.as_ref().is_some_and(|(_, given)| !given.split_whitespace().eq(rest.split_whitespace()));
        match (earlier, known) {
            (Some((_, given)), _) => rest.clone_into(given),
            (None, Some(known)) => self.given.push((known, rest.to_owned())),
            (None, None) => {}
        }
        let (kind, why) = match self.statement(known.unwrap_or(keyword), keyword, rest) {
            Ok(()) if is_changed => (ReportKind::Approximated, "it replaces an earlier one"),
            Ok(()) => return,
            Err(Flaw::LeftOut(why)) => (ReportKind::LeftOut, why),
            Err(Flaw::Approximated(why)) => (ReportKind::Approximated, why),
        };
        let statement = format!("{keyword} {rest}");
        self.flaws.push((kind, format!("'{}' in line {line} of its file: {why}", statement.trim_end())));
    }

    /// Whether it has a filter that does something. One of 0 is that of programs without.
    pub(super) fn filters(&self) -> bool {
        self.filter.is_some_and(|filter| filter != [1.0; 3] && filter != [0.0; 3])
    }

    /// Takes in a statement; `known` is its keyword as the format spells it.
    fn statement(&mut self, known: &str, keyword: &str, rest: &str) -> Result<(), Flaw> {
        let map = || Map::parse(rest).map(|map| Some(map.in_folder(&self.folder))).map_err(Flaw::LeftOut);
        match known {
            "Ka" | "Kd" | "Ks" | "Ke" | "Tf" => {
                if rest.starts_with("spectral") || rest.starts_with("xyz") {
                    self.others.push(format!("{keyword} {rest}"));
                    return Ok(());
                }
                let place = match known {
                    "Ka" => &mut self.ambient,
                    "Kd" => &mut self.diffuse,
                    "Ks" => &mut self.specular,
                    "Ke" => &mut self.emissive,
                    _ => &mut self.filter,
                };
                let (color, has_more) = color(rest).ok_or(Flaw::LeftOut("one finite number, or three, must follow"))?;
                let most = color.into_iter().fold(0.0, f64::max);
                // Nothing reflects more than all; emission has no bound.
                let (white, unit) = match known {
                    "Ka" | "Ke" => (f64::INFINITY, 1.0),
                    _ if most > 10.0 => (255.0, 255.0),
                    _ => (1.0, 1.0),
                };
                *place = Some(color.map(|part| part.clamp(0.0, white) / unit));
                if color.iter().any(|part| !(0.0..=white).contains(part)) {
                    return Err(Flaw::Approximated(if white.is_finite() {
                        "its numbers must lie between 0 and 1, and are clamped"
                    } else {
                        "its numbers must be at least 0, and are clamped"
                    }));
                }
                if unit > 1.0 {
                    return Err(Flaw::Approximated("it is taken as numbers from 0 to 255"));
                }
                if has_more {
                    return Err(Flaw::Approximated("the first three numbers are taken"));
                }
            }
            "Ns" => self.shininess = Some(finite(rest)?),
            "Ni" => {
                let ior = Some(finite(rest)?).filter(|&ior| ior > 0.0);
                self.ior = Some(ior.ok_or(Flaw::LeftOut("a refractive index is above 0"))?);
            }
            "Pr" => return share(rest, |share| self.roughness = Some(share)),
            "Pm" => return share(rest, |share| self.metallic = Some(share)),
            "d" => {
                let plain = rest.trim_start_matches("-halo");
                let set = share(plain, |share| self.opacity = Some(share));
                set.and(self.cover())?;
                if plain != rest {
                    return Err(Flaw::Approximated("its opacity does not vary with the angle"));
                }
            }
            "Tr" => {
                let set = share(rest, |share| self.transparency = Some(share));
                set.and(self.cover())?;
            }
            "illum" => {
                let is_model = |model: &f64| (0.0..=10.0).contains(model) && model.fract() == 0.0;
                let model = Some(finite(rest)?).filter(is_model);
                let model = model.ok_or(Flaw::LeftOut("an illumination model is a whole number from 0 to 10"))?;
                self.illumination = Some(model as u8);
            }
            "map_Kd" => self.diffuse_map = map()?,
            "map_Ke" => self.emissive_map = map()?,
            "norm" => self.normal_map = map()?,
            "map_Pr" => self.roughness_map = map()?,
            "map_Pm" => self.metallic_map = map()?,
            "map_d" => self.dissolve_map = map()?,
            "bump" | "disp" | "decal" | "refl" => self.textures.push(format!("{keyword} {rest}")),
            _ if keyword.starts_with("map_") => self.textures.push(format!("{keyword} {rest}")),
            _ => self.others.push(format!("{keyword} {rest}").trim_end().to_owned()),
        }
        Ok(())
    }

    /// Decides from `d` and `Tr` how much of a surface is there.
    fn cover(&mut self) -> Result<(), Flaw> {
        let of_tr = self.transparency.map(|share| 1.0 - share);
        self.dissolve = self.opacity.or(of_tr);
        self.is_tr_one = self.opacity.is_none() && self.transparency == Some(1.0);
        let differs = self.dissolve.zip(of_tr).is_some_and(|(d, of_tr)| (d - of_tr).abs() > 1e-3);
        if differs { Err(Flaw::Approximated("d and Tr contradict each other; d counts")) } else { Ok(()) }
    }
}

fn finite(rest: &str) -> Result<f64, Flaw> {
    let first = words(rest).next().and_then(number);
    first.filter(|number| number.is_finite()).ok_or(Flaw::LeftOut("a finite number must follow"))
}

/// Passes on a share of the light, from 0 to 1; it is clamped, silently if rounding explains it.
fn share(rest: &str, mut set: impl FnMut(f64)) -> Result<(), Flaw> {
    let share = finite(rest)?;
    set(share.clamp(0.0, 1.0));
    let is_near = (-1e-3..=1.001).contains(&share);
    if is_near { Ok(()) } else { Err(Flaw::Approximated("it must lie between 0 and 1, and is clamped")) }
}

/// Three finite numbers, or one number for all channels, and whether more follows.
fn color(rest: &str) -> Option<([f64; 3], bool)> {
    let mut words = words(rest);
    let first = number(words.next()?)?;
    let mut color = [first; 3];
    if let Some(second) = words.next() {
        color = [first, number(second)?, number(words.next()?)?];
    }
    color.iter().all(|part| part.is_finite()).then(|| (color, words.next().is_some()))
}
