//! Grids of densities: media whose coefficients differ from place to place by a common factor.
//!
//! Densities are trilinear between cell centres, clamped at the border and 0 outside of the grid's box. The integral of the
//! density along a ray, its *column*, is exact: along a line the density is a cubic in each cell, which Simpson's rule
//! integrates. All channels share the column, so that flights, deposits and transmittances are those of a homogeneous medium
//! ([`crate::flight`]) with the column in place of the distance; the place of a column is found in the cell where it ends.
//! Nothing is estimated by random numbers, and no majorants are needed.
//!
//! Cells are stored in bricks of 8³ with the nodes of their borders; bricks of one density, such as empty ones, have none,
//! and are crossed in one step.

mod bricks;
mod columns;
#[cfg(test)]
mod tests;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::medium::Medium;
pub use bricks::OwnedGridTables;
pub use columns::{Columns, KNOTS};

/// Number of cells of a brick along each axis.
pub const BRICK: u32 = 8;
/// Number of nodes of a brick along each axis.
pub const NODES: u32 = 9;
/// Bit of [`GridTables::bricks`]: the brick has nodes.
pub const STORED: u32 = 1 << 31;
/// Number of nodes of a brick.
const BRICK_NODES: usize = (NODES * NODES * NODES) as usize;

/// A grid of densities, for the medium with the same index; one without cells, of density 1 everywhere, for a medium without.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Grid {
    /// First row of the affine map from normalised space to nodes. The centre of cell `i`, from 0, is at the coordinate
    /// `i + 1`, and the box is from ½ to the number of cells and ½.
    pub x: [f32; 4],
    /// Second row.
    pub y: [f32; 4],
    /// Third row.
    pub z: [f32; 4],
    /// Number of cells along each axis.
    pub cells: [u32; 3],
    /// Index of its first brick in [`GridTables::bricks`]; there are `cells / 8 + 1` along each axis, x fastest.
    pub first: u32,
}

/// Grids of densities of a scene.
// Exhaustive: written as a literal.
#[derive(Clone, Copy, Debug, Default)]
pub struct GridTables<'a> {
    /// One for each entry of [`crate::SceneView::media`]; empty if no medium has one.
    pub grids: &'a [Grid],
    /// The bits of a density ≥ 0, which all of a brick has; or with the highest bit the index of its 9³ nodes in
    /// `densities`, in units of that.
    pub bricks: &'a [u32],
    /// Densities of the nodes of bricks, from 0 to 1, x fastest: in a brick the first node along an axis is also the last of
    /// the one before.
    pub densities: &'a [f32],
}

impl<'a> GridTables<'a> {
    /// The densities of the medium with this index; `None` if it is homogeneous.
    #[inline]
    #[must_use]
    pub fn of(&self, medium: u32) -> Option<Density<'a>> {
        let grid = self.grids.get(medium as usize).filter(|grid| grid.cells[0] > 0)?;
        Some(Density { grid, bricks: self.bricks, densities: self.densities })
    }
}

impl GridTables<'_> {
    /// Whether a word is a valid entry of [`Self::bricks`], with a table of so many densities.
    pub(super) fn is_brick(word: u32, densities: usize) -> bool {
        if word & STORED == 0 {
            return (0.0..=1.0).contains(&f32::from_bits(word));
        }
        ((word & !STORED) as usize) < densities / BRICK_NODES
    }
}

/// The densities of one medium.
#[derive(Clone, Copy, Debug)]
pub struct Density<'a> {
    grid: &'a Grid,
    bricks: &'a [u32],
    densities: &'a [f32],
}

/// A ray in the coordinates of nodes, by the distances of normalised space.
#[derive(Clone, Copy, Debug)]
struct Line {
    origin: Vec3,
    direction: Vec3,
    inverse: Vec3,
}

/// The densities of a brick: one, or its nodes.
enum Brick<'a> {
    Even(f32),
    Stored(&'a [f32]),
}

/// Largest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// [`Density::is_thick`].
pub const THICK: f32 = 8.0;

/// Steps towards the place of a column within a cell.
pub const ROOT_STEPS: u32 = 16;

