//! Grids of densities, as tables of bricks.

use super::{BRICK, BRICK_NODES, Grid, GridTables, NODES, STORED};
use crate::memory::{self, OutOfMemory};

/// Tables of [`GridTables`].
#[derive(Clone, Debug, Default)]
// Exhaustive: written as a literal.
pub struct OwnedGridTables {
    /// [`GridTables::grids`].
    pub grids: Vec<Grid>,
    /// [`GridTables::bricks`].
    pub bricks: Vec<u32>,
    /// [`GridTables::densities`].
    pub densities: Vec<f32>,
}

impl OwnedGridTables {
    /// The tables, borrowed.
    #[must_use]
    pub fn view(&self) -> GridTables<'_> {
        GridTables { grids: &self.grids, bricks: &self.bricks, densities: &self.densities }
    }

    /// Bytes of the tables.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let Self { grids, bricks, densities } = self;
        (size_of_val(&grids[..]) + size_of_val(&bricks[..]) + size_of_val(&densities[..])) as u64
    }

    /// Adds the bricks of `cells` densities ≥ 0, x fastest, as shares of `largest`, which is > 0. Returns the index of the
    /// first brick: [`Grid::first`].
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn add(&mut self, cells: [u32; 3], densities: &[f32], largest: f32) -> Result<u32, OutOfMemory> {
        const LABEL: &str = "grids of densities";
        let counts = cells.map(|cells| cells as usize);
        let [across, deep, high] = counts.map(|cells| cells / BRICK as usize + 1);
        let first = self.bricks.len();
        memory::reserve(&mut self.bricks, across * deep * high, LABEL)?;
        // Node `i` of an axis is the centre of the cell before, and the border has the density of the nearest one.
        let cell = |node: usize, axis: usize| node.saturating_sub(1).min(counts[axis] - 1);
        let mut nodes = [0.0; BRICK_NODES];
        let row = NODES as usize;
        for brick in 0..across * deep * high {
            let start = [brick % across, brick / across % deep, brick / across / deep].map(|at| at * BRICK as usize);
            for (at, node) in nodes.iter_mut().enumerate() {
                let [x, y, z] = [at % row, at / row % row, at / row / row];
                let line = cell(start[2] + z, 2) * counts[1] + cell(start[1] + y, 1);
                // A negative zero would have the highest bit.
                *node = densities[line * counts[0] + cell(start[0] + x, 0)] / largest + 0.0;
            }
            let even = nodes[0];
            self.bricks.push(if nodes.iter().all(|&node| node == even) {
                even.to_bits()
            } else {
                let index = self.densities.len() / BRICK_NODES;
                memory::reserve_doubling(&mut self.densities, BRICK_NODES, LABEL)?;
                self.densities.extend_from_slice(&nodes);
                STORED | index as u32
            });
        }
        Ok(first as u32)
    }
}

/// Copies the tables.
impl TryFrom<GridTables<'_>> for OwnedGridTables {
    type Error = OutOfMemory;

    fn try_from(tables: GridTables<'_>) -> Result<Self, OutOfMemory> {
        const LABEL: &str = "grids of densities";
        Ok(Self {
            grids: memory::copied(tables.grids, LABEL)?,
            bricks: memory::copied(tables.bricks, LABEL)?,
            densities: memory::copied(tables.densities, LABEL)?,
        })
    }
}
