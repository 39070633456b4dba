//! MTL: the materials of OBJ files.

use super::read_text;
use crate::describe::{MaterialDesc, Surface};
use crate::error::SceneError;
use crate::report::LoadReport;
use std::cell::Cell;
use std::io::{BufRead, Read};
use std::path::{Path, PathBuf};
use tobj::Material;

/// All materials of the MTL files that an OBJ file names.
#[derive(Default)]
pub(super) struct Library {
    materials: Vec<Material>,
}

impl Library {
    /// Adds what a statement `mtllib names` refers to; what is not there is reported.
    pub(super) fn open(&mut self, obj: &Path, names: &str, report: &mut LoadReport) -> Result<(), SceneError> {
        let beside = |name: &str| obj.parent().unwrap_or(Path::new("")).join(name.replace('\\', "/"));
        // One name with blanks in it, or several names.
        let whole = beside(names);
        let paths = if whole.is_file() { vec![whole] } else { names.split_whitespace().map(beside).collect() };
        for path in paths {
            if path.is_file() {
                self.materials.extend(parse(&path)?);
            } else {
                let text = "is not there; what it defines is made a diffuse grey of 0.5; put it beside the OBJ file";
                report.left_out(format!("material file '{}'", path.display()), text);
            }
        }
        Ok(())
    }

    /// Index of the material of that name; the last definition counts.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.materials.iter().rposition(|material| material.name == name)
    }

    /// Each material as this library models it; what that loses is reported.
    pub(super) fn describe(&self, report: &mut LoadReport) -> Vec<MaterialDesc> {
        self.materials.iter().map(|material| Translation { material, report }.describe()).collect()
    }
}

fn parse(path: &PathBuf) -> Result<Vec<Material>, SceneError> {
    let text = read_text(path)?;
    let lines = Cell::new(0);
    let mut counting = Counting { text: text.as_bytes(), lines: &lines };
    tobj::load_mtl_buf(&mut counting).map(|(materials, _)| materials).map_err(|error| {
        let line = lines.get();
        let statement = text.lines().nth(line.saturating_sub(1)).unwrap_or_default().trim();
        SceneError::Content {
            path: path.clone(),
            line: Some(line as u64),
            what: format!("'{statement}' cannot be understood ({error})"),
            mend: "correct or remove the statement".to_owned(),
        }
    })
}

/// Counts the lines that are taken from it, which is how the parser's errors get theirs.
struct Counting<'a> {
    text: &'a [u8],
    lines: &'a Cell<usize>,
}

impl Read for Counting<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.text.read(buffer)
    }
}

impl BufRead for Counting<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        // One line at a time, so that each is one call of `consume`.
        let end = self.text.iter().position(|&byte| byte == b'\n').map_or(self.text.len(), |at| at + 1);
        Ok(&self.text[..end])
    }

    fn consume(&mut self, amount: usize) {
        self.lines.set(self.lines.get() + usize::from(amount > 0));
        self.text = &self.text[amount..];
    }
}

/// One material on its way.
struct Translation<'a> {
    material: &'a Material,
    report: &'a mut LoadReport,
}

const MEND: &str = "give it in an override file";

