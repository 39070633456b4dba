//! Wavefront OBJ: polygons grouped by name and material.
//!
//! A parser of our own, since existing libraries report neither line nor face of an error,
//! or panic at malformed input.

mod census;
mod pools;
mod statements;

use self::census::Census;
use self::statements::Reference;
pub(super) use self::statements::{number, parts, spellings, statements, words};
use super::budget::Budget;
use super::group::{Corner, Group, NONE, Pools};
use super::mtl::Library;
use super::polygon::{Triangulator, scratch};
use super::text::{check_kind, text_of};
use super::{default_material, read_within, stem, white_material};
use crate::builder::{MaterialId, SceneBuilder};
use crate::describe::MaterialDesc;
use crate::error::SceneError;
use crate::report::LoadReport;
use glam::DVec3;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;

/// Reads an OBJ file and the MTL files that it refers to.
///
/// Polygons become triangles, also those that are not convex; each pair of an object (or group) and a material becomes a
/// mesh. All materials of the MTL files can be overridden, used or not. Normals, texture coordinates (those of materials
/// with textures) and vertex colours, which are taken as sRGB, become vertex attributes. What is left out or guessed is in
/// the report.
///
/// # Errors
/// A file that cannot be read, a vertex without coordinates, or a face of vertices that do not exist or are not finite;
/// the error has its line number.
pub fn load_obj(path: &Path) -> Result<(SceneBuilder, LoadReport), SceneError> {
    load_within(path, &Budget::unlimited())
}

/// Bytes of a vertex of the mesh with all attributes, in lists that may be half empty, and of its entry among the known ones.
const VERTEX: u64 = 2 * (24 + 24 + 16 + 32) + 48;
/// Bytes of a group of triangles, its mesh and its name; the lists of a short one are allocated for four triangles.
const GROUP: u64 = 1024;

/// Bytes that a statement adds to the scene and, until that is built, to the lists that it is built from.
///
/// A new vertex of the mesh comes with a new position, normal or pair of texture coordinates; files that combine a few of them
/// in many ways take more.
fn bytes_of(statement: &str) -> u64 {
    let (keyword, rest) = parts(statement);
    match keyword {
        "v" => 24 + 2 * 32 + VERTEX,
        "vn" => 2 * 24 + VERTEX,
        "vt" => 2 * 16 + VERTEX,
        // A triangle for each corner but two: indices of positions, normals and texture coordinates.
        "f" => (rest.split_whitespace().count() as u64).saturating_sub(2) * 2 * 36,
        "o" | "g" | "usemtl" => GROUP + rest.len() as u64,
        _ => 0,
    }
}

