//! Points within a radius of a segment, exactly: a search along its line, and a test in double precision.

use photon_core::glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::index::layout::WIDTH;
use crate::index::{Batches, PointIndex};

/// Segments per parallel task.
const CHUNK: usize = 64;

/// Squared distance of a point from the segment between two ends; in double precision, where squares of differences of `f32` are
/// exact to the last digits.
fn squared_distance([a, b]: [[f32; 3]; 2], point: [f32; 3]) -> f64 {
    let between = |from: [f32; 3], to: [f32; 3]| -> [f64; 3] {
        std::array::from_fn(|axis| f64::from(to[axis]) - f64::from(from[axis]))
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (axis, to_point) = (between(a, b), between(a, point));
    let squared = dot(axis, axis);
    // Both ends may be one point.
    let share = if squared > 0.0 { (dot(to_point, axis) / squared).clamp(0.0, 1.0) } else { 0.0 };
    let beside = [0, 1, 2].map(|i| to_point[i] - share * axis[i]);
    dot(beside, beside)
}

impl PointIndex {
    /// Calls `visit` with the slot and the squared distance of every point within `radius` of the segment between two ends, in an
    /// order that depends only on the arguments; as in a test of every point, in double precision.
    /// Coordinates and radius are at most 2⁶² in magnitude.
    pub fn near_segment(&self, ends: [[f32; 3]; 2], radius: f32, mut visit: impl FnMut(u32, f64)) {
        let [a, b] = ends.map(double);
        let length = (b - a).length();
        let direction = if length > 0.0 { (b - a) / length } else { DVec3::X };
        // Rounding of the direction, of feet and of distances, each a few units in the last place of the length.
        let reach = f64::from(radius) + 4e-6 * (length + f64::from(radius)) + f64::from(f32::MIN_POSITIVE);
        let squared_radius = f64::from(radius) * f64::from(radius);
        let near = |slot: u32| {
            let squared = squared_distance(ends, self.position(slot));
            if squared <= squared_radius {
                visit(slot, squared);
            }
        };
        self.batches_along(ends[0], direction.as_vec3().into(), length as f32, reach as f32, &mut Each(near));
    }

    /// The number of points that [`Self::near_segment`] visits, for every segment, in parallel.
    ///
    /// # Panics
    /// If `out` and `segments` differ in length.
    pub fn count_near_segments(&self, segments: &[[[f32; 3]; 2]], radius: f32, out: &mut [u32]) {
        assert_eq!(out.len(), segments.len(), "`out` must have one element per segment");
        out.par_chunks_mut(CHUNK).with_max_len(1).zip(segments.par_chunks(CHUNK)).for_each(|(counts, segments)| {
            for (count, &ends) in counts.iter_mut().zip(segments) {
                *count = 0;
                self.near_segment(ends, radius, |_, _| *count += 1);
            }
        });
    }
}

/// Calls a function with each slot.
struct Each<F>(F);

impl<F: FnMut(u32)> Batches for Each<F> {
    #[inline(always)]
    fn accepts(&self, _slot: u32) -> bool {
        true
    }

    #[inline(always)]
    fn take(&mut self, slots: &[u32; WIDTH], _d2: &[f32; WIDTH], count: usize) {
        slots[..count].iter().for_each(|&slot| self.0(slot));
    }
}

fn double(point: [f32; 3]) -> DVec3 {
    Vec3::from(point).as_dvec3()
}

#[cfg(test)]
mod tests {
    use photon_core::IndexKind;
    use photon_core::random::{SplitMix64, unit_f32};

    use super::*;

    /// Equal to a test of all points: for random segments, along axes, of no length, far away, and from and to points of the map,
    /// of which many are at the radius exactly.
    #[test]
    fn points_are_those_of_brute_force() {
        let mut numbers = SplitMix64(23);
        let mut number = || unit_f32(numbers.word() as u32);
        let mut points: Vec<[f32; 3]> = (0..3000).map(|_| [number() - 0.5, number() - 0.5, 0.2 * number()]).collect();
        // A grid, whose distances from its own lines are multiples of 1/8.
        points.extend((0..512_u32).map(|i| [i % 8, i / 8 % 8, i / 64].map(|c| c as f32 / 8.0)));
        for kind in [IndexKind::Median, IndexKind::Morton, IndexKind::Vvh] {
            let index = PointIndex::build(&points, kind).unwrap();
            let mut total = 0;
            for case in 0..600 {
                let mut any = || [number() - 0.5, number() - 0.5, 0.2 * number()];
                let (a, b) = (any(), any());
                let ends = match case % 6 {
                    0 => [a, a],
                    1 => [a, [b[0], a[1], a[2]]],
                    2 => [a.map(|c| c - 300.0), b],
                    3 => [[0.0, 0.125, 0.25], [0.875, 0.125, 0.25]],
                    4 => [points[case], points[2 * case]],
                    _ => [a, b],
                };
                let radius = [0.125, 0.25, 0.05, 1e-4, 0.01][case % 5];
                let squared_radius = f64::from(radius) * f64::from(radius);
                let mut found = Vec::new();
                index.near_segment(ends, radius, |slot, squared| {
                    let id = index.order()[slot as usize];
                    assert_eq!(squared, squared_distance(ends, points[id as usize]));
                    found.push(id);
                });
                found.sort_unstable();
                let is_near = |point: &[f32; 3]| squared_distance(ends, *point) <= squared_radius;
                let expected: Vec<u32> = (0..).zip(&points).filter(|(_, p)| is_near(p)).map(|(id, _)| id).collect();
                assert_eq!(found, expected, "{kind:?} {case}");
                let mut count = [0];
                index.count_near_segments(&[ends], radius, &mut count);
                assert_eq!(count[0] as usize, expected.len());
                total += expected.len();
            }
            assert!(total > 20_000, "{total}");
        }
    }

    /// Beside the ends and beside the middle, by hand.
    #[test]
    fn distances_of_known_points() {
        let ends = [[0.0; 3], [2.0, 0.0, 0.0]];
        for (point, squared) in
            [([1.0, 3.0, 0.0], 9.0), ([-3.0, 0.0, 4.0], 25.0), ([5.0, 4.0, 0.0], 25.0), ([2.0, 0.0, 0.0], 0.0)]
        {
            assert_eq!(squared_distance(ends, point), squared);
            assert_eq!(squared_distance([ends[1], ends[0]], point), squared);
        }
        assert_eq!(squared_distance([[1.0; 3]; 2], [1.0, 1.0, 3.0]), 4.0);
    }
}
