//! Grids of Mitsuba: `.vol`, version 3.

use half::f16;

use super::budget::Budget;
use super::grid::{Bytes, Fault, Refusal, check_cells};
use crate::describe::GridDesc;

/// Bytes before the densities.
const HEADER: u64 = 48;

/// Reads the grid of a file.
pub(super) fn parse(bytes: &[u8], budget: &Budget) -> Result<GridDesc, Refusal> {
    let file = Bytes(bytes);
    let hint = "write it by mitsuba.VolumeGrid.write, or as Mitsuba's manual describes a gridvolume";
    if file.slice(0, 3) != Some(b"VOL") {
        return Err(Fault::new("it does not begin with VOL", hint).into());
    }
    let truncated = || Fault::new(format!("it ends after {} bytes, within its header", bytes.len()), hint);
    let version = file.slice(3, 1).ok_or_else(truncated)?[0];
    if version != 3 {
        return Err(Fault::new(format!("it has the version {version} instead of 3"), hint).into());
    }
    let word = |at: u64| file.i32(at).ok_or_else(truncated);
    let (encoding, channels) = (word(4)?, word(20)?);
    let cells = [word(8)?, word(12)?, word(16)?];
    let mut corners = [[0.0; 3]; 2];
    for (at, part) in (0..).zip(corners.as_flattened_mut()) {
        *part = f64::from(file.f32(24 + 4 * at).ok_or_else(truncated)?);
    }
    let size: u64 = match encoding {
        1 => 4,
        2 => 2,
        3 => 1,
        _ => {
            let what = format!("it has the encoding {encoding}");
            return Err(Fault::new(what, "1, 32-bit floats, 2, 16-bit floats, and 3, bytes, are read").into());
        }
    };
    if channels != 1 {
        let hint = "densities have one; write the luminance, or leave the grid out";
        return Err(Fault::new(format!("it has {channels} channels"), hint).into());
    }
    // Before anything is allocated by the numbers of a header.
    let positive = cells.map(|cells| u64::try_from(cells).unwrap_or(0));
    let needed = positive.iter().try_fold(size, |all, &cells| all.checked_mul(cells));
    let present = (bytes.len() as u64).saturating_sub(HEADER);
    if needed.is_none_or(|needed| needed > present) {
        let what = format!("it has {present} bytes of densities, too few for {cells:?} cells");
        return Err(Fault::new(what, "it was cut off, or its header is wrong: write it again").into());
    }
    let count = check_cells(positive, budget)?;
    let data = &bytes[HEADER as usize..HEADER as usize + count * size as usize];
    let densities: Vec<f32> = match size {
        4 => data.as_chunks::<4>().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect(),
        2 => data.as_chunks::<2>().0.iter().map(|&bytes| f16::from_le_bytes(bytes).to_f32()).collect(),
        _ => data.iter().map(|&byte| f32::from(byte) / 255.0).collect(),
    };
    let grid = GridDesc::new(positive.map(|cells| cells as u32), densities);
    let [low, high] = corners;
    // Files that are placed by a transform alone may have no box.
    let has_box = (0..3).all(|axis| low[axis] < high[axis] && low[axis].is_finite() && high[axis].is_finite());
    Ok(if has_box { grid.with_box(low, high) } else { grid })
}
