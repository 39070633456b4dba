//! Wavefront OBJ: polygons grouped by name and material.
//!
//! A parser of our own, since existing libraries report neither line nor face of an error,
//! or panic at malformed input.

mod census;
mod group;
mod statements;

use self::census::Census;
use self::group::{Corner, Group, NONE, Pools};
use self::statements::{resolve, statements};
use super::budget::Budget;
use super::mtl::Library;
use super::{default_material, read_within, stem, text_of};
use crate::builder::{MaterialId, SceneBuilder};
use crate::color::srgb_to_linear;
use crate::describe::MaterialDesc;
use crate::error::SceneError;
use crate::report::LoadReport;
use glam::DVec3;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

/// Reads an OBJ file and the MTL files that it refers to.
///
/// Polygons are triangulated as fans; each pair of an object (or group) and a material becomes a
/// mesh. All materials of the MTL files can be overridden, used or not. Normals, texture coordinates (those of materials
/// with textures) and vertex colours, which are taken as sRGB, become vertex attributes.
///
/// # Errors
/// A file that cannot be read, or an invalid statement; the error has its line number.
pub fn load_obj(path: &Path) -> Result<(SceneBuilder, LoadReport), SceneError> {
    load_within(path, &Budget::unlimited())
}

/// Bytes of a vertex of the mesh with all attributes, in lists that may be half empty, and of its entry among the known ones.
const VERTEX: u64 = 2 * (24 + 24 + 16 + 32) + 40;

/// Bytes that a statement adds to the scene and, until that is built, to the lists that it is built from.
///
/// A new vertex of the mesh comes with a new position, normal or pair of texture coordinates; files that combine a few of them
/// in many ways take more.
fn bytes_of(statement: &str) -> u64 {
    let mut words = statement.split_whitespace();
    match words.next() {
        Some("v") => 24 + 2 * 32 + VERTEX,
        Some("vn") => 2 * 24 + VERTEX,
        Some("vt") => 2 * 16 + VERTEX,
        // A triangle for each corner but two: indices of positions, normals and texture coordinates.
        Some("f") => (words.count() as u64).saturating_sub(2) * 2 * 36,
        _ => 0,
    }
}

/// As [`load_obj`], within a limit on memory.
pub(super) fn load_within(path: &Path, budget: &Budget) -> Result<(SceneBuilder, LoadReport), SceneError> {
    let text = text_of(read_within(path, budget, 1)?);
    // A line that is joined to the previous one is not a statement of its own here either.
    let is_vertex = |(statement, _): &(Cow<'_, str>, usize)| statement.split_whitespace().next() == Some("v");
    let vertices = statements(&text).filter(is_vertex).count();
    if budget.left().is_some() {
        let bytes = statements(&text).map(|(statement, _)| bytes_of(&statement)).sum();
        budget.take(bytes, || "its vertices and triangles".to_owned()).map_err(|why| why.in_file(path))?;
    }
    if vertices >= u32::MAX as usize {
        return Err(SceneError::TooMany { what: "vertices", count: vertices });
    }
    let mut reader = Reader {
        path,
        budget,
        vertices,
        pools: Pools { positions: Vec::with_capacity(vertices), ..Pools::default() },
        library: Library::default(),
        report: LoadReport::default(),
        object: stem(path),
        material: None,
        groups: Vec::new(),
        by_name: HashMap::new(),
        group: None,
        faces: 0,
        census: Census::default(),
    };
    for (statement, line) in statements(&text) {
        reader.statement(&statement, line)?;
    }
    reader.finish(budget)
}

struct Reader<'a> {
    path: &'a Path,
    budget: &'a Budget,
    /// Number of vertices in the whole file: a face may refer to one that comes later.
    vertices: usize,
    pools: Pools,
    library: Library,
    report: LoadReport,
    object: String,
    material: Option<String>,
    groups: Vec<Group>,
    by_name: HashMap<(String, Option<String>), usize>,
    /// The group that faces are added to; `None` until the next face determines it.
    group: Option<usize>,
    faces: usize,
    census: Census,
}

