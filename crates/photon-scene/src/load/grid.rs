//! Grids of densities from files.

use std::path::Path;

use super::budget::{Budget, LoadOptions};
use super::text::check_kind;
use super::{nvdb, read_within, vol};
use crate::describe::GridDesc;
use crate::error::SceneError;

/// A fault in the content of a file, and valid content.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) what: String,
    pub(super) hint: String,
}

impl Fault {
    pub(super) fn new(what: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { what: what.into(), hint: hint.into() }
    }
}

/// Why a grid is refused: its content, or memory.
#[derive(Debug)]
pub(super) enum Refusal {
    Content(Fault),
    Memory(super::budget::Shortage),
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Self {
        Self::Content(fault)
    }
}

impl From<super::budget::Shortage> for Refusal {
    fn from(shortage: super::budget::Shortage) -> Self {
        Self::Memory(shortage)
    }
}

impl GridDesc {
    /// Reads a grid of densities: Mitsuba's `.vol` (version 3, one channel, floats of 32 or 16 bits or bytes), or a grid of
    /// floats of a NanoVDB file, `.nvdb` (version 32, uncompressed or zipped; of several grids the one named `density`). The
    /// transform is that of the file's bounding box.
    ///
    /// # Errors
    /// A file that cannot be read, has another format or invalid densities; [`SceneError::Memory`] if it does not fit.
    pub fn read(path: &Path, options: &LoadOptions) -> Result<Self, SceneError> {
        Self::read_budgeted(path, &Budget::new(options))
    }

    pub(super) fn read_budgeted(path: &Path, budget: &Budget) -> Result<Self, SceneError> {
        let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        let is_vdb = match extension.as_deref() {
            Some("vol") => false,
            Some("nvdb") => true,
            _ => {
                let what = "unknown format of a grid of densities";
                let hint =
                    "supported are .vol of Mitsuba and .nvdb of NanoVDB; nanovdb_convert makes .nvdb of OpenVDB's .vdb";
                return Err(content(path, Fault::new(what, hint)));
            }
        };
        let bytes = read_within(path, budget, 1)?;
        check_kind(path, &bytes, &[if is_vdb { "nvdb" } else { "vol" }])?;
        let read = if is_vdb { nvdb::parse(&bytes, budget) } else { vol::parse(&bytes, budget) };
        let grid = read.map_err(|refusal| match refusal {
            Refusal::Content(fault) => content(path, fault),
            Refusal::Memory(shortage) => shortage.in_file(path),
        })?;
        match grid.fault() {
            None => Ok(grid),
            Some((property, value, hint)) => Err(content(path, Fault::new(format!("its {property} is {value}"), hint))),
        }
    }
}

fn content(path: &Path, Fault { what, hint }: Fault) -> SceneError {
    SceneError::Content { path: path.to_owned(), line: None, what, hint }
}

/// Checks that a grid has cells, and that they fit into memory; returns their number.
pub(super) fn check_cells(cells: [u64; 3], budget: &Budget) -> Result<usize, Refusal> {
    let count = cells.iter().try_fold(1_u64, |all, &cells| all.checked_mul(cells));
    match count {
        Some(count) if (1..=GridDesc::MAX_CELLS).contains(&count) => {
            budget.take(4 * count, || format!("the grid of {cells:?} cells"))?;
            Ok(count as usize)
        }
        _ => {
            let hint = "each side must have at least 1 cell, and all of it at most 2^27, such as 512x512x512: use a coarser grid";
            Err(Fault::new(format!("it has {cells:?} cells"), hint).into())
        }
    }
}

/// Little-endian numbers of a file; `None` beyond its end.
#[derive(Clone, Copy)]
pub(super) struct Bytes<'a>(pub(super) &'a [u8]);

impl<'a> Bytes<'a> {
    pub(super) fn slice(self, at: u64, length: u64) -> Option<&'a [u8]> {
        let end = at.checked_add(length)?;
        self.0.get(usize::try_from(at).ok()?..usize::try_from(end).ok()?)
    }

    fn array<const N: usize>(self, at: u64) -> Option<[u8; N]> {
        self.slice(at, N as u64)?.try_into().ok()
    }

    pub(super) fn u16(self, at: u64) -> Option<u16> {
        self.array(at).map(u16::from_le_bytes)
    }

    pub(super) fn u32(self, at: u64) -> Option<u32> {
        self.array(at).map(u32::from_le_bytes)
    }

    pub(super) fn i32(self, at: u64) -> Option<i32> {
        self.array(at).map(i32::from_le_bytes)
    }

    pub(super) fn u64(self, at: u64) -> Option<u64> {
        self.array(at).map(u64::from_le_bytes)
    }

    pub(super) fn f32(self, at: u64) -> Option<f32> {
        self.array(at).map(f32::from_le_bytes)
    }

    pub(super) fn f64(self, at: u64) -> Option<f64> {
        self.array(at).map(f64::from_le_bytes)
    }
}

#[cfg(test)]
mod tests;
