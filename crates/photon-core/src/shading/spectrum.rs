//! Wavelengths of light that refraction disperses; `spectrum.glsl` is the twin.
//!
//! Maps, albedos and films are of three channels. A path has no wavelength until it meets a boundary whose refractive index
//! depends on it. There it draws one, which it keeps: a channel by its share w of the power, and a wavelength with the
//! density b of that channel. Each channel is then multiplied by `b(λ)/Σ w b(λ)`: right on average, and the sum of the
//! channels is unchanged. The densities are the positive parts of the colour matching functions of Rec. 709.
//!
//! The photons and the camera path draw wavelengths of their own, if both disperse: right for either path by itself.

use std::sync::OnceLock;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// The wavelength of a path: none, or a cell of the [`Spectrum`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Wavelength(u32);

impl Wavelength {
    /// Of a path that has not drawn one.
    pub const NONE: Self = Self(0);
    /// Number of bits that [`Self::bits`] needs.
    pub const BITS: u32 = 9;

    /// That of a cell of the spectrum, below [`Spectrum::CELLS`].
    #[inline]
    #[must_use]
    pub const fn of_cell(cell: u32) -> Self {
        Self(cell + 1)
    }

    /// The bits, as stored with a path: 0 for none, 1 + cell otherwise.
    #[inline]
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether the path has drawn a wavelength.
    #[inline]
    #[must_use]
    pub const fn is_drawn(self) -> bool {
        self.0 != 0
    }

    /// The middle of the cell, in micrometres, if there is one.
    #[inline]
    #[must_use]
    pub fn micrometres(self) -> f32 {
        (self.0 as f32 - 0.5) * Spectrum::STEP + Spectrum::FIRST
    }
}

/// The share of each channel in one cell of the spectrum, and in it and all cells before. Multiples of 2⁻²⁴.
// Exhaustive: a record of buffers, whose layout is part of the interface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct SpectrumCell {
    /// Probability of the cell for red, green and blue light.
    pub share: [f32; 3],
    /// The sum up to this cell; 1 in the last one.
    pub cumulative: [f32; 3],
}

/// The densities of wavelengths of each channel, in cells of equal width.
#[derive(Clone, Debug)]
pub struct Spectrum {
    cells: Vec<SpectrumCell>,
}

impl Spectrum {
    /// Number of cells.
    pub const CELLS: u32 = 256;
    /// The shortest wavelength, in micrometres.
    pub const FIRST: f32 = 0.38;
    /// Width of a cell, in micrometres: the longest wavelength is 0.78.
    pub const STEP: f32 = 0.001_562_5;

