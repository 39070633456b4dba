//! Grids of NanoVDB: `.nvdb`, version 32.
//!
//! A file has segments: a header, metadata and a name for each of its grids, then the grids, of which each may be zipped. A
//! grid is a tree: a root with tiles of 4096³ voxels, nodes of 32³ and 16³ children, and leaves of 8³ voxels. Offsets of
//! children are relative to their parent.

use std::io::Read as _;

use flate2::read::ZlibDecoder;

use super::budget::Budget;
use super::grid::{Bytes, Fault, Refusal, check_cells};
use crate::describe::GridDesc;

/// Magic numbers of files, and of grids without a file around them.
const FILES: [&[u8]; 2] = [b"NanoVDB0", b"NanoVDB2"];
const GRID: &[u8] = b"NanoVDB1";

/// Bytes of the header of a segment, and of the metadata of a grid without its name.
const HEADER: u64 = 16;
const METADATA: u64 = 176;

/// Bytes of the header of a grid, which its tree follows.
const GRID_HEADER: u64 = 672;
/// Type of grids of 32-bit floats, and class of level sets.
const FLOAT: u32 = 1;
const LEVEL_SET: u32 = 1;

/// A node above the leaves: where its children's table and mask are, and how many children of how many voxels it has along
/// each axis.
struct Level {
    mask: u64,
    table: u64,
    children: i64,
    voxels: i64,
}

const LEVELS: [Level; 2] = [
    Level { mask: 4128, table: 8256, children: 32, voxels: 128 },
    Level { mask: 544, table: 1088, children: 16, voxels: 8 },
];
const ROOT_TILE: i64 = 4096;
const LEAF_VALUES: u64 = 96;

/// The hint for files that are damaged.
const AGAIN: &str = "it was cut off or damaged: write it again, by nanovdb_convert for example";

fn truncated() -> Fault {
    Fault::new("it ends within its tables", AGAIN)
}

/// Reads the grid of a file.
pub(super) fn parse(bytes: &[u8], budget: &Budget) -> Result<GridDesc, Refusal> {
    let file = Bytes(bytes);
    match file.slice(0, 8) {
        Some(magic) if magic == GRID => dense(Bytes(bytes), budget),
        Some(magic) if FILES.contains(&magic) => {
            let entry = choose(file)?;
            let body = entry.body(file, budget)?;
            dense(Bytes(&body), budget)
        }
        _ => {
            let hint = "it is no NanoVDB file; nanovdb_convert makes one of OpenVDB's .vdb";
            Err(Fault::new("it does not begin with NanoVDB0, 1 or 2", hint).into())
        }
    }
}

/// A grid of a file.
struct Entry {
    name: String,
    /// [`FLOAT`], or another.
    kind: u32,
    codec: u16,
    /// Start in the file, length there, and length unzipped.
    start: u64,
    stored: u64,
    length: u64,
}

/// The grid of densities among those of the file: the one that is called so, or the only one.
fn choose(file: Bytes<'_>) -> Result<Entry, Fault> {
    let mut entries = Vec::new();
    let mut at = 0;
    while at < file.0.len() as u64 {
        let version = file.u32(at + 8).ok_or_else(truncated)?;
        check_version(version)?;
        let count = file.u16(at + 12).ok_or_else(truncated)?;
        at += HEADER;
        let first = entries.len();
        for _ in 0..count {
            let word = |offset: u64| file.u64(at + offset).ok_or_else(truncated);
            let (length, stored) = (word(0)?, word(8)?);
            let kind = file.u32(at + 32).ok_or_else(truncated)?;
            let name_length = u64::from(file.u32(at + 136).ok_or_else(truncated)?);
            let codec = file.u16(at + 168).ok_or_else(truncated)?;
            let name = file.slice(at + METADATA, name_length).ok_or_else(truncated)?;
            let name = String::from_utf8_lossy(name).trim_end_matches('\0').to_owned();
            entries.push(Entry { name, kind, codec, start: 0, stored, length });
            at += METADATA + name_length;
        }
        for entry in &mut entries[first..] {
            entry.start = at;
            file.slice(at, entry.stored).ok_or_else(truncated)?;
            at += entry.stored;
        }
    }
    let names: Vec<String> = entries.iter().map(|entry| format!("'{}'", entry.name)).collect();
    let found = match entries.iter().position(|entry| entry.name == "density") {
        None if entries.len() == 1 => Some(0),
        found => found,
    };
    let Some(found) = found else {
        let what = format!("it has {} grids, {}, and none is called density", entries.len(), names.join(", "));
        return Err(Fault::new(what, "write the one of densities alone"));
    };
    Ok(entries.swap_remove(found))
}

