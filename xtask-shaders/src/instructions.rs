//! The instructions of a SPIR-V module.

/// Words before the first instruction.
pub(crate) const HEADER: usize = 5;

/// `OpTypeVoid` to `OpTypeForwardPointer`: types follow the decorations.
const TYPES: std::ops::RangeInclusive<u32> = 19..=39;

/// Instructions, and where they begin.
pub(crate) fn instructions(words: &[u32]) -> impl Iterator<Item = (usize, &[u32])> {
    let mut at = HEADER;
    std::iter::from_fn(move || {
        let start = at;
        let length = (words.get(start)? >> 16) as usize;
        at += length.max(1);
        Some((start, words.get(start..at)?))
    })
}

/// The module with further decorations.
pub(crate) fn before_types(words: &[u32], added: &[u32]) -> Vec<u32> {
    let mut types = instructions(words).filter(|(_, instruction)| TYPES.contains(&(instruction[0] & 0xFFFF)));
    let (before, after) = words.split_at(types.next().map_or(words.len(), |(at, _)| at));
    [before, added, after].concat()
}

/// An instruction.
#[cfg(test)]
pub(crate) fn op(code: u32, operands: &[u32]) -> Vec<u32> {
    [&[(operands.len() as u32 + 1) << 16 | code], operands].concat()
}
