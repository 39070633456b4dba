//! Denoising of finished pictures by Open Image Denoise, where its library is found at run time.
//!
//! Only on request: a denoised picture is not the expectation that the film estimates. Where the film claims an error, the
//! picture stays within it.

mod installed;
mod library;

use std::path::Path;

use photon_core::Film;

use crate::fault::Fault;

/// Open Image Denoise, loaded.
#[expect(missing_debug_implementations, reason = "functions of a library")]
pub struct Denoiser(library::Oidn);

/// A denoised picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// Linear RGB, W/(m²·sr), row by row from the top.
    pub pixels: Vec<[f32; 3]>,
    /// Description of its making, for the file.
    pub note: String,
}

impl Denoiser {
    /// Loads the library.
    ///
    /// # Errors
    /// [`Fault::Input`] where it is not found, with what to do.
    pub fn load() -> Result<Self, Fault> {
        Self::load_from(None)
    }

    /// Loads the library, first from the packages of an environment of Python, given by its folder.
    ///
    /// # Errors
    /// Those of [`Self::load`].
    pub fn load_from(environment: Option<&Path>) -> Result<Self, Fault> {
        library::Oidn::load(environment).map(Self).map_err(|why| {
            Fault::input(format!(
                "denoising needs Open Image Denoise 2, which was not found: `pip install pyoidn`, or set {} to the path of \
                 libOpenImageDenoise.so ({why})",
                library::VARIABLE
            ))
        })
    }

    /// Denoises the picture of a film, by the albedos and normals of what the camera sees first.
    ///
    /// Where the film has [confidence intervals](Film::confidence_intervals), the mean of red, green and blue stays within
    /// them: the difference to the film is scaled down to the half width.
    ///
    /// # Errors
    /// [`Fault::Failure`] with what the library says.
    pub fn denoise(&self, film: &Film) -> Result<Denoised, Fault> {
        let size = (film.width as usize, film.height as usize);
        let picture = film.beauty();
        let (mut pixels, version) = self
            .0
            .denoise(size, picture.clone(), film.albedo(), film.normal())
            .map_err(|why| Fault::failure(format!("Open Image Denoise failed: {why}")))?;
        let mut note = format!("Open Image Denoise {version}, by albedo and normal");
        if let Some(intervals) = film.confidence_intervals() {
            let half_widths: Vec<f64> = intervals.iter().map(|interval| interval.half_width).collect();
            let limited = limit(&picture, &mut pixels, &half_widths);
            let claimed = half_widths.iter().filter(|width| width.is_finite()).count();
            if claimed > 0 {
                let share = 100.0 * claimed as f64 / half_widths.len() as f64;
                note +=
                    &format!(", within the claimed errors of {share:.0} % of the pixels ({limited} limited by them)");
            }
        }
        Ok(Denoised { pixels, note })
    }
}

/// Limits the differences of `denoised` to `picture`, as means of RGB, to the half widths that are finite; returns how many
/// were larger.
fn limit(picture: &[[f32; 3]], denoised: &mut [[f32; 3]], half_widths: &[f64]) -> usize {
    let mut limited = 0;
    for ((raw, pixel), &most) in picture.iter().zip(denoised).zip(half_widths) {
        let difference: f64 = raw.iter().zip(&*pixel).map(|(&a, &b)| f64::from(b) - f64::from(a)).sum::<f64>() / 3.0;
        if !most.is_finite() || difference.abs() <= most {
            continue;
        }
        let share = (most / difference.abs()) as f32;
        *pixel = std::array::from_fn(|c| raw[c] + share * (pixel[c] - raw[c]));
        limited += 1;
    }
    limited
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differences within the half width stay, larger ones end at it, and without a claim all stay.
    #[test]
    fn differences_end_at_the_claimed_error() {
        let picture = [[1.0, 2.0, 3.0]; 4];
        let given = [[1.1, 2.1, 3.1], [1.5, 2.5, 3.5], [9.0, 2.0, 3.0], [4.0, 2.0, 0.0]];
        let mut denoised = given;
        assert_eq!(limit(&picture, &mut denoised, &[0.2, 0.2, f64::INFINITY, 0.0]), 1);
        assert_eq!([denoised[0], denoised[2], denoised[3]], [given[0], given[2], given[3]]);
        let mean = denoised[1].iter().sum::<f32>() / 3.0;
        assert!((mean - 2.2).abs() < 1e-6, "{mean}");
    }
}
