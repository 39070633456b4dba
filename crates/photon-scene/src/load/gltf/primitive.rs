//! Converts the primitives of a mesh to triangles.

use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::Accessors;
use super::fault::{AGAIN, Fault};
use crate::extras::{self, CHANGED, PrimitiveExtras};
use crate::report::LoadReport;

/// The triangles of a primitive, in the space of its node.
#[derive(Debug, Default)]
pub(super) struct Triangles {
    pub(super) positions: Vec<[f64; 3]>,
    /// Vertex indices, all in range; counter-clockwise seen from the front.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Whether a triangle has the vertex, for each.
    pub(super) is_used: Vec<bool>,
    /// Where exact values of attributes are.
    pub(super) extras: PrimitiveExtras,
    /// Number of vertices at the end of the list that do not form a whole triangle.
    pub(super) stray: usize,
}

/// Whether a primitive consists of triangles, not of points or lines.
pub(super) fn is_surface(primitive: &Primitive, part: &str) -> Result<bool, Fault> {
    match primitive.mode {
        Checked::Valid(Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) => Ok(true),
        Checked::Valid(_) => Ok(false),
        Checked::Invalid => Err(Fault::new(part, "has an unknown mode", AGAIN)),
    }
}

/// Index of the accessor that holds an attribute.
pub(super) fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<usize> {
    primitive.attributes.get(&Checked::Valid(semantic)).map(|accessor| accessor.value())
}

/// Upper bound on the number of vertices and triangles together, without reading them.
pub(super) fn size(accessors: &Accessors<'_>, primitive: &Primitive, part: &str) -> Result<u64, Fault> {
    let count = |accessor: Option<usize>| match accessor {
        Some(accessor) => accessors.count(accessor, part),
        None => Ok(0),
    };
    let indices = count(primitive.indices.map(|indices| indices.value()))?;
    Ok(indices.saturating_add(count(attribute(primitive, Semantic::Positions))?))
}

/// Upper bound on the bytes that it takes up in the scene, in which there are only vertices that triangles have, without
/// reading it.
pub(super) fn bytes(accessors: &Accessors<'_>, primitive: &Primitive, part: &str) -> Result<u64, Fault> {
    let Some(positions) = attribute(primitive, Semantic::Positions) else { return Ok(0) };
    let vertices = accessors.count(positions, part)?;
    let corners = match &primitive.indices {
        Some(indices) => accessors.count(indices.value(), part)?,
        None => vertices,
    };
    let each = primitive.attributes.keys().map(|semantic| match semantic {
        Checked::Valid(Semantic::Positions | Semantic::Normals) => 24,
        Checked::Valid(Semantic::Tangents | Semantic::Colors(_)) => 32,
        Checked::Valid(Semantic::TexCoords(_)) => 16,
        _ => 0,
    });
    // A strip has nearly as many triangles as corners.
    let triangle = if matches!(primitive.mode, Checked::Valid(Mode::Triangles)) { 4 } else { 12 };
    Ok(vertices.min(corners).saturating_mul(each.sum()).saturating_add(corners.saturating_mul(triangle)))
}

