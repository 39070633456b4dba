//! PLY: a mesh without materials, perhaps with images.
//!
//! A parser of our own: that of `ply-rs-bw` took 250 bytes for each element, whatever that has, and no lists of 64-bit
//! integers, no elements over several lines, and no line ends of old Macs.

mod body;
mod colors;
mod faces;
mod header;
mod layout;
mod mesh;
mod numbers;

use self::body::Body;
use self::header::{Encoding, Header};
use self::layout::{Layout, Place};
use super::budget::Budget;
use super::group::Corner;
use super::polygon::scratch;
use super::read_within;
use super::text::content;
use crate::builder::SceneBuilder;
use crate::error::SceneError;
use crate::report::LoadReport;
use std::path::Path;

/// Bytes of a vertex with all attributes.
const VERTEX: u64 = 24 + 24 + 16 + 32;
/// Bytes of a face with all attributes, in lists that may be half empty.
const FACE: u64 = 2 * (4 + 4 + 4 + 32);
/// Bytes of an index, and the triangle that it may stand for: as it is read, and in the mesh.
const INDEX: u64 = 2 * (3 * 4 + 4 + 12);
/// Those of a corner with attributes of its own, and of the vertex that it becomes.
const CORNER: u64 = 2 * (16 + 48 + size_of::<Corner>() as u64 + VERTEX) + 48;

const AGAIN: &str = "it is truncated or damaged; copy or export it again";

/// Reads the vertices and faces of a PLY file, ASCII or binary of either byte order.
///
/// Polygons become triangles, also those that are not convex. Triangle strips are resolved. The mesh is named after the
/// file. Read are of vertices: normals (`nx ny nz`), colours (`red green blue`; integers are sRGB, floats linear), `alpha`,
/// and texture coordinates (`s t` or `u v`); of faces: colours, `alpha`, `texcoord` and `texnumber`; images are those that
/// `comment TextureFile` names. What else a file has is in the report.
///
/// # Errors
/// A file that cannot be read or is invalid, with the line number if the format has lines; a polygon that
/// refers to a vertex that does not exist or is not finite.
pub fn load_ply(path: &Path) -> Result<(SceneBuilder, LoadReport), SceneError> {
    load_within(path, &Budget::unlimited())
}

/// As [`load_ply`], within a limit on memory.
pub(super) fn load_within(path: &Path, budget: &Budget) -> Result<(SceneBuilder, LoadReport), SceneError> {
    let file = read_within(path, budget, 1)?;
    let bytes = content(path, &file, &["ply"])?;
    let fault = |(what, line): (String, u64)| SceneError::Content {
        path: path.to_owned(),
        line: (line > 0).then_some(line),
        what,
        hint: AGAIN.to_owned(),
    };
    let header = Header::parse(bytes).map_err(fault)?;
    check(path, &header, bytes.len() as u64, budget)?;
    let body = Body::read(bytes, &header).map_err(fault)?;
    drop(file);
    if let Some((number, vertex)) = body.unusable() {
        let what = format!("face {number} uses vertex {vertex}, which is {:?}", body.positions[vertex as usize]);
        return Err(SceneError::Content {
            path: path.to_owned(),
            line: None,
            what,
            hint: "each coordinate must be a finite number".to_owned(),
        });
    }
    mesh::add(path, &header, body, budget)
}

/// Checks that a file of `length` bytes can hold what its header declares, and that this fits into memory.
fn check(path: &Path, header: &Header, length: u64, budget: &Budget) -> Result<(), SceneError> {
    let mut rest = length.saturating_sub(header.length as u64);
    // The narrowest number of the lists that are read, and the bytes of a corner.
    let (mut narrowest, mut corner, mut known) = (None, INDEX, 0_u64);
    for element in &header.elements {
        let (count, least) = (element.count, element.least(header.encoding));
        // At least a byte each: what cannot be is reported at once instead of reading on.
        let Some(left) = count.checked_mul(least).filter(|_| count == 0 || least > 0) else { continue };
        rest = rest.saturating_sub(left);
    }
    for element in &header.elements {
        let (count, least) = (element.count, element.least(header.encoding));
        // The last number needs no space.
        if count > 0 && (least == 0 || count.saturating_mul(least) > length + 1) {
            let what = format!("the header declares {count} elements '{}', more than the file can hold", element.name);
            let (path, hint) = (path.to_owned(), AGAIN.to_owned());
            return Err(SceneError::Content { path, line: None, what, hint });
        }
        let layout = Layout::of(element);
        let each = match element.name.as_str() {
            "vertex" => VERTEX,
            "face" => FACE,
            _ => 0,
        };
        known = known.saturating_add(count.saturating_mul(each));
        for (place, property) in layout.places.iter().zip(&element.properties) {
            if matches!(place, Some(Place::Indices | Place::Corners)) {
                let bytes = if header.encoding == Encoding::Text { 2 } else { property.kind.bytes() as u64 };
                narrowest = narrowest.into_iter().chain([bytes]).min();
            }
            if element.name == "face" && matches!(place, Some(Place::Corners | Place::Color(0) | Place::Alpha)) {
                corner = INDEX + CORNER;
            }
        }
    }
    let corners = narrowest.map_or(0, |bytes| rest / bytes);
    if corners >= u32::MAX.into() {
        return Err(SceneError::TooMany { what: "corners of faces", count: corners as usize });
    }
    let bytes = known.saturating_add(corners * corner).saturating_add(scratch(corners));
    budget.take(bytes, || "reading its vertices and faces".to_owned()).map_err(|why| why.in_file(path))
}
