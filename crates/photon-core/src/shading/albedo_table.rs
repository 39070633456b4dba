//! Directional albedos of GGX reflection, by cosine and roughness.
//!
//! With Schlick's Fresnel factor, `F = F0 (1 − s) + F90 s` with `s = (1 − o·h)⁵`, the share of light that single
//! scattering reflects is `F0 A + F90 B`, where A and B do not depend on the material. Both are tabulated over √cos and
//! roughness, and interpolated linearly: the error is below 2.5e-3.

use std::sync::LazyLock;

use glam::{Vec2, Vec3};

use crate::parallel;
use crate::shading::ggx;

/// Directional albedos A and B of single scattering, and their means over the hemisphere.
#[derive(Debug)]
pub struct AlbedoTable {
    /// A and B: row by roughness, column by √cos; then the means of each row, `2 ∫ A cos d cos` of what is interpolated.
    entries: Vec<[f32; 2]>,
}

/// Points of the quadrature over sampled directions.
const ACROSS: usize = 64;
const AROUND: usize = 24;

static TABLE: LazyLock<AlbedoTable> = LazyLock::new(AlbedoTable::compute);

/// [`AlbedoTable::SIZE`].
const SIZE: usize = AlbedoTable::SIZE;

impl AlbedoTable {
    /// Entries along each axis.
    pub const SIZE: usize = 32;

    /// The table, computed at first use by all cores: some 50 milliseconds of processor time.
    #[must_use]
    pub fn get() -> &'static Self {
        &TABLE
    }

    /// All entries: [`Self::SIZE`] rows of that many columns, then as many means.
    #[must_use]
    pub fn entries(&self) -> &[[f32; 2]] {
        &self.entries
    }

    fn compute() -> Self {
        Self { entries: tabulate(single_scattering) }
    }

    /// A and B for directions with this cosine, in `[0, 1]`, at a roughness in `[0, 1]`.
    #[inline]
    #[must_use]
    pub fn directional(&self, cosine: f32, roughness: f32) -> Vec2 {
        directional_of(&self.entries, cosine, roughness)
    }

    /// The table at one roughness in `[0, 1]`, to be read at several cosines.
    #[inline(always)]
    pub(crate) fn row(&self, roughness: f32) -> Row<'_> {
        row_of(&self.entries, roughness)
    }

    /// A and B averaged over the hemisphere, weighted by the cosine.
    #[inline]
    #[must_use]
    pub fn mean(&self, roughness: f32) -> Vec2 {
        mean_of(&self.entries, roughness)
    }
}

/// The entries of a table of two albedos, in the order of [`AlbedoTable::entries`], from the function of α and the cosine
/// that it tabulates. The rows are shared by all cores.
pub(crate) fn tabulate(albedos_of: impl Fn(f32, f32) -> [f64; 2] + Sync) -> Vec<[f32; 2]> {
    let last = (SIZE - 1) as f64;
    let rows = parallel::map(parallel::threads(), 0..SIZE, |_, row| {
        let roughness = row as f64 / last;
        let alpha = (roughness * roughness).max(f64::from(ggx::MIN_ALPHA)) as f32;
        let albedos: Vec<[f64; 2]> = (0..SIZE)
            .map(|column| {
                let root = column as f64 / last;
                // The limit at 0 is approached, not reached.
                albedos_of(alpha, (root * root).max(1e-6) as f32)
            })
            .collect();
        // 4 ∫ E x³ dx with x = √cos, exact for linear pieces.
        let mut mean = [0.0; 2];
        for (column, pair) in albedos.windows(2).enumerate() {
            let (x0, x1) = (column as f64 / last, (column + 1) as f64 / last);
            for c in 0..2 {
                mean[c] += linear_times_cube(x0, x1, pair[0][c], pair[1][c]) * 4.0;
            }
        }
        (albedos, mean)
    });
    let single = |pair: &[f64; 2]| pair.map(|value| value as f32);
    let means: Vec<[f32; 2]> = rows.iter().map(|(_, mean)| single(mean)).collect();
    rows.iter().flat_map(|(albedos, _)| albedos).map(single).chain(means).collect()
}

/// A table of two albedos between two rows.
pub(crate) struct Row<'a> {
    /// The entries of both rows.
    entries: &'a [[f32; 2]; 2 * SIZE],
    /// Position between the rows.
    down: f32,
}

impl Row<'_> {
    /// Both albedos for directions with this cosine, in `[0, 1]`.
    #[inline(always)]
    pub(crate) fn directional(&self, cosine: f32) -> Vec2 {
        let (column, across) = place(cosine.sqrt());
        let at = |first: usize| mix(self.entries[first], self.entries[first + 1], across);
        at(column) * (1.0 - self.down) + at(SIZE + column) * self.down
    }
}

/// A table at a roughness in `[0, 1]`.
#[inline(always)]
fn row_of(entries: &[[f32; 2]], roughness: f32) -> Row<'_> {
    let (row, down) = place(roughness);
    let entries = entries[row * SIZE..].first_chunk().expect("`place` returns a row with another one after it");
    Row { entries, down }
}

