//! Discs that lie whole within one triangle, with nothing above: their area needs no probes.

use photon_core::glam::Vec3;
use photon_core::offset::STEP;

/// Distance that separates for certain: more than points of rays and triangles move by rounding and by offsets.
pub(crate) const MARGIN: f32 = 64.0 * STEP;

/// Least sine of the angle between the normal and an edge whose perpendicular may separate. Corners are rounded by at most
/// 2⁻²³ of an edge's length, so that the perpendicular leaves the plane by 2⁻²²/2⁻⁶ = 2⁻¹⁶ at most: along it the space is wider
/// than the disc by this part of its height, far less than `MARGIN`.
const LEAST_SINE: f32 = 0.015_625;

/// Distance from the plane at which a point is on it: the rounding of coordinates.
pub(crate) const ON_PLANE: f32 = 4.0 * STEP;

/// A disc, and the space above and below it in which surfaces matter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatDisc {
    pub(crate) centre: Vec3,
    /// Unit vector.
    pub(crate) normal: Vec3,
    pub(crate) radius: f32,
    /// The space reaches this far above and below the plane.
    pub(crate) height: f32,
}

/// Where a triangle lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Outside of the space around the disc.
    Apart,
    /// In the plane of the disc, which it contains.
    Holds,
    /// Anywhere else, or not certain.
    Other,
}

impl FlatDisc {
    /// The lower and upper corner of a box around the space.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        let across = (Vec3::ONE - self.normal * self.normal).max(Vec3::ZERO).map(f32::sqrt) * self.radius;
        let half = across + self.normal.abs() * self.height + MARGIN;
        (self.centre - half, self.centre + half)
    }

    /// Where the triangle with these corners lies. It is apart if the plane's normal or a perpendicular to one of its edges
    /// separates it (separating axes).
    pub(crate) fn place(&self, corners: [Vec3; 3]) -> Place {
        let from = corners.map(|corner| corner - self.centre);
        let heights = from.map(|corner| corner.dot(self.normal));
        let beyond = self.height + MARGIN;
        if heights.iter().all(|h| *h > beyond) || heights.iter().all(|h| *h < -beyond) {
            return Place::Apart;
        }
        let reach = self.radius + MARGIN;
        let mut holds = heights.iter().all(|h| h.abs() <= ON_PLANE);
        for first in 0..3 {
            let (next, third) = ((first + 1) % 3, (first + 2) % 3);
            let edge = from[next] - from[first];
            let axis = self.normal.cross(edge);
            let length = axis.length();
            // Parallel to the normal, an edge has no perpendicular in the plane; the other two have the same.
            if !(length > MARGIN.max(LEAST_SINE * edge.length())) {
                holds = false;
                continue;
            }
            let along = from.map(|corner| corner.dot(axis) / length);
            if along.iter().all(|at| *at >= reach) || along.iter().all(|at| *at <= -reach) {
                return Place::Apart;
            }
            // The centre is at 0: on the same side of this edge as the third corner, and far enough from it.
            let edge = along[first];
            holds &=
                if edge < 0.0 { along[third] > edge && -edge >= reach } else { along[third] < edge && edge >= reach };
        }
        if holds { Place::Holds } else { Place::Other }
    }
}

/// Radius of a triangle's inscribed circle, the largest within it: twice the area over the perimeter.
pub(crate) fn inradius([a, b, c]: &[Vec3; 3]) -> f32 {
    let area = 0.5 * (*b - *a).cross(*c - *a).length();
    2.0 * area / ((*b - *a).length() + (*c - *b).length() + (*a - *c).length()).max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DISC: FlatDisc = FlatDisc { centre: Vec3::new(0.3, 0.4, 0.5), normal: Vec3::Z, radius: 0.1, height: 0.05 };

    /// A triangle from coordinates relative to the centre.
    fn place(corners: [[f32; 3]; 3]) -> Place {
        DISC.place(corners.map(|corner| DISC.centre + Vec3::from(corner)))
    }

    #[test]
    fn inscribed_circles() {
        let corners = [[0.0, 0.0, 0.5], [3.0, 0.0, 0.5], [0.0, 4.0, 0.5]].map(Vec3::from);
        assert!((inradius(&corners) - 1.0).abs() < 1e-6);
        assert_eq!(inradius(&[Vec3::ONE; 3]), 0.0);
    }

    #[test]
    fn triangles_that_hold_the_disc() {
        let around = [[-1.0, -0.11, 0.0], [1.0, -0.11, 0.0], [0.0, 2.0, 0.0]];
        assert_eq!(place(around), Place::Holds);
        assert_eq!(place([around[1], around[0], around[2]]), Place::Holds, "in any winding");
        // An edge through the disc, or that touches it.
        for y in [-0.1, -0.05, 0.0] {
            assert_eq!(place([[-1.0, y, 0.0], [1.0, y, 0.0], [0.0, 2.0, 0.0]]), Place::Other, "{y}");
        }
        // Above the plane by less than the height, and tilted.
        assert_eq!(place(around.map(|[x, y, _]| [x, y, 0.01])), Place::Other);
        assert_eq!(place(around.map(|[x, y, _]| [x, y, 0.001 * x])), Place::Other);
    }

    #[test]
    fn triangles_apart_from_the_disc() {
        // Beside it in the plane: the neighbour beyond an edge.
        assert_eq!(place([[-1.0, -0.11, 0.0], [0.0, -2.0, 0.0], [1.0, -0.11, 0.0]]), Place::Apart);
        assert_eq!(place([[-1.0, -0.09, 0.0], [0.0, -2.0, 0.0], [1.0, -0.09, 0.0]]), Place::Other);
        // A wall beside it, and one through it.
        assert_eq!(place([[0.11, -1.0, -1.0], [0.11, 1.0, -1.0], [0.11, 0.0, 1.0]]), Place::Apart);
        assert_eq!(place([[0.09, -1.0, -1.0], [0.09, 1.0, -1.0], [0.09, 0.0, 1.0]]), Place::Other);
        // A ceiling, high and low.
        let ceiling = |z: f32| [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 2.0, z]];
        assert_eq!(place(ceiling(0.06)), Place::Apart);
        assert_eq!(place(ceiling(-0.06)), Place::Apart);
        assert_eq!(place(ceiling(0.04)), Place::Other);
        // All edges within a degree of the normal: no edge may separate, even if it could.
        let sliver = |x: f32| [[x, 0.0, -1.0], [x, 0.01, 0.0], [x, 0.0, 1.0]];
        assert_eq!(place(sliver(0.2)), Place::Other);
        // Degenerate ones are never held, nor lost where they cross the disc.
        assert_eq!(place([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]), Place::Other);
        assert_eq!(place([[f32::NAN; 3]; 3]), Place::Other);
    }

    #[test]
    fn the_box_contains_the_space() {
        let normal = Vec3::new(2.0, -1.0, 2.0) / 3.0;
        let disc = FlatDisc { normal, ..DISC };
        let (low, high) = disc.bounds();
        let (tangent, bitangent) = photon_core::sampling::basis(normal);
        for step in 0..64 {
            let (sine, cosine) = (step as f32 * 0.1).sin_cos();
            for height in [-disc.height, disc.height] {
                let point = disc.centre + (tangent * cosine + bitangent * sine) * disc.radius + normal * height;
                assert!(point.cmpge(low).all() && point.cmple(high).all(), "{point} is outside of {low} to {high}");
            }
        }
    }
}
