//! Pairs of triangles that coincide, in nearly one plane, with areas that overlap; and of those that nearly do.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec2, DVec3, Vec3};
use photon_core::{offset, parallel};

use crate::bvh::{Binary, BinaryTree};
use crate::normalise::Geometry;

/// Distance of planes up to which triangles coincide: the next ray starts [`offset::STEP`] beyond the one, which may be
/// beyond the other.
pub(super) const REACH: f64 = 2.0 * offset::STEP as f64;

/// Mean width above which an overlap is more than a common edge.
const WIDTH: f64 = 4.0 * offset::STEP as f64;

/// Leaves of the search tree that a thread takes at a time.
const PART: usize = 1 << 12;

/// Two triangles that coincide, or nearly do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    pub(super) triangles: [u32; 2],
    /// Whether both face the same way.
    pub(super) is_parallel: bool,
    /// Area of the overlap.
    pub(super) area: f64,
    /// A point of the overlap.
    pub(super) middle: DVec3,
    /// Mean height of the second triangle over the first one, along the normal of the first.
    pub(super) height: f64,
    /// Whether the one is beyond the reach of the other, and only nearly coincides with it.
    pub(super) is_apart: bool,
    /// Whether they are the two faces of a solid that is thinner than what is resolved.
    pub(super) is_thin: bool,
}

/// The contacts among `candidates`, up to a distance of planes of `reach`, of pairs that are `wanted`, which gets their places
/// there and whether they face the same way; and whether so many boxes overlap that the search was given up.
pub(super) fn find(
    geometry: &Geometry,
    candidates: &[u32],
    reach: f64,
    wanted: impl Fn([usize; 2], bool) -> bool + Sync,
) -> (Vec<Contact>, bool) {
    let own: Vec<[u32; 3]> = candidates.iter().map(|&triangle| geometry.triangles[triangle as usize]).collect();
    let Ok(tree) = BinaryTree::build(&geometry.positions, &own, 4) else { return (Vec::new(), false) };
    let leaves: Vec<Binary> = tree.nodes.iter().filter(|node| node.count > 0).copied().collect();
    let (tested, limit) = (AtomicU64::new(0), (1 << 26) + 256 * own.len() as u64);
    let found = parallel::map(parallel::threads(), leaves.chunks(PART), |_, leaves| {
        let (mut found, mut stack) = (Vec::new(), Vec::new());
        for leaf in leaves {
            let mut tests = 0;
            stack.push(0);
            while let Some(node) = stack.pop() {
                let node: &Binary = &tree.nodes[node as usize];
                if !meet(leaf, node, reach as f32) {
                    continue;
                }
                if node.count == 0 {
                    stack.extend([node.first, node.first + 1]);
                    continue;
                }
                for &a in ids(&tree, leaf) {
                    for &b in ids(&tree, node).iter().filter(|&&b| a < b) {
                        tests += 1;
                        let both = [a as usize, b as usize];
                        let triangles = both.map(|id| candidates[id]);
                        found.extend(contact(geometry, triangles, reach, |is_parallel| wanted(both, is_parallel)));
                    }
                }
            }
            if tested.fetch_add(tests, Ordering::Relaxed) > limit {
                break;
            }
        }
        found
    });
    let mut found = found.concat();
    found.sort_unstable_by_key(|contact| contact.triangles);
    (found, tested.into_inner() > limit)
}

fn ids<'a>(tree: &'a BinaryTree, leaf: &Binary) -> &'a [u32] {
    &tree.order[leaf.first as usize..][..leaf.count as usize]
}

fn meet(a: &Binary, b: &Binary, reach: f32) -> bool {
    (0..3).all(|axis| a.low[axis] - b.high[axis] <= reach && b.low[axis] - a.high[axis] <= reach)
}

fn contact(geometry: &Geometry, [s, t]: [u32; 2], reach: f64, wanted: impl Fn(bool) -> bool) -> Option<Contact> {
    let normals = [s, t].map(|id| Vec3::from_array(geometry.primitives[id as usize].0));
    let cosine = normals[0].dot(normals[1]);
    // Before the overlap, which takes most of the time: neighbours in a smooth mesh end here.
    if cosine.abs() < 0.9 || !wanted(cosine > 0.0) {
        return None;
    }
    let overlap = Overlap::of(corners(geometry, s), corners(geometry, t))?;
    let (low, high) = overlap.heights;
    let is_apart = low < -REACH || high > REACH;
    // Of those that are apart, one is above the other everywhere.
    let is_ordered = low >= 0.0 && high <= reach || high <= 0.0 && low >= -reach;
    (!is_apart || is_ordered).then_some(Contact {
        triangles: [s, t],
        is_parallel: cosine > 0.0,
        area: overlap.area,
        middle: overlap.middle,
        height: 0.5 * (low + high),
        is_apart,
        is_thin: false,
    })
}

