//! Boundaries of media that light passes unchanged: which media a point lies in, and which of them applies.
//!
//! Whether a point is inside of a boundary depends on the point alone: on how often the triangles enclose it, which the crossings
//! of any ray from there tell. Paths carry nothing of it, so that a boundary in the plane of a surface is neither lost nor
//! met twice.

use glam::{DVec2, Vec2, Vec3};

use crate::scene::caster::Ray;
use crate::scene::medium::Medium;

/// The triangles of all boundaries: closed meshes whose fronts face outwards. Rays to surfaces never meet them.
// Exhaustive: a part of `SceneView`, which is written as a literal.
#[derive(Clone, Copy, Debug)]
pub struct Boundaries<'a> {
    /// Vertices, in units of [`Self::scale`].
    pub positions: &'a [[f32; 3]],
    /// Three vertex indices each.
    pub triangles: &'a [[u32; 3]],
    /// For each triangle, the index of the medium behind it in [`crate::SceneView::media`]; it is [`Medium::MATCHED`].
    pub media: &'a [u32],
    /// Normalised length of a unit of `positions`, which lie within 16 units of the origin: a power of two, so that nothing is
    /// rounded.
    pub scale: f32,
}

/// No boundaries.
impl Default for Boundaries<'_> {
    fn default() -> Self {
        Self { positions: &[], triangles: &[], media: &[], scale: 1.0 }
    }
}

impl Boundaries<'_> {
    /// Whether there are none.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// A ray in the units of [`Self::positions`].
    #[inline]
    #[must_use]
    pub fn scaled(scale: f32, ray: &Ray) -> Ray {
        Ray { origin: ray.origin / scale, direction: ray.direction, t_max: ray.t_max / scale }
    }
}

/// Media whose boundaries enclose a point, and how often: of up to [`Enclosing::MOST`] media.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Enclosing {
    media: [u32; Self::MOST],
    counts: [i32; Self::MOST],
}

impl Enclosing {
    /// Maximum number of media around a point whose boundaries overlap; more are ignored.
    pub const MOST: usize = 4;

    /// Adds the crossing of a boundary: 1 where its medium is entered, -1 where it is left.
    #[inline]
    pub fn add(&mut self, medium: u32, sign: i32) {
        let known = (0..Self::MOST).find(|&slot| self.counts[slot] != 0 && self.media[slot] == medium);
        if let Some(slot) = known.or_else(|| (0..Self::MOST).find(|&slot| self.counts[slot] == 0)) {
            self.media[slot] = medium;
            self.counts[slot] += sign;
        }
    }

    /// Index of the medium that applies, where `solid` is that of the solids around the point, 0 outside of all. The highest
    /// priority counts; of equals a solid, then the boundary whose medium comes last in the table.
    #[inline]
    #[must_use]
    pub fn current(&self, media: &[Medium], solid: u32) -> u32 {
        let mut found = solid;
        for slot in 0..Self::MOST {
            if self.counts[slot] <= 0 {
                continue;
            }
            let (medium, of) = (self.media[slot], media[found as usize].priority);
            let priority = media[self.media[slot] as usize].priority;
            let is_equal = priority == of && if found == solid { solid == 0 } else { medium > found };
            if priority > of || is_equal {
                found = medium;
            }
        }
        found
    }
}

/// Crossing of a triangle by a ray that hits it: 1 from the front, -1 from the back, 0 if that counts for a neighbour.
///
/// A ray through an edge or a vertex hits every triangle that has it. Here the ray is moved aside by an infinitesimal distance,
/// so that the crossings of a closed mesh add up. The coordinates are those of the intersection test, rounded alike.
#[must_use]
pub fn boundary_crossing(ray: &Ray, corners: [Vec3; 3]) -> i32 {
    let size = ray.direction.abs();
    let along = if size.x > size.y {
        if size.x > size.z { 0 } else { 2 }
    } else if size.y > size.z {
        1
    } else {
        2
    };
    let (kx, ky) = ((along + 1) % 3, (along + 2) % 3);
    let d = ray.direction;
    let (sx, sy) = (d[kx] / d[along], d[ky] / d[along]);
    let [a, b, c] = corners.map(|corner| {
        let height = corner[along] - ray.origin[along];
        Vec2::new((corner[kx] - ray.origin[kx]) - sx * height, (corner[ky] - ray.origin[ky]) - sy * height)
    });
    let sides = [side(b, c), side(c, a), side(a, b)];
    if sides[0] != sides[1] || sides[1] != sides[2] {
        return 0;
    }
    if d[along] < 0.0 { -sides[0] } else { sides[0] }
}

