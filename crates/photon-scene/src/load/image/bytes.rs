//! Conversion of interleaved bytes to words.

/// Appends texels of one (grey), two (grey, alpha), three or four channels as words.
pub(super) fn append(words: &mut Vec<u32>, bytes: &[u8], channels: usize) {
    match channels {
        1 => words.extend(bytes.iter().map(|&grey| word([grey, grey, grey, 255]))),
        2 => words.extend(bytes.as_chunks().0.iter().map(|&[grey, alpha]| word([grey, grey, grey, alpha]))),
        3 => words.extend(bytes.as_chunks().0.iter().map(|&[r, g, b]| word([r, g, b, 255]))),
        _ => words.extend(bytes.as_chunks().0.iter().map(|&texel| word(texel))),
    }
}

fn word(texel: [u8; 4]) -> u32 {
    u32::from_le_bytes(texel)
}

/// Rounds big-endian values of 16 bits to 8.
pub(super) fn narrow(wide: &[u8]) -> Vec<u8> {
    let round = |pair: &[u8; 2]| ((u32::from(u16::from_be_bytes(*pair)) * 255 + 32_767) / 65_535) as u8;
    wide.as_chunks().0.iter().map(round).collect()
}
