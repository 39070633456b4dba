//! Runtime dispatch: searches in indices and descents of light trees are compiled for the baseline, for AVX2 and for
//! AVX-512, and the version to run is selected when an index or a tree is built. None of them fuses or reorders
//! floating-point operations, so the results are bit-identical.

use crate::index::lanes::{Baseline, Lanes};
#[cfg(target_arch = "x86_64")]
use crate::index::{
    compress,
    lanes::{Collected, Distances, Distributed},
    points::Item,
    rank::Key,
};

/// Instruction sets that searches are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Isa {
    /// Available on every processor of the target.
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Isa {
    /// The best instruction set that this processor supports.
    pub(crate) fn detect() -> Isa {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("popcnt")
                && is_x86_feature_detected!("lzcnt")
            {
                return Isa::Avx512;
            }
            if is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("popcnt")
                && is_x86_feature_detected!("lzcnt")
            {
                return Isa::Avx2;
            }
        }
        Isa::Baseline
    }

    /// All instruction sets that this processor supports, for tests that compare them.
    #[cfg(test)]
    pub(crate) fn all() -> Vec<Isa> {
        let mut all = vec![Isa::Baseline];
        #[cfg(target_arch = "x86_64")]
        match Isa::detect() {
            Isa::Baseline => {}
            Isa::Avx2 => all.push(Isa::Avx2),
            Isa::Avx512 => all.extend([Isa::Avx2, Isa::Avx512]),
        }
        all
    }

    /// Runs `search` compiled for this instruction set.
    #[inline]
    pub(crate) fn run<S: Dispatched>(self, search: S) -> S::Output {
        match self {
            Isa::Baseline => search.run(Baseline),
            #[cfg(target_arch = "x86_64")]
            #[allow(
                unsafe_code,
                reason = "a function compiled for more than the baseline can be called in no other way"
            )]
            // SAFETY: these values are constructed in `detect` only, after it found the features that the
            // functions are compiled for.
            Isa::Avx2 => unsafe { avx2(search) },
            #[cfg(target_arch = "x86_64")]
            #[allow(
                unsafe_code,
                reason = "a function compiled for more than the baseline can be called in no other way"
            )]
            // SAFETY: as above.
            Isa::Avx512 => unsafe { avx512(search) },
        }
    }
}

/// Work compiled once per instruction set. `run`, and everything in it that should be compiled for the instruction
/// set, has to be `#[inline(always)]`.
pub(crate) trait Dispatched {
    type Output;
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Can only be constructed by code compiled for AVX2.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Avx2(());

#[cfg(target_arch = "x86_64")]
impl Lanes for Avx2 {
    #[inline(always)]
    #[allow(unsafe_code, reason = "a trait's method cannot be compiled for more than the baseline")]
    fn at_most(self, d2: &Distances, limit: f32) -> u32 {
        // SAFETY: `self` only exists in code compiled for AVX2.
        unsafe { compress::at_most_of_eight_twice(d2, limit) }
    }
}

/// Can only be constructed by code compiled for AVX-512.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Avx512(());

#[cfg(target_arch = "x86_64")]
impl Lanes for Avx512 {
    const WIDE: bool = true;

    #[inline(always)]
    #[allow(unsafe_code, reason = "a trait's method cannot be compiled for more than the baseline")]
    fn at_most(self, d2: &Distances, limit: f32) -> u32 {
        // SAFETY: `self` only exists in code compiled for AVX-512.
        unsafe { compress::at_most_of_sixteen(d2, limit) }
    }

    #[inline(always)]
    #[allow(unsafe_code, reason = "a trait's method cannot be compiled for more than the baseline")]
    fn append(self, keys: &mut [Key], hits: u32, first_slot: u32, d2: &Distances) -> usize {
        // SAFETY: `self` only exists in code compiled for AVX-512.
        unsafe { compress::append_by_eight(keys, hits, first_slot, d2) }
    }

    #[inline(always)]
    #[allow(unsafe_code, reason = "a trait's method cannot be compiled for more than the baseline")]
    fn distribute<const AXIS: usize>(self, from: &[Item], to: &mut [Item], left: usize, last: f32) -> Distributed {
        // SAFETY: `self` only exists in code compiled for AVX-512.
        unsafe { compress::distribute_by_four::<AXIS>(from, to, left, last) }
    }

    #[inline(always)]
    #[allow(unsafe_code, reason = "a trait's method cannot be compiled for more than the baseline")]
    fn collect<const AXIS: usize>(self, items: &[Item], to: &mut [f32], low: f32, high: f32) -> Collected {
        // SAFETY: `self` only exists in code compiled for AVX-512.
        unsafe { compress::collect_by_four::<AXIS>(items, to, low, high) }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
fn avx2<S: Dispatched>(search: S) -> S::Output {
    search.run(Avx2(()))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,bmi1,bmi2,popcnt,lzcnt")]
fn avx512<S: Dispatched>(search: S) -> S::Output {
    search.run(Avx512(()))
}
