//! Whether refracting solids are closed and face outwards.

use crate::describe::{MaterialDesc, Surface};
use crate::normalise::Geometry;
use glam::{DVec3, Vec3};

/// Warns of every solid dielectric whose triangles leave a hole or face inwards.
///
/// All triangles of a material are taken together: a bubble inside glass is a shell that faces
/// inwards by itself, and a solid may come in several meshes.
pub(crate) fn warn(geometry: &Geometry, materials: &[MaterialDesc], warnings: &mut Vec<String>) {
    for (index, material) in materials.iter().enumerate() {
        if !matches!(material.surface, Surface::Dielectric { .. }) {
            continue;
        }
        let triangles: Vec<[Vec3; 3]> = geometry
            .triangles
            .iter()
            .zip(&geometry.facets)
            .filter(|(_, facet)| facet.1 as usize == index)
            .map(|(corners, _)| corners.map(|vertex| Vec3::from_array(geometry.positions[vertex as usize])))
            .collect();
        let name = &material.name;
        let open = open_edges(&triangles);
        if open > 0 {
            warnings.push(format!(
                "the solid glass '{name}' is not closed: {open} edges border on one side only; light that enters \
                 may never leave; close it, or make the material thin"
            ));
        } else if signed_volume(&triangles) < 0.0 {
            warnings.push(format!(
                "the solid glass '{name}' is inside out: its triangles run clockwise as seen from outside; turn \
                 them around"
            ));
        }
    }
}

/// How many directed edges lack one that runs the other way; vertices are the same where their
/// coordinates are.
fn open_edges(triangles: &[[Vec3; 3]]) -> usize {
    let key = |at: Vec3| (at + 0.0).to_array().map(f32::to_bits);
    // Each edge in a fixed direction, and which way the triangle runs along it.
    let mut edges: Vec<([u32; 3], [u32; 3], i32)> = triangles
        .iter()
        .flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(from, to)| (key(*from), key(*to)))
        .map(|(from, to)| if from < to { (from, to, 1) } else { (to, from, -1) })
        .collect();
    edges.sort_unstable();
    edges
        .chunk_by(|left, right| (left.0, left.1) == (right.0, right.1))
        .map(|same| same.iter().map(|edge| edge.2).sum::<i32>().unsigned_abs() as usize)
        .sum()
}

/// Volume that closed triangles enclose, negative where they face inwards (the divergence theorem).
fn signed_volume(triangles: &[[Vec3; 3]]) -> f64 {
    triangles
        .iter()
        .map(|corners| corners.map(Vec3::as_dvec3))
        .map(|[a, b, c]: [DVec3; 3]| a.dot(b.cross(c)) / 6.0)
        .sum()
}