/// The corners of a triangle.
pub(super) fn corners(geometry: &Geometry, triangle: u32) -> [DVec3; 3] {
    geometry.triangles[triangle as usize].map(|vertex| Vec3::from_array(geometry.positions[vertex as usize]).as_dvec3())
}

/// Overlap of the projections of two triangles into the plane of the larger one.
#[derive(Debug)]
pub(super) struct Overlap {
    pub(super) area: f64,
    /// A point of the larger triangle's overlap.
    pub(super) middle: DVec3,
    /// Least and greatest height of the second triangle over the first one, along the normal of the first.
    pub(super) heights: (f64, f64),
}

impl Overlap {
    /// `None` if they overlap by no more than an edge.
    pub(super) fn of(first: [DVec3; 3], second: [DVec3; 3]) -> Option<Self> {
        let cross = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let (mut base, mut other) = (first, second);
        let is_swapped = cross(first).length_squared() < cross(second).length_squared();
        if is_swapped {
            (base, other) = (second, first);
        }
        let normal = cross(base).try_normalize()?;
        let x = (base[1] - base[0]).try_normalize()?;
        let y = normal.cross(x);
        let flat = |at: DVec3| DVec2::new((at - base[0]).dot(x), (at - base[0]).dot(y));
        let corners = base.map(flat);
        let mut polygon = [(DVec2::ZERO, 0.0); 6];
        let mut count = 3;
        for (place, at) in polygon.iter_mut().zip(other) {
            *place = (flat(at), (at - base[0]).dot(normal));
        }
        // Sutherland and Hodgman 1974: a side adds at most one corner.
        for side in 0..3 {
            let from = corners[side];
            let along = (corners[(side + 1) % 3] - from).normalize_or_zero();
            let inside = |point: DVec2| along.perp_dot(point - from);
            let before = polygon;
            let old = &before[..count];
            if old.iter().all(|&(point, _)| inside(point) <= WIDTH / 4.0) {
                return None;
            }
            count = 0;
            for (i, &(point, height)) in old.iter().enumerate() {
                let (last, last_height) = old[(i + old.len() - 1) % old.len()];
                let (now, then) = (inside(point), inside(last));
                // Rounding can make slivers cross a line more than twice.
                if (now < 0.0) != (then < 0.0) && count < polygon.len() {
                    let way = then / (then - now);
                    polygon[count] = (last.lerp(point, way), last_height + (height - last_height) * way);
                    count += 1;
                }
                if now >= 0.0 && count < polygon.len() {
                    polygon[count] = (point, height);
                    count += 1;
                }
            }
            if count < 3 {
                return None;
            }
        }
        let polygon = &polygon[..count];
        let sides = || polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(a, b)| (a.0, b.0));
        let area = 0.5 * sides().map(|(a, b)| (a - corners[0]).perp_dot(b - corners[0])).sum::<f64>().abs();
        let centre = polygon.iter().map(|corner| corner.0).sum::<DVec2>() / count as f64;
        let around: f64 = sides().map(|(a, b)| a.distance(b)).sum();
        let (low, high) = polygon
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &(_, at)| (low.min(at), high.max(at)));
        // The height of the larger over the smaller one has the other sign, and another if they face each other.
        let flips = is_swapped && cross(first).dot(normal) > 0.0;
        let heights = if flips { (-high, -low) } else { (low, high) };
        let middle = base[0] + x * centre.x + y * centre.y;
        (2.0 * area > WIDTH * around).then_some(Self { area, middle, heights })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlaps_have_areas_and_heights() {
        let unit = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let up = |by: f64, at: [DVec3; 3]| at.map(|corner| corner + DVec3::Z * by);
        let [a, b, c] = unit.map(|at| at * 0.5 + DVec3::new(0.25, 0.25, 0.0));
        for turned in [[a, b, c], [a, c, b]] {
            let over = Overlap::of(unit, up(0.25, turned)).expect("overlap");
            assert!((over.area - 0.125).abs() < 1e-12 && over.heights == (0.25, 0.25), "{over:?}");
            let under = Overlap::of(up(0.25, turned), unit).expect("overlap");
            let expected = if turned[1] == b { -0.25 } else { 0.25 };
            assert_eq!(under.heights, (expected, expected), "{under:?}");
        }
        let beside = [DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        assert!(Overlap::of(unit, beside).is_none(), "a common edge");
        assert!(Overlap::of(unit, up(0.0, [a, b, c]).map(|at| at + DVec3::X)).is_none());
    }
}
