//! Difference of two pictures of one scene, compared with the noise of each.

use photon_core::Film;

/// Measures of the difference of two films.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Mean of the second over mean of the first, minus 1.
    pub mean: f64,
    /// Root mean square of the differences over the mean of the first.
    pub rms: f64,
    /// Noise: root mean square of the first film's own estimate of its standard errors, over the mean of the first.
    pub noise: f64,
    /// Fraction of the pixels that differ by more than a hundredth of the mean.
    pub apart: f64,
    /// Largest difference over the mean of the first.
    pub greatest: f64,
}

/// Compares the pictures, by the mean of RGB.
///
/// # Panics
/// If their sizes differ.
#[must_use]
pub fn between(a: &Film, b: &Film) -> Difference {
    assert_eq!((a.width, a.height), (b.width, b.height), "pictures differ in size");
    let grey = |film: &Film| -> Vec<f64> {
        film.beauty().iter().map(|c| c.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0).collect()
    };
    let (left, right) = (grey(a), grey(b));
    let n = left.len() as f64;
    let level = left.iter().sum::<f64>() / n;
    let differences: Vec<f64> = left.iter().zip(&right).map(|(a, b)| b - a).collect();
    let noise = a.standard_error();
    let root = |squares: f64| (squares / n).sqrt() / level;
    Difference {
        mean: differences.iter().sum::<f64>() / n / level,
        rms: root(differences.iter().map(|d| d * d).sum()),
        noise: root(noise.iter().map(|&s| f64::from(s) * f64::from(s)).sum()),
        apart: differences.iter().filter(|d| !(d.abs() <= 0.01 * level)).count() as f64 / n,
        greatest: differences.iter().fold(0.0, |most, d| d.abs().max(most)) / level,
    }
}

/// The difference as a picture: grey for no difference, brighter or darker by `gain` times the difference over
/// the mean.
#[must_use]
pub fn picture(a: &Film, b: &Film, gain: f32) -> Vec<u8> {
    signed(&a.beauty(), &b.beauty(), gain)
}

/// Pixels of [`picture`] for two pictures; if the first is black everywhere, differences are absolute.
#[must_use]
pub fn signed(left: &[[f32; 3]], right: &[[f32; 3]], gain: f32) -> Vec<u8> {
    let level = left.iter().flatten().sum::<f32>() / (3 * left.len()) as f32;
    let level = if level > 0.0 { level } else { 1.0 };
    let shade = |a: f32, b: f32| (127.5 + 127.5 * gain * (b - a) / level).clamp(0.0, 255.0) as u8;
    left.iter().zip(right).flat_map(|(a, b)| [shade(a[0], b[0]), shade(a[1], b[1]), shade(a[2], b[2])]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use photon_core::Units;

    fn film(level: f64, spot: f64) -> Film {
        let mut film = Film::new(10, 10, Units::default()).expect("a size");
        for pixel in &mut film.pixels {
            pixel.layers[0] = [level; 3];
        }
        film.pixels[55].layers[0] = [spot; 3];
        film.passes = 1;
        film
    }

    #[test]
    fn one_pixel_that_is_off_shows() {
        let d = between(&film(1.0, 1.0), &film(1.0, 2.0));
        assert!((d.apart - 0.01).abs() < 1e-9 && (d.greatest - 1.0).abs() < 1e-6);
        assert!((d.mean - 0.01).abs() < 1e-6 && (d.rms - 0.1).abs() < 1e-6);
    }

    #[test]
    fn a_film_does_not_differ_from_itself() {
        let d = between(&film(1.0, 3.0), &film(1.0, 3.0));
        assert!(d.mean == 0.0 && d.rms == 0.0 && d.apart == 0.0);
    }

    #[test]
    fn broken_numbers_are_apart() {
        assert!(between(&film(1.0, 1.0), &film(1.0, f64::NAN)).apart > 0.0);
    }

    #[test]
    fn grey_is_no_difference_and_brighter_is_more() {
        let shades = picture(&film(1.0, 1.0), &film(1.0, 1.05), 10.0);
        assert_eq!(shades[0], 127);
        assert!(shades[3 * 55] > 180);
    }
}
