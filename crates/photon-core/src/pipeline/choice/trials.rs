//! Trials of settings: passes of few pixels with each, and what they take.

use super::super::Pipeline;
use super::super::estimate::is_shown;
use super::super::slot::BuiltMap;
use super::forecast::added;
use crate::backend::stages::Pass;
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::film::{Film, FilmPixel, Layer};
use crate::requirements::map_kind::PerMap;
use crate::settings::Area;

/// A pass with each of several settings.
pub(super) struct Tried {
    /// Seconds until there were maps.
    pub(super) photons: f64,
    /// Seconds for camera paths and direct light.
    pub(super) look: f64,
    /// What the camera sees of lights, and direct light by shadow rays: the radiance of each pixel, mean of RGB.
    seen: Vec<f64>,
    /// Light that was found by each number of gather rays, and its seconds.
    gathered: Vec<(Vec<f64>, f64)>,
    /// The radiance of each pixel by photons at visible points, and the seconds of these estimates.
    pub(super) shown: Vec<(Vec<f64>, f64)>,
    /// The radiance of each pixel by photons with the [`widest`] setting, at the visible points of this pass; those of `shown` are
    /// of the first pass.
    own: Vec<f64>,
    /// The share of the pixels that have caustics, by the first setting.
    pub(super) caustic_share: f64,
}

impl Tried {
    /// The mean radiance of the two passes without that of photons at visible points; of the numbers of gather rays, that of
    /// the last.
    pub(super) fn others(&self, second: &Self) -> Vec<f64> {
        let last = self.gathered.len().saturating_sub(1);
        self.sampled(last).iter().zip(second.sampled(last)).map(|(a, b)| 0.5 * (a + b)).collect()
    }

    /// What does not come from photons at visible points: lights that the camera sees, direct light by shadow rays and light by
    /// gather rays, of which there are as many as in the `number`-th trial.
    pub(super) fn sampled(&self, number: usize) -> Vec<f64> {
        match self.gathered.get(number) {
            Some((gathered, _)) => added(&self.seen, gathered),
            None => self.seen.clone(),
        }
    }

    /// All light, with that of photons at the visible points of this pass.
    pub(super) fn all(&self, number: usize) -> Vec<f64> {
        added(&self.sampled(number), &self.own)
    }

    /// Seconds for the gather rays of the `number`-th trial; 0 without final gathering.
    pub(super) fn gathering(&self, number: usize) -> f64 {
        self.gathered.get(number).map_or(0.0, |(_, seconds)| *seconds)
    }
}

/// Seconds of a pass with the whole picture.
pub(super) struct Timed {
    /// Until there are photon maps: fixed, and proportional to the number of paths.
    pub(super) photons: [f64; 2],
    pub(super) look: f64,
    /// Gather rays, with each of several numbers.
    pub(super) gathering: Vec<f64>,
    /// The estimates with each of several settings.
    pub(super) shown: Vec<f64>,
}

impl<B: TransportBackend> Pipeline<B> {
    /// One pass into the present film with each of the numbers of gather rays, if there are any, and each of the settings, areas
    /// and factors on radii.
    pub(super) fn tried(&mut self, index: u32, rays: &[u32], settings: &[(Area, f64)]) -> Result<Tried> {
        let (mut maps, paths, photons) = self.timed_maps(index, self.settings.photons)?;
        self.look(index)?;
        let look = self.rendering()?;
        self.on.end_pass(&mut self.film)?;
        let seen = sum(&self.on.read_film(&self.film)?);
        let mut gathered = Vec::with_capacity(rays.len());
        for &rays in rays {
            self.on.clear_film(&mut self.film)?;
            let seconds = self.timed_gathering((&maps, paths), index, rays)?;
            self.on.end_pass(&mut self.film)?;
            gathered.push((sum(&self.on.read_film(&self.film)?), seconds));
        }
        self.on.clear_film(&mut self.film)?;
        let mut own = None;
        if index > 0 {
            if let Some(widest) = widest(settings) {
                self.timed_estimates(&mut maps, settings[widest], index)?;
                self.on.end_pass(&mut self.film)?;
                own = Some(sum(&self.on.read_film(&self.film)?));
                self.on.clear_film(&mut self.film)?;
            }
            // The visible points of the first pass once more, so that the two passes differ in photons only.
            self.look(0)?;
            self.on.clear_film(&mut self.film)?;
        }
        let mut shown = Vec::with_capacity(settings.len());
        let mut caustic_share = 0.0;
        for &setting in settings {
            let seconds = self.timed_estimates(&mut maps, setting, 0)?;
            self.on.end_pass(&mut self.film)?;
            let film = self.on.read_film(&self.film)?;
            let radiance = sum(&film);
            if shown.is_empty() {
                caustic_share = share_of_caustics(&film, &added(&seen, &radiance));
            }
            shown.push((radiance, seconds));
            self.on.clear_film(&mut self.film)?;
        }
        self.reclaim_maps(maps);
        let own = own.or_else(|| Some(shown[widest(settings)?].0.clone())).unwrap_or_else(|| vec![0.0; seen.len()]);
        Ok(Tried { photons, look, seen, gathered, shown, own, caustic_share })
    }

    /// Seconds for camera paths and direct light of the whole picture.
    pub(super) fn time_look(&mut self) -> Result<f64> {
        self.on.timings()?;
        let seconds = self.look(0).and_then(|_| self.rendering());
        self.on.abandon_pass(&mut self.film)?;
        seconds
    }

