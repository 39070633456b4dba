//! Refractive indices that depend on the wavelength.

use photon_core::{Medium, Spectrum, Wavelength};

use super::MaterialDesc;

/// Wavelengths of the lines F, d and C of Fraunhofer, in micrometres.
const LINES: [f64; 3] = [0.486_13, 0.587_56, 0.656_27];

/// Formula of the refractive index n of glass by the wavelength λ, from 0.38 to 0.78 µm. Values below 1 become 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Dispersion {
    /// By the Abbe number V = (n_d − 1)/(n_F − n_C), finite and > 0; n_d is the refractive index of the surface. Between the
    /// lines Cauchy's formula: that of glTF's `KHR_materials_dispersion`.
    Abbe(f64),
    /// `[A, B]` of n = A + B/λ², λ in micrometres.
    Cauchy([f64; 2]),
    /// `[B1, B2, B3, C1, C2, C3]` of n² = 1 + Σ Bλ²/(λ² − C), λ in micrometres and C in their squares.
    Sellmeier([f64; 6]),
}

impl Dispersion {
    /// Its name in override files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Abbe(_) => "abbe",
            Self::Cauchy(_) => "cauchy",
            Self::Sellmeier(_) => "sellmeier",
        }
    }

    /// The refractive index at a wavelength in micrometres, at least 1, where that at 0.58756 µm is given by `ior` unless the
    /// formula gives it too.
    #[must_use]
    pub fn index(self, ior: f64, micrometres: f64) -> f64 {
        // NaN, the root of a negative number, is 1 too.
        self.unclamped(ior, micrometres).max(1.0)
    }

    fn unclamped(self, ior: f64, micrometres: f64) -> f64 {
        let squared = micrometres * micrometres;
        match self {
            Self::Abbe(_) | Self::Cauchy(_) => {
                let [a, b] = self.cauchy(ior);
                a + b / squared
            }
            Self::Sellmeier([b1, b2, b3, c1, c2, c3]) => {
                let terms = [(b1, c1), (b2, c2), (b3, c3)].map(|(b, c)| b * squared / (squared - c));
                (1.0 + terms.iter().sum::<f64>()).sqrt()
            }
        }
    }

    /// Coefficients of Cauchy's formula, also for an Abbe number.
    fn cauchy(self, ior: f64) -> [f64; 2] {
        match self {
            // `KHR_materials_dispersion`, with λ in micrometres.
            Self::Abbe(abbe) => {
                let slope = (ior - 1.0) / abbe;
                [ior - 1.5168 * slope, 0.523_655 * slope]
            }
            Self::Cauchy(terms) => terms,
            Self::Sellmeier(_) => [1.0, 0.0],
        }
    }

    /// The refractive index of the surface: at the line d.
    pub(crate) fn ior(self, ior: f64) -> f64 {
        match self {
            Self::Abbe(_) => ior,
            Self::Cauchy(_) | Self::Sellmeier(_) => self.index(ior, LINES[1]),
        }
    }

    /// 20 divided by the Abbe number, as glTF has it: 0 without dispersion, and where the index rises with the wavelength.
    #[cfg(any(test, feature = "files"))]
    pub(crate) fn strength(self, ior: f64) -> f64 {
        if let Self::Abbe(abbe) = self {
            return 20.0 / abbe;
        }
        let [blue, middle, red] = LINES.map(|line| self.index(ior, line));
        let strength = 20.0 * (blue - red) / (middle - 1.0);
        if strength.is_finite() { strength.max(0.0) } else { 0.0 }
    }

    /// The formula in the table of media, and the refractive index at the line d.
    pub(crate) fn medium(self, ior: f64) -> Medium {
        let (dispersion, terms) = match self {
            Self::Sellmeier([b1, b2, b3, ..]) if [b1, b2, b3] == [0.0; 3] => (0, [0.0; 6]),
            Self::Sellmeier(terms) => (Medium::SELLMEIER, terms),
            Self::Abbe(_) | Self::Cauchy(_) => match self.cauchy(ior) {
                [_, 0.0] => (0, [0.0; 6]),
                [a, b] => (Medium::CAUCHY, [a, b, 0.0, 0.0, 0.0, 0.0]),
            },
        };
        let ior = self.ior(ior);
        // Clamped as that of all wavelengths.
        let ior = if dispersion == 0 { ior } else { ior.max(1.0) };
        Medium { ior: ior as f32, dispersion, terms: terms.map(|term| term as f32), ..Medium::VACUUM }
    }

    /// Its value, and usual ones if they are one number.
    fn in_words(self) -> (String, &'static str) {
        match self {
            Self::Abbe(abbe) => (format!("{abbe:?}"), "; glass has Abbe numbers of 20 to 90"),
            Self::Cauchy(terms) => (format!("{terms:?}"), ""),
            Self::Sellmeier(terms) => (format!("{terms:?}"), ""),
        }
    }

    /// Why it is invalid for a surface with this refractive index: the value and a hint.
    pub(crate) fn fault(self, ior: f64) -> Option<(String, &'static str)> {
        let (value, _) = self.in_words();
        let numbers = match self {
            Self::Abbe(abbe) => vec![abbe],
            Self::Cauchy(terms) => terms.to_vec(),
            Self::Sellmeier(terms) => terms.to_vec(),
        };
        if let Self::Abbe(abbe) = self
            && !(abbe.is_finite() && abbe > 0.0)
        {
            let hint =
                "an Abbe number must be finite and above 0, such as 60; leave it out for glass without dispersion";
            return Some((value, hint));
        }
        // The error for an invalid index is another one.
        if matches!(self, Self::Abbe(_)) && !ior.is_finite() {
            return None;
        }
        let medium = self.medium(ior);
        let mut indices = (0..Spectrum::CELLS).map(|cell| medium.index(Wavelength::of_cell(cell)));
        let is_valid = numbers.iter().all(|number| (*number as f32).is_finite())
            && medium.terms.iter().all(|term| term.is_finite())
            && medium.ior.is_normal()
            && indices.all(f32::is_normal);
        let hint = "the coefficients must be finite, and so must be the refractive index from 0.38 to 0.78 micrometres; \
                    wavelengths are in micrometres";
        (!is_valid).then_some((value, hint))
    }

    /// The least refractive index of visible light that is below 1, or none, and its wavelength in micrometres.
    fn clamped(self, ior: f64) -> Option<(f64, f64)> {
        let lines = (0..Spectrum::CELLS).map(|cell| f64::from(Wavelength::of_cell(cell).micrometres()));
        let indices = lines.map(|micrometres| (self.unclamped(ior, micrometres), micrometres));
        indices.filter(|(index, _)| !(*index >= 1.0)).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// Warns of solids whose refractive index is clamped.
pub(crate) fn warn(materials: &[MaterialDesc], warnings: &mut Vec<String>) {
    for desc in materials.iter().filter(|desc| desc.is_solid()) {
        if let (Some(dispersion), Some(ior)) = (desc.dispersion, desc.ior())
            && let Some((index, micrometres)) = dispersion.clamped(ior)
        {
            let (name, (value, usual)) = (dispersion.name(), dispersion.in_words());
            warnings.push(format!(
                "material '{}': its {name} {value} gives a refractive index of {index:.3} at {micrometres:.2} micrometres; \
                 1 is used for all below 1{usual}",
                desc.name
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The warning has what was given, the index that follows, and what is usual.
    #[test]
    fn indices_below_1_are_a_warning() {
        let warnings = |dispersion| {
            let mut warnings = Vec::new();
            warn(&[MaterialDesc::glass("prism", 1.5).with_dispersion(dispersion)], &mut warnings);
            warnings.join("\n")
        };
        for usual in [Dispersion::Abbe(20.0), Dispersion::Abbe(1.0), Dispersion::Cauchy([1.5, 0.004])] {
            assert_eq!(warnings(usual), "", "{usual:?}");
        }
        let text = warnings(Dispersion::Abbe(0.001));
        assert!(text.starts_with("material 'prism': its abbe 0.001 gives a refractive index of -"), "{text}");
        assert!(text.ends_with("below 1; glass has Abbe numbers of 20 to 90"), "{text}");
        let text = warnings(Dispersion::Cauchy([0.9, 0.0]));
        assert!(text.contains("its cauchy [0.9, 0.0] gives a refractive index of 0.900 at"), "{text}");
    }

    /// BK7 at the lines F, d and C by its catalogue, and its Abbe number; glTF's formula at an index of 1.5 and a dispersion
    /// of 0.33, as an independent program evaluates it.
    #[test]
    fn indices_of_known_glass() {
        let terms = [1.039_612_12, 0.231_792_344, 1.010_469_45, 0.006_000_698_67, 0.020_017_914_4, 103.560_653];
        let bk7 = Dispersion::Sellmeier(terms);
        for (line, expected) in LINES.into_iter().zip([1.522_38, 1.516_80, 1.514_32]) {
            assert!((bk7.index(1.0, line) - expected).abs() < 1e-5);
        }
        assert!((20.0 / bk7.strength(1.0) - 64.1673).abs() < 2e-3, "{}", 20.0 / bk7.strength(1.0));
        let gltf = Dispersion::Abbe(20.0 / 0.33);
        for (line, expected) in LINES.into_iter().zip([1.505_767, 1.500_000, 1.497_517]) {
            assert!((gltf.index(1.5, line) - expected).abs() < 1e-6, "{line}");
        }
        // The means of the channels, to the precision of the matching functions.
        let mean = |channel: usize| -> f64 {
            let cells = (0..Spectrum::CELLS).zip(Spectrum::get().cells());
            let index = |cell| gltf.index(1.5, f64::from(Wavelength::of_cell(cell).micrometres()));
            cells.map(|(cell, of)| f64::from(of.share[channel]) * index(cell)).sum()
        };
        for (channel, expected) in [1.499_701, 1.502_385, 1.508_788].into_iter().enumerate() {
            assert!((mean(channel) - expected).abs() < 1e-5, "{}", mean(channel));
        }
        // The table of media has the same; f32 keeps it to 2⁻²³.
        for dispersion in [bk7, gltf, Dispersion::Cauchy([1.6, 0.02])] {
            let medium = dispersion.medium(1.5);
            for wavelength in (0..Spectrum::CELLS).map(Wavelength::of_cell) {
                let exact = dispersion.index(1.5, f64::from(wavelength.micrometres()));
                assert!((f64::from(medium.index(wavelength)) - exact).abs() < 4e-7);
            }
        }
    }
}
