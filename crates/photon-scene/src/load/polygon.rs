//! Triangulation of polygons with more than three corners.

use glam::DVec3;

/// Whether the triangle fan around the first corner covers exactly the polygon: every triangle
/// has the orientation of the whole (Newell's normal). True for convex polygons, and for others if
/// the first corner sees the whole polygon.
pub(super) fn fan_covers(places: &[DVec3]) -> bool {
    let last = places.len().saturating_sub(1);
    let fan = |next: usize| (places[next] - places[0]).cross(places[next + 1] - places[0]);
    let whole: DVec3 = (1..last).map(fan).sum();
    (1..last).all(|next| fan(next).dot(whole) >= 0.0)
}

/// The report line on polygons that fans do not cover; `first` is the location of one of them.
pub(super) fn concave(count: usize, first: &str) -> String {
    format!(
        "{count} polygons are not convex, the first {first}; each is triangulated as a fan, which may extend beyond \
         the polygon; triangulate them before export"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chevron: the third corner lies inside the convex hull of the others.
    const CHEVRON: [[f64; 2]; 4] = [[0.0, 0.0], [2.0, 1.0], [0.0, 0.5], [-2.0, 1.0]];

    fn covers(first: usize, corners: &[[f64; 2]]) -> bool {
        let turned = corners.iter().cycle().skip(first).take(corners.len());
        let places: Vec<DVec3> = turned.map(|&[x, y]| DVec3::new(x, y, 1.0)).collect();
        fan_covers(&places)
    }

    #[test]
    fn a_fan_covers_what_its_first_corner_sees() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!((0..4).all(|first| covers(first, &square)));
        // The whole polygon is visible from the tip and from the notch, but not from the wings.
        assert_eq!([0, 1, 2, 3].map(|first| covers(first, &CHEVRON)), [true, false, true, false]);
    }

    #[test]
    fn what_has_no_fan_has_no_fault() {
        assert!(covers(0, &[]) && covers(0, &CHEVRON[..1]) && covers(0, &CHEVRON[..2]));
    }
}