fn check_version(version: u32) -> Result<(), Fault> {
    match version >> 21 {
        32 => Ok(()),
        other => {
            let hint = "version 32, which all libraries since 2021 write, is read: convert it again";
            Err(Fault::new(format!("it has the version {other} of NanoVDB"), hint))
        }
    }
}

fn check_kind(kind: u32, name: &str) -> Result<(), Fault> {
    if kind == FLOAT {
        return Ok(());
    }
    let hint = "grids of 32-bit floats are read: convert it with nanovdb_convert and without quantization";
    Err(Fault::new(format!("the grid '{name}' has the type {kind}"), hint))
}

impl Entry {
    /// The bytes of the grid.
    fn body(&self, file: Bytes<'_>, budget: &Budget) -> Result<Vec<u8>, Refusal> {
        check_kind(self.kind, &self.name)?;
        let stored = file.slice(self.start, self.stored).ok_or_else(truncated)?;
        match self.codec {
            0 => {
                budget.check(self.stored, || format!("the grid '{}'", self.name))?;
                Ok(stored.to_vec())
            }
            1 => {
                budget.check(self.length, || format!("the grid '{}'", self.name))?;
                let packed = Bytes(stored).u64(0).and_then(|length| Bytes(stored).slice(8, length));
                let mut body = Vec::new();
                // Grows with what there is, not with what the header says; one byte more tells that there is more.
                let limit = self.length.saturating_add(1);
                let read = ZlibDecoder::new(packed.ok_or_else(truncated)?).take(limit).read_to_end(&mut body);
                if read.is_err() || body.len() as u64 != self.length {
                    let what = format!(
                        "the grid '{}' has {} bytes unzipped instead of {}",
                        self.name,
                        body.len(),
                        self.length
                    );
                    return Err(Fault::new(what, AGAIN).into());
                }
                Ok(body)
            }
            _ => {
                let what = format!("the grid '{}' is compressed by BLOSC", self.name);
                Err(Fault::new(what, "write it uncompressed, or zipped: nanovdb_convert --zip").into())
            }
        }
    }
}

/// The densities of the box of active voxels.
fn dense(grid: Bytes<'_>, budget: &Budget) -> Result<GridDesc, Refusal> {
    let word = |at: u64| grid.u32(at).ok_or_else(truncated);
    check_version(word(16)?)?;
    check_kind(word(636)?, "of the file")?;
    if word(632)? == LEVEL_SET {
        let hint = "its values are distances from a surface: convert it to a fog volume, or use a mesh of the surface";
        return Err(Fault::new("it is a level set", hint).into());
    }
    let root = GRID_HEADER + grid.u64(GRID_HEADER + 24).ok_or_else(truncated)?.min(u64::from(u32::MAX));
    let coordinate = |at: u64| grid.i32(root + at).map(i64::from).ok_or_else(truncated);
    let mut low = [coordinate(0)?, coordinate(4)?, coordinate(8)?];
    let mut high = [coordinate(12)?, coordinate(16)?, coordinate(20)?];
    let background = grid.f32(root + 28).ok_or_else(truncated)?;
    if (0..3).any(|axis| low[axis] > high[axis]) {
        // No voxel is active.
        (low, high) = ([0; 3], [0; 3]);
    }
    let cells: [u64; 3] = std::array::from_fn(|axis| (high[axis] - low[axis] + 1) as u64);
    let count = check_cells(cells, budget)?;
    let mut voxels = Voxels { grid, low, high, densities: vec![background; count] };
    let tiles = word(root + 24)?;
    let mut keys = std::collections::HashSet::new();
    for tile in 0..u64::from(tiles) {
        let at = root + 64 + 32 * tile;
        let key = grid.u64(at).ok_or_else(truncated)?;
        // A tile that is there twice would be read twice.
        if !keys.insert(key) {
            return Err(Fault::new("two tiles of its root have the same place", AGAIN).into());
        }
        // The upper 20 bits of each coordinate.
        let origin = [key >> 42, key >> 21, key].map(|part| i64::from(((part as u32) << 12) as i32));
        let child = grid.u64(at + 8).ok_or_else(truncated)?;
        if child == 0 {
            voxels.fill(origin, ROOT_TILE, grid.f32(at + 20).ok_or_else(truncated)?);
        } else {
            voxels.node(0, root.wrapping_add(child), origin)?;
        }
    }
    let desc = GridDesc::new(cells.map(|cells| cells as u32), voxels.densities);
    place(grid, desc, low, cells).ok_or_else(|| truncated().into())
}

