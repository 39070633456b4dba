//! Mode 2: a sequence of indices, each near one of the last two.

use super::stream::{TRUNCATED, split, unzigzag};

/// Length of the tail, which is padding.
const TAIL: usize = 4;

/// Decodes `count` indices.
pub(super) fn decode(bytes: &[u8], count: usize) -> Result<Vec<u32>, &'static str> {
    let (&header, rest) = bytes.split_first().ok_or(TRUNCATED)?;
    if header != 0xd1 {
        return Err("its first byte is not that of a sequence of indices");
    }
    let (mut stream, _) = split(rest, TAIL)?;
    let mut last = [0_u32; 2];
    // Each index takes a byte at least, so that a wrong count cannot request memory.
    let mut indices = Vec::with_capacity(count.min(bytes.len()));
    for _ in 0..count {
        let code = stream.number()?;
        let last = &mut last[(code & 1) as usize];
        *last = last.wrapping_add(unzigzag(code >> 1));
        indices.push(*last);
    }
    stream.end()?;
    Ok(indices)
}
