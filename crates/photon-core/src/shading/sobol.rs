//! Low-discrepancy points: Sobol's sequence in five dimensions, scrambled so that each set of points is
//! uniformly distributed and independent of the others. Integer arithmetic only: the GLSL counterpart gives
//! the same words.

/// Coordinate `dimension`, below 5, of point `index` of the sequence, as a fraction of 2³² (Sobol 1967;
/// direction numbers of Joe and Kuo 2008). Of the first 2ᵐ points, one is in each of 2ᵐ equal intervals of
/// every coordinate, and in the first two dimensions one in each rectangle with that area.
#[inline]
#[must_use]
pub fn sobol(mut index: u32, dimension: u32) -> u32 {
    if dimension == 0 {
        return index.reverse_bits();
    }
    // The direction numbers follow from the preceding ones by the polynomial's recurrence; three are
    // stored.
    let [mut v, mut next, mut after] = match dimension {
        1 => [1 << 31, 3 << 30, 5 << 29],
        2 => [1 << 31, 3 << 30, 3 << 29],
        3 => [1 << 31, 3 << 30, 1 << 29],
        _ => [1 << 31, 1 << 30, 1 << 29],
    };
    let mut point = 0;
    while index != 0 {
        if index & 1 != 0 {
            point ^= v;
        }
        index >>= 1;
        let new: u32 = match dimension {
            1 => after ^ after >> 1,
            2 => after ^ next ^ next >> 2,
            3 => next ^ v ^ v >> 3,
            _ => after ^ v ^ v >> 3,
        };
        (v, next, after) = (next, after, new);
    }
    point
}

/// Scrambles a coordinate: each bit is flipped depending on the bits above it and on `seed` (Owen 1995), by
/// a hash of the reversed word in which every bit depends only on lower ones (Laine and Karras 2011;
/// constants of Vegdahl 2021).
#[inline]
#[must_use]
pub fn scramble(coordinate: u32, seed: u32) -> u32 {
    let mut x = coordinate.reverse_bits();
    x ^= x.wrapping_mul(0x3D20_ADEA);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul(seed >> 16 | 1);
    x ^= x.wrapping_mul(0x0552_6C56);
    x ^= x.wrapping_mul(0x53A2_2864);
    x.reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first points of the published table.
    #[test]
    fn the_published_points() {
        let of = |index: u32| -> Vec<f64> { (0..5).map(|d| f64::from(sobol(index, d)) / 4_294_967_296.0).collect() };
        assert_eq!(of(0), [0.0; 5]);
        assert_eq!(of(1), [0.5; 5]);
        // Ordered by the bits of the index; in Gray code order the next two are exchanged.
        assert_eq!(of(2), [0.25, 0.75, 0.75, 0.75, 0.25]);
        assert_eq!(of(3), [0.75, 0.25, 0.25, 0.25, 0.75]);
        assert_eq!(of(4), [0.125, 0.625, 0.375, 0.125, 0.125]);
    }

    /// 1024 points, scrambled or not: one in each 1024th of every coordinate, and in the first two
    /// dimensions one in each rectangle with that area, of all shapes. A stream of hashes fails this test.
    #[test]
    fn stretches_and_rectangles_have_one_point_each() {
        let full = |bits: u32, cell: &dyn Fn(u32) -> u32| {
            let mut seen = vec![false; 1 << bits];
            (0..1 << bits).for_each(|i| seen[cell(i) as usize] = true);
            seen.iter().all(|&seen| seen)
        };
        for seed in [0, 1, 0x1234_5678] {
            let at = |i: u32, d: u32| if seed == 0 { sobol(i, d) } else { scramble(sobol(i, d), seed + d) };
            for dimension in 0..5 {
                assert!(full(10, &|i| at(i, dimension) >> 22), "{dimension}");
            }
            for across in 1..10 {
                let cell = |i: u32| (at(i, 0) >> (32 - across)) << (10 - across) | at(i, 1) >> (22 + across);
                assert!(full(10, &cell), "{across}");
            }
        }
        assert!(!full(10, &|i| scramble(i.wrapping_mul(0x9E37_79B9), 7).wrapping_mul(0x85EB_CA6B) >> 22));
    }
}