/// As [`load_obj`], within a limit on memory.
pub(super) fn load_within(path: &Path, budget: &Budget) -> Result<(SceneBuilder, LoadReport), SceneError> {
    let bytes = read_within(path, budget, 1)?;
    check_kind(path, &bytes, &[])?;
    let text = text_of(path, bytes)?;
    // A line that is joined to the previous one is not a statement of its own here either.
    let is_vertex = |(statement, _): &(Cow<'_, str>, usize)| parts(statement).0 == "v";
    let vertices = statements(&text).filter(is_vertex).count();
    if budget.left().is_some() {
        let bytes: u64 = statements(&text).map(|(statement, _)| bytes_of(&statement)).sum();
        let corners = |(statement, _): (Cow<'_, str>, usize)| match parts(&statement) {
            ("f", rest) => rest.split_whitespace().count() as u64,
            _ => 0,
        };
        let most = statements(&text).map(corners).max().unwrap_or(0);
        let face = scratch(most) + most * 2 * size_of::<Corner>() as u64;
        budget.take(bytes + face, || "its vertices and triangles".to_owned()).map_err(|why| why.in_file(path))?;
    }
    if vertices >= u32::MAX as usize {
        return Err(SceneError::TooMany { what: "vertices", count: vertices });
    }
    let mut census = Census::default();
    let pools = pools::read(&text, vertices, &mut census)
        .map_err(|(line, what)| fault(path, line, what, "three numbers must follow"))?;
    let object = Arc::<str>::from(stem(path));
    let mut reader = Reader {
        path,
        budget,
        pools,
        before: Before::default(),
        library: Library::default(),
        report: LoadReport::default(),
        names: HashSet::from([Arc::clone(&object)]),
        object,
        material: None,
        groups: Vec::new(),
        by_name: HashMap::new(),
        group: None,
        faces: 0,
        triangulator: Triangulator::default(),
        corners: Vec::new(),
        places: Vec::new(),
        census,
    };
    for (statement, line) in statements(&text) {
        reader.statement(&statement, line)?;
    }
    reader.finish()
}

fn fault(path: &Path, line: usize, what: impl Into<String>, hint: &str) -> SceneError {
    SceneError::Content { path: path.to_owned(), line: Some(line as u64), what: what.into(), hint: hint.to_owned() }
}

/// How many definitions come before a face.
#[derive(Default)]
struct Before {
    positions: usize,
    normals: usize,
    uvs: usize,
}

/// The names of an object and a material, each shared by all groups.
type Names = (Arc<str>, Option<Arc<str>>);

struct Reader<'a> {
    path: &'a Path,
    budget: &'a Budget,
    /// Of the whole file: a face may refer to what comes later.
    pools: Pools,
    before: Before,
    library: Library,
    report: LoadReport,
    names: HashSet<Arc<str>>,
    object: Arc<str>,
    material: Option<Arc<str>>,
    groups: Vec<(Names, Group)>,
    /// By the addresses of the names.
    by_name: HashMap<(*const u8, Option<*const u8>), usize>,
    /// The group that faces are added to; `None` until the next face determines it.
    group: Option<usize>,
    faces: usize,
    triangulator: Triangulator,
    /// Of the present face.
    corners: Vec<Corner>,
    places: Vec<DVec3>,
    census: Census,
}

