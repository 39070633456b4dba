//! Elementary functions with identical results on all backends.
//!
//! Vulkan allows `sin` and `cos` an error of 2⁻¹¹, and system libraries differ in the last bit of `exp` and
//! `log`. These functions use only additions, multiplications and bit patterns; the coefficients are
//! least-squares fits at Chebyshev nodes, made for this project.

/// `(sin 2πt, cos 2πt)` for `t` in `[0, 1)`; absolute error below 2⁻²².
#[inline]
#[must_use]
pub fn sin_cos_turns(t: f32) -> (f32, f32) {
    // Reduced to the nearest quarter turn; the remainder, in [-1/8, 1/8], is exact.
    let quarter = (t * 4.0 + 0.5) as u32;
    let r = t - quarter as f32 * 0.25;
    let s = r * r;
    let sin = r * (6.283_185_5 + s * (-41.341_7 + s * (81.605_2 + s * (-76.697_87 + s * 41.472_89))));
    let cos = 1.0 + s * (-19.739_208 + s * (64.939_316 + s * (-85.442_85 + s * 59.220_29)));
    match quarter & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// `t.floor()`, without a call of the system's library, which processors before SSE4.1 need for it.
#[inline]
#[must_use]
pub fn floor(t: f32) -> f32 {
    // From 2²³ on all numbers are whole. NaN is returned as it is.
    if !(t.abs() < 8_388_608.0) {
        return t;
    }
    let whole = t as i32 as f32;
    if whole > t { whole - 1.0 } else { whole }
}

/// `exp(-tau)` for `tau` ≥ 0; relative error below 2⁻²¹. Exactly 1 at 0, exactly 0 from 87 on, where the
/// result would be subnormal; 0 for infinity and NaN.
#[inline]
#[must_use]
pub fn exp_neg(tau: f32) -> f32 {
    if tau >= 87.0 || tau.is_nan() {
        return 0.0;
    }
    let whole = (-tau * std::f32::consts::LOG2_E - 0.5) as i32;
    let w = whole as f32;
    // ln 2 in two parts, the first with few bits, so that its product is exact (Cody and Waite 1980).
    let rest = (-tau - w * 0.693_359_4) + w * 2.121_944_4e-4;
    let f = rest * std::f32::consts::LOG2_E;
    let p = 1.0
        + f * (std::f32::consts::LN_2
            + f * (0.240_226_5
                + f * (0.055_503_27 + f * (0.009_618_026 + f * (0.001_340_043_2 + f * 0.000_154_697_32)))));
    p * f32::from_bits(((127 + whole) as u32) << 23)
}

/// `1 - exp(-tau)` for `tau` ≥ 0; relative error below 2⁻²⁰.
#[inline]
#[must_use]
pub fn one_minus_exp(tau: f32) -> f32 {
    if !(tau < 0.25) {
        return 1.0 - exp_neg(tau);
    }
    // The series: the difference would lose digits.
    tau * (1.0
        - tau * (0.5 - tau * (0.166_666_67 - tau * (0.041_666_668 - tau * (8.333_334e-3 - tau * 1.388_888_9e-3)))))
}

/// `-ln(1 - y)` for `y` in `[0, 1)`; relative error below 2⁻²⁰.
#[inline]
#[must_use]
pub fn minus_ln_one_minus(y: f32) -> f32 {
    if !(y < 0.25) {
        return -ln((1.0 - y).max(f32::MIN_POSITIVE));
    }
    let tail = 0.166_666_67 + y * (0.142_857_15 + y * (0.125 + y * (0.111_111_11 + y * 0.1)));
    y * (1.0 + y * (0.5 + y * (0.333_333_34 + y * (0.25 + y * (0.2 + y * tail)))))
}

/// `ln x` for normal positive `x`; absolute error below 2⁻²¹ near 1, relative below 2⁻²¹ elsewhere.
#[inline]
#[must_use]
pub fn ln(x: f32) -> f32 {
    // Mantissa reduced to [√½, √2).
    let bits = x.to_bits();
    let exponent = (bits.wrapping_sub(0x3F35_04F3) as i32) >> 23;
    let m = f32::from_bits(bits.wrapping_sub((exponent as u32) << 23)) - 1.0;
    let q = 0.333_333_3
        + m * (-0.250_002_97
            + m * (0.200_014_7
                + m * (-0.166_422_48
                    + m * (0.142_021_74 + m * (-0.129_722_39 + m * (0.127_123_08 + m * -0.081_015_59))))));
    // The exponent's term in two parts, so that the large one is exact.
    let e = exponent as f32;
    (m - 0.5 * m * m + m * m * m * q + e * 1.428_606_8e-6) + e * 0.693_145_75
}

/// The angle of `(x, y)`, `y` ≥ 0, from the first axis, in turns: in `[0, ½]`; relative error below 2⁻²¹. 0
/// for a vector of length 0; finite for finite vectors whose sum of coordinates is finite.
#[inline]
#[must_use]
pub fn turns_of(y: f32, x: f32) -> f32 {
    let along = x.abs();
    let steep = y > along;
    let (low, high) = if steep { (along, y) } else { (y, along) };
    // Above tan 22.5°, the angle is computed relative to the diagonal, so that a short polynomial is
    // sufficient.
    let diagonal = low > 0.414_213_56 * high;
    let (opposite, adjacent) = if diagonal { (low - high, low + high) } else { (low, high) };
    if !(adjacent > 0.0) {
        return 0.0;
    }
    let t = opposite / adjacent;
    let s = t * t;
    let near =
        t * (0.159_154_94 + s * (-0.053_050_78 + s * (0.031_789_843 + s * (-0.022_041_53 + s * 0.012_697_482_5))));
    let low_turns = if diagonal { near + 0.125 } else { near };
    let turns = if steep { 0.25 - low_turns } else { low_turns };
    if x < 0.0 { 0.5 - turns } else { turns }
}

/// Cube root of `x` ≥ 0, finite; within one unit in the last place. 0 for numbers that are not normal and
/// positive.
#[inline]
#[must_use]
pub fn cube_root(x: f32) -> f32 {
    let bits = x.to_bits();
    if bits.wrapping_sub(0x0080_0000) >= 0x7F00_0000 {
        return 0.0;
    }
    // The inverse root needs no division. A third of the bits is about a third of the exponent: within 3.5
    // %, with a constant found by trial; each Newton step squares the error.
    let mut r = f32::from_bits(0x54A2_3400 - bits / 3);
    for _ in 0..3 {
        r += r * ((1.0 - x * r * r * r) * 0.333_333_33);
    }
    // A final step on the root itself, which removes the accumulated rounding errors of `r`.
    let y = x * r * r;
    y + (x - y * y * y) * (r * r * 0.333_333_33)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn small_depths_keep_their_digits() {
        let mut numbers = SplitMix64(9);
        for _ in 0..100_000 {
            let tau = 2_f32.powf(60.0 * numbers.unit() - 55.0);
            let exact = -(-f64::from(tau)).exp_m1();
            let error = (f64::from(one_minus_exp(tau)) / exact - 1.0).abs();
            assert!(error < 9.6e-7, "{tau} {error}");
            let y = 2_f32.powf(-40.0 * numbers.unit());
            if y < 1.0 {
                let error = (f64::from(minus_ln_one_minus(y)) / -(-f64::from(y)).ln_1p() - 1.0).abs();
                assert!(error < 9.6e-7, "{y} {error}");
            }
        }
        assert_eq!((one_minus_exp(0.0), one_minus_exp(f32::INFINITY), minus_ln_one_minus(0.0)), (0.0, 1.0, 0.0));
    }

    #[test]
    fn floors_are_those_of_the_library() {
        let mut numbers = SplitMix64(3);
        let any = (0..200_000).map(|_| f32::from_bits(numbers.word() as u32));
        let mut small = SplitMix64(4);
        let near = (0..200_000).map(|_| (small.unit() - 0.5) * 64.0);
        let special = [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 8_388_607.5, -8_388_607.5, 8_388_608.0, -8_388_609.0, -1e-30];
        for t in any.chain(near).chain(special).chain([f32::MAX, f32::INFINITY, f32::NEG_INFINITY]) {
            if !t.is_nan() {
                assert_eq!(floor(t), t.floor(), "{t}");
            }
        }
        assert!(floor(f32::NAN).is_nan());
    }

    #[test]
    fn sine_and_cosine() {
        for i in 0..100_000 {
            let t = i as f32 / 100_000.0;
            let (sin, cos) = sin_cos_turns(t);
            let angle = f64::from(t) * std::f64::consts::TAU;
            assert!((f64::from(sin) - angle.sin()).abs() < 2.4e-7, "{t}");
            assert!((f64::from(cos) - angle.cos()).abs() < 2.4e-7, "{t}");
        }
        assert_eq!(sin_cos_turns(0.0), (0.0, 1.0));
        assert_eq!(sin_cos_turns(0.25).1, 0.0);
    }

    #[test]
    fn exponential() {
        for i in 0..87_000 {
            let tau = i as f32 / 1000.0;
            let relative = f64::from(exp_neg(tau)) / (-f64::from(tau)).exp() - 1.0;
            assert!(relative.abs() < 4.8e-7, "{tau}: {relative}");
        }
        assert_eq!(exp_neg(0.0), 1.0);
        for tau in [100.0, 1e4, f32::INFINITY, f32::NAN] {
            assert_eq!(exp_neg(tau), 0.0);
        }
    }

    #[test]
    fn angles() {
        for i in 0..=100_000 {
            let angle = f64::from(i) * 1e-5 * std::f64::consts::PI;
            for length in [1.0, 1e-12, 3e8] {
                let (x, y) = ((angle.cos() * length) as f32, (angle.sin() * length).max(0.0) as f32);
                let truth = f64::from(y).atan2(f64::from(x)) / std::f64::consts::TAU;
                let error = (f64::from(turns_of(y, x)) - truth).abs();
                assert!(error <= 4.8e-7 * truth, "{y} {x}: {error}");
            }
        }
        for (y, x, turns) in
            [(0.0, 1.0, 0.0), (1.0, 1.0, 0.125), (1.0, 0.0, 0.25), (1.0, -1.0, 0.375), (0.0, -1.0, 0.5)]
        {
            assert_eq!(turns_of(y, x), turns);
        }
        for x in [0.0, -0.0] {
            assert_eq!(turns_of(0.0, x), 0.0);
        }
    }

    #[test]
    fn logarithm() {
        for i in 1..100_000 {
            for x in [i as f32 / 50_000.0, i as f32 * 1e20, i as f32 * 1e-30] {
                let truth = f64::from(x).ln();
                let error = (f64::from(ln(x)) - truth).abs();
                assert!(error < 4.8e-7 * truth.abs().max(1.0), "{x}: {error}");
            }
        }
        assert_eq!(ln(1.0), 0.0);
    }

    #[test]
    fn cube_roots() {
        let ulp = |x: f32| f64::from(f32::from_bits(x.to_bits() + 1) - x);
        let check = |x: f32| {
            let truth = f64::from(x).cbrt();
            let error = (f64::from(cube_root(x)) - truth).abs() / ulp(truth as f32);
            assert!(error <= 1.0, "{x:e}: {error} units in the last place");
        };
        // The initial guess repeats after three octaves.
        for i in 0..3_000_000_u32 {
            check(f32::from_bits(0x3F00_0000 + i * 8));
        }
        for exponent in -126..=127 {
            for mantissa in [1.0, 1.000_000_1, 1.1, 1.5, 1.999_999_9] {
                check(mantissa * 2.0_f32.powi(exponent));
            }
        }
        for x in [0.0, -0.0, 1e-40, f32::INFINITY, f32::NAN] {
            assert_eq!(cube_root(x), 0.0);
        }
        assert_eq!((cube_root(1.0), cube_root(8.0)), (1.0, 2.0));
    }
}
