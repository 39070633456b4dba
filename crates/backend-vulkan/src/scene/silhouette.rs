//! The set of valid results for a ray whose hit or miss depends on rounding.
//!
//! Vulkan allows division an error of 2.5 units in the last place, so the triangle test effectively sees a
//! slightly displaced ray. A ray that passes well inside a triangle hits it, one that passes well outside does
//! not. A ray closer than [`NEAR`] to an edge may fall on either side of it: where triangles on both sides
//! share the edge it hits one of them, but at the silhouette of the mesh it may also miss. An edge belongs to
//! the silhouette if only one triangle has it, or if its triangles are on the same side of it as seen along the
//! ray.

use std::collections::{BTreeMap, BTreeSet};

use photon_core::glam::{DVec2, DVec3, Vec3};
use photon_core::{Hit, Ray};

/// Bound on the displacement of a ray by the test, as seen in the plane perpendicular to the ray's largest
/// axis, in units in the last place of the distance between the ray's origin and the triangle's farthest
/// corner. Of a corner's coordinates, the differences from the origin are off by half a unit each, the quotient
/// of the shear by 2.5, its product and the last difference by a half each: 4.5. Products of edge functions are
/// off by as much as moving a corner by half a unit, at each end of the edge.
const NEAR: f64 = 6.0 * f32::EPSILON as f64;

/// Tolerance of hit distances, relative to the true distance but to 0.1 at least: the distance is a weighted
/// mean of those of three corners, with weights that are off by a few units.
pub(super) const TOLERANCE: f64 = 1e-5;

/// A triangle that a ray hits or may hit.
#[derive(Clone, Debug)]
struct Met {
    triangle: u32,
    /// Lower and upper bound of the hit distance.
    from: f64,
    to: f64,
    /// Its edges that are within [`NEAR`] of the ray.
    near: Vec<[u32; 2]>,
    /// Whether the distance certainly lies within the ray's interval.
    in_reach: bool,
}

/// The valid results for one ray.
#[derive(Debug)]
pub(super) struct Verdict {
    met: Vec<Met>,
    /// Upper bound of the distance of the nearest hit; infinite if a miss is valid.
    at_most: f64,
}

impl Verdict {
    /// Whether both a hit and a miss are valid.
    pub(super) fn is_open(&self) -> bool {
        self.at_most == f64::INFINITY && !self.met.is_empty()
    }

    /// Whether `answer` is a valid result for the ray.
    pub(super) fn allows(&self, answer: Option<Hit>) -> bool {
        let Some(hit) = answer else { return self.at_most == f64::INFINITY };
        let t = f64::from(hit.t);
        let met = self.met.iter().any(|met| met.triangle == hit.primitive && met.from <= t && t <= met.to);
        met && t <= self.at_most
    }
}

/// A mesh and its edge adjacency.
#[derive(Debug)]
pub(super) struct Judge<'a> {
    positions: &'a [[f32; 3]],
    triangles: &'a [[u32; 3]],
    /// Triangles that share each edge.
    edges: BTreeMap<[u32; 2], Vec<u32>>,
}

impl<'a> Judge<'a> {
    pub(super) fn new((positions, triangles): &'a (Vec<[f32; 3]>, Vec<[u32; 3]>)) -> Self {
        let mut edges: BTreeMap<_, Vec<u32>> = BTreeMap::new();
        for (triangle, corners) in (0..).zip(triangles) {
            for edge in sides(*corners) {
                edges.entry(edge).or_default().push(triangle);
            }
        }
        Self { positions, triangles, edges }
    }

    /// Computes the valid results in double precision, where the ray is not displaced.
    pub(super) fn verdict(&self, ray: &Ray) -> Verdict {
        let seen = Seen::new(ray);
        let all = (0..).zip(self.triangles);
        let met: Vec<Met> = all.filter_map(|(triangle, &corners)| self.meet(&seen, triangle, corners)).collect();
        let mut at_most = f64::INFINITY;
        let mut done = BTreeSet::new();
        for first in 0..met.len() {
            if done.contains(&first) {
                continue;
            }
            // All triangles that the ray may hit instead of this one, reached across shared edges.
            let mut group = vec![first];
            let mut next = 0;
            while let Some(&one) = group.get(next) {
                next += 1;
                done.insert(one);
                for (other, candidate) in met.iter().enumerate() {
                    if !group.contains(&other) && candidate.near.iter().any(|edge| met[one].near.contains(edge)) {
                        group.push(other);
                    }
                }
            }
            let closed = group.iter().all(|&i| met[i].in_reach && !met[i].near.iter().any(|&e| self.ends(&seen, e)));
            if closed {
                at_most = at_most.min(group.iter().map(|&i| met[i].to).fold(0.0, f64::max));
            }
        }
        Verdict { met, at_most }
    }

