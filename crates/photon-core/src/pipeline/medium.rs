//! Light that is scattered in media, as camera paths see it.

use super::slot::BuiltMap;
use super::small_pass::reduced;
use super::{Pipeline, QUERIES_PER_PIXEL};
use crate::backend::stages::{BeamParams, EstimateBuffers};
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::radius::radii;
use crate::requirements::Requirements;
use crate::requirements::features::Features;
use crate::scene::layout::Estimate;
use crate::scene::media::MediaFeatures;

/// Pixels whose segments tell the radius.
const PIXELS: f64 = 4096.0;

/// Search radius of the first estimates of the pilot, normalised: a fiftieth of the scene.
const FIRST_RADIUS: f32 = 0.02;

/// Maximum number of segments of a pixel: its camera path has one up to its first surface, and more only beyond surfaces that
/// it passes or is reflected by, and where it crosses boundaries.
#[must_use]
pub fn segments_per_pixel(required: &Requirements) -> u32 {
    let is_divided = required.media.contains(MediaFeatures::BOUNDARIES);
    let goes_on = required.features.intersects(Features::SPECULAR.union(Features::FOLLOWED));
    if is_divided || goes_on { QUERIES_PER_PIXEL } else { 1 }
}

impl<B: TransportBackend> Pipeline<B> {
    /// Adds the estimates from one map of media along the segments to the film.
    pub(super) fn show_medium(&mut self, built: &BuiltMap<B>) -> Result<()> {
        let (Some(media), Some(segments)) = (&mut self.stages.media, &self.segments) else { return Ok(()) };
        let Some(estimates) = &mut self.estimates else { return Ok(()) };
        self.on.mark(Some(Stage::Estimate));
        let params = BeamParams { kernel: built.gather.kernel, radius: built.gather.radius_scale };
        let buffers = EstimateBuffers { estimates, error_moments: self.error_moments.as_mut() };
        media.estimator.estimate(&mut self.on, &self.scene, &built.map, segments, &params, buffers)?;
        self.on.mark(Some(Stage::Film));
        if let Some(error_moments) = &self.error_moments {
            let film = &mut self.film;
            self.on.accumulate_errors(film, built.kind, segments, estimates, error_moments, built.paths)?;
        }
        self.on.accumulate(&mut self.film, built.kind.layer(), segments, estimates, built.paths)
    }

    /// The radius within which the median segment that sees photons of the pilot pass sees `wanted` effective ones
    /// ([`Estimate::effective_photons`]), whose number grows as the square of the radius. Behind several mean free paths, or
    /// beside the peak of a phase function, photons count for little.
    pub(super) fn medium_radius(&mut self, map: &B::PhotonMap, wanted: f64) -> Result<f32> {
        self.pilot_camera_paths(&reduced(self.view, PIXELS))?;
        let (Some(media), Some(segments)) = (&mut self.stages.media, &self.segments) else { return Ok(FIRST_RADIUS) };
        let Some(estimates) = &mut self.estimates else { return Ok(FIRST_RADIUS) };
        // Few photons are counted inaccurately, so that more are looked for.
        let looked_for = wanted.max(8.0);
        let mut radius = FIRST_RADIUS;
        let mut found: Vec<Estimate> = Vec::new();
        // The second time within about the radius that is needed, since photons are not spread evenly.
        for _ in 0..2 {
            let params = BeamParams { kernel: self.settings.kernel, radius };
            let buffers = EstimateBuffers { estimates, error_moments: None };
            media.estimator.estimate(&mut self.on, &self.scene, map, segments, &params, buffers)?;
            self.on.download(estimates, &mut found)?;
            // Radii in dense media are bounded, so that each segment says by how much its own has to grow.
            let mut squared: Vec<f64> = found
                .iter()
                .filter(|estimate| estimate.photons > 0)
                .map(|estimate| f64::from(estimate.radius_squared) * looked_for / estimate.effective_photons())
                .filter(|squared| squared.is_finite())
                .collect();
            if squared.is_empty() {
                break;
            }
            let middle = squared.len() / 2;
            let (_, &mut median, _) = squared.select_nth_unstable_by(middle, f64::total_cmp);
            radius = radii::scaled(1.0, median.sqrt() as f32);
        }
        Ok(radii::scaled(radius, (wanted / looked_for).sqrt() as f32))
    }
}