impl Reader<'_> {
    fn statement(&mut self, statement: &str, line: usize) -> Result<(), SceneError> {
        let (keyword, rest) = parts(statement);
        match keyword {
            "v" => self.before.positions += 1,
            "vn" => self.before.normals += 1,
            "vt" => self.before.uvs += 1,
            "f" => self.face(rest, line)?,
            "o" | "g" => {
                self.object = if rest.is_empty() { self.shared(&stem(self.path)) } else { self.shared(rest) };
                self.group = None;
            }
            "usemtl" => {
                self.material = (!rest.is_empty()).then(|| self.shared(rest));
                self.group = None;
            }
            "mtllib" => self.library.open(self.path, rest, self.budget, &mut self.report)?,
            // Vertex normals say what is smooth.
            "" | "#" | "s" => {}
            other => self.census.ignore(other, line),
        }
        Ok(())
    }

    /// The one copy of a name.
    fn shared(&mut self, name: &str) -> Arc<str> {
        if let Some(known) = self.names.get(name) {
            return Arc::clone(known);
        }
        let name = Arc::<str>::from(name);
        self.names.insert(Arc::clone(&name));
        name
    }

    fn face(&mut self, rest: &str, line: usize) -> Result<(), SceneError> {
        self.faces += 1;
        self.corners.clear();
        self.places.clear();
        let Pools { positions, normals, uvs, .. } = &self.pools;
        for word in words(rest) {
            let mut parts = word.split('/');
            let vertex = parts.next().unwrap_or_default();
            let Reference::To(position) = Reference::parse(Some(vertex), self.before.positions, positions.len()) else {
                let what = format!(
                    "face {} refers to vertex '{vertex}', but the file has {}, of which {} come before it",
                    self.faces,
                    positions.len(),
                    self.before.positions
                );
                return Err(fault(self.path, line, what, "vertices count from 1, or back from -1"));
            };
            let place = DVec3::from(positions[position as usize]);
            if !place.is_finite() {
                let what = format!("face {} uses vertex {}, which is {place}", self.faces, position + 1);
                return Err(fault(self.path, line, what, "each coordinate must be a finite number"));
            }
            let uv = Reference::parse(parts.next(), self.before.uvs, uvs.len());
            let normal = Reference::parse(parts.next(), self.before.normals, normals.len());
            for (reference, lost) in [(uv, &mut self.census.lost_uvs), (normal, &mut self.census.lost_normals)] {
                if reference == Reference::Wrong {
                    lost.add(line);
                }
            }
            self.corners.push(Corner { position, uv: uv.index(), normal: normal.index(), color: NONE });
            self.places.push(place);
        }
        if self.corners.len() < 3 {
            self.census.small.add(line);
            return Ok(());
        }
        let group = self.current();
        let (triangles, is_exact) = self.triangulator.triangles(&self.places);
        if !is_exact {
            self.census.crossing.add(line);
        }
        self.groups[group].1.add(&self.corners, triangles);
        Ok(())
    }

    fn current(&mut self) -> usize {
        if let Some(group) = self.group {
            return group;
        }
        let (object, material) = (&self.object, &self.material);
        let groups = &mut self.groups;
        let key = (object.as_ptr(), material.as_ref().map(|name| name.as_ptr()));
        let group = *self.by_name.entry(key).or_insert_with(|| {
            groups.push(((Arc::clone(object), material.clone()), Group::default()));
            groups.len() - 1
        });
        self.group = Some(group);
        group
    }

    fn finish(mut self) -> Result<(SceneBuilder, LoadReport), SceneError> {
        let mut builder = SceneBuilder::new();
        let descs = self.library.describe(&mut builder, &mut self.report, self.budget);
        let descs = descs.map_err(|shortage| shortage.in_file(self.path))?;
        let ids: Vec<MaterialId> = descs.into_iter().map(|desc| builder.material(desc)).collect();
        let mut others = HashMap::new();
        for ((object, name), group) in self.groups {
            let known = name.as_deref().and_then(|name| self.library.find(name)).map(|index| ids[index]);
            let material = known.unwrap_or_else(|| {
                let has_colors = group.has_colors(&self.pools);
                *others.entry((name.clone(), has_colors)).or_insert_with(|| {
                    let desc = stand_in(name.as_deref(), has_colors, &mut self.report);
                    builder.material(desc)
                })
            });
            let is_textured = builder.materials[material.0 as usize].textures.all().next().is_some();
            let bare = group.without_uvs();
            if is_textured && bare > 0 {
                let text = format!(
                    "{bare} of its triangles have no texture coordinates, which its material needs; 0 is taken"
                );
                self.report.approximated(format!("mesh '{object}'"), text);
            }
            let uncolored = group.without_colors(&self.pools);
            if uncolored > 0 {
                let text = format!("{uncolored} corners of its triangles have no colour, others do; they are white");
                self.report.approximated(format!("mesh '{object}'"), text);
            }
            let (positions, triangles, attributes) = group.mesh(&self.pools, is_textured);
            builder.mesh_with(object, positions, triangles, attributes, material);
        }
        self.census.report(&mut self.report);
        Ok((builder, self.report))
    }
}

/// A material that is not defined anywhere, or that of faces without material; under its name, so that an override file can
/// define it. It does not darken the colours of vertices.
fn stand_in(name: Option<&str>, has_colors: bool, report: &mut LoadReport) -> MaterialDesc {
    let desc = if has_colors { white_material() } else { default_material() };
    let kind = if has_colors { "diffuse, with the colours of its vertices as albedo" } else { "a diffuse grey of 0.5" };
    match name {
        Some(name) => {
            report.approximated(format!("material '{name}'"), format!("is not defined; it is made {kind}"));
            MaterialDesc { name: name.to_owned(), ..desc }
        }
        None => {
            let text = format!("has polygons without material; they are made {kind}, 'default'");
            report.approximated("the file", text);
            desc
        }
    }
}
