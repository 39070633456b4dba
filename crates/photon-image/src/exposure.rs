//! The exposure of a tone-mapped picture.

use std::str::FromStr;

/// Luminance that the mean of a picture is brought to: middle grey.
const KEY: f64 = 0.18;
/// Share of the pixels that is left out at either end.
const TRIMMED: f64 = 0.1;

/// Beyond so many stops, a factor is not a normal number of 32 bits.
const MOST_STOPS: f32 = 126.0;

/// The exposure of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// Stops: a factor of a power of two.
    Stops(f32),
    /// Derived from the picture.
    Auto,
}

impl FromStr for Exposure {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            number => match number.parse::<f32>() {
                Ok(stops) if stops.abs() <= MOST_STOPS => Ok(Self::Stops(stops)),
                _ => Err(format!("give a number of stops such as -1.5, from -{MOST_STOPS} to {MOST_STOPS}, or auto")),
            },
        }
    }
}

/// The pixels that decide the exposure: those that are mostly covered by surfaces, or all if there are none. Surroundings
/// are often far brighter or darker than what stands in them. `alpha` is [`photon_core::Film::alpha`].
#[must_use]
pub fn measured(colours: &[[f32; 3]], alpha: &[f32]) -> Vec<[f32; 3]> {
    let covered: Vec<[f32; 3]> =
        colours.iter().zip(alpha).filter(|&(_, &alpha)| alpha >= 0.5).map(|(&colour, _)| colour).collect();
    if covered.is_empty() { colours.to_vec() } else { covered }
}

impl Exposure {
    /// The exposure in stops of a picture in linear RGB.
    ///
    /// [`Exposure::Auto`]: `log2(0.18 / L)`, where L is the log-average luminance (Reinhard et al. 2002, equation 1) of the
    /// pixels whose luminance is positive and finite, without the darkest and the brightest tenth of them: neither a black
    /// background nor light sources nor noise in the dark decide. 0 for a picture without such pixels.
    #[must_use]
    pub fn stops(self, colours: &[[f32; 3]]) -> f32 {
        match self {
            Self::Stops(stops) => stops,
            Self::Auto => {
                let luminance =
                    |[r, g, b]: [f32; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
                let lit = colours.iter().map(|&colour| luminance(colour)).filter(|&l| l > 0.0 && l.is_finite());
                let mut logarithms: Vec<f64> = lit.map(f64::log2).collect();
                logarithms.sort_unstable_by(f64::total_cmp);
                let trimmed = (logarithms.len() as f64 * TRIMMED) as usize;
                let kept = &logarithms[trimmed..logarithms.len() - trimmed];
                if kept.is_empty() { 0.0 } else { (KEY.log2() - kept.iter().sum::<f64>() / kept.len() as f64) as f32 }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_are_read() {
        assert_eq!("auto".parse(), Ok(Exposure::Auto));
        assert_eq!("-1.5".parse(), Ok(Exposure::Stops(-1.5)));
        assert_eq!("126".parse(), Ok(Exposure::Stops(126.0)));
        for bad in ["bright", "nan", "inf", "126.5", "-1e9"] {
            assert!(bad.parse::<Exposure>().unwrap_err().contains("-126 to 126"), "{bad}");
        }
        assert_eq!(Exposure::Stops(2.0).stops(&[[1.0; 3]]), 2.0);
    }

    #[test]
    fn surfaces_are_measured_rather_than_surroundings() {
        let colours = [[1.0; 3], [2.0; 3], [3.0; 3]];
        assert_eq!(measured(&colours, &[0.0, 1.0, 0.4]), [[2.0; 3]]);
        assert_eq!(measured(&colours, &[0.0; 3]), colours);
    }

    #[test]
    fn the_middle_of_the_picture_becomes_grey() {
        let auto = |colours: &[[f32; 3]]| Exposure::Auto.stops(colours);
        // Two stops below middle grey, and the same with black, light sources, NaN and noise.
        let even = [[0.045_f32; 3]; 8];
        assert!((auto(&even) - 2.0).abs() < 1e-5, "{}", auto(&even));
        let odd = [[0.0; 3], [1e6; 3], [1e-20; 3], [f32::NAN; 3], [f32::INFINITY; 3], [-1.0; 3]];
        let mixed = [&even[..], &odd].concat();
        assert!((auto(&mixed) - 2.0).abs() < 1e-5, "{}", auto(&mixed));
        // The geometric mean of 1 and 1/16.
        let two = [[1.0; 3], [0.0625; 3]];
        assert!((auto(&two) - (0.18_f32 / 0.25).log2()).abs() < 1e-5);
        // Twice the light is a stop less.
        assert!((auto(&two.map(|c| c.map(|x| 2.0 * x))) - auto(&two) + 1.0).abs() < 1e-5);
        assert_eq!(auto(&[]), 0.0);
        assert_eq!(auto(&[[0.0; 3]; 3]), 0.0);
    }
}