impl Translation<'_> {
    fn subject(&self) -> String {
        format!("material '{}'", self.material.name)
    }

    fn approximated(&mut self, text: impl Into<String>) {
        self.report.approximated(self.subject(), text);
    }

    fn left_out(&mut self, text: impl Into<String>) {
        self.report.left_out(self.subject(), text);
    }

    fn describe(mut self) -> MaterialDesc {
        let surface = self.surface();
        let emission = self.material.emissive.map_or([0.0; 3], |colour| colour.map(f64::from));
        let mut desc = MaterialDesc::new(&self.material.name, surface);
        desc.emission = emission;
        if desc.is_emissive() {
            self.report.note(
                self.subject(),
                format!("emits {emission:?}, taken as radiance in W/(m²·sr), from its front; set emits_both_sides to change that"),
            );
        } else if let Some(ambient) = self.material.ambient.filter(|colour| colour.iter().any(|&part| part > 1.0)) {
            self.left_out(format!(
                "its Ka of {ambient:?}: ambient light is not physical, but some files put emission there; if this one \
                 does, give emission in an override file"
            ));
        }
        self.textures();
        desc
    }

    fn surface(&mut self) -> Surface {
        let material = self.material;
        let wide = |colour: [f32; 3]| colour.map(f64::from);
        let black = |colour: [f64; 3]| colour.iter().all(|&part| part == 0.0);
        let illumination = material.illumination_model.unwrap_or(2);
        let specular = material.specular.map_or([0.0; 3], wide);
        let diffuse = material.diffuse.map(wide);
        let rest = diffuse.filter(|&colour| !black(colour));
        let dissolve = self.dissolve();
        if matches!(illumination, 4 | 6 | 7 | 9) {
            let ior = self.ior();
            let tint = self.filter();
            self.approximated(format!(
                "is taken as solid glass of refractive index {ior} (illum {illumination}), whose triangles must enclose it"
            ));
            Surface::Dielectric { ior, absorption: [0.0; 3], tint }
        } else if dissolve < 1.0 {
            let ior = self.ior();
            let tint = self.filter();
            self.approximated(format!("is see-through (d {dissolve}) and taken as a clear thin pane; {MEND} as glass or lambert if that is wrong"));
            Surface::Thin { ior, tint }
        } else if matches!(illumination, 3 | 5) && !black(specular) {
            if let Some(colour) = rest {
                self.left_out(format!("its diffuse part Kd {colour:?} beside the mirror (illum {illumination})"));
            }
            Surface::Mirror { reflectance: specular }
        } else {
            // Models 0 and 1 have no highlight whatever Ks says.
            if illumination >= 2 && !black(specular) {
                let shininess = material.shininess.unwrap_or(0.0);
                self.approximated(format!("its glossy highlight (Ks {specular:?}, Ns {shininess}) is left out; kind = \"mirror\" in an override file is the nearest"));
            }
            let albedo = diffuse.unwrap_or_else(|| {
                self.approximated(format!("has no Kd and is made a diffuse grey of 0.5; {MEND}"));
                [0.5; 3]
            });
            Surface::Lambert { albedo }
        }
    }

    /// Opacity: `d`, or 1 − `Tr`.
    fn dissolve(&self) -> f64 {
        let material = self.material;
        let transparency = || material.unknown_param.get("Tr")?.parse::<f64>().ok();
        material.dissolve.map(f64::from).or_else(|| Some(1.0 - transparency()?)).unwrap_or(1.0)
    }

    fn ior(&mut self) -> f64 {
        match self.material.optical_density {
            Some(ior) => {
                if ior == 1.0 {
                    self.report.note(self.subject(), "its refractive index Ni is 1, so that it bends no light");
                }
                f64::from(ior)
            }
            None => {
                self.approximated(format!("has no refractive index Ni; 1.5 is taken; {MEND}"));
                1.5
            }
        }
    }

    /// Transmission filter `Tf`, if it is given as colours.
    fn filter(&self) -> [f64; 3] {
        let words = self.material.unknown_param.get("Tf").map_or("", String::as_str);
        let numbers: Vec<f64> = words.split_whitespace().map_while(|word| word.parse().ok()).collect();
        match numbers[..] {
            [grey] => [grey; 3],
            [red, green, blue] => [red, green, blue],
            _ => [1.0; 3],
        }
    }

    fn textures(&mut self) {
        let material = self.material;
        let known = [
            &material.ambient_texture,
            &material.diffuse_texture,
            &material.specular_texture,
            &material.normal_texture,
            &material.shininess_texture,
            &material.dissolve_texture,
        ];
        let mut files: Vec<String> = known.into_iter().flatten().cloned().collect();
        let mut others = Vec::new();
        for (keyword, value) in &material.unknown_param {
            let keyword = keyword.as_str();
            if keyword.starts_with("map_") || matches!(keyword, "disp" | "decal" | "refl" | "norm") {
                files.push(value.clone());
            } else if keyword.starts_with('P') || keyword == "aniso" || keyword == "anisor" {
                others.push(format!("{keyword} {value}"));
            }
        }
        // The parser keeps them in no particular order.
        files.sort();
        others.sort();
        if !files.is_empty() {
            self.left_out(format!(
                "its textures ({}); {MEND} an albedo that looks like them on average",
                files.join(", ")
            ));
        }
        if !others.is_empty() {
            self.left_out(format!("its physically based parameters ({})", others.join(", ")));
        }
    }
}