/// On which side of an edge the ray passes: 1 or -1; the opposite for the reversed edge. 0 for an edge without length.
fn side(from: Vec2, to: Vec2) -> i32 {
    let sign = |x: f64| i32::from(x > 0.0) - i32::from(x < 0.0);
    let value = to.x * from.y - to.y * from.x;
    if value != 0.0 {
        return sign(f64::from(value));
    }
    // Products of two f32 are exact.
    let (wide_from, wide_to): (DVec2, DVec2) = (from.as_dvec2(), to.as_dvec2());
    let value = sign(wide_to.x * wide_from.y - wide_to.y * wide_from.x);
    if value != 0 {
        return value;
    }
    // On the edge: the ray is moved along x, and less along y.
    if to.y == from.y { sign(f64::from(from.x) - f64::from(to.x)) } else { sign(f64::from(to.y) - f64::from(from.y)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn media() -> Vec<Medium> {
        let matched = |priority| Medium { priority, dispersion: Medium::MATCHED, ..Medium::VACUUM };
        let glass = |priority| Medium { priority, ior: 1.5, ..Medium::VACUUM };
        vec![Medium::VACUUM, matched(0), matched(0), matched(2), glass(0), glass(1)]
    }

    #[test]
    fn priorities_decide_then_solids_then_the_table() {
        let media = media();
        let around = |all: &[u32]| {
            let mut found = Enclosing::default();
            all.iter().for_each(|&medium| found.add(medium, 1));
            found
        };
        for (all, solid, expected) in [
            (&[][..], 0, 0),
            (&[], 4, 4),
            // Space outside of all solids is not one.
            (&[1], 0, 1),
            (&[1], 4, 4),
            (&[2, 1], 0, 2),
            (&[1, 2], 0, 2),
            (&[3, 1], 5, 3),
            (&[2, 3, 1], 0, 3),
            (&[2], 5, 5),
        ] {
            assert_eq!(around(all).current(&media, solid), expected, "{all:?} in {solid}");
        }
    }

    #[test]
    fn media_are_left_as_often_as_they_are_entered() {
        let media = media();
        let mut found = Enclosing::default();
        let now = |found: &Enclosing| found.current(&media, 0);
        for (medium, sign, expected) in
            [(1, 1, 1), (1, 1, 1), (2, 1, 2), (1, -1, 2), (2, -1, 1), (1, -1, 0), (1, -1, 0), (1, 1, 0), (3, 1, 3)]
        {
            found.add(medium, sign);
            assert_eq!(now(&found), expected, "{medium} {sign}");
        }
        // More than there is space for are ignored.
        let mut full = Enclosing::default();
        (0..5).for_each(|_| full.add(1, 1));
        [2, 3, 4, 5].iter().for_each(|&medium| full.add(medium, 1));
        assert_eq!(full.current(&media, 0), 3);
    }

    /// The crossings of a box by rays through its edges, vertices and diagonals add up to the number of times that it encloses
    /// their origin.
    #[test]
    fn crossings_add_up() {
        let at = |i: usize| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let faces = [
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
            [0, 1, 4],
            [1, 5, 4],
            [2, 6, 3],
            [3, 6, 7],
            [0, 4, 2],
            [2, 4, 6],
            [1, 3, 5],
            [3, 7, 5],
        ];
        let targets: Vec<Vec3> =
            (0..27).map(|i| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) * 0.5).collect();
        let (mut inside, mut on_edges) = (0, 0);
        for origin in
            [[0.5, 0.5, 0.5], [0.25, 0.5, 0.75], [0.5, 0.25, 0.5], [-1.0, 0.5, 0.5], [2.0, 2.0, 2.0], [0.5, -1.0, 0.0]]
        {
            let origin = Vec3::from(origin);
            let expected = i32::from((0..3).all(|axis| origin[axis] > 0.0 && origin[axis] < 1.0));
            for &target in &targets {
                let Some(direction) = (target - origin).try_normalize() else { continue };
                let ray = Ray { origin, direction, t_max: f32::INFINITY };
                let (mut sum, mut hit) = (0, 0);
                for corners in faces.map(|face| face.map(at)) {
                    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                    let t = normal.dot(corners[0] - origin) / normal.dot(direction);
                    let sign = boundary_crossing(&ray, corners);
                    assert!(sign == 0 || sign as f32 * normal.dot(direction) <= 0.0, "{sign} {normal} {direction}");
                    if sign != 0 && t >= 0.0 {
                        sum -= sign;
                        hit += 1;
                    }
                }
                assert_eq!(sum, expected, "from {origin} to {target}");
                (inside, on_edges) = (inside + expected, on_edges + hit);
            }
        }
        assert!(inside > 50 && on_edges > 60, "{inside} {on_edges}");
    }
}
