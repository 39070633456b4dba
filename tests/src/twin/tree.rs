//! The nearest triangle along a ray, in f64: a BVH split at the middle triangle.

use photon_core::glam::DVec3;

/// Maximum number of triangles in a leaf.
const LEAF: usize = 4;

#[derive(Clone, Debug)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// In a leaf, the index of its first triangle in `order`; otherwise the second child, while the first follows
    /// directly.
    first: usize,
    count: usize,
}

/// A BVH over triangles.
#[derive(Clone, Debug)]
pub struct Tree {
    triangles: Vec<[DVec3; 3]>,
    order: Vec<u32>,
    nodes: Vec<Node>,
}

/// The intersection of a ray with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WideHit {
    /// Distance along the ray.
    pub t: f64,
    /// Index of the triangle.
    pub primitive: u32,
    /// Weight of the second vertex.
    pub u: f64,
    /// Weight of the third vertex.
    pub v: f64,
}

impl Tree {
    /// Builds the tree.
    #[must_use]
    pub fn new(triangles: Vec<[DVec3; 3]>) -> Self {
        let order = (0..triangles.len() as u32).collect();
        let mut tree = Self { triangles, order, nodes: Vec::new() };
        tree.split(0, tree.triangles.len());
        tree
    }

    fn split(&mut self, first: usize, end: usize) {
        let corners = || self.order[first..end].iter().flat_map(|&id| self.triangles[id as usize]);
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let own = self.nodes.len();
        self.nodes.push(Node { low, high, first, count: end - first });
        if end - first <= LEAF {
            return;
        }
        let extent = (high - low).to_array();
        let axis = (0..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
        let triangles = &self.triangles;
        let middle = |id: &u32| triangles[*id as usize].iter().map(|corner| corner[axis]).sum::<f64>();
        self.order[first..end].sort_unstable_by(|a, b| middle(a).total_cmp(&middle(b)));
        let half = first + (end - first) / 2;
        self.split(first, half);
        let second = self.nodes.len();
        self.split(half, end);
        self.nodes[own].first = second;
        self.nodes[own].count = 0;
    }

    /// The nearest intersection with `0 < t ≤ far`, except with triangle `except`, which the ray leaves.
    #[must_use]
    pub fn nearest(&self, origin: DVec3, direction: DVec3, far: f64, except: u32) -> Option<WideHit> {
        if self.triangles.is_empty() {
            return None;
        }
        let inverse = direction.recip();
        let mut best: Option<WideHit> = None;
        let mut reach = far;
        let mut waiting = vec![0];
        while let Some(index) = waiting.pop() {
            let node: &Node = &self.nodes[index];
            let (a, b) = ((node.low - origin) * inverse, (node.high - origin) * inverse);
            // A ray in a face's plane gives NaN, which `min` and `max` of f64 ignore.
            let fold = |of: fn(f64, f64) -> f64, inner: fn(f64, f64) -> f64, start: f64| {
                (0..3).fold(start, |sum, axis| of(sum, inner(a[axis], b[axis])))
            };
            let (enter, leave) = (fold(f64::max, f64::min, 0.0), fold(f64::min, f64::max, reach));
            if enter > leave * (1.0 + 1e-12) + 1e-300 {
                continue;
            }
            if node.count == 0 {
                waiting.extend([node.first, index + 1]);
                continue;
            }
            for &id in &self.order[node.first..node.first + node.count] {
                if id != except
                    && let Some((t, u, v)) = meet(&self.triangles[id as usize], origin, direction)
                    && t > 1e-15
                    && t <= reach
                {
                    reach = t;
                    best = Some(WideHit { t, primitive: id, u, v });
                }
            }
        }
        best
    }
}

/// Ray–triangle intersection (Möller and Trumbore 1997).
fn meet([a, b, c]: &[DVec3; 3], origin: DVec3, direction: DVec3) -> Option<(f64, f64, f64)> {
    let (e, f) = (*b - *a, *c - *a);
    let p = direction.cross(f);
    let determinant = e.dot(p);
    let s = origin - *a;
    let u = s.dot(p) / determinant;
    let q = s.cross(e);
    let v = direction.dot(q) / determinant;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    (inside && determinant != 0.0).then(|| (f.dot(q) / determinant, u, v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harness::Uniform;

    #[test]
    fn as_every_triangle_tried() {
        let mut uniform = Uniform::new(5);
        let mut point = || DVec3::new(uniform.draw(), uniform.draw(), uniform.draw());
        let triangles: Vec<[DVec3; 3]> = (0..300)
            .map(|_| {
                let at = point();
                [at, at + point() * 0.2, at + point() * 0.2]
            })
            .collect();
        let tree = Tree::new(triangles.clone());
        let mut hits = 0;
        for _ in 0..500 {
            let (from, along) = (point(), (point() - 0.5).normalize_or_zero());
            let brute = triangles.iter().filter_map(|triangle| meet(triangle, from, along)).map(|found| found.0);
            let brute = brute.filter(|&t| t > 1e-15).fold(f64::INFINITY, f64::min);
            let found = tree.nearest(from, along, f64::INFINITY, u32::MAX);
            assert_eq!(found.map_or(f64::INFINITY, |hit| hit.t), brute);
            if let Some(hit) = found {
                hits += 1;
                let other = tree.nearest(from, along, f64::INFINITY, hit.primitive);
                assert!(other.is_none_or(|other| other.primitive != hit.primitive && other.t >= hit.t));
            }
        }
        assert!(hits > 50, "{hits}");
    }
}
