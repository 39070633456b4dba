//! A small generator with state, for tests, benchmarks and procedural scenes; renderers use
//! [`Sampler`](super::Sampler), which is stateless.

/// SplitMix64 (Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number Generators"): the
/// same numbers in every version of this library.
///
/// ```
/// use photon_core::random::SplitMix64;
///
/// let mut random = SplitMix64(1_234_567);
/// assert_eq!(random.word(), 6_457_827_717_110_365_317);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplitMix64(
    /// The state; initially the seed.
    pub u64,
);

impl SplitMix64 {
    /// The next 64 bits.
    #[inline]
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// A number in `[0, 1)`, a multiple of 2⁻²⁴.
    #[inline]
    pub fn unit(&mut self) -> f32 {
        (self.word() >> 40) as f32 * (1.0 / (1 << 24) as f32)
    }

    /// A number in `[0, 1)`, a multiple of 2⁻⁵³.
    #[inline]
    pub fn unit_f64(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A point of the unit cube: three times [`SplitMix64::unit`].
    #[inline]
    pub fn point(&mut self) -> [f32; 3] {
        [self.unit(), self.unit(), self.unit()]
    }
}

#[cfg(test)]
mod tests {
    use super::SplitMix64;

    /// The output of the reference implementation for this seed.
    #[test]
    fn words_are_the_published_ones() {
        let mut random = SplitMix64(1_234_567);
        let words = [(); 5].map(|()| random.word());
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!(words, expected);
    }

    #[test]
    fn units_are_the_upper_bits_of_words() {
        let (mut narrow, mut wide, mut word) = (SplitMix64(9), SplitMix64(9), SplitMix64(9));
        for _ in 0..100 {
            let bits = word.word();
            assert_eq!(narrow.unit(), (bits >> 40) as f32 / 16_777_216.0);
            assert_eq!(wide.unit_f64(), (bits >> 11) as f64 / 9_007_199_254_740_992.0);
        }
    }
}