/// Both albedos of a table for directions with this cosine, in `[0, 1]`, at a roughness in `[0, 1]`.
#[inline]
pub(crate) fn directional_of(entries: &[[f32; 2]], cosine: f32, roughness: f32) -> Vec2 {
    row_of(entries, roughness).directional(cosine)
}

/// Both means of a table.
#[inline]
pub(crate) fn mean_of(entries: &[[f32; 2]], roughness: f32) -> Vec2 {
    let (row, down) = place(roughness);
    let first = SIZE * SIZE + row;
    mix(entries[first], entries[first + 1], down)
}

#[inline]
fn mix(from: [f32; 2], to: [f32; 2], share: f32) -> Vec2 {
    Vec2::from(from) * (1.0 - share) + Vec2::from(to) * share
}

/// The entry before a coordinate in `[0, 1]`, and the position between it and the next one.
#[inline]
fn place(coordinate: f32) -> (usize, f32) {
    let at = coordinate * (SIZE - 1) as f32;
    let first = (at as usize).min(SIZE - 2);
    (first, at - first as f32)
}

/// ∫ (linear from y0 to y1) x³ dx from x0 to x1.
fn linear_times_cube(x0: f64, x1: f64, y0: f64, y1: f64) -> f64 {
    let slope = (y1 - y0) / (x1 - x0);
    let constant = y0 - slope * x0;
    constant * (x1.powi(4) - x0.powi(4)) / 4.0 + slope * (x1.powi(5) - x0.powi(5)) / 5.0
}

/// A and B by a quadrature over sampled directions.
fn single_scattering(alpha: f32, cosine: f32) -> [f64; 2] {
    let o = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let mut sums = [0.0_f64; 2];
    for i in 0..ACROSS {
        let u = (i as f32 + 0.5) / ACROSS as f32;
        for j in 0..AROUND {
            // Half a turn is enough, by symmetry.
            let direction = ggx::sample(alpha, o, u, 0.5 * (j as f32 + 0.5) / AROUND as f32);
            if direction.z <= 0.0 {
                continue;
            }
            let h = (o + direction).normalize_or(Vec3::Z);
            let value = ggx::distribution(alpha, h) * ggx::visibility(alpha, o.z, direction.z) * direction.z;
            let weight = f64::from(value / ggx::pdf(alpha, o, h));
            let grazing = f64::from(1.0 - o.dot(h).clamp(0.0, 1.0)).powi(5);
            sums[0] += weight * (1.0 - grazing);
            sums[1] += weight * grazing;
        }
    }
    sums.map(|sum| sum / (ACROSS * AROUND) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// G2: for α = 1, E(μ) = 1 − μ ln(1 + 1/μ) with the mean 4/3 (1 − ln 2); other widths from a reference quadrature.
    #[test]
    fn albedos_of_a_perfect_reflector() {
        let table = AlbedoTable::get();
        let total = |cosine: f32, roughness: f32| table.directional(cosine, roughness).element_sum();
        for cosine in [1.0_f32, 0.7, 0.5, 0.25, 0.1, 0.03] {
            let mu = f64::from(cosine);
            let expected = 1.0 - mu * (1.0 + 1.0 / mu).ln();
            assert!((f64::from(total(cosine, 1.0)) - expected).abs() < 2.5e-3, "{cosine}");
        }
        assert!((table.mean(1.0).element_sum() - 0.409_137_1).abs() < 1e-3);
        for (alpha, expected, mean) in [
            (0.1_f32, [0.98830, 0.96920, 0.88345], 0.97205),
            (0.25, [0.91581, 0.85726, 0.89162], 0.88232),
            (0.5, [0.68785, 0.69825, 0.86011], 0.70024),
        ] {
            for (cosine, expected) in [1.0_f32, 0.5, 0.1].into_iter().zip(expected) {
                let found = total(cosine, alpha.sqrt());
                assert!((found - expected).abs() < 2.5e-3, "α {alpha}, cos {cosine}: {found} for {expected}");
            }
            let found = table.mean(alpha.sqrt()).element_sum();
            assert!((found - mean).abs() < 2.5e-3, "α {alpha}: {found} for {mean}");
        }
    }

    /// G3: a dielectric with F0 = .04.
    #[test]
    fn albedos_of_a_dielectric() {
        let table = AlbedoTable::get();
        let of = |pair: Vec2| 0.04 * pair.x + pair.y;
        for (alpha, expected, mean) in [
            (0.25_f32, [0.03666, 0.05574], 0.05322),
            (0.5, [0.02756, 0.03767], 0.03602),
            (1.0, [0.01231, 0.02090], 0.01901),
        ] {
            for (cosine, expected) in [1.0_f32, 0.5].into_iter().zip(expected) {
                let found = of(table.directional(cosine, alpha.sqrt()));
                assert!((found - expected).abs() < 5e-4, "α {alpha}, cos {cosine}: {found} for {expected}");
            }
            assert!((of(table.mean(alpha.sqrt())) - mean).abs() < 5e-4, "α {alpha}");
        }
        // A smooth surface: Schlick's factor itself, with the mean F0 + (1 − F0)/21.
        assert!((of(table.mean(0.0)) - (0.04 + 0.96 / 21.0)).abs() < 1e-3);
        assert!((table.directional(1.0, 0.0) - Vec2::new(1.0, 0.0)).length() < 1e-3);
    }
}
