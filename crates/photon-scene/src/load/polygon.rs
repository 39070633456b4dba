//! Polygons with more than three corners.

use glam::DVec3;

/// Whether the fan of triangles about the first corner covers a polygon and no more: every triangle
/// faces as the whole does (Newell's normal). Any convex polygon passes, of the others those that
/// the first corner sees all of.
pub(super) fn fan_covers(places: &[DVec3]) -> bool {
    let last = places.len().saturating_sub(1);
    let fan = |next: usize| (places[next] - places[0]).cross(places[next + 1] - places[0]);
    let whole: DVec3 = (1..last).map(fan).sum();
    (1..last).all(|next| fan(next).dot(whole) >= 0.0)
}

/// The line of a report on polygons that fans do not cover; `first` says where one of them is.
pub(super) fn concave(count: usize, first: &str) -> String {
    format!(
        "{count} polygons are not convex, the first {first}; each is cut into a fan of triangles, which may stick \
         out; triangulate them where the file is made"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chevron: the third corner lies inside the hull of the others.
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
        // From the tip and from the notch all of it is in view, from its wings it is not.
        assert_eq!([0, 1, 2, 3].map(|first| covers(first, &CHEVRON)), [true, false, true, false]);
    }

    #[test]
    fn what_has_no_fan_has_no_fault() {
        assert!(covers(0, &[]) && covers(0, &CHEVRON[..1]) && covers(0, &CHEVRON[..2]));
    }
}
