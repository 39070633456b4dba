//! Checks that refracting solids are closed and face outwards.

use crate::describe::MaterialDesc;
use crate::edges::{open_edges, unmatched_edges};
use crate::normalise::Geometry;
use glam::{DVec3, Vec3};

/// Warns of every solid dielectric whose mesh has holes or faces inwards.
///
/// All triangles of a material are checked together: a bubble inside glass is by itself a shell that faces
/// inwards, and a solid may consist of several meshes.
pub(crate) fn warn(geometry: &Geometry, materials: &[MaterialDesc], warnings: &mut Vec<String>) {
    for (index, material) in materials.iter().enumerate() {
        if !material.is_solid() {
            continue;
        }
        let own = geometry.triangles.iter().zip(&geometry.primitives);
        let own: Vec<[u32; 3]> =
            own.filter(|(_, primitive)| primitive.1 as usize == index).map(|(&corners, _)| corners).collect();
        let at = |vertex: u32| Vec3::from_array(geometry.positions[vertex as usize]);
        let triangles = || own.iter().map(|corners| corners.map(at));
        let name = &material.name;
        // Edges that match by index do so by place; the others may, if vertices are listed several times.
        let unmatched = unmatched_edges(geometry.positions.len(), &own);
        let open = open_edges(unmatched.into_iter().map(|(from, to)| (place(at(from)), place(at(to)))));
        if open > 0 {
            warnings.push(format!(
                "the solid glass '{name}' is not closed: {open} edges have a triangle on one side only; light that \
                 enters may never leave; close it, or make the material thin"
            ));
        } else if signed_volume(triangles().map(|corners| corners.map(|corner| corner.as_dvec3()))) < 0.0 {
            warnings.push(format!(
                "the solid glass '{name}' is inside out: its triangles run clockwise as seen from outside; flip \
                 them"
            ));
        }
    }
}

/// Warns of a boundary whose triangles have holes or face inwards.
pub(crate) fn warn_of_boundary(name: &str, triangles: &[[DVec3; 3]], warnings: &mut Vec<String>) {
    let edges = triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let open = open_edges(edges.map(|(from, to)| (place(from.as_vec3()), place(to.as_vec3()))));
    if open > 0 {
        warnings.push(format!(
            "the boundary '{name}' is not closed: {open} edges have a triangle on one side only; light that passes there is \
             not in its medium; close it"
        ));
    } else if signed_volume(triangles.iter().copied()) < 0.0 {
        warnings.push(format!(
            "the boundary '{name}' is inside out: its triangles run clockwise as seen from outside, so that nothing is inside; \
             flip them"
        ));
    }
}

/// The bits of the coordinates as key of a vertex, to identify vertices that several triangles list separately.
fn place(at: Vec3) -> [u32; 3] {
    // Zeros of both signs are the same.
    (at + 0.0).to_array().map(f32::to_bits)
}

/// Volume enclosed by closed triangles, negative if they face inwards (divergence theorem).
pub(crate) fn signed_volume(triangles: impl Iterator<Item = [DVec3; 3]>) -> f64 {
    triangles.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}
