//! Trials of settings: passes of few pixels with each, and what they take.

use super::super::Pipeline;
use super::super::estimate::is_shown;
use super::super::slot::BuiltMap;
use crate::backend::stages::Pass;
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::film::{Film, FilmPixel, Layer};
use crate::settings::Area;

/// A pass with each of several settings.
pub(super) struct Tried {
    /// Seconds until there were maps.
    pub(super) photons: f64,
    /// Seconds for camera paths and direct light.
    pub(super) look: f64,
    /// What the camera sees of lights, and direct light by shadow rays: the radiance of each pixel, mean of RGB.
    emission: Vec<f64>,
    pub(super) direct: Vec<f64>,
    /// The same by photons, and the seconds of the estimates.
    pub(super) shown: Vec<(Vec<f64>, f64)>,
}

impl Tried {
    /// The mean radiance of the two passes without that of photons.
    pub(super) fn others(&self, second: &Self) -> Vec<f64> {
        let parts = self.emission.iter().zip(&self.direct).zip(second.emission.iter().zip(&second.direct));
        parts.map(|((a, b), (c, d))| 0.5 * (a + b + c + d)).collect()
    }
}

/// Seconds of a pass with the whole picture.
pub(super) struct Timed {
    /// Until there are photon maps: fixed, and proportional to the number of paths.
    pub(super) photons: [f64; 2],
    pub(super) look: f64,
    /// The estimates with each of several settings.
    pub(super) shown: Vec<f64>,
}

impl<B: TransportBackend> Pipeline<B> {
    /// One pass into the present film with each of the settings, areas and factors on radii.
    pub(super) fn tried(&mut self, index: u32, settings: &[(Area, f64)]) -> Result<Tried> {
        let (mut maps, photons) = self.timed_maps(index, self.settings.photons)?;
        self.look(index)?;
        let look = self.rendering()?;
        self.on.end_pass(&mut self.film)?;
        let seen = self.on.read_film(&self.film)?;
        if index > 0 {
            // The visible points of the first pass once more, so that the two passes differ in photons only.
            self.look(0)?;
        }
        self.on.clear_film(&mut self.film)?;
        let mut shown = Vec::with_capacity(settings.len());
        for &setting in settings {
            let seconds = self.timed_estimates(&mut maps, setting)?;
            self.on.end_pass(&mut self.film)?;
            shown.push((sum(&self.on.read_film(&self.film)?, &Layer::ALL), seconds));
            self.on.clear_film(&mut self.film)?;
        }
        self.reclaim_maps(maps);
        let direct = sum(&seen, &[Layer::Direct, Layer::Caustic, Layer::Indirect]);
        Ok(Tried { photons, look, emission: sum(&seen, &[Layer::Emission]), direct, shown })
    }

    /// What a pass with the whole picture takes; nothing is added to the film.
    pub(super) fn time_whole(&mut self, settings: &[(Area, f64)]) -> Result<Timed> {
        let paths = self.settings.photons;
        let few = (paths / 4).max(1);
        let (maps, seconds_few) = self.timed_maps(0, few)?;
        self.reclaim_maps(maps);
        let (mut maps, seconds) = self.timed_maps(0, paths)?;
        let more = f64::from(paths) / f64::from(paths.abs_diff(few).max(1));
        let proportional = (more * (seconds - seconds_few)).clamp(0.0, seconds);
        self.look(0)?;
        let look = self.rendering()?;
        let shown: Result<Vec<f64>> =
            settings.iter().map(|&setting| self.timed_estimates(&mut maps, setting)).collect();
        self.on.abandon_pass(&mut self.film)?;
        self.reclaim_maps(maps);
        Ok(Timed { photons: [seconds - proportional, proportional], look, shown: shown? })
    }

    fn timed_maps(&mut self, index: u32, paths: u32) -> Result<(Vec<BuiltMap<B>>, f64)> {
        self.on.timings()?;
        let sent = self.emit_and_trace(index, paths, &mut ())?;
        self.on.mark(Some(Stage::Build));
        let maps = self.build_maps(index, &sent.per_map())?;
        self.on.mark(None);
        Ok((maps, self.rendering()?))
    }

    /// Adds the estimates to the film.
    fn timed_estimates(&mut self, maps: &mut [BuiltMap<B>], (area, factor): (Area, f64)) -> Result<f64> {
        self.on.timings()?;
        let stage = if area == Area::Disc { self.stages.area.take() } else { None };
        let pass = Pass { seed: self.settings.seed, index: 0, random: self.settings.random };
        let mut result = Ok(());
        for built in maps {
            if !is_shown(&self.settings, built.kind) {
                continue;
            }
            let scale = built.gather.radius_scale;
            built.gather.radius_scale = scale * factor as f32;
            result = result.and_then(|()| self.show(built, pass));
            built.gather.radius_scale = scale;
        }
        if stage.is_some() {
            self.stages.area = stage;
        }
        result?;
        self.on.mark(None);
        self.rendering()
    }

    /// Seconds since the last call, without those of kernels that were compiled.
    fn rendering(&mut self) -> Result<f64> {
        let seconds = self.on.timings()?;
        Ok(seconds.total() - seconds.get(Stage::Prepare) - seconds.get(Stage::Bvh))
    }
}

/// The sum of layers of each pixel, mean of RGB.
fn sum(film: &Film, layers: &[Layer]) -> Vec<f64> {
    let grey = |pixel: &FilmPixel, layer: Layer| pixel.layers[layer as usize].iter().sum::<f64>() / 3.0;
    film.pixels.iter().map(|pixel| layers.iter().map(|&layer| grey(pixel, layer)).sum()).collect()
}