impl Reader<'_> {
    fn fault(&self, line: usize, what: impl Into<String>, hint: impl Into<String>) -> SceneError {
        let (what, hint) = (what.into(), hint.into());
        SceneError::Content { path: self.path.to_owned(), line: Some(line as u64), what, hint }
    }

    fn statement(&mut self, line: &str, number: usize) -> Result<(), SceneError> {
        let line = line.trim();
        // Only at the start: names may contain '#'.
        if line.starts_with('#') {
            return Ok(());
        }
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        match keyword {
            "v" => {
                let position = self.numbers(keyword, rest, number)?;
                self.pools.positions.push(position);
                // A fourth number is a weight that only curves use; a sixth is the last component of a colour.
                if rest.split_whitespace().nth(5).is_some() {
                    self.color(rest);
                }
            }
            "vn" => {
                let normal = self.numbers(keyword, rest, number)?;
                self.pools.normals.push(DVec3::from_array(normal).normalize_or_zero());
            }
            "f" => self.face(rest, number)?,
            "o" | "g" => {
                self.object = if rest.is_empty() { stem(self.path) } else { rest.to_owned() };
                self.group = None;
            }
            "usemtl" => {
                self.material = (!rest.is_empty()).then(|| rest.to_owned());
                self.group = None;
            }
            "mtllib" => self.library.open(self.path, rest, self.budget, &mut self.report)?,
            "vt" => self.texture_coordinates(rest),
            // Vertex normals say what is smooth.
            "" | "s" => {}
            other => *self.census.ignored.entry(other.to_owned()).or_default() += 1,
        }
        Ok(())
    }

    /// The colour of the last vertex: the fourth to sixth number, sRGB.
    fn color(&mut self, rest: &str) {
        let mut words = rest.split_whitespace().skip(3);
        let mut channel = || words.next().and_then(|word| word.parse::<f64>().ok()).filter(|part| part.is_finite());
        if let (Some(red), Some(green), Some(blue)) = (channel(), channel(), channel()) {
            let [r, g, b] = [red, green, blue].map(|part| srgb_to_linear(part.clamp(0.0, 1.0)));
            self.pools.colors.resize(self.pools.positions.len() - 1, [1.0; 4]);
            self.pools.colors.push([r, g, b, 1.0]);
        }
    }

    /// A statement `vt u v`; v is 0 if it is left out. Invalid ones only matter to faces with textures, as NaN.
    fn texture_coordinates(&mut self, rest: &str) {
        let mut words = rest.split_whitespace();
        let u = words.next().and_then(|word| word.parse().ok()).unwrap_or(f64::NAN);
        let v = words.next().map_or(0.0, |word| word.parse().unwrap_or(f64::NAN));
        self.pools.uvs.push([u, 1.0 - v]);
    }

    fn numbers(&self, keyword: &str, rest: &str, line: usize) -> Result<[f64; 3], SceneError> {
        let mut words = rest.split_whitespace();
        let mut numbers = [0.0; 3];
        for number in &mut numbers {
            let word = words.next().unwrap_or("nothing");
            *number = word.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
                self.fault(
                    line,
                    format!("'{keyword} {rest}' has {word} in place of a number"),
                    "three finite numbers must follow",
                )
            })?;
        }
        Ok(numbers)
    }

    fn face(&mut self, rest: &str, line: usize) -> Result<(), SceneError> {
        self.faces += 1;
        let mut corners = Vec::with_capacity(4);
        let Pools { positions, normals, uvs, .. } = &self.pools;
        for word in rest.split_whitespace().take_while(|word| !word.starts_with('#')) {
            let mut parts = word.split('/');
            let vertex = parts.next().unwrap_or_default();
            let Some(index) = resolve(vertex, positions.len(), self.vertices) else {
                let what = format!(
                    "face {} refers to vertex '{vertex}', but the file has {}, of which {} come before it",
                    self.faces,
                    self.vertices,
                    positions.len()
                );
                return Err(self.fault(line, what, "vertices count from 1, or back from -1"));
            };
            let other = |word: Option<&str>, count: usize| {
                word.and_then(|word| resolve(word, count, count)).map_or(NONE, |index| index as u32)
            };
            let (uv, normal) = (other(parts.next(), uvs.len()), other(parts.next(), normals.len()));
            corners.push(Corner { position: index as u32, uv, normal });
        }
        if corners.len() < 3 {
            let what = format!("face {} has {} corners", self.faces, corners.len());
            return Err(self.fault(line, what, "it needs at least three"));
        }
        self.census.polygon(&corners, positions, line);
        let group = self.current();
        self.groups[group].add(&corners);
        Ok(())
    }

    fn current(&mut self) -> usize {
        if let Some(group) = self.group {
            return group;
        }
        let key = (self.object.clone(), self.material.clone());
        let groups = &mut self.groups;
        let group = *self.by_name.entry(key.clone()).or_insert_with(|| {
            groups.push(Group::new(key.0, key.1));
            groups.len() - 1
        });
        self.group = Some(group);
        group
    }

    fn finish(mut self, budget: &Budget) -> Result<(SceneBuilder, LoadReport), SceneError> {
        let mut builder = SceneBuilder::new();
        let descs = self.library.describe(&mut builder, &mut self.report, budget);
        let descs = descs.map_err(|shortage| shortage.in_file(self.path))?;
        let ids: Vec<MaterialId> = descs.into_iter().map(|desc| builder.material(desc)).collect();
        // Materials that are not defined anywhere, and the one of faces without material; under their names, so that an
        // override file can define them.
        let mut grey = HashMap::new();
        for group in self.groups {
            let known = group.material.as_deref().and_then(|name| self.library.find(name)).map(|index| ids[index]);
            let material = known.unwrap_or_else(|| {
                *grey.entry(group.material.clone()).or_insert_with(|| {
                    let desc = default_material();
                    match group.material.clone() {
                        Some(name) => {
                            let text = "is not defined; it is made a diffuse grey of 0.5";
                            self.report.approximated(format!("material '{name}'"), text);
                            builder.material(MaterialDesc { name, ..desc })
                        }
                        None => {
                            let text = "has polygons without material; they are made a diffuse grey of 0.5, 'default'";
                            self.report.approximated("the file", text);
                            builder.material(desc)
                        }
                    }
                })
            });
            let is_textured = builder.materials[material.0 as usize].textures.all().next().is_some();
            let bare = group.without_uvs();
            if is_textured && bare > 0 {
                let text = format!(
                    "{bare} of its triangles have no texture coordinates, which its material needs; 0 is taken"
                );
                self.report.approximated(format!("mesh '{}'", group.object), text);
            }
            let object = group.object.clone();
            let (positions, triangles, attributes) = group.mesh(&self.pools, is_textured);
            builder.mesh_with(object, positions, triangles, attributes, material);
        }
        self.census.report(&mut self.report);
        Ok((builder, self.report))
    }
}
