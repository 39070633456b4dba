//! What pictures are measured against.

use std::f64::consts::FRAC_1_PI;
use std::path::Path;

use photon_core::{Area, Budget, Film, Settings, View};
use photon_examples::fault::Fault;
use photon_scene::IntegratingSphere;

use crate::engine::{Engine, Subject};
use crate::records::{self, Note, Reference};

/// Radiance of each pixel, mean of RGB.
#[derive(Clone, Debug)]
pub(crate) struct Truth {
    pub(crate) note: Note,
    /// None for a constant.
    pixels: Vec<f64>,
    /// Likewise, linear RGB.
    pub(crate) colours: Vec<[f32; 3]>,
}

impl Truth {
    /// The closed form, or a long run: one that lies in `folder`, or a new one of `effort`, left there.
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
            let told = (reference.scene.as_str(), reference.size, reference.pixels.len());
            let View { width, height, .. } = subject.view;
            if told != (&subject.name, width, width as usize * height as usize) {
                let (scene, size, pixels) = told;
                let what = format!("it is of {scene} at {size} pixels across, {pixels} in all");
                return Err(Fault::input(format!("{}: {what}; move it away to have a new one", path.display())));
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

    /// Whether claims of a run of so many paths can be held against it: its own error is a third of theirs.
    pub(crate) fn judges(&self, paths: u64) -> bool {
        match self.note {
            Note::Constant(_) => true,
            Note::Reference { photons, .. } => photons >= 27 * paths,
        }
    }

    /// One hundredth of its mean, squared: what keeps errors of dark pixels in bounds.
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

/// How long a reference is to be, beside the longest run that it judges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Passes of that run.
    pub(crate) passes: u32,
    /// Its photons.
    pub(crate) photons: u64,
    /// How many times these.
    pub(crate) times: u32,
}

/// The radiance of scenes whose answer is known.
pub(crate) fn closed_form(scene: &str) -> Option<f64> {
    match scene {
        // Albedo over π times the irradiance by light that was scattered before.
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
/// the photons are a hundredth of the error if a hundred times the passes go with them.
fn long_run(engine: &mut Engine, subject: &Subject, base: &Settings, effort: Effort) -> Result<Reference, Fault> {
    let passes = (f64::from(effort.passes) * f64::from(effort.times).powf(2.0 / 3.0) * 1.28).ceil();
    let photons = (effort.photons as f64 * f64::from(effort.times) / passes).ceil().max(1.0);
    // What discs lose at the ends of surfaces is given back: it falls slowest of all with the radii.
    let settings =
        Settings { photons: photons as u32, errors: true, seed: u64::MAX, area: Area::Surface, ..base.clone() };
    crate::progress(&format!("{}: a reference of {passes} passes of {photons} paths", subject.name));
    let (film, told) = engine.film(subject, &settings, Budget::Passes(passes as u32))?;
    Ok(Reference {
        scene: subject.name.clone(),
        size: subject.view.width,
        backend: engine.names().0.to_owned(),
        note: claimed(&film, told.outcome.paths),
        seconds: told.seconds,
        pixels: film.beauty(),
    })
}

/// What a run claims of its own relMSE; of flagged pixels as of others, though their bias may be told wrongly.
fn claimed(film: &Film, photons: u64) -> Note {
    let claims = film.claims().unwrap_or_default();
    let count = claims.len().max(1) as f64;
    let mean = claims.iter().map(|claim| claim.value).sum::<f64>() / count;
    let floor = 0.01 * mean * mean;
    let squares = claims.iter().map(|claim| {
        let bias = (claim.bias * claim.bias - claim.bias_error * claim.bias_error).max(0.0);
        (claim.standard_error * claim.standard_error + bias) / (claim.value * claim.value + floor)
    });
    Note::Reference {
        passes: film.passes,
        photons,
        error: squares.sum::<f64>() / count,
        flagged: claims.iter().filter(|claim| !claim.flags.is_empty()).count() as f64 / count,
    }
}
