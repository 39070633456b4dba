//! Explicit SIMD intrinsics, for loops that the compiler does not vectorise.
//!
//! The loops over all points of a segment in `select` process whole vectors only and return how many points they
//! handled; scalar loops process the rest, or everything if the instruction set is missing.

use crate::index::lanes::{Collected, Distances, Distributed};
use crate::index::points::Item;
use crate::index::rank::Key;
use bytemuck::cast;
use std::arch::x86_64::*;

/// [`Lanes::distribute`](crate::index::lanes::Lanes::distribute).
#[target_feature(enable = "avx512f,popcnt")]
pub(crate) fn distribute_by_four<const AXIS: usize>(
    from: &[Item],
    to: &mut [Item],
    left: usize,
    last: f32,
) -> Distributed {
    let cut = _mm512_set1_ps(last);
    let (mut done, mut next_left) = (0, 0);
    let (fours, _) = from.as_chunks::<4>();
    for &four in fours {
        let next_right = left + done - next_left;
        // Four points are stored on either side; surplus ones are overwritten by later points. Where that is not
        // guaranteed, the loop has to stop.
        if next_left + 4 > left || next_right + 4 > to.len() {
            break;
        }
        let points: __m512 = cast(four.map(|item| item.0));
        let goes_left = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(0x1111 << AXIS, points, cut) >> AXIS;
        // Expand one bit per point to one bit per component.
        let numbers = goes_left * 15;
        let low: [[f32; 4]; 4] = cast(_mm512_maskz_compress_ps(numbers, points));
        let high: [[f32; 4]; 4] = cast(_mm512_maskz_compress_ps(!numbers, points));
        to[next_left..next_left + 4].copy_from_slice(&low.map(Item));
        to[next_right..next_right + 4].copy_from_slice(&high.map(Item));
        next_left += goes_left.count_ones() as usize;
        done += 4;
    }
    Distributed { done, went_left: next_left }
}

/// [`Lanes::collect`](crate::index::lanes::Lanes::collect).
#[target_feature(enable = "avx512f,popcnt")]
pub(crate) fn collect_by_four<const AXIS: usize>(items: &[Item], keys: &mut [f32], low: f32, high: f32) -> Collected {
    let (low, high) = (_mm512_set1_ps(low), _mm512_set1_ps(high));
    let mut seen = Collected::default();
    let (fours, _) = items.as_chunks::<4>();
    for &four in fours {
        let points: __m512 = cast(four.map(|item| item.0));
        let reaches = _mm512_mask_cmp_ps_mask::<_CMP_GE_OQ>(0x1111 << AXIS, points, low);
        let inside = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(reaches, points, high);
        let found: [f32; 4] = cast(_mm512_castps512_ps128(_mm512_maskz_compress_ps(inside, points)));
        keys[seen.inside..seen.inside + 4].copy_from_slice(&found);
        seen.below += 4 - reaches.count_ones() as usize;
        seen.inside += inside.count_ones() as usize;
        seen.done += 4;
    }
    seen
}

/// [`Lanes::at_most`](crate::index::lanes::Lanes::at_most).
#[inline]
#[target_feature(enable = "avx512f")]
pub(crate) fn at_most_of_sixteen(d2: &Distances, limit: f32) -> u32 {
    u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(cast(*d2), _mm512_set1_ps(limit)))
}

/// [`Lanes::at_most`](crate::index::lanes::Lanes::at_most).
#[inline]
#[target_feature(enable = "avx2")]
pub(crate) fn at_most_of_eight_twice(d2: &Distances, limit: f32) -> u32 {
    let limit = _mm256_set1_ps(limit);
    let [low, high]: [__m256; 2] = cast(*d2);
    let low = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(low, limit)) as u32;
    let high = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(high, limit)) as u32;
    low | high << 8
}

/// [`Lanes::append`](crate::index::lanes::Lanes::append).
#[inline]
#[target_feature(enable = "avx512f,popcnt")]
pub(crate) fn append_by_eight(keys: &mut [Key], hits: u32, first_slot: u32, d2: &Distances) -> usize {
    let slots = _mm512_add_epi64(_mm512_set1_epi64(i64::from(first_slot)), _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7));
    let halves: [__m256i; 2] = cast(*d2);
    let mut count = 0;
    for (half, bits) in halves.into_iter().enumerate() {
        let slots = _mm512_add_epi64(slots, _mm512_set1_epi64(8 * half as i64));
        let whole = _mm512_or_si512(_mm512_slli_epi64::<32>(_mm512_cvtepu32_epi64(bits)), slots);
        let hits = (hits >> (8 * half)) as u8;
        let found: [Key; 8] = cast(_mm512_maskz_compress_epi64(hits, whole));
        keys[count..count + 8].copy_from_slice(&found);
        count += hits.count_ones() as usize;
    }
    count
}
