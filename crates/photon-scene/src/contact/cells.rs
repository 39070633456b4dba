//! Grid of cells, and those in which triangles may touch.

use std::ops::{ControlFlow, Range};

use glam::Vec3;

use crate::normalise::Geometry;

/// Maximum number of cells along an axis.
const MOST: f32 = 64.0;

/// Triangles for each cell that a surface across the grid has.
const PER_CELL: f32 = 8.0;

/// Size of runs that are not divided into pieces, in cells.
const SMALL: f32 = 4.0;

/// Number of pieces of large triangles in addition to one for each triangle.
const PIECES: f32 = 65536.0;

/// A box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range3 {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

impl Range3 {
    pub(super) const EMPTY: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    /// The box around both.
    pub(super) fn join(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

/// Consecutive triangles of one mesh.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) triangles: Range<u32>,
    /// Its bounding box, padded so that the boxes of triangles that coincide overlap.
    low: Vec3,
    high: Vec3,
    /// Triangles of other classes may touch it.
    class: u32,
    /// Directions of its normals, if those of its class may touch it: [`facing`].
    faces: u16,
}

impl Run {
    /// Triangles of a class in a box, with a box of their normals; they may touch others up to a distance of `reach`.
    pub(super) fn new(triangles: Range<usize>, around: Range3, normals: Range3, class: u32, reach: f32) -> Self {
        let margin = Vec3::splat(reach);
        Self {
            triangles: triangles.start as u32..triangles.end as u32,
            low: around.low - margin,
            high: around.high + margin,
            class,
            faces: facing(normals),
        }
    }
}

/// Axes along which normals are: three bits each for components that may be the largest one of a normal, if positive and if
/// negative; and for those that are clearly positive, and clearly negative. Of two normals that enclose more than 154°, one
/// has a bit of the former kind, and the other one the opposite bit of the latter kind.
fn facing(normals: Range3) -> u16 {
    // The largest component is at least 0.577, and that of a normal which deviates by 0.447 from the opposite one 0.13.
    let (largest, clear) = (Vec3::splat(0.577), Vec3::splat(0.125));
    let bits = [
        normals.high.cmpge(largest),
        normals.low.cmple(-largest),
        normals.high.cmpgt(clear),
        normals.low.cmplt(-clear),
    ];
    bits.iter().rev().fold(0, |all, axes| all << 3 | axes.bitmask() as u16)
}

/// A cell: its class, and the union of the directions of normals.
#[derive(Clone, Copy)]
struct Cell {
    class: u32,
    faces: u16,
}

impl Cell {
    const EMPTY: Self = Self { class: u32::MAX, faces: 0 };
    const SEVERAL: u32 = u32::MAX - 1;

    fn add(&mut self, run: &Run) {
        self.class = if self.class == Self::EMPTY.class || self.class == run.class { run.class } else { Self::SEVERAL };
        self.faces |= run.faces;
    }

    /// Whether triangles in it may touch.
    fn is_crowded(self) -> bool {
        let [up, down, upwards, downwards] = [0, 3, 6, 9].map(|place| self.faces >> place & 7);
        self.class == Self::SEVERAL || up & downwards != 0 || down & upwards != 0
    }
}

/// Place and size of the cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    low: Vec3,
    high: Vec3,
    /// Cells per length along each axis.
    per_length: Vec3,
    counts: [usize; 3],
    /// Distance up to which triangles may touch.
    reach: f32,
}

impl Frame {
    /// Cells in a box, of a size for this number of triangles, which may touch up to a distance of `reach`. They are as flat as
    /// the box, which may be around what is near a plane.
    pub(super) fn new(low: Vec3, high: Vec3, triangles: usize, reach: f32) -> Self {
        let margin = Vec3::splat(2.0 * reach);
        let count = (triangles as f32 / (3.0 * PER_CELL)).sqrt().clamp(1.0, MOST);
        Self::of(low - margin, high + margin, count, reach)
    }

    fn of(low: Vec3, high: Vec3, count: f32, reach: f32) -> Self {
        let extent = high - low;
        let counts = (extent / (4.0 * reach)).min(Vec3::splat(count)).max(Vec3::ONE).floor();
        let per_length = counts / extent;
        Self { low, high, per_length, counts: counts.to_array().map(|count| count as usize), reach }
    }

