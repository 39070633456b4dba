//! Columns of density at many places of one ray.

use glam::Vec3;

use super::{Density, Line};

/// Number of parts of a ray whose columns are kept.
pub const KNOTS: usize = 32;

/// The columns along a part of a ray up to the ends of its even parts within the grid, from which those to all places follow
/// exactly by a walk within one part.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a> {
    density: Density<'a>,
    line: Line,
    start: f32,
    step: f32,
    knots: [f32; KNOTS + 1],
}

impl<'a> Columns<'a> {
    /// Of a ray from `origin` along the unit vector `direction`, from one distance to another.
    #[must_use]
    pub fn new(density: Density<'a>, origin: Vec3, direction: Vec3, ends: [f32; 2]) -> Self {
        let line = density.line(origin, direction);
        let [start, end] = density.within_box(&line, ends);
        let mut columns = Self { density, line, start, step: (end - start) / KNOTS as f32, knots: [0.0; KNOTS + 1] };
        // The ray may miss the grid.
        if start < end {
            for part in 0..KNOTS {
                let (column, _) = density.walk(&line, columns.part(part), f32::INFINITY);
                columns.knots[part + 1] = columns.knots[part] + column;
            }
        }
        columns
    }

    /// The ends of a part.
    fn part(&self, part: usize) -> [f32; 2] {
        [part, part + 1].map(|number| self.start + number as f32 * self.step)
    }

    /// The column of all of it.
    #[must_use]
    pub fn total(&self) -> f32 {
        self.knots[KNOTS]
    }

    /// The column from its start to a distance of the ray; beyond its end that of all of it.
    #[must_use]
    pub fn to(&self, distance: f32) -> f32 {
        // Conversion also turns what is before the start into 0.
        let part = (((distance - self.start) / self.step) as usize).min(KNOTS - 1);
        let [from, end] = self.part(part);
        self.knots[part] + self.density.walk(&self.line, [from, distance.min(end)], f32::INFINITY).0
    }

    /// The density at a distance of the ray.
    #[must_use]
    pub fn density(&self, distance: f32) -> f32 {
        self.density.at_node(self.line.origin + self.line.direction * distance)
    }

    /// The distance of the ray up to which it has a column; the end of the part that has any, if all of it has less.
    #[must_use]
    pub fn place(&self, column: f32) -> f32 {
        let part = self.knots.partition_point(|&before| before < column).clamp(1, KNOTS) - 1;
        self.density.walk(&self.line, self.part(part), column - self.knots[part]).1
    }
}
