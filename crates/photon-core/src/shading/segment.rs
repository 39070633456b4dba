//! Segments of camera paths in a medium that scatters light.

use glam::Vec3;

use crate::scene::layout::Query;
use crate::scene::media::MediumStack;
use crate::shading::octahedral;

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

    /// Whether a point lies between the planes of both ends.
    #[inline]
    #[must_use]
    pub fn contains(&self, from_origin: Vec3) -> bool {
        from_origin.dot(self.planes[0]) >= 0.0
            && (from_origin - self.direction * self.length).dot(self.planes[1]) <= 0.0
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
        let at = |x: f32, z: f32| segment.contains(Vec3::new(x, 0.0, z));
        assert!(at(0.0, 0.69) && !at(0.0, 0.71) && at(-0.1, 0.77) && !at(0.1, 0.63) && !at(0.0, -0.01));
    }
}
