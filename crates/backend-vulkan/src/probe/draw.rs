//! Inputs of probes: special values and random ones.

use photon_core::glam::Vec3;
use photon_core::random::{philox4x32, unit_f32};

use super::Input;

/// Inputs per function.
const COUNT: u32 = 20_000;

/// Half a step of a 24-bit number.
pub(super) const LAST: f32 = 1.0 / 16_777_216.0;

/// Generates the values of one input.
#[derive(Debug)]
pub(super) struct Draw {
    index: u32,
    stream: u32,
    next: u32,
}

/// A table of inputs, always the same.
pub(super) fn inputs(draw: fn(&mut Draw) -> Input) -> Vec<Input> {
    (0..COUNT).map(|index| draw(&mut Draw::of(index, 0))).collect()
}

impl Draw {
    /// Random numbers of one of several streams.
    pub(super) fn of(index: u32, stream: u32) -> Self {
        Self { index, stream, next: 0 }
    }

    /// Index of the input.
    pub(super) fn index(&self) -> u32 {
        self.index
    }

    pub(super) fn word(&mut self) -> u32 {
        self.next += 1;
        philox4x32([self.index, self.next, self.stream, 0], [0x5EED, 0])[0]
    }

    /// One of a few values.
    pub(super) fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.word() as usize % of.len()]
    }

    /// True occasionally, so that special values are combined with each other and with ordinary ones.
    pub(super) fn now_and_then(&mut self) -> bool {
        self.word().is_multiple_of(4)
    }

    /// A random number in `[0, 1)`, as the generators return it; includes multiples of an eighth.
    pub(super) fn unit(&mut self) -> f32 {
        if self.now_and_then() {
            let edge = self.pick(&[0.0, LAST, 2.0 * LAST, 1.0 - LAST]);
            let eighths = self.pick(&[0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875]);
            let beside = self.pick(&[eighths, (eighths - LAST).abs(), eighths + LAST]);
            return self.pick(&[edge, beside]);
        }
        unit_f32(self.word())
    }

    /// In `[from, to)`.
    pub(super) fn between(&mut self, from: f32, to: f32) -> f32 {
        from + unit_f32(self.word()) * (to - from)
    }

    /// A positive number, over many powers of two.
    pub(super) fn magnitude(&mut self, least: i32, most: i32) -> f32 {
        let exponent = least + (self.word() % (most - least) as u32) as i32;
        self.between(1.0, 2.0) * 2.0_f32.powi(exponent)
    }

    /// A unit vector; includes axes, their neighbourhoods, diagonals and the circle z = 0.
    pub(super) fn direction(&mut self) -> Vec3 {
        if self.now_and_then() {
            let small = [0.0, -0.0, 1e-30, -1e-30, 1e-7, -1e-7, 1e-4, -1e-4];
            let (a, b, one) = (self.pick(&small), self.pick(&small), self.pick(&[1.0, -1.0]));
            let diagonal = Vec3::new(1.0, self.pick(&[1.0, -1.0]), one).normalize();
            let around = Vec3::new(self.between(-1.0, 1.0), 0.75, a).normalize();
            return self.pick(&[Vec3::new(one, a, b), Vec3::new(a, one, b), Vec3::new(a, b, one), diagonal, around]);
        }
        photon_core::sampling::uniform_sphere(unit_f32(self.word()), unit_f32(self.word()))
    }

    /// A point of the unit box; includes the origin, its neighbourhood and the threshold of the ray offset.
    pub(super) fn point(&mut self) -> Vec3 {
        let near = 1.0 / 32.0_f32;
        let special = [
            0.0,
            -0.0,
            1e-40,
            -1e-30,
            near,
            f32::from_bits(near.to_bits() - 1),
            -near,
            0.5,
            -0.5,
            0.25,
            f32::from_bits(0.25_f32.to_bits() - 1),
        ];
        let mut axis = || if self.now_and_then() { self.pick(&special) } else { self.between(-0.5, 0.5) };
        Vec3::new(axis(), axis(), axis())
    }

    /// Any bit pattern, including special values.
    pub(super) fn any(&mut self) -> f32 {
        let famous = [
            0.0,
            -0.0,
            1e-40,
            f32::MIN_POSITIVE,
            -f32::MIN_POSITIVE,
            1.0 - LAST,
            1.0,
            f32::from_bits(0x3F80_0001),
            f32::MAX,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
        ];
        if self.now_and_then() { self.pick(&famous) } else { f32::from_bits(self.word()) }
    }
}

/// Assembles an input from three vectors.
pub(super) fn input(a: [f32; 4], b: [f32; 4], c: [f32; 4]) -> Input {
    let mut words = [0; 12];
    for (word, float) in words.iter_mut().zip(a.iter().chain(&b).chain(&c)) {
        *word = float.to_bits();
    }
    Input(words)
}

impl Input {
    pub(super) fn float(&self, place: usize) -> f32 {
        f32::from_bits(self.0[place])
    }

    /// The vector that begins at word `place`.
    pub(super) fn vector(&self, place: usize) -> Vec3 {
        Vec3::new(self.float(place), self.float(place + 1), self.float(place + 2))
    }
}
