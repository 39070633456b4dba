//! Search along a segment: all points within a radius of its line.

use crate::index::dispatch::Dispatched;
use crate::index::lanes::{Distances, Lanes};
use crate::index::layout::{Block, Node, Tree, WIDTH};
use crate::index::range::{Batches, Search, Waiting, walk};

/// A segment, and how far points may lie from it.
#[derive(Clone, Copy)]
pub(crate) struct Line {
    pub(crate) origin: [f32; 3],
    /// Unit vector.
    pub(crate) direction: [f32; 3],
    /// Distances of feet on the line, from the first to the last that counts.
    pub(crate) range: [f32; 2],
    pub(crate) radius: f32,
}

/// Passes every point within the radius of the line whose foot is in range, with its squared distance from the line, to `batches`
/// if it is accepted.
pub(crate) struct Along<'a, B> {
    pub(crate) tree: &'a Tree,
    pub(crate) line: Line,
    pub(crate) batches: &'a mut B,
}

impl<B: Batches> Dispatched for Along<'_, B> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        let slabs = Slabs::new(&self.line);
        let mut blocks = Blocks { of: &mut self, slabs, waiting: Waiting::default() };
        walk(lanes, blocks.of.tree, &mut blocks);
        blocks.waiting.finish(blocks.of.batches);
    }
}

/// The blocks with a point that counts.
struct Blocks<'a, 'b, B> {
    of: &'b mut Along<'a, B>,
    slabs: Slabs,
    waiting: Waiting,
}

impl<L: Lanes, B: Batches> Search<L> for Blocks<'_, '_, B> {
    #[inline(always)]
    fn children(&self, lanes: L, node: &Node) -> u32 {
        lanes.at_most(&self.slabs.to_boxes(node), 0.0)
    }

    #[inline(always)]
    fn block(&mut self, lanes: L, number: u32) -> bool {
        let Along { tree, line, batches } = &mut *self.of;
        let d2 = to_points(&tree.blocks[number as usize], line);
        let hits = lanes.at_most(&d2, line.radius * line.radius);
        self.waiting.add(*batches, number, hits, &d2);
        true
    }
}

/// Squared distances of points from the line: infinite out of range, NaN in empty lanes.
#[inline(always)]
fn to_points(block: &Block, line: &Line) -> Distances {
    let ([ox, oy, oz], [dx, dy, dz], [first, last]) = (line.origin, line.direction, line.range);
    let mut d2 = [0.0; WIDTH];
    for lane in 0..WIDTH {
        let (x, y, z) = (block.x[lane] - ox, block.y[lane] - oy, block.z[lane] - oz);
        let foot = x * dx + y * dy + z * dz;
        let (x, y, z) = (x - foot * dx, y - foot * dy, z - foot * dz);
        let squared = x * x + y * y + z * z;
        d2[lane] = if foot < first || foot > last { f32::INFINITY } else { squared };
    }
    d2
}

/// The line for tests of boxes: reciprocals of its direction, and the radius with room for rounding.
struct Slabs {
    origin: [f32; 3],
    inverse: [f32; 3],
    range: [f32; 2],
    margin: f32,
}

impl Slabs {
    fn new(line: &Line) -> Self {
        // Without infinities, which give NaN for boxes in the plane of the origin.
        let inverse = line.direction.map(|d| if d.abs() < 1e-12 { 1e12_f32.copysign(d) } else { 1.0 / d });
        let largest = line.origin.iter().fold(line.range[1].abs(), |most, c| most.max(c.abs()));
        // Feet and distances are rounded relative to the largest of all numbers.
        Self { origin: line.origin, inverse, range: line.range, margin: line.radius * 1.001 + 1e-6 * largest }
    }