impl Density<'_> {
    /// The density at a point, from 0 to 1.
    #[must_use]
    pub fn at(&self, point: Vec3) -> f32 {
        self.at_node(self.node(point.extend(1.0).to_array()))
    }

    /// The density at a place in the coordinates of nodes.
    fn at_node(&self, at: Vec3) -> f32 {
        let last = Vec3::from(self.grid.cells.map(|cells| cells as f32));
        if at.cmplt(Vec3::splat(0.5)).any() || at.cmpgt(last + 0.5).any() {
            return 0.0;
        }
        let cell = self.cell(at);
        match self.brick(cell) {
            Brick::Even(density) => density,
            Brick::Stored(nodes) => interpolate(
                &corners(nodes, cell),
                (at - Vec3::from(cell.map(|c| c as f32))).clamp(Vec3::ZERO, Vec3::ONE),
            ),
        }
    }

    /// Integral of the density along a ray from one distance to another.
    #[must_use]
    pub fn column(&self, origin: Vec3, direction: Vec3, [from, to]: [f32; 2]) -> f32 {
        self.walk(&self.line(origin, direction), [from, to], f32::INFINITY).0
    }

    /// Goes along a ray from one distance to another, until the column is `limit`: the column, and the distance there; all of
    /// it, and the end of the part that has any, if it has less.
    #[must_use]
    pub fn until(&self, origin: Vec3, direction: Vec3, ends: [f32; 2], limit: f32) -> (f32, f32) {
        self.walk(&self.line(origin, direction), ends, limit)
    }

    /// Whether all channels of a medium have an optical depth above [`THICK`] along each axis of the grid, if its largest density
    /// filled it: then most photons collide, and are stored where they do, which takes a walk through the cells up to there. In
    /// others they are stored where they are expected to, for which the column of the whole ray is needed.
    #[inline]
    #[must_use]
    pub fn is_thick(&self, medium: &Medium) -> bool {
        let Grid { x, y, z, cells, .. } = self.grid;
        let least = medium.extinction().min_element();
        [x, y, z].iter().zip(cells).all(|(row, &cells)| {
            let (across, row) = (least * cells as f32, Vec3::new(row[0], row[1], row[2]));
            across * across > THICK * THICK * row.dot(row)
        })
    }

    fn node(&self, [x, y, z, w]: [f32; 4]) -> Vec3 {
        let Grid { x: first, y: second, z: third, .. } = self.grid;
        [first, second, third].map(|row| row[0] * x + row[1] * y + row[2] * z + row[3] * w).into()
    }

    fn line(&self, origin: Vec3, direction: Vec3) -> Line {
        let direction = self.node(direction.extend(0.0).to_array());
        // Without infinities, which give NaN for rays in the planes between cells.
        let reciprocal = |part: f32| if part.abs() < 1e-12 { 1e12_f32.copysign(part) } else { 1.0 / part };
        let inverse = direction.to_array().map(reciprocal).into();
        Line { origin: self.node(origin.extend(1.0).to_array()), direction, inverse }
    }

    /// The cell around a place, between node `i` and the next.
    fn cell(&self, at: Vec3) -> [i32; 3] {
        let cells = self.grid.cells;
        std::array::from_fn(|axis| (at[axis].floor() as i32).clamp(0, cells[axis] as i32))
    }

    fn brick(&self, cell: [i32; 3]) -> Brick<'_> {
        let [x, y, z] = cell.map(|c| c as usize / BRICK as usize);
        let [across, deep, _] = self.grid.cells.map(|cells| (cells / BRICK) as usize + 1);
        let entry = self.bricks[self.grid.first as usize + (z * deep + y) * across + x];
        if entry & STORED == 0 {
            return Brick::Even(f32::from_bits(entry));
        }
        let start = (entry & !STORED) as usize * BRICK_NODES;
        Brick::Stored(&self.densities[start..start + BRICK_NODES])
    }

    /// The part of a line within the box of the grid; it ends before it starts where the line misses the box.
    fn within_box(&self, line: &Line, [from, to]: [f32; 2]) -> [f32; 2] {
        let last = Vec3::from(self.grid.cells.map(|cells| cells as f32 + 0.5));
        let [low, high] = [Vec3::splat(0.5), last].map(|edge| (edge - line.origin) * line.inverse);
        [low.min(high).max_element().max(from), low.max(high).min_element().min(to)]
    }

    /// Goes along a line through the cells and bricks from one distance to another, until the column is `limit`: the column,
    /// and the distance there.
    fn walk(&self, line: &Line, [from, to]: [f32; 2], limit: f32) -> (f32, f32) {
        let [mut t, end] = self.within_box(line, [from, to]);
        let (mut column, mut reached) = (0.0_f32, t.min(to));
        if !(t < end) {
            return (column, reached);
        }
        let mut cell = self.cell(line.origin + line.direction * t);
        // The density at `t`, where a part has ended: it is continuous.
        let mut density_here = None;
        // Rounding may repeat a cell beside a brick that is crossed in one step.
        let most = 2 * self.grid.cells.iter().sum::<u32>() + 16;
        for _ in 0..most {
            let brick = self.brick(cell);
            let (first, width) = match brick {
                Brick::Even(_) => (cell.map(|c| c / BRICK as i32 * BRICK as i32), BRICK as i32),
                Brick::Stored(_) => (cell, 1),
            };
            let edge: Vec3 = std::array::from_fn::<f32, 3, _>(|axis| {
                (first[axis] + if line.inverse[axis] > 0.0 { width } else { 0 }) as f32
            })
            .into();
            let exits = (edge - line.origin) * line.inverse;
            let axis = if exits.x <= exits.y && exits.x <= exits.z { 0 } else { 1 + usize::from(exits.z < exits.y) };
            let next = exits[axis].clamp(t, end);
            let length = next - t;
            let part = match brick {
                Brick::Even(density) => {
                    let part = density * length;
                    if part > 0.0 && column + part >= limit {
                        return (limit, (t + (limit - column) / density).clamp(t, next));
                    }
                    density_here = Some(density);
                    part
                }
                Brick::Stored(nodes) => {
                    let base = Vec3::from(cell.map(|c| c as f32));
                    let within = |t: f32| (line.origin + line.direction * t - base).clamp(Vec3::ZERO, Vec3::ONE);
                    let along = Part { corners: corners(nodes, cell), from: within(t), to: within(next), length };
                    let enters = density_here.unwrap_or_else(|| interpolate(&along.corners, along.from));
                    let leaves = interpolate(&along.corners, along.to);
                    let part = simpson(enters, along.density(0.5), leaves, length);
                    density_here = Some(leaves);
                    if part > 0.0 && column + part >= limit {
                        return (limit, (t + length * along.share(limit - column)).clamp(t, next));
                    }
                    part
                }
            };
            column += part;
            if part > 0.0 {
                reached = next;
            }
            if next >= end {
                break;
            }
            t = next;
            if width > 1 {
                let at = line.origin + line.direction * t;
                let found = self.cell(at);
                cell = std::array::from_fn(|axis| found[axis].clamp(first[axis], first[axis] + width - 1));
            }
            cell[axis] = if line.inverse[axis] > 0.0 { first[axis] + width } else { first[axis] - 1 };
            if cell[axis] < 0 || cell[axis] > self.grid.cells[axis] as i32 {
                break;
            }
        }
        (column, reached)
    }
}