    /// Returns `None` if the ray passes well outside of the triangle.
    fn meet(&self, seen: &Seen, triangle: u32, corners: [u32; 3]) -> Option<Met> {
        let at = corners.map(|corner| self.positions[corner as usize]);
        let [a, b, c] = at.map(|corner| seen.across(corner));
        let slack = NEAR * at.iter().map(|&corner| seen.distance(corner)).fold(0.0, f64::max);
        if [a, b, c].iter().all(|p| p.x > slack) || [a, b, c].iter().all(|p| p.x < -slack) {
            return None;
        }
        let ends = [[a, b], [b, c], [c, a]];
        let near: Vec<[u32; 2]> =
            sides(corners).into_iter().zip(ends).filter(|(_, e)| from_segment(*e) <= slack).map(|(s, _)| s).collect();
        let [w, u, v] = ends.map(|[from, to]| from.perp_dot(to));
        let inside = (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
        if !inside && near.is_empty() {
            return None;
        }
        let z = at.map(|corner| seen.along(corner));
        let (least, most) = z.iter().fold((f64::INFINITY, -f64::INFINITY), |(l, m), z| (l.min(*z), m.max(*z)));
        // Distance of the triangle's plane along the ray, and its gradient across the ray.
        let (p, q) = (b - a, c - a);
        let area = p.perp_dot(q);
        let slope = DVec2::new(
            ((z[1] - z[0]) * q.y - (z[2] - z[0]) * p.y) / area,
            ((z[2] - z[0]) * p.x - (z[1] - z[0]) * q.x) / area,
        );
        let (here, change) = (z[0] - slope.dot(a), 2.0 * slack * slope.length());
        let (mut from, mut to) = (least, most);
        if here.is_finite() && change.is_finite() {
            from = (here - change).clamp(least, most);
            to = (here + change).clamp(least, most);
        }
        from -= TOLERANCE * from.abs().max(0.1);
        to += TOLERANCE * to.abs().max(0.1);
        (to >= 0.0 && from <= seen.farthest).then_some(Met {
            triangle,
            from,
            to,
            near,
            in_reach: from >= 0.0 && to <= seen.farthest,
        })
    }

    /// Whether an edge belongs to the silhouette.
    fn ends(&self, seen: &Seen, edge: [u32; 2]) -> bool {
        let [from, to] = edge.map(|corner| seen.across(self.positions[corner as usize]));
        let side = |triangle: &u32| {
            let third = self.triangles[*triangle as usize].into_iter().find(|corner| !edge.contains(corner));
            let third = third.map_or(from, |corner| seen.across(self.positions[corner as usize]));
            (to - from).perp_dot(third - from)
        };
        let sides: Vec<f64> = self.edges[&edge].iter().map(side).collect();
        !(sides.iter().any(|&side| side > 0.0) && sides.iter().any(|&side| side < 0.0))
    }
}

/// The edges of a triangle in order, starting at the first corner; each with the lower vertex index first.
fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[x, y]| [x.min(y), x.max(y)])
}

/// Distance of the origin to a segment.
fn from_segment([from, to]: [DVec2; 2]) -> f64 {
    let along = to - from;
    let share = if along.length_squared() > 0.0 { -from.dot(along) / along.length_squared() } else { 0.0 };
    (from + along * share.clamp(0.0, 1.0)).length()
}

/// Points relative to a ray.
struct Seen {
    origin: DVec3,
    direction: DVec3,
    axes: [usize; 3],
    farthest: f64,
}

impl Seen {
    fn new(ray: &Ray) -> Self {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let last = direction.abs().max_position();
        let axes = [(last + 1) % 3, (last + 2) % 3, last];
        Self { origin, direction, axes, farthest: f64::from(ray.t_max) }
    }

    fn relative(&self, point: [f32; 3]) -> DVec3 {
        Vec3::from(point).as_dvec3() - self.origin
    }

    fn distance(&self, point: [f32; 3]) -> f64 {
        self.relative(point).length()
    }

    /// Position relative to the ray, projected onto the plane perpendicular to its largest axis.
    fn across(&self, point: [f32; 3]) -> DVec2 {
        let p = self.relative(point);
        let [x, y, z] = self.axes;
        let along = p[z] / self.direction[z];
        DVec2::new(p[x] - along * self.direction[x], p[y] - along * self.direction[y])
    }

