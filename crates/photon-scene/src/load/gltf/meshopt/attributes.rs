//! Mode 0: records of equal length, whose bytes are stored as differences to those of the record before.

use super::stream::{Stream, TRUNCATED, split, unzigzag};

/// Records of a group, which share a number of bits.
const GROUP: usize = 16;
/// Largest number of records of a block.
const MAX_BLOCK: usize = 256;

/// Bits for each difference by the two header bits of a group, for version 0 and for the control modes 0 and 1.
const BITS_0: [u32; 4] = [0, 2, 4, 8];
const BITS: [[u32; 4]; 2] = [[0, 1, 2, 4], [1, 2, 4, 8]];

/// How the differences of four neighbouring bytes of records are defined.
#[derive(Clone, Copy)]
enum Channel {
    /// Each byte for itself.
    Bytes,
    /// As two 16-bit integers.
    Words,
    /// As a 32-bit integer: exclusive or, rotated to the left by that many bits.
    Xor(u32),
}

/// Decodes `count` records of `stride` bytes, a multiple of 4 up to 256.
pub(super) fn decode(bytes: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, &'static str> {
    let (&header, rest) = bytes.split_first().ok_or(TRUNCATED)?;
    let (modes, least_tail) = match header {
        0xa0 => (0, 32),
        0xa1 => (stride / 4, 24),
        _ => return Err("its first byte is not that of attributes"),
    };
    let (mut stream, tail) = split(rest, (stride + modes).max(least_tail))?;
    let (first, modes) = tail[tail.len() - stride - modes..].split_at(stride);
    let mut channels = vec![Channel::Bytes; stride / 4];
    for (channel, &mode) in channels.iter_mut().zip(modes) {
        *channel = match (mode & 15, mode >> 4) {
            (0, 0) => Channel::Bytes,
            (1, 0) => Channel::Words,
            (2, turn) => Channel::Xor(u32::from(turn)),
            _ => return Err("it has an unknown channel mode"),
        };
    }

    let mut records = vec![0; count * stride];
    let mut previous: Vec<[u8; 4]> = first.as_chunks().0.to_vec();
    let block = (8192 / stride / GROUP * GROUP).min(MAX_BLOCK);
    let mut differences = vec![[0; MAX_BLOCK]; stride];
    for records in records.chunks_mut(block * stride) {
        read_block(&mut stream, &mut differences, records.len() / stride, !modes.is_empty())?;
        for (at, record) in records.chunks_exact_mut(stride).enumerate() {
            for (number, value) in record.as_chunks_mut().0.iter_mut().enumerate() {
                let difference = std::array::from_fn(|byte| differences[4 * number + byte][at]);
                *value = channels[number].next(previous[number], difference);
                previous[number] = *value;
            }
        }
    }
    stream.end()?;
    Ok(records)
}

/// Reads the differences of a block of `count` records, for each byte of a record.
fn read_block(
    stream: &mut Stream<'_>,
    differences: &mut [[u8; MAX_BLOCK]],
    count: usize,
    has_controls: bool,
) -> Result<(), &'static str> {
    let controls = stream.take(if has_controls { differences.len() / 4 } else { 0 })?;
    for (byte, differences) in differences.iter_mut().enumerate() {
        let control = controls.get(byte / 4).map(|controls| controls >> (2 * (byte % 4)) & 3);
        let bits = match control {
            None => BITS_0,
            Some(control @ (0 | 1)) => BITS[usize::from(control)],
            Some(2) => {
                differences.fill(0);
                continue;
            }
            Some(_) => {
                differences[..count].copy_from_slice(stream.take(count)?);
                continue;
            }
        };
        let groups = count.div_ceil(GROUP);
        let headers = stream.take(groups.div_ceil(4))?;
        for (group, differences) in differences.as_chunks_mut().0.iter_mut().enumerate().take(groups) {
            let header = headers[group / 4] >> (2 * (group % 4)) & 3;
            read_group(stream, bits[usize::from(header)], differences)?;
        }
    }
    Ok(())
}

/// Reads the differences of a group, of that many bits each; one whose bits are all set follows as a whole byte.
fn read_group(stream: &mut Stream<'_>, bits: u32, differences: &mut [u8; GROUP]) -> Result<(), &'static str> {
    if bits == 0 {
        *differences = [0; GROUP];
        return Ok(());
    }
    let packed = stream.take(2 * bits as usize)?;
    if bits == 8 {
        differences.copy_from_slice(packed);
        return Ok(());
    }
    let mask = (1_u8 << bits) - 1;
    let in_byte = 8 / bits as usize;
    for (at, difference) in differences.iter_mut().enumerate() {
        let place = at % in_byte;
        // Single bits start at the lowest, others at the highest.
        let place = if bits == 1 { place } else { in_byte - 1 - place };
        let value = packed[at / in_byte] >> (place * bits as usize) & mask;
        *difference = if value == mask { stream.byte()? } else { value };
    }
    Ok(())
}

impl Channel {
    /// The value of a record from that of the one before.
    fn next(self, previous: [u8; 4], difference: [u8; 4]) -> [u8; 4] {
        match self {
            Self::Bytes => {
                std::array::from_fn(|byte| previous[byte].wrapping_add(unzigzag(u32::from(difference[byte])) as u8))
            }
            Self::Words => {
                let word = |at: usize| {
                    let [previous, difference] = [previous, difference].map(|v| u16::from_le_bytes([v[at], v[at + 1]]));
                    previous.wrapping_add(unzigzag(u32::from(difference)) as u16).to_le_bytes()
                };
                let ([a, b], [c, d]) = (word(0), word(2));
                [a, b, c, d]
            }
            Self::Xor(turn) => {
                let difference = u32::from_le_bytes(difference).rotate_right(turn);
                (u32::from_le_bytes(previous) ^ difference).to_le_bytes()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the specification.
    #[test]
    fn a_group_of_four_bits_has_whole_bytes_after_it() {
        let bytes = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
        let (mut stream, _) = split(&bytes, 0).unwrap();
        let mut group = [0; GROUP];
        read_group(&mut stream, 4, &mut group).unwrap();
        assert_eq!(stream.end(), Ok(()));
        let signed = group.map(|code| unzigzag(u32::from(code)) as i8);
        assert_eq!(signed, [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]);
    }

    #[test]
    fn single_bits_start_at_the_lowest() {
        let (mut stream, _) = split(&[0b0000_0101, 0b1000_0000, 7, 8, 9], 0).unwrap();
        let mut group = [0; GROUP];
        read_group(&mut stream, 1, &mut group).unwrap();
        assert_eq!(group, [7, 0, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 9]);
    }
}