    /// 0 for boxes that the line meets within its range and the margin, infinite for others, NaN for absent ones.
    #[inline(always)]
    fn to_boxes(&self, node: &Node) -> Distances {
        let mut gaps = [0.0; WIDTH];
        for lane in 0..WIDTH {
            let (mut near, mut far) = (self.range[0] - self.margin, self.range[1] + self.margin);
            for axis in 0..3 {
                let low = (node.lo[axis][lane] - self.margin - self.origin[axis]) * self.inverse[axis];
                let high = (node.hi[axis][lane] + self.margin - self.origin[axis]) * self.inverse[axis];
                let (first, last) = if low > high { (high, low) } else { (low, high) };
                near = if first > near { first } else { near };
                far = if last < far { last } else { far };
            }
            let is_absent = node.lo[0][lane].is_nan();
            // Rounding of the quotients may make a thin box end before it begins.
            let gap = near - far - 1e-6 * (near.abs() + far.abs());
            gaps[lane] = if is_absent {
                f32::NAN
            } else if gap > 0.0 {
                f32::INFINITY
            } else {
                0.0
            };
        }
        gaps
    }
}

#[cfg(test)]
mod tests {
    use photon_core::IndexKind;
    use photon_core::glam::Vec3;
    use photon_core::random::{SplitMix64, unit_f32};
    use photon_core::sampling;

    use crate::index::layout::WIDTH;
    use crate::index::{Batches, PointIndex};

    /// All points that are found.
    #[derive(Default)]
    struct Found(Vec<(u32, f32)>);

    impl Batches for Found {
        fn accepts(&self, _slot: u32) -> bool {
            true
        }

        fn take(&mut self, slots: &[u32; WIDTH], d2: &[f32; WIDTH], count: usize) {
            self.0.extend(slots[..count].iter().copied().zip(d2.iter().copied()));
        }
    }

    /// Points found are those of a test of all, for random lines and for lines along an axis.
    #[test]
    fn the_points_are_those_of_a_search_without_a_tree() {
        let mut numbers = SplitMix64(17);
        let mut number = || unit_f32(numbers.word() as u32);
        let points: Vec<[f32; 3]> = (0..5000).map(|_| [number() - 0.5, number() - 0.5, number() * 0.2]).collect();
        for kind in [IndexKind::Median, IndexKind::Morton, IndexKind::Vvh] {
            let index = PointIndex::build(&points, kind).unwrap();
            let mut total = 0;
            for line in 0..300 {
                let origin =
                    Vec3::new(number() - 0.5, number() - 0.5, if line % 2 == 0 { 0.1 } else { 20.0 * number() });
                let direction = match line % 5 {
                    0 => Vec3::X,
                    1 => -Vec3::Z,
                    _ => sampling::uniform_sphere(number() - 0.5, number()),
                };
                let (length, radius) = (number() * 30.0, 0.1 * number() * number());
                let mut found = Found::default();
                index.batches_along(origin.into(), direction.into(), length, radius, &mut found);
                assert!(found.0.iter().all(|&(_, d2)| d2 <= radius * radius));
                let mut found: Vec<u32> = found.0.iter().map(|&(slot, _)| index.order()[slot as usize]).collect();
                found.sort_unstable();
                let counts = |point: &[f32; 3]| {
                    let v = Vec3::from(*point) - origin;
                    let foot = v.dot(direction);
                    let squared = (v - direction * foot).length_squared();
                    (
                        squared <= radius * radius && foot >= -8.0 * radius && foot <= length + 8.0 * radius,
                        squared,
                        foot,
                    )
                };
                let expected: Vec<u32> =
                    (0..).zip(&points).filter(|(_, point)| counts(point).0).map(|(id, _)| id).collect();
                // Points at the edge may differ by rounding.
                let at_edge = |id: &u32| {
                    let (_, squared, _) = counts(&points[*id as usize]);
                    (squared.sqrt() - radius).abs() < 2e-5
                };
                let differ = expected.iter().filter(|id| found.binary_search(id).is_err() && !at_edge(id)).count()
                    + found.iter().filter(|id| expected.binary_search(id).is_err() && !at_edge(id)).count();
                assert_eq!(differ, 0, "{kind:?} {line}: {} {}", found.len(), expected.len());
                total += found.len();
            }
            assert!(total > 3000, "{total}");
        }
    }
}