/// A line through a cell.
struct Part {
    corners: [f32; 8],
    /// Its ends, as shares of the cell.
    from: Vec3,
    to: Vec3,
    length: f32,
}

impl Part {
    fn density(&self, share: f32) -> f32 {
        interpolate(&self.corners, self.from + (self.to - self.from) * share)
    }

    /// The column of a first share of it.
    fn column(&self, share: f32) -> f32 {
        simpson(self.density(0.0), self.density(0.5 * share), self.density(share), self.length * share)
    }

    /// The share that has a column: by Newton's steps, or halves where they leave the bracket.
    fn share(&self, column: f32) -> f32 {
        let (mut low, mut high) = (0.0, 1.0);
        let mut share = (column / self.column(1.0)).min(BELOW_ONE);
        for _ in 0..ROOT_STEPS {
            let excess = self.column(share) - column;
            if excess > 0.0 {
                high = share;
            } else {
                low = share;
            }
            let next = share - excess / (self.length * self.density(share));
            // Not at a density of 0 either.
            share = if next >= low && next <= high { next } else { 0.5 * (low + high) };
        }
        share
    }
}

/// The column of a part of a cell from the densities at its ends and in the middle: Simpson's rule, exact for a cubic.
#[inline(always)]
fn simpson(first: f32, middle: f32, last: f32, length: f32) -> f32 {
    length * ((first + 4.0 * middle + last) * (1.0 / 6.0))
}

/// The densities at the corners of a cell, x fastest.
#[inline(always)]
fn corners(nodes: &[f32], cell: [i32; 3]) -> [f32; 8] {
    const ROW: usize = NODES as usize;
    let [x, y, z] = cell.map(|c| c as usize % BRICK as usize);
    let first = (z * ROW + y) * ROW + x;
    std::array::from_fn(|corner| nodes[first + (corner & 1) + (corner >> 1 & 1) * ROW + (corner >> 2) * ROW * ROW])
}

#[inline(always)]
fn interpolate(corners: &[f32; 8], at: Vec3) -> f32 {
    let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
    let x = |first: usize| mix(corners[first], corners[first + 1], at.x);
    mix(mix(x(0), x(2), at.y), mix(x(4), x(6), at.y), at.z)
}
