//! Random numbers as a pure function of (seed, pass, domain, path, dimension).
//!
//! No state is carried from one path to the next, so that the numbers do not depend on the thread, batch,
//! machine or backend that uses them. Integer arithmetic only: the GLSL counterpart gives the same words.
//!
//! # Dimensions
//!
//! [`philox4x32`] turns a key of 64 bits (the seed) and a counter of four words into four words, one **block** of four
//! dimensions:
//!
//! | word of the counter | content |
//! |---|---|
//! | 0 | path: number within the pass for photons; 4 · pixel + branch for camera paths and all that depends on them |
//! | 1 | block |
//! | 2 | pass; 2³² − 1 is the pilot, whose photons only determine the first radii |
//! | 3 | [`Domain`], and the camera sample times 2¹⁶ |
//!
//! | domain | block | words |
//! |---|---|---|
//! | photon | 0 | light · point on it, u · point on it, v · side |
//! | photon | 1 | direction, u · direction, v · – · – |
//! | photon | 2 + n, surface n from 0 | Russian roulette, choice of the lobe · direction, u · direction, v · alpha |
//! | camera path | 1 | x in the pixel · y in the pixel (both of sample 0) · point on the lens, u · point on the lens, v |
//! | camera path | 2 + n, after n surfaces | choice of the lobe · direction, u · direction, v · alpha of the next |
//! | camera path | [`BLOCK_LIGHTS`] + n, surface n from 1 | light · point, u · point, v · light (low), alpha |
//! | camera path | [`BLOCK_LIGHT_SIDES`] + n, surface n from 1 | side of rough glass · Russian roulette · – · – |
//! | shadow rays | ray r of the query | light · point or direction, u · the same, v (both of ray 0) · light (low), alpha |
//! | final gathering | r · (max bounces + 1), ray r | direction, u · direction, v (of ray 0) · – · – |
//! | final gathering | r · (max bounces + 1) + n, surface n from 1 | choice of the lobe · direction, u · direction, v · alpha |
//! | flights | 2n, after n surfaces and collisions | channel · length · roulette · thinning |
//! | flights | 2n + 1 | phase function, u · phase function, v · – · – |
//! | deposits in media | n, after n surfaces and collisions; aimed paths: + 2³¹ | channel · place · – · – |
//! | camera segments | ray r of the segment | light · point, u · point, v (both of ray 0) · place on the segment |
//! | camera segments | [`BLOCK_SEGMENTS`] + n, segment n of the pixel | which of several is kept · alpha of shadow ray n · – · – |
//! | wavelength | domain of the path + 8 · gather ray | wavelength · – · – · – |
//! | area probes | 0, by the path of the query | rotation of the spokes · shift of the rings · – · – |
//!
//! Further rays of a query, and camera samples of a pixel, have their points from the first by [`evenly_spread`], and gather rays
//! their azimuths by [`GOLDEN_STEP`].
//! Aimed photons have the blocks of photons. A stage consumes its own block even where it needs no number. With
//! [`RandomKind::Lcg`] photons draw four numbers per block of a sequence that starts at the path number; all other
//! domains keep Philox.

use crate::settings::RandomKind;

mod split_mix;

pub use split_mix::SplitMix64;

/// What the numbers are used for; separates the streams of different stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
#[non_exhaustive]
pub enum Domain {
    /// Emission and scattering of photons.
    Photon = 0,
    /// Camera paths.
    Eye = 1,
    /// Points on lights for shadow rays.
    Shadow = 2,
    /// Final-gather rays.
    Gather = 3,
    /// Probe rays for the area of a disc.
    Area = 4,
    /// Photons that are aimed, for the caustic map.
    Aimed = 5,
    /// Lengths of flights in media, and directions after collisions.
    Flight = 6,
    /// Places of photons in media.
    Deposit = 7,
    /// Segments of camera paths in media.
    Segment = 8,
    /// Wavelengths of paths that are dispersed.
    Wavelength = 9,
}

