//! Streams of a reference encoder, damaged ones, and files with them.

mod damage;
mod files;
mod streams;

use super::{Compressed, Filter, Mode, attributes, filters, indices, packed, triangles};
use streams::{ATTRIBUTES, FILTERS, INDICES};

fn bytes(hex: &str) -> Vec<u8> {
    hex.as_bytes()
        .as_chunks::<2>()
        .0
        .iter()
        .map(|two| u8::from_str_radix(str::from_utf8(two).unwrap(), 16).unwrap())
        .collect()
}

/// The records of the streams: two 16-bit integers, a float, four bytes.
fn records(count: usize) -> Vec<u8> {
    let record = |i: usize| {
        let mut record = Vec::new();
        record.extend((3 * i as u16 + 5).to_le_bytes());
        record.extend(((i * i) as u16).to_le_bytes());
        record.extend((0.25 * i as f32 - 3.0).to_le_bytes());
        record.extend([7, if i.is_multiple_of(16) { 99 } else { 0 }, (i * 151) as u8, (i >> 4 & 3) as u8]);
        record
    };
    (0..count).flat_map(record).collect()
}

#[test]
fn attributes_of_both_versions_are_decoded() {
    for (count, hex) in ATTRIBUTES {
        assert_eq!(attributes::decode(&bytes(hex), count, 12).unwrap(), records(count), "{count}: {hex}");
    }
}

#[test]
fn triangles_and_sequences_are_decoded() {
    for (hex, expected) in INDICES {
        assert_eq!(triangles::decode(&bytes(hex[0]), expected[0].len()).unwrap(), expected[0]);
        assert_eq!(indices::decode(&bytes(hex[1]), expected[1].len()).unwrap(), expected[1]);
    }
    assert_eq!(packed(&[1, 70_000], 4), [1, 0, 0, 0, 0x70, 0x11, 1, 0]);
    assert_eq!(packed(&[1, 70_000], 2), [1, 0, 0x70, 0x11]);
}

/// To one unit in the last place, as the specification says; exponents exactly.
#[test]
fn filters_are_undone() {
    for (filter, stride, raw, expected) in FILTERS {
        let (mut found, expected) = (bytes(raw), bytes(expected));
        match filter {
            "OCTAHEDRAL" => filters::octahedral(&mut found, stride),
            "QUATERNION" => filters::quaternion(&mut found),
            "EXPONENTIAL" => filters::exponential(&mut found),
            _ => filters::color(&mut found, stride),
        }
        let distance: Vec<i32> = match (filter, stride) {
            ("EXPONENTIAL", _) => found.iter().zip(&expected).map(|(a, b)| 9 * i32::from(a != b)).collect(),
            (_, 4) => found.iter().zip(&expected).map(|(a, b)| i32::from(a.wrapping_sub(*b) as i8).abs()).collect(),
            _ => {
                let words = |bytes: &[u8]| bytes.as_chunks().0.iter().map(|two| u16::from_le_bytes(*two)).collect();
                let (found, expected): (Vec<u16>, Vec<u16>) = (words(&found), words(&expected));
                found.iter().zip(expected).map(|(a, b)| i32::from(a.wrapping_sub(b) as i16).abs()).collect()
            }
        };
        assert!(distance.iter().all(|&distance| distance <= 1), "{filter} {stride}: {found:x?} {expected:x?}");
        assert_ne!(bytes(raw), expected, "{filter} must change something");
    }
}

#[test]
fn contradictions_are_refused() {
    let good = || Compressed {
        buffer: 0,
        offset: 0,
        length: 100,
        stride: 8,
        count: 6,
        mode: Mode::Attributes,
        filter: Filter::None,
    };
    assert_eq!(good().check(48), Ok(()));
    let index = |mode, stride, count| Compressed { mode, stride, count, ..good() };
    assert_eq!(index(Mode::Triangles, 2, 6).check(12), Ok(()));
    let filtered = |filter, stride| Compressed { filter, stride, ..good() };
    assert_eq!(filtered(Filter::Exponential, 12).check(72), Ok(()));
    for (wrong, size, word) in [
        (good(), 47, "do not fill"),
        (Compressed { count: u64::MAX, ..good() }, 48, "do not fill"),
        (index(Mode::Attributes, 6, 8), 48, "stride of 6"),
        (index(Mode::Attributes, 260, 1), 260, "stride of 260"),
        (index(Mode::Attributes, 0, 1), 0, "stride of 0"),
        (index(Mode::Indices, 8, 6), 48, "stride of 8"),
        (index(Mode::Triangles, 4, 5), 20, "triangles"),
        (filtered(Filter::Octahedral, 12), 72, "Octahedral"),
        (filtered(Filter::Color, 12), 72, "Color"),
        (filtered(Filter::Quaternion, 4), 24, "Quaternion"),
        (Compressed { filter: Filter::Exponential, mode: Mode::Indices, stride: 4, ..good() }, 24, "Exponential"),
        (Compressed { count: 1 << 40, ..good() }, 8 << 40, "cannot hold"),
    ] {
        let why = wrong.check(size).unwrap_err();
        assert!(why.contains(word), "{word}: {why}");
    }
}
