//! Segments of camera paths in a medium that scatters light.

use glam::Vec3;

use crate::scene::layout::Query;
use crate::scene::media::MediumStack;
use crate::shading::octahedral;
use crate::shading::reflection_lobe::{Vectors, vector};

/// A straight part of a camera path in one medium, seen from its start: light that is scattered along it is added to a pixel.
/// It is stored as a [`Query`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Its start.
    pub origin: Vec3,
    /// Unit vector to its end.
    pub direction: Vec3,
    /// Its length.
    pub length: f32,
    /// Unit normals of the surfaces at its start and its end, towards the medium at the start and away from it at the end:
    /// light counts between these planes. The direction itself where there is no surface.
    pub planes: [Vec3; 2],
    /// Media around it.
    pub media: MediumStack,
    /// Factor from radiance at its start to that of the pixel.
    pub throughput: Vec3,
}

impl Segment {
    /// Converts it to a record: the normals and the length are in words that have other meanings at surfaces.
    #[inline]
    #[must_use]
    pub fn query(&self, pixel: u32, path: u32) -> Query {
        Query {
            position: self.origin.into(),
            radius: 1.0,
            normal: self.direction.into(),
            pixel,
            throughput: self.throughput.into(),
            media: self.media.bits(),
            offset_or_wo: self.length.to_bits(),
            path,
            shading_normal: octahedral::pack(self.planes[1]),
            coat: octahedral::pack(self.planes[0]),
        }
    }

    /// The segment that a record has.
    #[inline]
    #[must_use]
    pub fn of(query: &Query) -> Self {
        Self {
            origin: query.position.into(),
            direction: query.normal.into(),
            length: f32::from_bits(query.offset_or_wo),
            planes: [octahedral::unpack(query.coat), octahedral::unpack(query.shading_normal)],
            media: MediumStack::from_bits(query.media),
            throughput: query.throughput.into(),
        }
    }

    /// The distance along the segment that a point beside it stands for, in `[0, length]`, or `None` if the point does not lie
    /// between the planes of both ends. Light passes the medium between the planes, which oblique planes cut from a line beside
    /// the segment earlier or later than from itself; the distance divides the segment as the point divides that part of its
    /// line. So the mean transmittance over points beside an even medium is that of the segment, however oblique the planes are,
    /// unless they meet nearby.
    #[inline]
    #[must_use]
    pub fn distance(&self, from_origin: Vec3) -> Option<f32> {
        let [start, end] = self.planes;
        // Normals are rounded, and may be along the segment.
        let along = |plane: Vec3| self.direction.dot(plane).max(1e-6);
        let before = from_origin.dot(start) * along(end);
        let behind = -(from_origin - self.direction * self.length).dot(end) * along(start);
        (before >= 0.0 && behind >= 0.0).then(|| self.length * (before / (before + behind).max(f32::MIN_POSITIVE)))
    }

    /// [`Self::distance`] for several points, NaN for those that do not count; the loop becomes vector instructions.
    #[inline(always)]
    #[must_use]
    pub fn distances<const N: usize>(&self, from_origin: &Vectors<N>) -> [f32; N] {
        let mut distances = [0.0; N];
        for lane in 0..N {
            distances[lane] = self.distance(vector(from_origin, lane)).unwrap_or(f32::NAN);
        }
        distances
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_keep_segments() {
        let segment = Segment {
            origin: Vec3::new(0.1, 0.2, 0.3),
            direction: Vec3::Z,
            length: 0.7,
            planes: [Vec3::Z, Vec3::new(0.6, 0.0, 0.8)],
            media: MediumStack::in_medium(3),
            throughput: Vec3::new(1.0, 0.5, 0.25),
        };
        let kept = Segment::of(&segment.query(5, 21));
        assert!(kept.planes[0].distance(segment.planes[0]) < 1e-4 && kept.planes[1].distance(segment.planes[1]) < 1e-4);
        assert_eq!(Segment { planes: segment.planes, ..kept }, segment);
        // The oblique end cuts off what is behind it on one side, and adds as much on the other.
        let at = |x: f32, z: f32| segment.distance(Vec3::new(x, 0.0, z)).is_some();
        assert!(at(0.0, 0.69) && !at(0.0, 0.71) && at(-0.1, 0.77) && !at(0.1, 0.63) && !at(0.0, -0.01));
    }

    #[test]
    fn several_distances_are_those_of_each() {
        let planes = [Vec3::new(0.6, 0.0, 0.8), Vec3::Z];
        let media = MediumStack::in_medium(1);
        let [origin, direction, throughput] = [Vec3::ZERO, Vec3::Z, Vec3::ONE];
        let segment = Segment { origin, direction, length: 0.7, planes, media, throughput };
        let points = [[0.1, 0.2, 0.3], [-0.4, 0.0, 0.1], [0.3, 0.1, 0.8], [0.0, 0.0, 0.7]];
        let found = segment.distances(&[0, 1, 2].map(|c| points.map(|point| point[c])));
        for (found, point) in found.into_iter().zip(points) {
            assert_eq!((!found.is_nan()).then_some(found), segment.distance(point.into()), "{point:?}");
        }
        assert!(found[0] > 0.0 && found[1].is_nan() && found[2].is_nan());
    }

    /// The start is turned by 45 degrees, so that lines beside the segment begin earlier or later by their distance from it.
    #[test]
    fn distances_divide_the_medium_between_the_planes() {
        let start = Vec3::new(0.5_f32.sqrt(), 0.0, 0.5_f32.sqrt());
        let media = MediumStack::in_medium(1);
        let [origin, direction, throughput] = [Vec3::ZERO, Vec3::Z, Vec3::ONE];
        let oblique = Segment { origin, direction, length: 1.0, planes: [start, Vec3::Z], media, throughput };
        let straight = Segment { planes: [Vec3::Z; 2], ..oblique };
        let at = |segment: &Segment, x: f32, z: f32| segment.distance(Vec3::new(x, 0.3, z));
        for (x, z) in [(0.0, 0.0), (0.0, 0.5), (0.25, 0.5), (-0.25, 0.5), (0.5, -0.2), (0.0, 1.0)] {
            let truth = (z + x) / (1.0 + x);
            assert!((at(&oblique, x, z).unwrap() - truth).abs() < 1e-6, "{x} {z}");
            assert_eq!(at(&straight, x, z), (z >= 0.0).then_some(z));
        }
        assert_eq!(at(&oblique, -0.6, 0.5), None);
        // Nothing is left of the medium where the planes meet. Before a plane along the segment is all of it.
        assert_eq!(at(&oblique, -1.0, 1.0), Some(0.0));
        let grazing = Segment { planes: [Vec3::new(1.0, 0.0, -1e-5), Vec3::Z], ..oblique };
        assert!((at(&grazing, 0.1, 0.5).unwrap() - 1.0).abs() < 1e-4);
        assert_eq!(at(&grazing, -0.1, 0.5), None);
        let at_both = Segment { planes: [Vec3::X, Vec3::NEG_X], ..oblique };
        assert_eq!((at(&at_both, 0.1, 0.5), at(&at_both, -0.1, 0.5)), (Some(0.5), None));
    }
}
