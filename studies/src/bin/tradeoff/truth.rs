//! The references against which pictures are measured.

use std::f64::consts::FRAC_1_PI;
use std::path::Path;

use photon_core::{Area, Budget, Film, FilmPixel, Plan, Settings, View, radius_squared_factor};
use photon_scene::IntegratingSphere;
use photonmap_cli::fault::Fault;

use crate::engine::{Engine, Subject};
use crate::records::{self, Note, Reference};

/// Radiance of each pixel, mean of RGB.
#[derive(Clone, Debug)]
pub(crate) struct Truth {
    pub(crate) note: Note,
    /// `None` for a constant.
    pixels: Vec<f64>,
    /// Likewise, linear RGB.
    pub(crate) colours: Vec<[f32; 3]>,
}

impl Truth {
    /// The closed form, or a long run: one stored in `folder`, or a new one of `effort`, stored there.
    pub(crate) fn of(
        engine: &mut Engine,
        subject: &Subject,
        (base, effort): (&Settings, Effort),
        folder: &Path,
    ) -> Result<Self, Fault> {
        if let Some(radiance) = closed_form(&subject.name) {
            return Ok(Self::constant(radiance));
        }
        let path = folder.join(format!("reference-{}-{}.json", subject.name, subject.view.width));
        if path.exists() {
            let reference = records::read::<Reference>(&path)?;
            let details = (reference.scene.as_str(), reference.size, reference.pixels.len());
            let View { width, height, .. } = subject.view;
            if details != (&subject.name, width, width as usize * height as usize) {
                let (scene, size, pixels) = details;
                let what = format!("it is of {scene} at {size} pixels across, {pixels} in all");
                return Err(Fault::input(format!("{}: {what}; move it away to render a new one", path.display())));
            }
            return Ok(Self::from(reference));
        }
        let reference = long_run(engine, subject, base, effort)?;
        records::write(&path, &reference)?;
        Ok(Self::from(reference))
    }

    pub(crate) fn constant(radiance: f64) -> Self {
        Self { note: Note::Constant(radiance), pixels: Vec::new(), colours: Vec::new() }
    }

    pub(crate) fn at(&self, pixel: usize) -> f64 {
        match self.note {
            Note::Constant(radiance) => radiance,
            Note::Reference { .. } => self.pixels.get(pixel).copied().unwrap_or(0.0),
        }
    }

    /// Whether intervals of a run of that many paths can be compared with it: its error is at most a third of theirs.
    pub(crate) fn judges(&self, paths: u64) -> bool {
        match self.note {
            Note::Constant(_) => true,
            Note::Reference { photons, .. } => photons >= 27 * paths,
        }
    }

    /// One hundredth of its squared mean: bounds the relative errors of dark pixels.
    pub(crate) fn floor(&self, count: usize) -> f64 {
        let mean = (0..count).map(|pixel| self.at(pixel)).sum::<f64>() / count.max(1) as f64;
        0.01 * mean * mean
    }
}

impl From<Reference> for Truth {
    fn from(reference: Reference) -> Self {
        let grey = |rgb: &[f32; 3]| rgb.iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0;
        Self { pixels: reference.pixels.iter().map(grey).collect(), note: reference.note, colours: reference.pixels }
    }
}

/// Length of a reference, relative to the longest run that is compared with it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Passes of that run.
    pub(crate) passes: u32,
    /// Its photons.
    pub(crate) photons: u64,
    /// Photons of the reference, as a multiple.
    pub(crate) times: u32,
}

/// The radiance of scenes with a known result.
pub(crate) fn closed_form(scene: &str) -> Option<f64> {
    match scene {
        // Albedo over π times the irradiance of light that was scattered before.
        "integrating-sphere" => {
            let sphere = IntegratingSphere::default();
            Some(sphere.albedo * FRAC_1_PI * sphere.indirect_irradiance())
        }
        // Radiosity 2.
        "furnace" => Some(2.0 * FRAC_1_PI),
        _ => None,
    }
}

/// A run with more and larger passes, and a seed that no other run has. The squared errors of photons fall as
/// the power −2/3 of their number, those of shadow rays and of rays through a pixel as −1: a thousand times
/// the photons give a hundredth of the error if there are a hundred times the passes. It is longer than that, since many
/// of the measured settings have larger passes or less bias.
fn long_run(engine: &mut Engine, subject: &Subject, base: &Settings, effort: Effort) -> Result<Reference, Fault> {
    let passes = (f64::from(effort.passes) * f64::from(effort.times).powf(2.0 / 3.0) * 1.28).ceil();
    let photons = (effort.photons as f64 * f64::from(effort.times) / passes).ceil().max(1.0);
    let passes = (passes as u32).max(EARLY * 2);
    // Corrects the loss of discs at surface boundaries, whose bias falls slowest of all with the radii.
    let settings = Settings { photons: photons as u32, seed: u64::MAX, area: Area::Surface, ..base.clone() };
    crate::progress(&format!("{}: a reference of {passes} passes of {photons} paths", subject.name));
    let early = passes / EARLY;
    let plans = [(0, early), (early, passes - early)]
        .map(|(first, passes)| Plan { first, ..Plan::from(Budget::Passes(passes)) });
    let (films, details) = engine.films_at(subject, &settings, &plans)?;
    let [first, film] = &films[..] else { return Err(Fault::Failure("a film for each stretch was to be had".into())) };
    let [noise, bias] = told_by_parts(first, film, settings.alpha);
    Ok(Reference {
        scene: subject.name.clone(),
        size: subject.view.width,
        backend: engine.names().0.to_owned(),
        note: Note::Reference { passes, photons: details.outcome.paths, error: noise + bias, bias },
        seconds: details.seconds,
        pixels: film.beauty(),
    })
}

