//! Triangles of the faces of a PLY file.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec3;

use super::body::Body;
use crate::load::group::{Corner, Group, NONE, Pools};
use crate::load::polygon::Triangulator;

/// Polygons that cross themselves: how many, and the first.
pub(super) type Crossed = (usize, usize);

impl Body {
    /// The first face with a vertex that is not finite, and the vertex.
    pub(super) fn unusable(&self) -> Option<(usize, u32)> {
        let is_finite = |vertex: u32| self.positions[vertex as usize].iter().all(|part| part.is_finite());
        let place = self.corners.iter().position(|&vertex| !is_finite(vertex))?;
        Some((self.ends.partition_point(|&end| end as usize <= place), self.corners[place]))
    }

    /// Passes on the number of each face, its range of corners, and its triangles as numbers of its corners.
    fn triangulate(&self, mut add: impl FnMut(usize, Range<usize>, &[[u32; 3]])) -> Crossed {
        let (mut triangulator, mut places, mut crossed) = (Triangulator::default(), Vec::new(), (0, 0));
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        for (number, (start, &end)) in starts.zip(&self.ends).enumerate() {
            let face = start as usize..end as usize;
            places.clear();
            places
                .extend(self.corners[face.clone()].iter().map(|&vertex| DVec3::from(self.positions[vertex as usize])));
            let (triangles, is_exact) = triangulator.triangles(&places);
            if !is_exact {
                crossed = if crossed.0 == 0 { (1, number) } else { (crossed.0 + 1, crossed.1) };
            }
            add(number, face, triangles);
        }
        crossed
    }

    /// The triangles, as numbers of vertices.
    pub(super) fn triangles(&self) -> (Vec<[u32; 3]>, Crossed) {
        if self.corners.len() == 3 * self.ends.len() {
            // None has fewer corners.
            return (self.corners.as_chunks().0.to_vec(), (0, 0));
        }
        let mut list = Vec::with_capacity(self.ends.len());
        let crossed = self.triangulate(|_, face, triangles| {
            let vertex = |corner: u32| self.corners[face.start + corner as usize];
            list.extend(triangles.iter().map(|triangle| triangle.map(vertex)));
        });
        (list, crossed)
    }

    /// The triangles with attributes of faces and their corners, by image if there are several; [`NONE`] without one.
    pub(super) fn groups(
        self,
        colors: Vec<[f64; 4]>,
        are_of_faces: bool,
        has_images: bool,
    ) -> (Pools, BTreeMap<u32, Group>, Crossed) {
        let mut groups = BTreeMap::<u32, Group>::new();
        let mut corners = Vec::new();
        let at = |list: &[u32], number: usize| list.get(number).copied().unwrap_or(NONE);
        let crossed = self.triangulate(|number, face, triangles| {
            let uv_start = at(&self.uv_starts, number);
            corners.clear();
            corners.extend(self.corners[face].iter().zip(0..).map(|(&position, place)| {
                let uv = match uv_start {
                    _ if !self.uvs.is_empty() => position,
                    NONE => NONE,
                    start => start + place,
                };
                let normal = if self.normals.is_empty() { NONE } else { position };
                let color = if are_of_faces { number as u32 } else { NONE };
                Corner { position, uv, normal, color }
            }));
            let image = if has_images { at(&self.textures, number) } else { 0 };
            groups.entry(image).or_default().add(&corners, triangles);
        });
        let normals = self.normals.into_iter().map(|normal| DVec3::from(normal).normalize_or_zero()).collect();
        let uvs = if self.uvs.is_empty() { self.corner_uvs } else { self.uvs };
        (Pools { positions: self.positions, colors, normals, uvs }, groups, crossed)
    }
}