    /// What a pass with the whole picture takes; nothing is added to the film, even after an error.
    pub(super) fn time_whole(&mut self, rays: &[u32], settings: &[(Area, f64)]) -> Result<Timed> {
        let timed = self.timed_pass(rays, settings);
        self.on.abandon_pass(&mut self.film)?;
        timed
    }

    fn timed_pass(&mut self, rays: &[u32], settings: &[(Area, f64)]) -> Result<Timed> {
        let paths = self.settings.photons;
        let few = (paths / 4).max(1);
        let (maps, _, seconds_few) = self.timed_maps(0, few)?;
        self.reclaim_maps(maps);
        let (mut maps, sent, seconds) = self.timed_maps(0, paths)?;
        let more = f64::from(paths) / f64::from(paths.abs_diff(few).max(1));
        let proportional = (more * (seconds - seconds_few)).clamp(0.0, seconds);
        self.look(0)?;
        let look = self.rendering()?;
        let gathering: Result<Vec<f64>> =
            rays.iter().map(|&rays| self.timed_gathering((&maps, sent), 0, rays)).collect();
        let shown: Result<Vec<f64>> =
            settings.iter().map(|&setting| self.timed_estimates(&mut maps, setting, 0)).collect();
        self.reclaim_maps(maps);
        Ok(Timed { photons: [seconds - proportional, proportional], look, gathering: gathering?, shown: shown? })
    }

    /// The maps of this many paths, those that were sent for each map, and the seconds.
    fn timed_maps(&mut self, index: u32, paths: u32) -> Result<(Vec<BuiltMap<B>>, PerMap<u64>, f64)> {
        self.on.timings()?;
        let sent = self.emit_and_trace(index, paths, &mut ())?;
        self.on.mark(Some(Stage::Build));
        let maps = self.build_maps(index, &sent.per_map())?;
        self.on.mark(None);
        Ok((maps, sent.per_map(), self.rendering()?))
    }

    /// Adds light by this many gather rays from each query to the film.
    fn timed_gathering(&mut self, (maps, paths): (&[BuiltMap<B>], PerMap<u64>), index: u32, rays: u32) -> Result<f64> {
        self.on.timings()?;
        let pass = Pass { seed: self.settings.seed, index, random: self.settings.random };
        self.gather(maps, pass, paths, rays)?;
        self.rendering()
    }

    /// Adds the estimates to the film; `index` is the pass of the random numbers with which areas are measured.
    fn timed_estimates(&mut self, maps: &mut [BuiltMap<B>], setting: (Area, f64), index: u32) -> Result<f64> {
        let (area, factor) = setting;
        self.on.timings()?;
        let stage = if area == Area::Disc { self.stages.area.take() } else { None };
        let pass = Pass { seed: self.settings.seed, index, random: self.settings.random };
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

/// The setting with the same kind of areas as the first and the greatest factor on radii, whose estimates have the least noise of
/// photons.
pub(super) fn widest(settings: &[(Area, f64)]) -> Option<usize> {
    let area = settings.first()?.0;
    settings.iter().rposition(|setting| setting.0 == area)
}

/// The sum of all layers of each pixel, mean of RGB.
fn sum(film: &Film) -> Vec<f64> {
    film.pixels.iter().map(|pixel| Layer::ALL.iter().map(|&layer| grey(pixel, layer)).sum()).collect()
}

fn grey(pixel: &FilmPixel, layer: Layer) -> f64 {
    pixel.layers[layer as usize].iter().sum::<f64>() / 3.0
}

/// The share of the pixels that have caustics: more than this part of all light.
const CAUSTIC: f64 = 0.2;

fn share_of_caustics(film: &Film, light: &[f64]) -> f64 {
    let has_caustics = |(pixel, light): &(&FilmPixel, &f64)| {
        let caustic = grey(pixel, Layer::Caustic);
        caustic > 0.0 && caustic > CAUSTIC * **light
    };
    film.pixels.iter().zip(light).filter(has_caustics).count() as f64 / film.pixels.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_with_caustics_have_more_than_a_fifth_of_their_light_from_them() {
        let mut film = Film::new(4, 1, crate::Units::default()).unwrap();
        for (pixel, caustic) in film.pixels.iter_mut().zip([0.0, 1.0, 2.0, 3.0]) {
            pixel.layers[Layer::Caustic as usize] = [3.0 * caustic, 0.0, 0.0];
            pixel.layers[Layer::Indirect as usize] = [4.0; 3];
        }
        // 1 of 5, 2 of 6 and 3 of 7; with more light 2 of 11.
        assert_eq!(share_of_caustics(&film, &sum(&film)), 0.5);
        assert_eq!(share_of_caustics(&film, &added(&sum(&film), &[0.0, 0.0, 5.0, 0.0])), 0.25);
        let dark = Film { pixels: vec![FilmPixel::default(); 4], ..film };
        assert_eq!(share_of_caustics(&dark, &sum(&dark)), 0.0);
    }

    #[test]
    fn the_widest_setting_has_the_first_kind_of_areas() {
        let both = [(Area::Surface, 0.7), (Area::Surface, 2.0), (Area::Disc, 0.7), (Area::Disc, 2.0)];
        assert_eq!(
            [widest(&both), widest(&both[2..]), widest(&both[..1]), widest(&[])],
            [Some(1), Some(1), Some(0), None]
        );
    }
}
