//! Environment maps: the radiance from a direction, and sampling of directions.

use glam::Vec3;

use crate::scene::environment::EnvironmentMap;
use crate::scene::guide;
use crate::shading::math::{floor, sin_cos_turns, turns_of};

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct EnvironmentSample {
    /// Unit vector towards the environment.
    pub direction: Vec3,
    /// Radiance from there over the probability per solid angle of the direction, linear RGB.
    pub weight: Vec3,
    /// That probability density.
    pub pdf: f32,
}

impl EnvironmentMap {
    /// Radiance that arrives from `direction`, a unit vector.
    #[inline]
    #[must_use]
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let across = (direction.x * direction.x + direction.z * direction.z).sqrt();
        let from_centre = turns_of(direction.x.abs(), -direction.z);
        let u = 0.5 + from_centre.copysign(direction.x) + self.rotation();
        self.bilinear(u - floor(u), 2.0 * turns_of(across, direction.y))
    }

    /// The image at (u, v), both in `[0, 1]`: radiance without the map's rotation.
    #[inline]
    #[must_use]
    pub fn bilinear(&self, u: f32, v: f32) -> Vec3 {
        let (width, height) = (self.width(), self.height());
        let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
        let (left, above) = (floor(x), floor(y));
        let (across, down) = (x - left, y - above);
        let first = if left < 0.0 { width - 1 } else { (left as u32).min(width - 1) };
        let second = if first + 1 == width { 0 } else { first + 1 };
        let upper = (above.max(0.0) as u32).min(height - 1);
        let lower = ((above + 1.0) as u32).min(height - 1);
        let row = |y: u32| {
            let at = |x: u32| {
                let [r, g, b, _] = self.texels()[y as usize * width as usize + x as usize];
                Vec3::new(r, g, b)
            };
            at(first) * (1.0 - across) + at(second) * across
        };
        row(upper) * (1.0 - down) + row(lower) * down
    }

    /// The interval of `starts` that contains `random`: its index, the position in it, in `(0, 1)`, and its probability.
    /// `starts` are those of the rows or of the cells of a row, and begin with 0; `guide` is the guide table of them.
    #[inline]
    #[must_use]
    pub fn interval(starts: &[u32], guide: &[u16], random: u32) -> (usize, f32, f32) {
        let index = guide::pick(starts, guide, random);
        // The last interval ends at 2³², so that the difference wraps around; a single one is the whole range.
        let end = starts.get(index + 1).copied().unwrap_or(0);
        let span = end.wrapping_sub(starts[index]);
        let span = if span == 0 { 4_294_967_296.0 } else { span as f32 };
        // 24 bits are exact in f32.
        let within = ((random - starts[index]) as f32 + 0.5) / span;
        (index, within.min(1.0 - f32::EPSILON), span * (1.0 / 4_294_967_296.0))
    }

    /// A direction for two random words.
    #[inline]
    #[must_use]
    pub fn sample(&self, words: [u32; 2]) -> EnvironmentSample {
        let (row, within_row, _) = Self::interval(self.row_starts(), self.row_guide(), words[0]);
        let columns = self.columns() as usize;
        let cells = row * columns..(row + 1) * columns;
        let (starts, guide) = (&self.column_starts()[cells.clone()], &self.column_guides()[cells]);
        let (column, within_column, column_probability) = Self::interval(starts, guide, words[1]);
        let cell = self.rows()[row];
        // From the nearer pole, where differences are small.
        let height = cell.extent * within_row;
        let from_top = cell.above + height;
        let from_bottom = cell.below + (cell.extent - height);
        let upper = from_top < 0.5;
        let (low, high) = if upper { (from_top, 1.0 - from_top) } else { (1.0 - from_bottom, from_bottom) };
        let cosine = if upper { 1.0 - 2.0 * low } else { 2.0 * high - 1.0 };
        let sine = 2.0 * (low * high).max(0.0).sqrt();
        let span = 1.0 / self.width() as f32;
        let first = (column as u32 * self.step()) as f32;
        let texels = ((column as u32 + 1) * self.step()).min(self.width()) as f32 - first;
        let turns = (first + 0.5 + texels * within_column) * span - 0.5 - self.rotation();
        let (sin, cos) = sin_cos_turns(turns - floor(turns));
        let direction = Vec3::new(sin * sine, cosine, -cos * sine);
        let solid_angle = 4.0 * std::f32::consts::PI * cell.extent * (texels * span);
        let probability = cell.probability * column_probability;
        let weight = self.radiance(direction) * (solid_angle / probability);
        EnvironmentSample { direction, weight, pdf: probability / solid_angle }
    }

    /// The probability per solid angle with which [`Self::sample`] samples `direction`, a unit vector; that of a
    /// neighbouring cell at most, where rounding moves a direction across an edge.
    #[inline]
    #[must_use]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let across = (direction.x * direction.x + direction.z * direction.z).sqrt();
        let from_centre = turns_of(direction.x.abs(), -direction.z);
        let u = 0.5 + from_centre.copysign(direction.x) + self.rotation();
        // Cells begin at the centres of texels: the first row above the first centres, the first column at the first.
        let x = (u - floor(u)) * self.width() as f32 - 0.5;
        let column = if x < 0.0 { self.width() - 1 } else { (x as u32).min(self.width() - 1) } / self.step();
        let y = 2.0 * turns_of(across, direction.y) * self.height() as f32 + 0.5;
        let row = (y as u32).min(self.height()) / self.step();
        let cell = self.rows()[row as usize];
        let columns = self.columns() as usize;
        let starts = &self.column_starts()[row as usize * columns..(row as usize + 1) * columns];
        let column = column as usize;
        let end = starts.get(column + 1).copied().unwrap_or(0);
        let span = end.wrapping_sub(starts[column]);
        let span = if span == 0 { 4_294_967_296.0 } else { span as f32 };
        let texels = ((column as u32 + 1) * self.step()).min(self.width()) - column as u32 * self.step();
        let solid_angle = 4.0 * std::f32::consts::PI * cell.extent * (texels as f32 / self.width() as f32);
        cell.probability * (span * (1.0 / 4_294_967_296.0)) / solid_angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn gradient(width: usize, height: usize) -> EnvironmentMap {
        rotated(width, height, 0.0)
    }

    fn rotated(width: usize, height: usize, rotation: f64) -> EnvironmentMap {
        let mut numbers = SplitMix64(7);
        let texels: Vec<[f32; 3]> =
            (0..width * height).map(|_| std::array::from_fn(|_| (numbers.word() % 1000) as f32 * 0.01)).collect();
        EnvironmentMap::new(width, &texels, rotation).unwrap()
    }

    /// The density of a sampled direction is the same by [`EnvironmentMap::pdf`], except beside the edges of cells.
    #[test]
    fn densities_are_those_of_the_samples() {
        for (width, height, rotation) in [(1, 1, 0.0), (7, 3, 0.3), (16, 8, 0.0), (3000, 5, 0.9)] {
            let map = rotated(width, height, rotation);
            let mut numbers = SplitMix64(11);
            let different = (0..10_000)
                .filter(|_| {
                    let word = numbers.word();
                    let found = map.sample([word as u32, (word >> 32) as u32]);
                    assert!(
                        found.pdf > 0.0 && (found.weight * found.pdf - map.radiance(found.direction)).length() < 1e-3
                    );
                    (map.pdf(found.direction) / found.pdf - 1.0).abs() > 1e-5
                })
                .count();
            // Rounding of 2^-21 turns moves directions across the edges of 3000 columns.
            assert!(different <= if width > 1000 { 60 } else { 5 }, "{width} × {height}: {different}");
        }
    }

    /// The axes: the centre is −z, a quarter to the right +x, the top +y; a quarter turn counter-clockwise as seen from
    /// +y moves the centre to −x.
    #[test]
    fn axes_and_rotation() {
        let mut texels = vec![[0.0; 3]; 8 * 4];
        texels[8 + 5] = [1.0, 0.0, 0.0];
        let direction = |u: f32, v: f32| {
            let (sin, cos) = (std::f32::consts::TAU * (u - 0.5)).sin_cos();
            let (sine, cosine) = (std::f32::consts::PI * v).sin_cos();
            Vec3::new(sin * sine, cosine, -cos * sine)
        };
        let map = EnvironmentMap::new(8, &texels, 0.0).unwrap();
        let at = direction(5.5 / 8.0, 1.5 / 4.0);
        assert!((map.radiance(at).x - 1.0).abs() < 1e-5 && at.x > 0.5 && at.y > 0.3);
        let turned = EnvironmentMap::new(8, &texels, 0.25).unwrap();
        // (x, z) of a vector turned by a quarter counter-clockwise, seen from +y, where x is to the right and z down.
        let there = Vec3::new(at.z, at.y, -at.x);
        assert!((turned.radiance(there).x - 1.0).abs() < 1e-5);
        assert!(
            (EnvironmentMap::constant([0.5, 1.0, 2.0]).unwrap().radiance(at) - Vec3::new(0.5, 1.0, 2.0)).length()
                < 1e-6
        );
    }

    /// G10: L = 1 + a ω_y: the mean of weights is 4π, that of weights times max(n·ω, 0) is π (1 + ⅔ a n_y); the map is
    /// bilinear in θ, hence fine. Weights are bounded.
    #[test]
    fn samples_integrate_to_the_whole() {
        let (width, height, a) = (64, 512, 0.8);
        let texel = |i: usize| 1.0 + a * (std::f64::consts::PI * ((i / width) as f64 + 0.5) / height as f64).cos();
        let texels: Vec<[f32; 3]> = (0..width * height).map(|i| [texel(i) as f32; 3]).collect();
        let map = EnvironmentMap::new(width, &texels, 0.1).unwrap();
        let normal = Vec3::new(0.6, 0.64, -0.48);
        let (mut whole, mut half) = (0.0, 0.0);
        let n = 512_u32;
        for i in 0..n * n {
            let step = u32::MAX / n;
            let sample = map.sample([(i % n) * step + step / 2, (i / n) * step + step / 2]);
            assert!((sample.direction.length() - 1.0).abs() < 1e-5);
            whole += f64::from(sample.weight.x);
            half += f64::from(sample.weight.x * sample.direction.dot(normal).max(0.0));
        }
        let count = f64::from(n) * f64::from(n);
        let pi = std::f64::consts::PI;
        assert!((whole / count / (4.0 * pi) - 1.0).abs() < 1e-3, "{}", whole / count);
        assert!((half / count / (pi * (1.0 + 2.0 / 3.0 * a * 0.64)) - 1.0).abs() < 1e-3, "{}", half / count);
        assert!((map.mean_radiance()[0] - 1.0).abs() < 1e-4);
    }

    /// For any map, also one with joined cells, the mean of weights is the integral; and no weight is above four times
    /// the brightest sum of channels that its cell's share of the probability allows.
    #[test]
    fn weights_are_exact_and_bounded() {
        for (width, height) in [(1, 1), (2, 1), (1, 5), (7, 3), (33, 16), (4100, 8), (3, 2500)] {
            let map = gradient(width, height);
            let mut numbers = SplitMix64(width as u64);
            let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
            let count = 200_000;
            for _ in 0..count {
                let word = numbers.word();
                let sample = map.sample([word as u32, (word >> 32) as u32]);
                let weight = f64::from(sample.weight.element_sum() / 3.0);
                sum += weight;
                squares += weight * weight;
            }
            let truth = map.mean_radiance().iter().sum::<f64>() / 3.0 * 4.0 * std::f64::consts::PI;
            let mean = sum / f64::from(count);
            let error = ((squares / f64::from(count) - mean * mean).max(0.0) / f64::from(count)).sqrt();
            // Rounding of lookups.
            let bound = truth * 1e-4;
            assert!((mean - truth).abs() < 4.5 * error + bound, "{width} × {height}: {mean} {truth} {error}");
        }
    }

    /// V13: the mean radiance of a map of one row of texels, of the row at a pole alone, and with a factor of 10^±30, is the
    /// integral of lookups over θ, weighted by sin θ, by the midpoint rule in rows; it is scaled without rounding but that of texels.
    #[test]
    fn means_are_exact() {
        for (width, height, row) in [(1_usize, 1_usize, 0), (64, 32, 0), (64, 32, 31), (4, 2, 1), (8, 5, 2)] {
            for scale in [1e-30_f32, 1.0, 1e30] {
                let mut texels = vec![[0.0_f32; 3]; width * height];
                texels[row * width..(row + 1) * width].fill([scale, 0.5 * scale, 0.0]);
                let map = EnvironmentMap::new(width, &texels, 0.3).unwrap();
                let n = 20_000;
                let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
                let sum: f64 = (0..n)
                    .map(|k| f64::from(map.bilinear(0.4, at(k) as f32).x) * (std::f64::consts::PI * at(k)).sin())
                    .sum();
                let truth = sum * 0.5 * std::f64::consts::PI / f64::from(n);
                let mean = map.mean_radiance();
                // v in f32 is off by 6e-8, with a slope of the height over the mean.
                assert!((mean[0] / truth - 1.0).abs() < 1e-5, "{width} × {height}: {mean:?} {truth}");
                assert!((mean[1] / mean[0] - 0.5).abs() < 1e-6 && mean[2] == 0.0);
            }
        }
    }

    /// V13: black, one texel, a pole row alone, extremes.
    #[test]
    fn odd_maps() {
        let black = EnvironmentMap::constant([0.0; 3]).unwrap();
        assert_eq!(black.sample([5, 7]).weight, Vec3::ZERO);
        for scale in [1e-30, 1.0, 1e30] {
            let mut texels = vec![[0.0_f32; 3]; 64 * 32];
            texels[..64].fill([scale; 3]);
            let map = EnvironmentMap::new(64, &texels, 0.7).unwrap();
            for word in [0, 1, u32::MAX / 3, u32::MAX] {
                let sample = map.sample([word, u32::MAX - word]);
                assert!(sample.weight.is_finite() && sample.weight.min_element() >= 0.0, "{scale} {word}");
            }
        }
        for (width, texels) in [(0, vec![]), (3, vec![[0.0; 3]; 4]), (1, vec![[f32::NAN; 3]]), (1, vec![[-1.0; 3]])] {
            assert!(EnvironmentMap::new(width, &texels, 0.0).is_err());
        }
        assert!(EnvironmentMap::new(1, &[[1.0; 3]], f64::NAN).is_err());
    }
}
