//! Wavefront OBJ: polygons grouped by name and material.
//!
//! A parser of our own, since existing libraries report neither line nor face of an error,
//! or panic at malformed input.

mod census;

use self::census::Census;
use super::mtl::Library;
use super::{default_material, read_text, stem};
use crate::builder::{MaterialId, SceneBuilder};
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
/// mesh. All materials of the MTL files can be overridden, used or not.
///
/// # Errors
/// A file that cannot be read, or an invalid statement; the error has its line number.
pub fn load_obj(path: &Path) -> Result<(SceneBuilder, LoadReport), SceneError> {
    let text = read_text(path)?;
    // A line that is joined to the previous one is not a statement of its own here either.
    let is_vertex = |(statement, _): &(Cow<'_, str>, usize)| statement.split_whitespace().next() == Some("v");
    let vertices = statements(&text).filter(is_vertex).count();
    if vertices >= u32::MAX as usize {
        return Err(SceneError::TooMany { what: "vertices", count: vertices });
    }
    let mut reader = Reader {
        path,
        vertices,
        positions: Vec::with_capacity(vertices),
        normals: Vec::new(),
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
    Ok(reader.finish())
}

/// The statements of a file, each with the number of its first line: a backslash at the end joins a line with the next.
fn statements(text: &str) -> impl Iterator<Item = (Cow<'_, str>, usize)> {
    let begun = |line: &'_ str| line.trim_end().strip_suffix('\\').map(str::len);
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (index, line) = lines.next()?;
        let Some(end) = begun(line) else {
            return Some((Cow::Borrowed(line), index + 1));
        };
        let mut joined = line[..end].to_owned();
        for (_, line) in lines.by_ref() {
            joined.push(' ');
            match begun(line) {
                Some(end) => joined.push_str(&line[..end]),
                None => {
                    joined.push_str(line);
                    break;
                }
            }
        }
        Some((Cow::Owned(joined), index + 1))
    })
}

/// Triangles of one object and material, by index into all vertices of the file.
struct Group {
    object: String,
    material: Option<String>,
    triangles: Vec<[u32; 3]>,
}

struct Reader<'a> {
    path: &'a Path,
    /// Number of vertices in the whole file: a face may refer to one that comes later.
    vertices: usize,
    positions: Vec<[f64; 3]>,
    normals: Vec<DVec3>,
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
                self.positions.push(position);
                // A fourth number is a weight that only curves use; a sixth is the last component of a colour.
                self.census.colored += usize::from(rest.split_whitespace().nth(5).is_some());
            }
            "vn" => {
                let normal = self.numbers(keyword, rest, number)?;
                self.normals.push(DVec3::from_array(normal).normalize_or_zero());
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
            "mtllib" => self.library.open(self.path, rest, &mut self.report)?,
            // Texture coordinates and smoothing groups are irrelevant without textures.
            "" | "vt" | "s" => {}
            other => *self.census.ignored.entry(other.to_owned()).or_default() += 1,
        }
        Ok(())
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
        let mut normals = Vec::new();
        for word in rest.split_whitespace().take_while(|word| !word.starts_with('#')) {
            let mut parts = word.split('/');
            let vertex = parts.next().unwrap_or_default();
            let Some(index) = resolve(vertex, self.positions.len(), self.vertices) else {
                let what = format!(
                    "face {} refers to vertex '{vertex}', but the file has {}, of which {} come before it",
                    self.faces,
                    self.vertices,
                    self.positions.len()
                );
                return Err(self.fault(line, what, "vertices count from 1, or back from -1"));
            };
            corners.push(index as u32);
            let normal = parts.nth(1).and_then(|word| resolve(word, self.normals.len(), self.normals.len()));
            normals.extend(normal.map(|index| self.normals[index]));
        }
        if corners.len() < 3 {
            let what = format!("face {} has {} corners", self.faces, corners.len());
            return Err(self.fault(line, what, "it needs at least three"));
        }
        self.census.polygon(&corners, &self.positions, &normals, line);
        let group = self.current();
        let triangles = &mut self.groups[group].triangles;
        triangles.extend((1..corners.len() - 1).map(|next| [corners[0], corners[next], corners[next + 1]]));
        Ok(())
    }

    fn current(&mut self) -> usize {
        if let Some(group) = self.group {
            return group;
        }
        let key = (self.object.clone(), self.material.clone());
        let groups = &mut self.groups;
        let group = *self.by_name.entry(key.clone()).or_insert_with(|| {
            groups.push(Group { object: key.0, material: key.1, triangles: Vec::new() });
            groups.len() - 1
        });
        self.group = Some(group);
        group
    }

    fn finish(mut self) -> (SceneBuilder, LoadReport) {
        let mut builder = SceneBuilder::new();
        let ids: Vec<MaterialId> =
            self.library.describe(&mut self.report).into_iter().map(|desc| builder.material(desc)).collect();
        // Materials that are not defined anywhere, and the one of faces without material; under their names, so that an
        // override file can define them.
        let mut grey = HashMap::new();
        // The last group that each vertex was copied to, and its index there.
        let mut moved = vec![(usize::MAX, 0_u32); self.positions.len()];
        for (number, group) in self.groups.into_iter().enumerate() {
            let known = group.material.as_deref().and_then(|name| self.library.find(name)).map(|index| ids[index]);
            let material = known.unwrap_or_else(|| {
                *grey.entry(group.material.clone()).or_insert_with(|| {
                    let desc = default_material();
                    match group.material {
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
            let mut positions = Vec::new();
            let mut triangles = group.triangles;
            for index in triangles.iter_mut().flatten() {
                let place = &mut moved[*index as usize];
                if place.0 != number {
                    *place = (number, positions.len() as u32);
                    positions.push(self.positions[*index as usize]);
                }
                *index = place.1;
            }
            builder.mesh(group.object, positions, triangles, material);
        }
        self.census.report(&mut self.report);
        (builder, self.report)
    }
}

/// Converts a reference, from 1 or backwards from -1, to an index from 0; `None` if it is out of range.
fn resolve(word: &str, before: usize, all: usize) -> Option<usize> {
    let number: i64 = word.parse().ok()?;
    let index = if number > 0 { number - 1 } else { (before as i64).checked_add(number)? };
    usize::try_from(index).ok().filter(|&index| number != 0 && index < all)
}