    /// Largest extent of a cell.
    pub(super) fn cell(&self) -> f32 {
        self.per_length.recip().max_element()
    }

    /// Keeps the runs in cells in which triangles may touch. Returns a box around these cells.
    pub(super) fn keep_crowded(mut self, geometry: &Geometry, runs: &mut Vec<Run>) -> (Vec3, Vec3) {
        // Large triangles have many pieces, of about a cell each.
        let pieces: f32 = runs
            .iter()
            .map(|run| (run.high.min(self.high) - run.low.max(self.low)).max(Vec3::ZERO) * self.per_length)
            .filter(|cells| cells.max_element() > SMALL)
            .map(Vec3::length_squared)
            .sum();
        let limit = 4.0 * runs.len() as f32 + PIECES;
        if pieces > limit {
            let [x, y, z] = self.counts;
            self = Self::of(self.low, self.high, x.max(y).max(z) as f32 * (limit / pieces).sqrt(), self.reach);
        }
        let mut cells = vec![Cell::EMPTY; self.counts.iter().product()];
        for run in &*runs {
            let _ = self.each(geometry, run, &mut |cell| {
                cells[cell].add(run);
                ControlFlow::Continue(())
            });
        }
        let is_crowded =
            |cell: usize| if cells[cell].is_crowded() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        runs.retain(|run| self.each(geometry, run, &mut |cell| is_crowded(cell)).is_break());
        let crowded = (0..cells.len()).filter(|&cell| cells[cell].is_crowded());
        let [x, y, _] = self.counts;
        crowded.map(|cell| Vec3::new((cell % x) as f32, (cell / x % y) as f32, (cell / x / y) as f32)).fold(
            (self.high, self.low),
            |(low, high), at| {
                let cell = self.per_length.recip();
                let from = self.low + at * cell;
                (low.min(from), high.max(from + cell))
            },
        )
    }

    /// The cells of a run; of a large triangle, those of its pieces.
    fn each(
        &self,
        geometry: &Geometry,
        run: &Run,
        visit: &mut impl FnMut(usize) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let size = ((run.high - run.low) * self.per_length).max_element();
        if run.triangles.len() > 1 || size <= SMALL {
            return self.within(run.low, run.high, visit);
        }
        let corners = geometry.triangles[run.triangles.start as usize];
        self.pieces(corners.map(|at| Vec3::from_array(geometry.positions[at as usize])), visit)
    }

    /// The cells that the pieces of a triangle, of at most two cells, may have points in.
    fn pieces(&self, [a, b, c]: [Vec3; 3], visit: &mut impl FnMut(usize) -> ControlFlow<()>) -> ControlFlow<()> {
        let margin = Vec3::splat(self.reach);
        let (low, high) = (a.min(b).min(c) - margin, a.max(b).max(c) + margin);
        if low.cmpgt(self.high).any() || high.cmplt(self.low).any() {
            return ControlFlow::Continue(());
        }
        let edges = [b - a, c - b, a - c].map(|edge| (edge * self.per_length).length_squared());
        let longest = edges[0].max(edges[1]).max(edges[2]);
        if longest <= 4.0 {
            return self.within(low, high, visit);
        }
        // Renamed so that the longest edge is from a to b.
        let [a, b, c] = match longest {
            l if l == edges[0] => [a, b, c],
            l if l == edges[1] => [b, c, a],
            _ => [c, a, b],
        };
        let middle = 0.5 * (a + b);
        self.pieces([a, middle, c], visit)?;
        self.pieces([middle, b, c], visit)
    }

    /// The cells of a box.
    fn within(&self, low: Vec3, high: Vec3, visit: &mut impl FnMut(usize) -> ControlFlow<()>) -> ControlFlow<()> {
        if low.cmpgt(self.high).any() || high.cmplt(self.low).any() {
            return ControlFlow::Continue(());
        }
        let [from, to] = [low, high].map(|at| ((at - self.low) * self.per_length).to_array());
        let [x, y, z] = std::array::from_fn(|axis| {
            let last = self.counts[axis] - 1;
            // Conversion of a negative number gives 0.
            (from[axis] as usize).min(last)..=(to[axis] as usize).min(last)
        });
        for z in z {
            for y in y.clone() {
                for x in x.clone() {
                    visit((z * self.counts[1] + y) * self.counts[0] + x)?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}
