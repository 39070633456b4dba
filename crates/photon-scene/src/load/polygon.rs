//! Triangulation of polygons with more than three corners.

use earcut::Earcut;
use glam::{DVec2, DVec3};

/// Corners of the largest polygon whose ears are clipped: the time of one that crosses itself grows with their square.
const MOST_CORNERS: usize = 1 << 16;

/// Bytes that the triangulation of a polygon takes at most, with its places and triangles.
pub(super) fn scratch(corners: u64) -> u64 {
    // Lists may be half empty.
    corners * 2 * (24 + 12) + corners.min(MOST_CORNERS as u64) * 2 * (16 + 12 + 64)
}

/// Triangulates polygons, one after another.
pub(super) struct Triangulator {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    indices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl Default for Triangulator {
    fn default() -> Self {
        Self { earcut: Earcut::new(), flat: Vec::new(), indices: Vec::new(), triangles: Vec::new() }
    }
}

impl Triangulator {
    /// Triangles of a polygon, as indices of its corners, and whether they cover exactly the polygon, in projection on its
    /// best plane; those of one that crosses itself may not.
    ///
    /// They are a fan around the first corner if that covers it. Otherwise ears are clipped, also of a polygon with holes
    /// that bridges, edges there and back, join to its outline.
    pub(super) fn triangles(&mut self, places: &[DVec3]) -> (&[[u32; 3]], bool) {
        self.triangles.clear();
        let is_fan = fan_covers(places);
        let is_exact = is_fan || self.clip_ears(places);
        if self.triangles.is_empty() {
            self.triangles.extend((2..places.len() as u32).map(|corner| [0, corner - 1, corner]));
        }
        (&self.triangles, is_exact)
    }

    fn clip_ears(&mut self, places: &[DVec3]) -> bool {
        let extent = places.iter().map(|place| (place - places[0]).abs().max_element()).fold(0.0, f64::max);
        if !extent.is_finite() || places.len() > MOST_CORNERS {
            return false;
        }
        let place = |corner: usize| (places[corner] - places[0]) / extent;
        let fan = || (2..places.len()).map(|corner| place(corner - 1).cross(place(corner)));
        // Newell's normal; the parts of one that crosses itself may cancel.
        let (whole, size) = fan().fold((DVec3::ZERO, 0.0), |(sum, size), part| (sum + part, size + part.length()));
        let largest = fan().max_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or_default();
        let normal = if whole.length() > 1e-9 * size { whole } else { largest };
        let Some(normal) = normal.try_normalize() else { return false };
        let (u, v) = normal.any_orthonormal_pair();
        self.flat.clear();
        self.flat.extend((0..places.len()).map(|corner| [place(corner).dot(u), place(corner).dot(v)]));
        self.earcut.earcut_slice(&self.flat, &[], &mut self.indices);

        // All have the orientation of the polygon.
        let turn = u.cross(v).dot(normal);
        let mut covered = 0.0;
        for &corners in self.indices.as_chunks::<3>().0 {
            let [a, b, c] = corners.map(|corner| DVec2::from(self.flat[corner as usize]));
            let area = turn * (b - a).perp_dot(c - a);
            covered += area.abs();
            let [first, second, third] = corners;
            self.triangles.push(if area < 0.0 { [first, third, second] } else { corners });
        }
        (covered - whole.dot(normal)).abs() <= 1e-9 * covered
    }
}

/// Whether the triangle fan around the first corner covers exactly the polygon: every triangle
/// has the orientation of the whole (Newell's normal). True for convex polygons, and for others if
/// the first corner sees the whole polygon.
fn fan_covers(places: &[DVec3]) -> bool {
    let last = places.len().saturating_sub(1);
    let fan = |next: usize| (places[next] - places[0]).cross(places[next + 1] - places[0]);
    let whole: DVec3 = (1..last).map(fan).sum();
    (1..last).map(fan).all(|part| part.dot(whole) > 0.0 || part == DVec3::ZERO)
}

/// The report line on polygons that cross themselves; `first` is the location of one of them.
pub(super) fn crossing(count: usize, first: &str) -> String {
    format!(
        "{count} polygons cross themselves, the first {first}; their triangles may not cover them; triangulate them \
         before export"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chevron: the third corner lies inside the convex hull of the others.
    const CHEVRON: [[f64; 2]; 4] = [[0.0, 0.0], [2.0, 1.0], [0.0, 0.5], [-2.0, 1.0]];
    /// An L of area 3.
    const ELL: [[f64; 2]; 6] = [[2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0]];
    /// A square of area 16 with a hole of area 4, which a bridge joins to its outline.
    const KEYHOLE: [[f64; 2]; 10] = [
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [1.0, 1.0],
    ];
    const BOW: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];

    #[test]
    fn a_fan_covers_what_its_first_corner_sees() {
        let covers = |first: usize, corners: &[[f64; 2]]| {
            let turned = corners.iter().cycle().skip(first).take(corners.len());
            fan_covers(&turned.map(|&[x, y]| DVec3::new(x, y, 1.0)).collect::<Vec<_>>())
        };
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!((0..4).all(|first| covers(first, &square)));
        // The whole polygon is visible from the tip and from the notch, but not from the wings.
        assert_eq!([0, 1, 2, 3].map(|first| covers(first, &CHEVRON)), [true, false, true, false]);
        assert!(covers(0, &[]) && covers(0, &CHEVRON[..1]) && covers(0, &CHEVRON[..2]));
    }

    /// In any plane, at any size, from any corner, and from both sides.
    #[test]
    fn triangles_cover_the_polygon_and_nothing_else() {
        let mut triangulator = Triangulator::default();
        for (corners, area, is_simple) in
            [(&CHEVRON[..], 1.0, true), (&ELL, 3.0, true), (&KEYHOLE, 12.0, true), (&BOW, 0.0, false)]
        {
            for (turn, size) in (0..2 * corners.len()).flat_map(|turn| [1e-30, 1.0, 1e30].map(|size| (turn, size))) {
                let plane = glam::DQuat::from_euler(glam::EulerRot::XYZ, turn as f64, 0.3, 2.0);
                let turned = corners.iter().cycle().skip(turn).take(corners.len());
                let place = |&[x, y]: &[f64; 2]| plane * DVec3::new(x, y, 5.0) * size;
                let mut places: Vec<DVec3> = turned.map(place).collect();
                let normal = plane * DVec3::Z * if turn % 2 == 0 { 1.0 } else { -1.0 };
                if turn % 2 == 1 {
                    places.reverse();
                }
                let (triangles, is_exact) = triangulator.triangles(&places);
                assert_eq!((is_exact, triangles.len() <= corners.len() - 2), (is_simple, true), "{corners:?}");
                let areas = triangles.iter().map(|triangle| {
                    let [a, b, c] = triangle.map(|corner| places[corner as usize] / size);
                    0.5 * (b - a).cross(c - a).dot(normal)
                });
                let areas: Vec<f64> = areas.collect();
                assert!(!is_simple || areas.iter().all(|&part| part > -1e-9), "{corners:?} from {turn}: {areas:?}");
                let found: f64 = areas.iter().sum();
                assert!(!is_simple || (found - area).abs() < 1e-9, "{corners:?} from {turn}: {found}");
            }
        }
    }
}
