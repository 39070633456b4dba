//! Checks that refracting solids are closed and face outwards.

use std::collections::HashMap;

use crate::describe::MaterialDesc;
use crate::edges::{edges_of, open_edges, unmatched_edges};
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
        let open = open_between(unmatched.into_iter().map(|(from, to)| (at(from), at(to))).collect());
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
    let corners = triangles.iter().map(|triangle| triangle.map(|corner| corner.as_vec3()));
    let open = open_between(edges_of(corners).collect());
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

/// The number of open edges between vertices that several triangles may list separately: identified by equal coordinates, or
/// else, as at the pole of a sphere that was computed with sines, by coordinates that are equal but for rounding.
fn open_between(edges: Vec<(Vec3, Vec3)>) -> usize {
    // Zeros of both signs are the same.
    let bits = |at: Vec3| (at + 0.0).to_array().map(f32::to_bits);
    match open_edges(edges.iter().map(|&(from, to)| (bits(from), bits(to)))) {
        0 => 0,
        _ => {
            let mut places = Places::default();
            let edges: Vec<_> = edges.into_iter().map(|(from, to)| (places.of(from), places.of(to))).collect();
            open_edges(edges.into_iter().filter(|(from, to)| from != to))
        }
    }
}

/// Distinct places.
#[derive(Default)]
struct Places {
    /// Number and point of the first one in each cell.
    cells: HashMap<[i64; 3], (u32, Vec3)>,
}

impl Places {
    /// Largest distance of points at one place, normalised: a few roundings of coordinates in the unit sphere. Rays do not pass
    /// through such gaps.
    const DISTANCE: f32 = 5e-7;

    /// The number of the place of `point`.
    fn of(&mut self, point: Vec3) -> u32 {
        let cell = point.to_array().map(|c| (f64::from(c) / f64::from(Self::DISTANCE)).floor() as i64);
        let next = self.cells.len() as u32;
        let near = (0..27).find_map(|i| {
            let cell = [cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1];
            self.cells.get(&cell).filter(|(_, other)| other.distance(point) <= Self::DISTANCE)
        });
        match near {
            Some(&(number, _)) => number,
            None => self.cells.entry(cell).or_insert((next, point)).0,
        }
    }
}

/// Volume enclosed by closed triangles, negative if they face inwards (divergence theorem).
pub(crate) fn signed_volume(triangles: impl Iterator<Item = [DVec3; 3]>) -> f64 {
    triangles.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere of `around` meridians whose triangles list all vertices separately, computed with sines and in f32, so that those
    /// of a pole and those where it closes differ by rounding.
    fn sphere(around: u32) -> Vec<[Vec3; 3]> {
        let at = |row: u32, column: u32| {
            let (theta, phi) =
                (std::f32::consts::PI * row as f32 / 8.0, 2.0 * std::f32::consts::PI * column as f32 / around as f32);
            Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
        };
        let quads = (0..8).flat_map(|row| (0..around).map(move |column| (row, column)));
        quads
            .flat_map(|(row, column)| {
                let [a, b] = [at(row, column), at(row, column + 1)];
                let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
                [[a, b, c], [b, d, c]]
            })
            .filter(|[a, b, c]| (*b - *a).cross(*c - *a).length() > 1e-6)
            .collect()
    }

    #[test]
    fn vertices_that_differ_by_rounding_close_a_mesh() {
        let open = |triangles: &[[Vec3; 3]]| open_between(edges_of(triangles.iter().copied()).collect());
        let sphere = sphere(12);
        let by_bits = edges_of(sphere.iter().copied())
            .map(|(a, b)| (a.to_array().map(f32::to_bits), b.to_array().map(f32::to_bits)));
        assert!(open_edges(by_bits) > 0);
        assert_eq!(open(&sphere), 0);
        assert_eq!(open(&sphere[1..]), 3);
        // A gap of twenty roundings stays one.
        let mut torn = sphere;
        torn[40][0].x += 2e-6;
        assert!(open(&torn) > 0);
    }
}