    /// Distance along the ray.
    fn along(&self, point: [f32; 3]) -> f64 {
        self.relative(point)[self.axes[2]] / self.direction[self.axes[2]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::sphere;

    fn ray(origin: [f32; 3], target: [f32; 3]) -> Ray {
        let origin = Vec3::from(origin);
        Ray { origin, direction: (Vec3::from(target) - origin).normalize(), t_max: f32::INFINITY }
    }

    fn hit(t: f32, primitive: u32) -> Option<Hit> {
        Some(Hit { t, primitive, u: 0.2, v: 0.2 })
    }

    /// A square of two triangles at z = 1, and a triangle behind both.
    fn square() -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
        let corners = vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]];
        let behind = vec![[-9.0, -9.0, 2.0], [9.0, -9.0, 2.0], [0.0, 9.0, 2.0]];
        ([corners, behind].concat(), vec![[0, 1, 2], [0, 2, 3], [4, 5, 6]])
    }

    #[test]
    fn inside_and_outside_are_decided() {
        let mesh = (square().0, vec![[0, 1, 2]]);
        let judge = Judge::new(&mesh);
        for x in [0.5, 0.999, 0.999_99_f32] {
            let inside = judge.verdict(&ray([x, 0.3, 0.0], [x, 0.3, 1.0]));
            assert!(inside.allows(hit(1.0, 0)) && !inside.is_open());
            assert!(!inside.allows(None) && !inside.allows(hit(1.0001, 0)) && !inside.allows(hit(1.0, 1)));
            let outside = judge.verdict(&ray([2.0 - x, 0.3, 0.0], [2.0 - x, 0.3, 1.0]));
            assert!(outside.allows(None) && !outside.allows(hit(1.0, 0)) && !outside.is_open());
        }
    }

    #[test]
    fn an_edge_of_one_triangle_is_open() {
        let mesh = (square().0, vec![[0, 1, 2]]);
        let judge = Judge::new(&mesh);
        for target in [[0.0, 0.0, 1.0], [1.0, 1.0, 1.0], [1.0, 0.4, 1.0], [0.3, 0.0, 1.0], [1.0 + 1e-7, 0.4, 1.0]] {
            let verdict = judge.verdict(&ray([0.3, 0.6, 0.0], target));
            assert!(verdict.is_open() && verdict.allows(None), "{target:?}");
            let t = (Vec3::from(target) - Vec3::new(0.3, 0.6, 0.0)).length();
            assert!(verdict.allows(hit(t, 0)) && !verdict.allows(hit(1.001 * t, 0)), "{target:?}");
        }
    }

    /// On the square's diagonal either triangle may be hit, but nothing behind them.
    #[test]
    fn nothing_passes_between_two_triangles() {
        let mesh = square();
        let judge = Judge::new(&mesh);
        let verdict = judge.verdict(&ray([0.4, 0.4, 0.0], [0.4, 0.4, 1.0]));
        assert!(verdict.allows(hit(1.0, 0)) && verdict.allows(hit(1.0, 1)));
        assert!(!verdict.allows(None) && !verdict.allows(hit(2.0, 2)) && !verdict.is_open());
        // At the square's border the ray may hit what is behind the square, but must not miss everything.
        let border = judge.verdict(&ray([0.4, 0.0, 0.0], [0.4, 0.0, 1.0]));
        assert!(border.allows(hit(1.0, 0)) && border.allows(hit(2.0, 2)));
        assert!(!border.allows(None) && !border.allows(hit(1.0, 1)));
    }

    #[test]
    fn a_closed_mesh_is_left_at_its_silhouette_alone() {
        let mesh = sphere(16);
        let judge = Judge::new(&mesh);
        for (number, &vertex) in mesh.0.iter().enumerate() {
            let inside = judge.verdict(&ray([0.01, 0.02, 0.03], vertex));
            assert!(!inside.allows(None), "vertex {number} from inside");
            // Seen from far away along x, the ring at x = 0 is the silhouette.
            let origin = [-50.0, vertex[1], vertex[2]];
            let outside = judge.verdict(&ray(origin, vertex));
            assert_eq!(outside.allows(None), vertex[0].abs() < 1e-6, "vertex {number} from outside");
        }
    }

    /// If the ray's end is near a triangle, both a hit and a miss are valid.
    #[test]
    fn the_end_of_a_ray_is_open() {
        let mesh = square();
        let judge = Judge::new(&mesh);
        let to = |t_max| judge.verdict(&Ray { t_max, ..ray([0.7, 0.2, 0.0], [0.7, 0.2, 1.0]) });
        assert!(to(1.0).is_open() && to(1.0).allows(hit(1.0, 0)) && to(1.0).allows(None));
        assert!(!to(0.9).allows(hit(1.0, 0)) && to(0.9).allows(None));
        assert!(!to(1.1).allows(None) && to(1.1).allows(hit(1.0, 0)));
    }
}
