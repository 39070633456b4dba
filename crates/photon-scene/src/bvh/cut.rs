//! Cuts many primitives into chunks that lie apart, of which trees can be built at the same time. They are sorted into the
//! cells of a grid by their centres; then sets of cells are split in two by the surface area heuristic, as binned
//! primitives are (Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies").

use photon_core::parallel;

use super::binary::Padded;

/// Primitives in a chunk, at most, unless their boxes have the same centre.
pub(crate) const CHUNK: usize = 1 << 14;

/// Primitives that a thread takes at a time.
const PIECE: usize = 1 << 15;

/// Cells along each axis.
const CELLS: usize = 32;

/// The top of a tree, and the chunks below it.
pub(crate) struct Cut {
    /// The root first, children adjacent and after their parents.
    pub(crate) nodes: Vec<Top>,
    /// Primitives of each chunk, by increasing index.
    pub(crate) chunks: Vec<Vec<u32>>,
}

/// A node of the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Top {
    /// Index of the first of two adjacent children.
    Inner(u32),
    /// Index of a chunk.
    Chunk(u32),
}

/// Cuts all primitives into chunks. The result does not depend on the number of threads.
pub(crate) fn cut(boxes: &[Padded], threads: usize) -> Cut {
    let mut cut = Cut { nodes: vec![Top::Chunk(0)], chunks: Vec::new() };
    let mut open = vec![(0, (0..boxes.len() as u32).collect::<Vec<u32>>())];
    while let Some((place, ids)) = open.pop() {
        match (ids.len() > CHUNK).then(|| Sorted::of(boxes, &ids, threads)).flatten() {
            // A cell may hold too many, which get a grid of their own.
            Some(sorted) => open.extend(sorted.split(place, &ids, &mut cut.nodes, threads)),
            None => {
                cut.nodes[place] = Top::Chunk(cut.chunks.len() as u32);
                cut.chunks.push(ids);
            }
        }
    }
    cut
}

/// Bounds of the primitives in a cell, and their number.
#[derive(Clone, Copy)]
struct Cell {
    low: [f32; 3],
    high: [f32; 3],
    count: u32,
}

impl Cell {
    const EMPTY: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3], count: 0 };

    fn add(&mut self, other: &Self) {
        for axis in 0..3 {
            self.low[axis] = self.low[axis].min(other.low[axis]);
            self.high[axis] = self.high[axis].max(other.high[axis]);
        }
        self.count += other.count;
    }

    /// Number times half of the surface; 0 for an empty cell.
    fn cost(&self) -> f32 {
        let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| (self.high[axis] - self.low[axis]).max(0.0));
        (x * y + y * z + z * x) * self.count as f32
    }
}

/// Twice the centre of a box.
fn centre(padded: &Padded) -> [f32; 3] {
    std::array::from_fn(|axis| padded.low[axis] + padded.high[axis])
}

/// Primitives in the cells of a grid over their centres.
struct Sorted {
    /// The cells that are not empty, with their index in the grid.
    cells: Vec<(u16, Cell)>,
    /// The cell of each primitive, piece by piece.
    homes: Vec<Vec<u16>>,
}

