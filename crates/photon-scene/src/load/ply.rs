//! PLY: a mesh without materials.

mod element;

use self::element::{COLOR, Element, NORMAL, UV};
use super::budget::Budget;
use super::polygon::{Triangulator, crossing};
use super::{default_material, read_within, stem};
use crate::builder::SceneBuilder;
use crate::describe::{MaterialDesc, Surface};
use crate::error::SceneError;
use crate::mesh::VertexAttributes;
use crate::report::LoadReport;
use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use std::path::Path;

/// Bytes of an element without its indices: as it is read, and in the mesh.
const ELEMENT: u64 = (size_of::<Element>() + 128) as u64;
/// Bytes of an index: as it is read and converted, in lists that may be half empty, and a triangle.
const INDEX: u64 = 16 + 8 + 24;

/// Reads the vertices and polygons of a PLY file, ASCII or binary of either byte order.
///
/// Polygons are triangulated as fans; the report says where those do not cover the polygon. Triangle strips are
/// resolved. The mesh is named after the file. Normals (`nx ny nz`), colours (`red green blue`; integers are sRGB, floats
/// linear) and texture coordinates (`s t` or `u v`) of vertices are read.
///
/// # Errors
/// A file that cannot be read or is invalid, with the line number if the format has lines; a polygon that
/// refers to a vertex that does not exist.
pub fn load_ply(path: &Path) -> Result<(SceneBuilder, LoadReport), SceneError> {
    load_within(path, &Budget::unlimited())
}

/// As [`load_ply`], within a limit on memory.
pub(super) fn load_within(path: &Path, budget: &Budget) -> Result<(SceneBuilder, LoadReport), SceneError> {
    let bytes = read_within(path, budget, 1)?;
    let fault = |line: Option<usize>, what: String, hint: &str| SceneError::Content {
        path: path.to_owned(),
        line: line.map(|line| line as u64),
        what,
        hint: hint.to_owned(),
    };
    let damaged = |error: ParseError| {
        // Its message begins with the line number and spans several lines.
        let text = error.to_string();
        let text = error.line().and_then(|line| text.strip_prefix(&format!("Line {line}: "))).unwrap_or(&text);
        let what = text.split_whitespace().collect::<Vec<_>>().join(" ");
        fault(error.line(), what, "it is truncated or damaged; copy or export it again")
    };
    let parser = Parser::<Element>::new();
    let mut reader = Reader::new(bytes.as_slice());
    let header = parser.read_header(&mut reader).map_err(damaged)?;
    let indices = element::most_indices(&header, bytes.len() as u64);
    budget.take(indices.saturating_mul(INDEX), || "the faces".to_owned()).map_err(|why| why.in_file(path))?;
    for element in header.elements.values() {
        // Each element takes at least a byte, so that more cannot exist: report that at once instead of reading on.
        if element.count > bytes.len() || (element.properties.is_empty() && element.count > 0) {
            let what = format!(
                "the header declares {} elements '{}', more than the file can hold",
                element.count, element.name
            );
            return Err(fault(None, what, "it is truncated or damaged; copy or export it again"));
        }
        let object = || format!("{} elements '{}'", element.count, element.name);
        budget.take(element.count as u64 * ELEMENT, object).map_err(|shortage| shortage.in_file(path))?;
    }
    let payload = parser.read_payload(&mut reader, &header).map_err(damaged)?;

    let elements = |name: &str| payload.get(name).map_or(&[][..], Vec::as_slice);
    let vertices = elements("vertex");
    if let Some(vertex) = vertices.iter().position(|vertex| vertex.axes != 0b111) {
        return Err(fault(None, format!("vertex {vertex} has no x, y and z"), "export it with positions as numbers"));
    }
    let positions: Vec<[f64; 3]> = vertices.iter().map(|vertex| vertex.position).collect();

    let mut triangles = Vec::new();
    let mut uncovered = Vec::new();
    let mut triangulator = Triangulator::default();
    let count = positions.len();
    let corner = |what: &str, number: usize, index: i64| {
        u32::try_from(index).ok().filter(|&index| (index as usize) < count).ok_or_else(|| {
            let what = format!("{what} {number} refers to vertex {index}, but there are {count}, numbered from 0");
            fault(None, what, "export it again")
        })
    };
    for (number, face) in elements("face").iter().enumerate() {
        let corners: Vec<u32> =
            face.indices.iter().map(|&index| corner("face", number, index)).collect::<Result<_, _>>()?;
        if corners.len() < 3 {
            let what = format!("face {number} has {} corners", corners.len());
            return Err(fault(None, what, "it needs at least three, in a list called vertex_indices"));
        }
        if corners.len() > 3 {
            let places: Vec<DVec3> =
                corners.iter().map(|&index| DVec3::from_array(positions[index as usize])).collect();
            let (parts, is_exact) = triangulator.triangles(&places);
            if !is_exact {
                uncovered.push(number);
            }
            triangles.extend(parts.iter().map(|part| part.map(|corner| corners[corner as usize])));
        } else {
            triangles.push([corners[0], corners[1], corners[2]]);
        }
    }
    for (number, strips) in elements("tristrips").iter().enumerate() {
        // A negative index ends a strip, and every other triangle of a strip is reversed.
        for strip in strips.indices.split(|&index| index < 0) {
            let corners: Vec<u32> =
                strip.iter().map(|&index| corner("strip", number, index)).collect::<Result<_, _>>()?;
            let turn = |(odd, three): (usize, &[u32])| match odd % 2 {
                0 => [three[0], three[1], three[2]],
                _ => [three[1], three[0], three[2]],
            };
            triangles.extend(corners.windows(3).enumerate().map(turn));
        }
    }

    let mut report = LoadReport::default();
    let mut builder = SceneBuilder::new();
    let name = stem(path);
    let subject = format!("mesh '{name}'");
    let properties = header.elements.get("vertex").map(|element| &element.properties);
    let has = |groups| element::has(|name| properties.is_some_and(|known| known.contains_key(name)), groups);
    let mut attributes = VertexAttributes::default();
    if has(NORMAL) {
        attributes.normals = vertices.iter().map(|vertex| vertex.normal).collect();
    }
    if has(UV) {
        // Their v runs upwards.
        attributes.uvs = vec![vertices.iter().map(|vertex| [vertex.uv[0], 1.0 - vertex.uv[1]]).collect()];
    }
    let material = if has(COLOR) {
        attributes.colors = vertices.iter().map(|Element { color: [r, g, b], .. }| [*r, *g, *b, 1.0]).collect();
        let text = "it has no material, which this format does not define; it is made diffuse, with the colours of its \
                    vertices as albedo, named 'default'";
        report.note(&subject, text);
        MaterialDesc { surface: Surface::Lambert { albedo: [1.0; 3] }, ..default_material() }
    } else {
        report.note(
            &subject,
            "it has no material, which this format does not define; it is made a diffuse grey of 0.5 named 'default'",
        );
        default_material()
    };
    let material = builder.material(material);
    if let Some(first) = uncovered.first() {
        report.approximated(&subject, crossing(uncovered.len(), &format!("is face {first}")));
    }
    if triangles.is_empty() {
        report.note(&subject, "it has no faces; points alone are not rendered");
    }
    builder.mesh_with(name, positions, triangles, attributes, material);
    Ok((builder, report))
}
