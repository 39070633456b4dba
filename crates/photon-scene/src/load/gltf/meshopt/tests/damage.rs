//! Damaged streams: each is refused, or decodes to as many bytes as were asked for.

use super::super::{attributes, filters, indices, triangles};
use super::bytes;
use super::streams::{ATTRIBUTES, INDICES};

type Decode = fn(&[u8], usize) -> Result<usize, &'static str>;

/// All streams, with the number of their elements and their decoders, which return the number of bytes.
fn all() -> Vec<(Vec<u8>, usize, Decode)> {
    let attributes: Decode = |bytes, count| attributes::decode(bytes, count, 12).map(|decoded| decoded.len() / 12);
    let triangles: Decode = |bytes, count| triangles::decode(bytes, count).map(|decoded| decoded.len());
    let indices: Decode = |bytes, count| indices::decode(bytes, count).map(|decoded| decoded.len());
    let mut all: Vec<(Vec<u8>, usize, Decode)> =
        ATTRIBUTES.iter().map(|&(count, hex)| (bytes(hex), count, attributes)).collect();
    for (hex, expected) in INDICES {
        all.push((bytes(hex[0]), expected[0].len(), triangles));
        all.push((bytes(hex[1]), expected[1].len(), indices));
    }
    all
}

#[test]
fn streams_cut_or_lengthened_are_refused() {
    for (bytes, count, decode) in all() {
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length], count).is_err(), "{length} of {}", bytes.len());
        }
        let longer = [&bytes[..], &[0]].concat();
        assert!(decode(&longer, count).is_err());
        for wrong in [0, 3, count + 3, 3 * count] {
            let found = decode(&bytes, wrong);
            assert!(wrong == count || found.is_err() || found == Ok(wrong), "{wrong} for {count}");
        }
    }
}

#[test]
fn changed_bytes_are_survived() {
    let (mut refused, mut decoded) = (0, 0);
    for (bytes, count, decode) in all() {
        for place in 0..bytes.len() {
            for value in [0x00, 0x01, 0x7f, 0x80, 0xf0, 0xff, bytes[place] ^ 0x11, bytes[place] ^ 0x40] {
                let mut damaged = bytes.clone();
                damaged[place] = value;
                match decode(&damaged, count) {
                    Ok(found) => {
                        assert_eq!(found, count);
                        decoded += 1;
                    }
                    Err(_) => refused += 1,
                }
            }
        }
    }
    assert!(refused > 1000 && decoded > 1000, "{refused} {decoded}");
}

#[test]
fn random_bytes_are_survived() {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as u8
    };
    for round in 0..20_000 {
        let length = usize::from(next()) + 20;
        let mut bytes: Vec<u8> = (0..length).map(|_| next()).collect();
        bytes[0] = [0xa0, 0xa1, 0xe1, 0xd1][round % 4];
        let tail = length - 16;
        if round % 4 == 2 {
            // A valid table, so that the codes are reached.
            bytes[tail..].fill(0);
        }
        let count = usize::from(next()) / 3 * 3;
        let _ = match round % 4 {
            0 | 1 => attributes::decode(&bytes, count, 4 * (1 + usize::from(next() % 64))).map(drop),
            2 => triangles::decode(&bytes, count).map(drop),
            _ => indices::decode(&bytes, count).map(drop),
        };
        let whole = length / 8 * 8;
        for stride in [4, 8] {
            filters::octahedral(&mut bytes[..whole], stride);
            filters::color(&mut bytes[..whole], stride);
        }
        filters::exponential(&mut bytes[..whole]);
        filters::quaternion(&mut bytes[..whole]);
    }
}