impl Sorted {
    /// `None` if all centres are the same.
    fn of(boxes: &[Padded], ids: &[u32], threads: usize) -> Option<Self> {
        let centres = parallel::map(threads, ids.chunks(PIECE), |_, ids| {
            ids.iter().map(|&id| centre(&boxes[id as usize])).fold(Cell::EMPTY, |mut all, at| {
                all.add(&Cell { low: at, high: at, count: 0 });
                all
            })
        });
        let all = centres.iter().fold(Cell::EMPTY, |mut all, part| {
            all.add(part);
            all
        });
        let scale: [f32; 3] = std::array::from_fn(|axis| {
            let extent = all.high[axis] - all.low[axis];
            let scale = CELLS as f32 / extent;
            if extent > 0.0 && scale.is_finite() { scale } else { 0.0 }
        });
        if scale == [0.0; 3] {
            return None;
        }
        let home = |at: [f32; 3]| {
            let place = |axis: usize| (((at[axis] - all.low[axis]) * scale[axis]) as usize).min(CELLS - 1);
            (place(0) * CELLS + place(1)) * CELLS + place(2)
        };
        let parts = parallel::map(threads, ids.chunks(PIECE), |_, ids| {
            let mut grid = vec![Cell::EMPTY; CELLS.pow(3)];
            let homes = ids.iter().map(|&id| {
                let padded = &boxes[id as usize];
                let home = home(centre(padded));
                grid[home].add(&Cell { low: padded.low, high: padded.high, count: 1 });
                home as u16
            });
            let homes: Vec<u16> = homes.collect();
            (homes, grid)
        });
        let mut grid = vec![Cell::EMPTY; CELLS.pow(3)];
        let mut homes = Vec::with_capacity(parts.len());
        for (part, own) in parts {
            homes.push(part);
            grid.iter_mut().zip(&own).filter(|(_, own)| own.count > 0).for_each(|(cell, own)| cell.add(own));
        }
        let cells = (0..).zip(grid).filter(|(_, cell)| cell.count > 0).collect();
        Some(Self { cells, homes })
    }

    /// Splits sets of cells as long as they hold too many. Returns nodes of the top and their primitives.
    fn split(self, place: usize, ids: &[u32], nodes: &mut Vec<Top>, threads: usize) -> Vec<(usize, Vec<u32>)> {
        // The part that the primitives of each cell go to.
        let mut part_of = vec![0_u16; CELLS.pow(3)];
        let mut places = Vec::new();
        let mut open = vec![(place, self.cells)];
        while let Some((place, cells)) = open.pop() {
            let count: u32 = cells.iter().map(|(_, cell)| cell.count).sum();
            if count as usize <= CHUNK || cells.len() == 1 {
                cells.iter().for_each(|&(home, _)| part_of[home as usize] = places.len() as u16);
                places.push(place);
                continue;
            }
            let (axis, at) = best_split(&cells);
            let (first, second) = cells.into_iter().partition(|&(home, _)| along(home, axis) < at);
            nodes[place] = Top::Inner(nodes.len() as u32);
            open.extend([(nodes.len() + 1, second), (nodes.len(), first)]);
            nodes.extend([Top::Chunk(0); 2]);
        }
        let pieces = ids.chunks(PIECE).zip(&self.homes);
        let parts = parallel::map(threads, pieces, |_, (ids, homes)| {
            let mut parts = vec![Vec::new(); places.len()];
            ids.iter().zip(homes).for_each(|(&id, &home)| parts[part_of[home as usize] as usize].push(id));
            parts
        });
        let all = |part: usize| parts.iter().flat_map(|parts: &Vec<Vec<u32>>| &parts[part]).copied().collect();
        places.iter().enumerate().map(|(part, &place)| (place, all(part))).collect()
    }
}

/// Position of a cell along an axis.
fn along(home: u16, axis: usize) -> usize {
    home as usize / CELLS.pow(2 - axis as u32) % CELLS
}

/// Axis and position of the split of at least two cells that costs least, the first of several.
fn best_split(cells: &[(u16, Cell)]) -> (usize, usize) {
    let mut best = (f32::INFINITY, (0, 0));
    for axis in 0..3 {
        let mut slabs = [Cell::EMPTY; CELLS];
        cells.iter().for_each(|(home, cell)| slabs[along(*home, axis)].add(cell));
        let mut above = slabs;
        for at in (0..CELLS - 1).rev() {
            let next = above[at + 1];
            above[at].add(&next);
        }
        let mut below = Cell::EMPTY;
        for at in 1..CELLS {
            below.add(&slabs[at - 1]);
            let cost = below.cost() + above[at].cost();
            if below.count > 0 && above[at].count > 0 && cost < best.0 {
                best = (cost, (axis, at));
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests;
