//! Columns of density at many places of one segment.

use glam::Vec3;

use super::{Density, Line};

/// Number of parts of a segment whose columns are kept.
pub const KNOTS: usize = 32;

/// The columns from the start of a segment to the ends of its even parts, from which those to all places follow exactly by a
/// walk within one part.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a> {
    density: Density<'a>,
    line: Line,
    step: f32,
    knots: [f32; KNOTS + 1],
}

impl<'a> Columns<'a> {
    /// Of a segment of `length` > 0 from `origin` along the unit vector `direction`.
    #[must_use]
    pub fn new(density: Density<'a>, origin: Vec3, direction: Vec3, length: f32) -> Self {
        let line = density.line(origin, direction);
        let step = length / KNOTS as f32;
        let mut knots = [0.0; KNOTS + 1];
        for part in 0..KNOTS {
            let (column, _) = density.walk(&line, Self::part(step, part), f32::INFINITY);
            knots[part + 1] = knots[part] + column;
        }
        Self { density, line, step, knots }
    }

    /// The ends of a part.
    fn part(step: f32, part: usize) -> [f32; 2] {
        [part as f32 * step, (part + 1) as f32 * step]
    }

    /// The column of all of it.
    #[must_use]
    pub fn total(&self) -> f32 {
        self.knots[KNOTS]
    }

    /// The column from its start to a distance; beyond its end that of all of it.
    #[must_use]
    pub fn to(&self, distance: f32) -> f32 {
        // Truncation also turns what is before the start into 0.
        let part = ((distance / self.step) as usize).min(KNOTS - 1);
        let [from, end] = Self::part(self.step, part);
        self.knots[part] + self.density.walk(&self.line, [from, distance.min(end)], f32::INFINITY).0
    }

    /// The density at a distance from its start.
    #[must_use]
    pub fn density(&self, distance: f32) -> f32 {
        self.density.at_node(self.line.origin + self.line.direction * distance)
    }

    /// The distance from its start within which it has a column.
    #[must_use]
    pub fn place(&self, column: f32) -> f32 {
        let part = self.knots.partition_point(|&before| before < column).clamp(1, KNOTS) - 1;
        self.density.walk(&self.line, Self::part(self.step, part), column - self.knots[part]).1
    }
}