/// Places the grid by the map of the file, whose integers are the centres of voxels.
fn place(grid: Bytes<'_>, desc: GridDesc, low: [i64; 3], cells: [u64; 3]) -> Option<GridDesc> {
    let (matrix, shift) = (296 + 88, 296 + 88 + 144);
    let mut transform = desc.transform;
    for row in 0..3 {
        let mut corner = grid.f64(shift + 8 * row as u64)?;
        for axis in 0..3 {
            let part = grid.f64(matrix + 8 * (3 * row + axis) as u64)?;
            corner += part * (low[axis] as f64 - 0.5);
            transform[row][axis] = part * cells[axis] as f64;
        }
        transform[row][3] = corner;
    }
    Some(desc.with_transform(transform))
}

/// The voxels from `low` to `high`.
struct Voxels<'a> {
    grid: Bytes<'a>,
    low: [i64; 3],
    high: [i64; 3],
    densities: Vec<f32>,
}

impl Voxels<'_> {
    /// The part of the box along each axis, relative to a cube of `size` voxels at `origin`: first, and one beyond the last;
    /// `None` if it is outside.
    fn part(&self, origin: [i64; 3], size: i64) -> Option<[[i64; 2]; 3]> {
        let along =
            |axis: usize| [(self.low[axis] - origin[axis]).max(0), (self.high[axis] - origin[axis] + 1).min(size)];
        let part = [along(0), along(1), along(2)];
        part.iter().all(|[first, end]| first < end).then_some(part)
    }

    /// Sets a cube to one density.
    fn fill(&mut self, origin: [i64; 3], size: i64, density: f32) {
        let Some([x, y, z]) = self.part(origin, size) else { return };
        for k in z[0]..z[1] {
            for j in y[0]..y[1] {
                let first = self.index([origin[0] + x[0], origin[1] + j, origin[2] + k]);
                self.densities[first..first + (x[1] - x[0]) as usize].fill(density);
            }
        }
    }

    fn index(&self, at: [i64; 3]) -> usize {
        let [x, y, z] = std::array::from_fn(|axis| (at[axis] - self.low[axis]) as usize);
        let [across, deep] = [0, 1].map(|axis| (self.high[axis] - self.low[axis] + 1) as usize);
        (z * deep + y) * across + x
    }

    /// Reads a node at `at` of the file.
    fn node(&mut self, level: usize, at: u64, origin: [i64; 3]) -> Result<(), Fault> {
        let Some(Level { mask, table, children, voxels }) = LEVELS.get(level) else { return self.leaf(at, origin) };
        let Some(part) = self.part(origin, children * voxels) else { return Ok(()) };
        let [x, y, z] = part.map(|[first, end]| first / voxels..(end + voxels - 1) / voxels);
        for i in x {
            for j in y.clone() {
                for k in z.clone() {
                    let number = ((i * children + j) * children + k) as u64;
                    let bits = self.grid.u64(at.saturating_add(mask + number / 64 * 8)).ok_or_else(truncated)?;
                    let entry = at.saturating_add(table + 8 * number);
                    let corner = [origin[0] + i * voxels, origin[1] + j * voxels, origin[2] + k * voxels];
                    if bits >> (number % 64) & 1 == 1 {
                        let child = self.grid.u64(entry).ok_or_else(truncated)?;
                        self.node(level + 1, at.wrapping_add(child), corner)?;
                    } else {
                        let density = self.grid.f32(entry).ok_or_else(truncated)?;
                        self.fill(corner, *voxels, density);
                    }
                }
            }
        }
        Ok(())
    }

    fn leaf(&mut self, at: u64, origin: [i64; 3]) -> Result<(), Fault> {
        let values = at.checked_add(LEAF_VALUES).and_then(|at| self.grid.slice(at, 4 * 512)).ok_or_else(truncated)?;
        let Some([x, y, z]) = self.part(origin, 8) else { return Ok(()) };
        for k in z[0]..z[1] {
            for j in y[0]..y[1] {
                let first = self.index([origin[0] + x[0], origin[1] + j, origin[2] + k]);
                for (to, i) in self.densities[first..].iter_mut().zip(x[0]..x[1]) {
                    let from = 4 * (64 * i + 8 * j + k) as usize;
                    *to = f32::from_le_bytes([values[from], values[from + 1], values[from + 2], values[from + 3]]);
                }
            }
        }
        Ok(())
    }
}
