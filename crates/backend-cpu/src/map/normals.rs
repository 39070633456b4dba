//! Unpacked photon normals, ready for comparison. Flat surfaces have few distinct normals; then each photon stores
//! a two-byte index into a table. Unpacking a normal at every use took a quarter of the estimation time.

use photon_core::glam::Vec3;
use photon_core::memory::{self, OutOfMemory};
use photon_core::octahedral;
use rayon::prelude::*;

/// Maximum number of distinct normals: the table has to fit in a core's private cache.
const MAX_DIFFERENT: usize = 1 << 14;

/// Photons per parallel task.
const CHUNK: usize = 1 << 14;

/// Normals, indexed by slot.
#[derive(Debug)]
pub(crate) enum Normals {
    /// The distinct normals, packed and unpacked, and each photon's index into both.
    Few(Vec<u32>, Vec<Vec3>, Vec<u16>),
    /// One normal per photon.
    Each(Vec<Vec3>),
}

impl Normals {
    /// Unpacks `packed`.
    pub(crate) fn new(packed: &[u32]) -> Result<Self, OutOfMemory> {
        Ok(match different(packed, MAX_DIFFERENT) {
            Err(Stop::Memory(refused)) => return Err(refused),
            Err(Stop::TooMany) => {
                let mut normals = memory::with_capacity(packed.len(), "photon normals")?;
                packed.par_iter().with_min_len(4096).map(|&n| octahedral::unpack(n)).collect_into_vec(&mut normals);
                Self::Each(normals)
            }
            Ok(known) => {
                let mut which = memory::zeroed(packed.len(), "photon normals")?;
                which.par_chunks_mut(CHUNK).zip(packed.par_chunks(CHUNK)).for_each(|(which, packed)| {
                    // Consecutive photons mostly lie on the same surface.
                    let mut last = (0, known.first().copied());
                    for (which, &normal) in which.iter_mut().zip(packed) {
                        if last.1 != Some(normal) {
                            last = (known.partition_point(|&other| other < normal) as u16, Some(normal));
                        }
                        *which = last.0;
                    }
                });
                let table = known.iter().copied().map(octahedral::unpack);
                let table = memory::collected(table, "photon normals")?;
                Self::Few(known, table, which)
            }
        })
    }

    #[inline]
    pub(crate) fn of(&self, slot: u32) -> Vec3 {
        match self {
            Self::Few(_, table, which) => table[usize::from(which[slot as usize])],
            Self::Each(normals) => normals[slot as usize],
        }
    }

    /// Whether the packed normal is this word.
    #[inline]
    pub(crate) fn is(&self, slot: u32, packed: u32) -> bool {
        match self {
            Self::Few(known, _, which) => known[usize::from(which[slot as usize])] == packed,
            Self::Each(normals) => normals[slot as usize] == octahedral::unpack(packed),
        }
    }

    /// Whether there is no other packed normal than this word, as far as is known.
    pub(crate) fn are(&self, packed: u32) -> bool {
        matches!(self, Self::Few(known, ..) if known[..] == [packed])
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Few(_, _, which) => which.len(),
            Self::Each(normals) => normals.len(),
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Few(known, table, which) => {
                known.capacity() * size_of::<u32>()
                    + table.capacity() * size_of::<Vec3>()
                    + which.capacity() * size_of::<u16>()
            }
            Self::Each(normals) => normals.capacity() * size_of::<Vec3>(),
        }
    }
}

/// Reason for having no table of the distinct normals.
enum Stop {
    TooMany,
    Memory(OutOfMemory),
}

impl From<OutOfMemory> for Stop {
    fn from(refused: OutOfMemory) -> Self {
        Self::Memory(refused)
    }
}

/// The distinct values in ascending order; [`Stop::TooMany`] if there are more than `most`.
fn different(packed: &[u32], most: usize) -> Result<Vec<u32>, Stop> {
    let few = |found: Vec<u32>| if found.len() <= most { Ok(found) } else { Err(Stop::TooMany) };
    let of_chunk = |chunk: &[u32]| {
        let mut found = memory::copied(chunk, "distinct normals")?;
        found.dedup();
        found.sort_unstable();
        found.dedup();
        few(found)
    };
    packed.par_chunks(CHUNK).map(of_chunk).try_reduce(Vec::new, |all, other| few(merge(&all, &other)?))
}

/// The union of two ascending lists without repetitions, as one such list.
fn merge(mut a: &[u32], mut b: &[u32]) -> Result<Vec<u32>, OutOfMemory> {
    let mut union = memory::with_capacity(a.len() + b.len(), "distinct normals")?;
    while let (Some(first), Some(second)) = (a.first(), b.first()) {
        union.push(*first.min(second));
        (a, b) = (&a[usize::from(first <= second)..], &b[usize::from(second <= first)..]);
    }
    union.extend_from_slice(a);
    union.extend_from_slice(b);
    Ok(union)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both representations return the same bits, for any number of distinct normals.
    #[test]
    fn every_normal_is_that_of_its_photon() {
        for different in [0, 1, 2, 300, MAX_DIFFERENT as u32, MAX_DIFFERENT as u32 + 1, 50_000] {
            let packed: Vec<u32> = (0..different * 2).map(|i| (i % different).wrapping_mul(0x9E37_79B1)).collect();
            let normals = Normals::new(&packed).unwrap();
            assert_eq!(matches!(normals, Normals::Few(..)), different <= MAX_DIFFERENT as u32, "{different}");
            assert_eq!(normals.len(), packed.len());
            for (slot, &normal) in packed.iter().enumerate() {
                let (seen, expected) = (normals.of(slot as u32), octahedral::unpack(normal));
                assert!(normals.is(slot as u32, normal) && !normals.is(slot as u32, normal ^ 0x0101));
                assert_eq!(seen.to_array().map(f32::to_bits), expected.to_array().map(f32::to_bits), "{slot}");
            }
        }
    }

    #[test]
    fn few_take_two_bytes() {
        let packed = vec![7; 100_000];
        assert!(Normals::new(&packed).unwrap().bytes() < 100_000 * 2 + 100);
    }
}