    /// The table, which is computed once.
    #[must_use]
    pub fn get() -> &'static Self {
        static TABLE: OnceLock<Spectrum> = OnceLock::new();
        TABLE.get_or_init(Self::new)
    }

    fn new() -> Self {
        let nanometres = |cell: u32| 1e3 * f64::from(Wavelength::of_cell(cell).micrometres());
        let densities: Vec<[f64; 3]> =
            (0..Self::CELLS).map(|cell| rec709(nanometres(cell)).map(|value| value.max(0.0))).collect();
        let totals: [f64; 3] = std::array::from_fn(|c| densities.iter().map(|density| density[c]).sum());
        let (mut sums, mut before) = ([0.0_f64; 3], [0.0_f32; 3]);
        let mut cells = Vec::with_capacity(densities.len());
        for density in densities {
            let cumulative: [f32; 3] = std::array::from_fn(|c| {
                sums[c] += density[c] / totals[c];
                ((sums[c] * 16_777_216.0).round() / 16_777_216.0) as f32
            });
            cells.push(SpectrumCell { share: std::array::from_fn(|c| cumulative[c] - before[c]), cumulative });
            before = cumulative;
        }
        Self { cells }
    }

    /// All cells, by wavelength.
    #[must_use]
    pub fn cells(&self) -> &[SpectrumCell] {
        &self.cells
    }

    /// Draws the wavelength of light of this `power` by a uniform number, and multiplies the channels by their share in it.
    #[must_use]
    pub fn draw(&self, power: &mut Vec3, u: f32) -> Wavelength {
        let [red, green, blue] = power.to_array();
        let sum = red + green + blue;
        let mut rest = u * sum;
        let (mut channel, mut of) = (0, red);
        if rest >= of {
            rest -= of;
            (channel, of) = (1, green);
        }
        if channel == 1 && rest >= of {
            rest -= of;
            (channel, of) = (2, blue);
        }
        // The first cell up to which the channel has more power than `rest`.
        let (mut low, mut high) = (0, Self::CELLS - 1);
        while low < high {
            let middle = (low + high) / 2;
            if self.cells[middle as usize].cumulative[channel] * of > rest {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        let share = self.cells[low as usize].share;
        let mixed = red * share[0] + green * share[1] + blue * share[2];
        // Not for black light, and where rounding has led to a cell without light.
        if mixed > 0.0 {
            let scale = sum / mixed;
            *power = Vec3::new(red * (share[0] * scale), green * (share[1] * scale), blue * (share[2] * scale));
        }
        Wavelength::of_cell(low)
    }
}

/// The matching functions of the primaries of Rec. 709 at a wavelength in nanometres, from those of CIE 1931.
fn rec709(nanometres: f64) -> [f64; 3] {
    let [x, y, z] = cie_1931(nanometres);
    // The fit makes green positive at both ends of the spectrum, where the observer's is negative.
    let is_green = (420.0..=680.0).contains(&nanometres);
    [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        if is_green { -0.969_266_0 * x + 1.876_010_8 * y + 0.041_556_0 * z } else { 0.0 },
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
}

/// The colour matching functions of the CIE 1931 2° observer: Wyman, Sloan and Shirley 2013, listing 1.
fn cie_1931(nanometres: f64) -> [f64; 3] {
    let lobe = |mean: f64, [below, above]: [f64; 2]| {
        let t = (nanometres - mean) * if nanometres < mean { below } else { above };
        libm::exp(-0.5 * t * t)
    };
    [
        0.362 * lobe(442.0, [0.0624, 0.0374]) + 1.056 * lobe(599.8, [0.0264, 0.0323])
            - 0.065 * lobe(501.1, [0.0490, 0.0382]),
        0.821 * lobe(568.8, [0.0213, 0.0247]) + 0.286 * lobe(530.9, [0.0613, 0.0322]),
        1.217 * lobe(437.0, [0.0845, 0.0278]) + 0.681 * lobe(459.0, [0.0385, 0.0725]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean wavelengths in nanometres, and the share of red light below 480 nm, as an independent program finds them.
    #[test]
    fn densities_are_those_of_rec_709() {
        let cells = Spectrum::get().cells();
        assert_eq!(cells[255].cumulative, [1.0; 3]);
        for (channel, mean) in [601.2, 540.7, 451.8].into_iter().enumerate() {
            let of = |cell: u32| f64::from(cells[cell as usize].share[channel]);
            assert_eq!((0..256).map(of).sum::<f64>(), 1.0);
            let found: f64 =
                (0..256).map(|cell| 1e3 * f64::from(Wavelength::of_cell(cell).micrometres()) * of(cell)).sum();
            assert!((found - mean).abs() < 0.5, "{channel}: {found}");
        }
        let violet: f32 = cells.iter().take(64).map(|cell| cell.share[0]).sum();
        assert!((violet - 0.046).abs() < 0.001, "{violet}");
    }

    /// Over evenly spaced numbers, the mean of each channel is its power, as closely as the cells are hit: the sum of
    /// n numbers misses the mass of each of 256 cells by at most 1/n, which is worth at most the sum of the channels.
    #[test]
    fn channels_are_right_on_average_and_their_sum_always() {
        let count = 1 << 20;
        for power in [[1.0, 1.0, 1.0], [0.2, 0.7, 0.1], [1e-12, 3e-12, 0.0], [0.0, 0.0, 5.0], [0.0; 3]] {
            let (before, mut mean) = (Vec3::from(power), [0.0_f64; 3]);
            let total = f64::from(before.element_sum());
            for i in 0..count {
                let mut after = before;
                let drawn = Spectrum::get().draw(&mut after, i as f32 / count as f32);
                assert!(drawn.is_drawn() && after.min_element() >= 0.0);
                assert!((f64::from(after.element_sum()) - total).abs() <= 4e-7 * total);
                (0..3).for_each(|c| mean[c] += f64::from(after[c]) / f64::from(count));
            }
            for c in 0..3 {
                let missed = (mean[c] - f64::from(power[c])).abs();
                assert!(missed <= (3.0 * 256.0 / f64::from(count) + 4e-7) * total, "{power:?}: {mean:?}");
            }
        }
    }
}