/// Four independent words from a counter and a key: Philox4x32-10 (Salmon, Moraes, Dror and Shaw
/// 2011), which passes TestU01's BigCrush.
#[inline]
#[must_use]
pub fn philox4x32(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    const ROUNDS: u32 = 10;
    const MULTIPLIER: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    for _ in 0..ROUNDS {
        let a = u64::from(MULTIPLIER[0]) * u64::from(counter[0]);
        let b = u64::from(MULTIPLIER[1]) * u64::from(counter[2]);
        counter = [(b >> 32) as u32 ^ counter[1] ^ key[0], b as u32, (a >> 32) as u32 ^ counter[3] ^ key[1], a as u32];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

/// One step of the generator of Lin and Wang 2010, `N' = (a N + b) mod 2³¹`, with the constants of the
/// example of `rand` in ISO C.
#[inline]
#[must_use]
pub fn lcg(state: u32) -> u32 {
    state.wrapping_mul(1_103_515_245).wrapping_add(12_345) & 0x7FFF_FFFF
}

/// Element `index` of a sequence of points that begins at `first`, in units of 2⁻³²: the (0, 2)-sequence of van der Corput and Sobol
/// (1967) in base 2, scrambled by exclusive or (Kollig and Keller 2002). Of the first 2ᵏ points, and of each later run of as many, one
/// lies in each of 2ᵏ rectangles of equal area, of any shape; with a uniform first point each is uniform.
#[inline]
#[must_use]
pub const fn evenly_spread(first: [u32; 2], index: u32) -> [u32; 2] {
    let (mut rest, mut column, mut second) = (index, 1 << 31, 0);
    while rest != 0 {
        if rest & 1 != 0 {
            second ^= column;
        }
        rest >>= 1;
        column ^= column >> 1;
    }
    [first[0] ^ index.reverse_bits(), first[1] ^ second]
}

/// A number in `[0, 1)` from the upper 24 bits of a word, exact.
#[inline]
#[must_use]
pub fn unit_f32(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A number in `[-1/2, 1/2]` from all bits of a word, equal to [`unit_f32`] modulo 1 except for precision:
/// around 0 in steps of 2⁻³².
#[inline]
#[must_use]
pub fn centred_f32(word: u32) -> f32 {
    // Both parts are exact, so that only one rounding occurs.
    ((word as i32) >> 8) as f32 * (1.0 / 16_777_216.0) + (word & 0xFF) as f32 * (1.0 / 4_294_967_296.0)
}

/// The random numbers of one path.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    kind: RandomKind,
    key: [u32; 2],
    path: u32,
    pass: u32,
    domain: u32,
    state: u32,
}

impl Sampler {
    /// The numbers of path `path` of pass `pass`. `kind` applies to photons only; all other domains use the
    /// counter.
    #[inline]
    #[must_use]
    pub fn new(kind: RandomKind, seed: u64, pass: u32, domain: Domain, path: u32) -> Self {
        let photon = matches!(domain, Domain::Photon | Domain::Aimed);
        let kind = if photon { kind } else { RandomKind::Counter };
        Self {
            kind,
            key: [seed as u32, (seed >> 32) as u32],
            path,
            pass,
            domain: domain as u32,
            // As in the paper, where neighbouring threads have neighbouring seeds.
            state: path.wrapping_add(pass.wrapping_mul(0x9E37_79B9)).wrapping_add(seed as u32) & 0x7FFF_FFFF,
        }
    }

    /// The numbers of camera sample `sample` of the pass; those of [`Sampler::new`] are of sample 0.
    #[inline]
    #[must_use]
    pub const fn of_sample(mut self, sample: u32) -> Self {
        self.domain |= sample << 16;
        self
    }

    /// The numbers of the first camera sample of the pass.
    #[inline]
    #[must_use]
    pub const fn of_first_sample(mut self) -> Self {
        self.domain &= 0xFFFF;
        self
    }

    /// Four random words. With the counter, `block` (four dimensions each) selects them; the LCG returns
    /// the next four of its sequence, 31 bits each, shifted to the upper bits of the word.
    #[inline]
    #[must_use]
    pub fn words(&mut self, block: u32) -> [u32; 4] {
        match self.kind {
            RandomKind::Counter => philox4x32([self.path, block, self.pass, self.domain], self.key),
            RandomKind::Lcg => std::array::from_fn(|_| {
                self.state = lcg(self.state);
                self.state << 1
            }),
        }
    }

    /// The random word for the wavelength of the path, or of its gather ray `ray`. Those of a camera sample are stratified over
    /// the passes.
    #[inline]
    #[must_use]
    pub fn wavelength(&self, ray: u32) -> u32 {
        let (domain, sample) = (self.domain & 0xFFFF, self.domain & 0xFFFF_0000);
        let block = ray << 3 | domain;
        let draw = |pass| philox4x32([self.path, block, pass, sample | Domain::Wavelength as u32], self.key)[0];
        if domain == Domain::Eye as u32 {
            return draw(0).wrapping_add(self.pass.wrapping_mul(GOLDEN_STEP));
        }
        draw(self.pass)
    }
}

/// Step of the wavelengths of a camera path from pass to pass, and of the azimuths of gather rays, as a share of 2³²: the
/// golden ratio.
pub const GOLDEN_STEP: u32 = 0x9E37_79B9;

/// Block of dimensions for the choice of the light and the point on it.
pub const BLOCK_LIGHT: u32 = 0;
/// Block of dimensions for the direction of an emitted photon, or for the point in the pixel where a camera
/// path starts.
pub const BLOCK_START: u32 = 1;
/// Block of dimensions of the first surface; those of the next surfaces follow.
pub const BLOCK_SURFACES: u32 = 2;
/// Block of dimensions for the light that is sampled at the first surface of a camera path; those of the next surfaces
/// follow.
pub const BLOCK_LIGHTS: u32 = 1 << 30;
/// Block of dimensions of the first surface of a camera path for the side on which a light is sampled, if it is rough glass, and
/// for Russian roulette; those of the next surfaces follow.
pub const BLOCK_LIGHT_SIDES: u32 = 3 << 29;
/// First block of choices among the segments of a pixel, and of the alpha of shadow rays from segments.
pub const BLOCK_SEGMENTS: u32 = 1 << 29;

#[cfg(test)]
mod tests {
    use super::*;

    /// The known answers published with Random123.
    #[test]
    fn philox_gives_the_published_words() {
        assert_eq!(philox4x32([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(philox4x32([u32::MAX; 4], [u32::MAX; 2]), [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]);
    }

    #[test]
    fn unit_interval_is_half_open() {
        assert_eq!(unit_f32(0), 0.0);
        assert!(unit_f32(u32::MAX) < 1.0);
    }

    #[test]
    fn centred_numbers_are_the_same_modulo_one_and_finer_about_zero() {
        for word in (0..4096).map(|i| i * 1_048_583) {
            let gap = f64::from(centred_f32(word)) - f64::from(unit_f32(word));
            assert!((gap - gap.round()).abs() <= 1.0 / 16_777_216.0 && centred_f32(word).abs() <= 0.5, "{word}");
        }
        for step in 0..=1_000_u32 {
            let exact = f64::from(step) / 4_294_967_296.0;
            assert_eq!((f64::from(centred_f32(step)), f64::from(centred_f32(step.wrapping_neg()))), (exact, -exact));
        }
    }

    /// Of 2ᵏ points, one is in each of 2ᵏ rectangles of equal area, whatever their shape. Independent ones are not spread so.
    #[test]
    fn runs_of_points_are_spread_evenly() {
        let mut numbers = SplitMix64(3);
        for log2 in 1..=8_u32 {
            let is_even = |points: &[[u32; 2]], across: u32| {
                let down = log2 - across;
                let cell = |[u, v]: [u32; 2]| (u64::from(u) >> (32 - across)) << down | u64::from(v) >> (32 - down);
                let mut cells: Vec<_> = points.iter().map(|&point| cell(point)).collect();
                cells.sort_unstable();
                cells.into_iter().eq(0..1 << log2)
            };
            for run in 0..4 {
                let word = numbers.word();
                let first = [word as u32, (word >> 32) as u32];
                let points: Vec<_> = (0..1 << log2).map(|i| evenly_spread(first, (run << log2) + i)).collect();
                assert!((0..=log2).all(|across| is_even(&points, across)), "2^{log2}, {run}");
            }
            let other: Vec<_> = (0..1 << log2).map(|_| [numbers.word() as u32, numbers.word() as u32]).collect();
            assert!(log2 < 3 || !(0..=log2).all(|across| is_even(&other, across)), "2^{log2}");
        }
        assert_eq!(evenly_spread([5, 7], 0), [5, 7]);
    }

    #[test]
    fn numbers_depend_on_every_part_of_the_key() {
        let draw =
            |seed, pass, domain, path, block| Sampler::new(RandomKind::Counter, seed, pass, domain, path).words(block);
        let base = draw(1, 2, Domain::Photon, 3, 4);
        assert_eq!(base, draw(1, 2, Domain::Photon, 3, 4));
        for other in [
            draw(1 << 40 | 1, 2, Domain::Photon, 3, 4),
            draw(1, 3, Domain::Photon, 3, 4),
            draw(1, 2, Domain::Eye, 3, 4),
            draw(1, 2, Domain::Photon, 4, 4),
            draw(1, 2, Domain::Photon, 3, 5),
        ] {
            assert_ne!(base, other);
        }
        let sample = |sample| Sampler::new(RandomKind::Counter, 1, 2, Domain::Eye, 3).of_sample(sample);
        assert_eq!(sample(0).words(4), draw(1, 2, Domain::Eye, 3, 4));
        for other in 1..4096 {
            assert_ne!(sample(other).words(4), sample(0).words(4));
            assert_eq!(sample(other).of_first_sample().words(4), sample(0).words(4));
            assert_ne!(sample(other).wavelength(0), sample(0).wavelength(0));
        }
    }
}