/// Reads a primitive for which [`is_surface`] holds.
pub(super) fn read(
    accessors: &Accessors<'_>,
    primitive: &Primitive,
    part: &str,
    report: &mut LoadReport,
) -> Result<Triangles, Fault> {
    let Some(positions) = attribute(primitive, Semantic::Positions) else {
        report.left_out(part, "has no POSITION");
        return Ok(Triangles::default());
    };
    let positions = accessors.vectors(positions, part)?;
    let extras = extras::read::<PrimitiveExtras>(primitive.extras.as_deref().map(|raw| raw.get()));
    let extras = extras.unwrap_or_else(|why| {
        report.note(part, why);
        None
    });
    let extras = extras.unwrap_or_default();
    let rounded = |exact: [f64; 3]| exact.map(|c| c as f32);
    let positions = refined(accessors, extras.positions, positions, rounded, part, report);
    let Ok(vertices) = u32::try_from(positions.len()) else {
        return Err(Fault::new(part, "has more vertices than 32 bits can number", "split it"));
    };

    let order = match primitive.indices {
        Some(indices) => accessors.indices(indices.value(), part)?,
        None => (0..vertices).collect(),
    };
    if let Some(place) = order.iter().position(|&vertex| vertex >= vertices) {
        return Err(Fault::new(
            part,
            format!(
                "index {place} (of triangle {}) is vertex {}, but there are {vertices}",
                match primitive.mode {
                    Checked::Valid(Mode::Triangles) => place / 3,
                    _ => place.saturating_sub(2),
                },
                order[place]
            ),
            AGAIN,
        ));
    }

    let (triangles, stray) = assemble(&order, primitive.mode);
    // Vertices that no triangle has may be anything.
    let mut is_used = vec![false; positions.len()];
    triangles.as_flattened().iter().for_each(|&vertex| is_used[vertex as usize] = true);
    let is_invalid = |(position, is_used): (&[f64; 3], &bool)| *is_used && position.iter().any(|x| !x.is_finite());
    if let Some(vertex) = positions.iter().zip(&is_used).position(is_invalid) {
        return Err(Fault::new(
            part,
            format!("vertex {vertex} is at {:?}", positions[vertex]),
            "every coordinate must be a finite number; repair the mesh and export it again",
        ));
    }
    Ok(Triangles { positions, triangles, is_used, extras, stray })
}

/// Values in double precision, if the extras refer to them and they round to those of the file.
pub(super) fn refined<const N: usize>(
    accessors: &Accessors<'_>,
    view: Option<usize>,
    values: Vec<[f64; N]>,
    rounded: fn([f64; N]) -> [f32; N],
    part: &str,
    report: &mut LoadReport,
) -> Vec<[f64; N]> {
    let Some(view) = view else { return values };
    match accessors.doubles(view, part) {
        Ok(exact) if exact.iter().map(|exact| rounded(*exact).map(f64::from)).eq(values.iter().copied()) => exact,
        Ok(_) => {
            report.note(part, CHANGED);
            values
        }
        Err(why) => {
            report.note(part, why.to_string());
            values
        }
    }
}

/// Triangles of a list, a strip or a fan (glTF 2.0 specification, section 3.7.2.1), and how many
/// vertices are left over.
fn assemble(order: &[u32], mode: Checked<Mode>) -> (Vec<[u32; 3]>, usize) {
    let windows = || order.windows(3).enumerate();
    // Strips repeat vertices to connect separate parts; the degenerate triangles are not intended.
    let is_meant = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    match mode {
        Checked::Valid(Mode::TriangleStrip) => {
            let turned = |(at, v): (usize, &[u32])| match at % 2 {
                0 => [v[0], v[1], v[2]],
                _ => [v[0], v[2], v[1]],
            };
            (windows().map(turned).filter(is_meant).collect(), 0)
        }
        Checked::Valid(Mode::TriangleFan) => {
            let triangles = order.iter().skip(1).zip(order.iter().skip(2));
            (triangles.map(|(&a, &b)| [a, b, order[0]]).filter(is_meant).collect(), 0)
        }
        _ => {
            let (triples, rest) = order.as_chunks::<3>();
            (triples.to_vec(), rest.len())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_front() {
        let strip = assemble(&[0, 1, 2, 3, 4], Checked::Valid(Mode::TriangleStrip));
        assert_eq!(strip, (vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]], 0));
        let fan = assemble(&[0, 1, 2, 3], Checked::Valid(Mode::TriangleFan));
        assert_eq!(fan, (vec![[1, 2, 0], [2, 3, 0]], 0));
        let list = assemble(&[0, 1, 2, 3], Checked::Valid(Mode::Triangles));
        assert_eq!(list, (vec![[0, 1, 2]], 1));
        for mode in [Mode::Triangles, Mode::TriangleStrip, Mode::TriangleFan] {
            for few in [&[][..], &[0], &[0, 1]] {
                assert!(assemble(few, Checked::Valid(mode)).0.is_empty());
            }
        }
    }
}
