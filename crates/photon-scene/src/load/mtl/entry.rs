//! The statements of one material of an MTL file.

use std::path::PathBuf;
use std::sync::Arc;

use super::map::Map;
use crate::load::obj::number;
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
        let (kind, why) = match self.statement(keyword, rest) {
            Ok(()) => return,
            Err(Flaw::LeftOut(why)) => (ReportKind::LeftOut, why),
            Err(Flaw::Approximated(why)) => (ReportKind::Approximated, why),
        };
        let statement = format!("{keyword} {rest}");
        self.flaws.push((kind, format!("'{}' in line {line} of its file: {why}", statement.trim_end())));
    }

    fn statement(&mut self, keyword: &str, rest: &str) -> Result<(), Flaw> {
        let known = KEYWORDS.iter().find(|known| known.eq_ignore_ascii_case(keyword)).copied().unwrap_or(keyword);
        let map = || Map::parse(rest).map(Some).map_err(Flaw::LeftOut);
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
                *place = Some(color);
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
                self.is_tr_one = false;
                let plain = rest.trim_start_matches("-halo");
                share(plain, |share| self.dissolve = Some(share))?;
                if plain != rest {
                    return Err(Flaw::Approximated("its opacity does not vary with the angle"));
                }
            }
            "Tr" => {
                return share(rest, |transparency| {
                    self.is_tr_one = self.dissolve.is_none() && transparency == 1.0;
                    self.dissolve = self.dissolve.or(Some(1.0 - transparency));
                });
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
}

fn finite(rest: &str) -> Result<f64, Flaw> {
    let first = rest.split_whitespace().next().and_then(number);
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
    let mut words = rest.split_whitespace().take_while(|word| !word.starts_with('#'));
    let first = number(words.next()?)?;
    let mut color = [first; 3];
    if let Some(second) = words.next() {
        color = [first, number(second)?, number(words.next()?)?];
    }
    color.iter().all(|part| part.is_finite()).then(|| (color, words.next().is_some()))
}
