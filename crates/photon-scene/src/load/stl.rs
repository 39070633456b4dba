//! STL: triangles alone, as text or in binary.
//!
//! A parser of our own: that of `stl_io` knows text by the word `solid` alone, with which many binary files begin too, reads
//! the first solid of several, and names no line.

mod binary;
mod corners;
mod text;

use self::corners::{Corners, Solid};
use super::budget::Budget;
use super::read_within;
use super::text::check_kind;
use super::{default_material, stem};
use crate::builder::SceneBuilder;
use crate::error::SceneError;
use crate::report::LoadReport;
use std::path::Path;

/// Bytes of a triangle: its corners as they are read, their order and number, and its vertices and indices in the mesh.
const TRIANGLE: u64 = 3 * (24 + 4 + 4 + 24 + 4);

const AGAIN: &str = "it is truncated or damaged; copy or export it again";

/// A fault, and its line or 0.
type Fault = (String, u64);

/// Reads the triangles of an STL file, text or binary; its content determines which.
///
/// Corners at equal places become one vertex. Each solid becomes a mesh, named as it is or else after the file. Normals of
/// triangles follow from the order of their vertices; what else a file has is in the report.
///
/// # Errors
/// A file that cannot be read or is invalid, with the line number of a text; a corner that is not finite.
pub fn load_stl(path: &Path) -> Result<(SceneBuilder, LoadReport), SceneError> {
    load_within(path, &Budget::unlimited())
}

/// [`load_stl`] within a limit on memory.
pub(super) fn load_within(path: &Path, budget: &Budget) -> Result<(SceneBuilder, LoadReport), SceneError> {
    let bytes = read_within(path, budget, 1)?;
    // The header of a binary file can begin as a file of another kind.
    let is_binary = binary::has_its_length(&bytes);
    if !is_binary {
        check_kind(path, &bytes, &["stl"])?;
    }
    let is_text = !is_binary && text::is_text(&bytes);
    let count = if is_text { text::most(&bytes) } else { binary::most(&bytes) };
    if count > u64::from(u32::MAX) / 3 {
        return Err(SceneError::TooMany { what: "triangles", count: count as usize });
    }
    budget.take(count * TRIANGLE, || "reading its triangles".to_owned()).map_err(|shortage| shortage.in_file(path))?;
    let read = if is_text { text::read(&bytes, count as usize) } else { binary::read(&bytes, count as usize) };
    let corners = read.map_err(|(what, line)| SceneError::Content {
        path: path.to_owned(),
        line: (line > 0).then_some(line),
        what,
        hint: AGAIN.to_owned(),
    })?;
    drop(bytes);
    if let Some((triangle, corner)) = corners.unusable() {
        let what = format!("triangle {triangle} has a corner at {corner:?}");
        let (path, hint) = (path.to_owned(), "each coordinate must be a finite number".to_owned());
        return Err(SceneError::Content { path, line: None, what, hint });
    }
    Ok(add(path, corners))
}

/// The scene of a file.
fn add(path: &Path, corners: Corners) -> (SceneBuilder, LoadReport) {
    let (mut builder, mut report) = (SceneBuilder::new(), LoadReport::default());
    let name = stem(path);
    let subject = format!("mesh '{name}'");
    if corners.attributes > 0 {
        report.left_out(&subject, format!("the attributes, perhaps colours, of {} triangles", corners.attributes));
    }
    if corners.rest > 0 {
        report.left_out(&subject, format!("{} bytes behind the last triangle", corners.rest));
    }
    let count = corners.list.len() / 3;
    if corners.turned > 0 {
        let text = format!(
            "the normals of {} of its {count} triangles do not agree with the order of their vertices, which is taken",
            corners.turned
        );
        report.note(&subject, text);
    }
    if count == 0 {
        report.note(&subject, "it has no triangles");
    }
    report.note(
        &subject,
        "it has no material, which this format does not define; it is made a diffuse grey of 0.5 named 'default'",
    );
    let material = builder.material(default_material());
    for (solid, corners) in corners.solids() {
        let Solid { name: given, .. } = solid;
        let (positions, triangles) = corners::merged(corners);
        builder.mesh(if given.is_empty() { name.as_str() } else { given }, positions, triangles, material);
    }
    (builder, report)
}