/// Fraction of a reference's passes, the first ones, by which its bias is estimated.
const EARLY: u32 = 16;

/// Noise and squared bias of a whole film, as parts of its relMSE, estimated from the first passes and the others.
///
/// Noise is the spread of the passes. The bias falls with the radius: linearly at edges of surfaces and of light,
/// elsewhere quadratically. The first and the other passes differ by noise, which is known, and by bias; from the
/// latter, assuming the slower law, follows an upper bound of the bias of the whole.
fn told_by_parts(first: &Film, whole: &Film, alpha: f64) -> [f64; 2] {
    let mean_radius = |from: u32, to: u32| {
        (from..to).map(|index| radius_squared_factor(index, alpha).sqrt()).sum::<f64>() / f64::from(to - from)
    };
    let (early, passes) = (first.passes, whole.passes);
    let left = mean_radius(0, passes) / (mean_radius(0, early) - mean_radius(early, passes));
    let pixels: Vec<[f64; 3]> = first
        .pixels
        .iter()
        .zip(&whole.pixels)
        .map(|(first, whole)| {
            let sum = |pixel: &FilmPixel| pixel.layers.iter().flatten().sum::<f64>() / 3.0;
            let of = |sum: f64, square: f64, passes: u32| {
                let n = f64::from(passes);
                let mean = sum / n;
                (mean, ((square / n - mean * mean) / (n - 1.0)).max(0.0))
            };
            let (value, noise) = of(sum(whole), whole.square, passes);
            let (early_value, early_noise) = of(sum(first), first.square, early);
            let (late_value, late_noise) = of(sum(whole) - sum(first), whole.square - first.square, passes - early);
            let difference = (early_value - late_value).powi(2) - early_noise - late_noise;
            [value, noise, difference]
        })
        .collect();
    let mean = pixels.iter().map(|pixel| pixel[0]).sum::<f64>() / pixels.len().max(1) as f64;
    let part = |of: usize| {
        let relative = pixels.iter().map(|pixel| pixel[of] / (pixel[0] * pixel[0] + 0.01 * mean * mean));
        relative.sum::<f64>() / pixels.len().max(1) as f64
    };
    [part(1), (left * left * part(2)).max(0.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use photon_core::{Layer, Units};

    /// Passes of 64 × 64 pixels whose true value is 1: bias proportional to the radius, and noise of known variance,
    /// uniformly distributed, in each pass.
    fn films(passes: u32, bias: f64, deviation: f64) -> [Film; 2] {
        let mut film = Film::new(64, 64, Units::default()).unwrap();
        let mut first = film.clone();
        let mut state = 1_u64;
        for pass in 0..passes {
            let radius = radius_squared_factor(pass, 2.0 / 3.0).sqrt();
            for pixel in &mut film.pixels {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let even = (state >> 11) as f64 / (1_u64 << 53) as f64;
                let value = 1.0 + bias * radius + deviation * 12.0_f64.sqrt() * (even - 0.5);
                pixel.layers[Layer::Indirect as usize] = pixel.layers[Layer::Indirect as usize].map(|sum| sum + value);
                pixel.square += value * value;
            }
            film.passes += 1;
            if film.passes == passes / EARLY {
                first = film.clone();
            }
        }
        [first, film]
    }

    #[test]
    fn noise_and_bias_of_a_long_run_are_told_apart() {
        for (bias, deviation) in [(0.1, 0.2), (0.0, 0.2), (0.2, 0.4)] {
            let [first, film] = films(256, bias, deviation);
            let [noise, bias_squared] = told_by_parts(&first, &film, 2.0 / 3.0);
            let mean = |pixel: &FilmPixel| pixel.layers[Layer::Indirect as usize][0] / 256.0 - 1.0;
            let whole = mean(&film.pixels[0]);
            let truth = film.pixels.iter().map(mean).sum::<f64>() / 4096.0;
            // Relative to 1.01 times the square of the pixel, near 1.
            let scale = 1.01 * (1.0 + truth).powi(2);
            let true_noise = deviation * deviation / 256.0;
            assert!((noise * scale - true_noise).abs() <= 0.05 * true_noise + 1e-12, "{noise} {true_noise} {whole}");
            // Squares of differences of variance 17.07 times the noise, 4096 of them, times 2.5; and the bias times
            // the noise of the mean of all.
            let spread = (2.6 * 17.1 * true_noise * (2.0_f64 / 4096.0).sqrt())
                .hypot(2.0 * truth.abs() * (2.6 * 17.1 * true_noise / 4096.0).sqrt());
            let off = bias_squared * scale - truth * truth;
            assert!(off.abs() <= 4.5 * spread + 1e-9, "{bias}, {deviation}: {bias_squared} {truth} {spread}");
        }
    }
}
