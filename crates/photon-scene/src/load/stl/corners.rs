//! Corners of the triangles of an STL file, and their vertices.

use glam::DVec3;

/// A solid of a file.
#[derive(Debug)]
pub(super) struct Solid {
    /// Empty if it has none.
    pub(super) name: String,
    /// Number of the corners before those of the solid.
    pub(super) start: usize,
}

/// All that is read.
#[derive(Debug, Default)]
pub(super) struct Corners {
    /// Three for each triangle.
    pub(super) list: Vec<[f64; 3]>,
    solids: Vec<Solid>,
    /// Triangles whose normal does not agree with the order of their vertices.
    pub(super) turned: usize,
    /// Triangles with attributes that are not zero.
    pub(super) attributes: usize,
    /// Bytes behind the last triangle.
    pub(super) rest: usize,
}

impl Corners {
    pub(super) fn with_capacity(triangles: usize) -> Self {
        Self { list: Vec::with_capacity(3 * triangles), ..Self::default() }
    }

    pub(super) fn begin(&mut self, name: String) {
        self.solids.push(Solid { name, start: self.list.len() });
    }

    pub(super) fn add(&mut self, normal: [f64; 3], corners: [[f64; 3]; 3]) {
        let [a, b, c] = corners.map(DVec3::from);
        // Zero, or not a number, where a file has none.
        let agrees = (b - a).cross(c - a).normalize_or_zero().dot(DVec3::from(normal).normalize_or_zero());
        self.turned += usize::from(agrees < -0.5);
        self.list.extend(corners);
    }

    /// The first triangle with a corner that is not finite, and the corner.
    pub(super) fn unusable(&self) -> Option<(usize, [f64; 3])> {
        let is_finite = |corner: &[f64; 3]| corner.iter().all(|part| part.is_finite());
        let at = self.list.iter().position(|corner| !is_finite(corner))?;
        Some((at / 3, self.list[at]))
    }

    /// The solids that have triangles, with their corners.
    pub(super) fn solids(&self) -> impl Iterator<Item = (&Solid, &[[f64; 3]])> {
        let ends = self.solids.iter().skip(1).map(|next| next.start).chain([self.list.len()]);
        let solids = self.solids.iter().zip(ends);
        solids.map(|(solid, end)| (solid, &self.list[solid.start..end])).filter(|(_, corners)| !corners.is_empty())
    }
}

/// The vertices of triangles, one for all corners at a place, in the order of the corners, and the triangles of them.
pub(super) fn merged(corners: &[[f64; 3]]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    // Zeros have one sign.
    let place = |corner: u32| corners[corner as usize].map(|part| (part + 0.0).to_bits());
    let mut order: Vec<u32> = (0..corners.len() as u32).collect();
    order.sort_unstable_by_key(|&corner| (place(corner), corner));
    // The first corner at the place of each.
    let mut vertices = vec![0; corners.len()];
    let mut count = 0;
    for equal in order.chunk_by(|&a, &b| place(a) == place(b)) {
        equal.iter().for_each(|&corner| vertices[corner as usize] = equal[0]);
        count += 1;
    }
    let mut positions = Vec::with_capacity(count);
    for corner in 0..corners.len() {
        let first = vertices[corner] as usize;
        vertices[corner] = if first == corner { positions.len() as u32 } else { vertices[first] };
        if first == corner {
            positions.push(corners[corner]);
        }
    }
    (positions, vertices.as_chunks().0.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_at_a_place_are_one_vertex() {
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let (positions, triangles) = merged(&[a, b, c, [-0.0, 0.0, -0.0], c, d]);
        assert_eq!((positions, triangles), (vec![a, b, c, d], vec![[0, 1, 2], [0, 2, 3]]));
        assert_eq!(merged(&[]), (vec![], vec![]));
        // Nearly equal places stay apart.
        let near = [f64::EPSILON, 0.0, 0.0];
        assert_eq!(merged(&[a, near, a]), (vec![a, near], vec![[0, 1, 0]]));
    }
}
