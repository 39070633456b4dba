//! The choice of areas, radii and photons for a given time, by trials.

mod decide;
mod forecast;
mod trials;

use super::Pipeline;
use super::estimate::is_shown;
use crate::backend::stages::View;
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::radius::radii;
use crate::scene::SceneView;
use crate::settings::{Area, Bandwidth, CausticPhotons, Estimator, Indirect};
use decide::decide;
use forecast::{Model, Trial, reference, weights};

/// What a setting of the estimates is expected to give.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Candidate {
    /// [`crate::Settings::photons`].
    pub photons: u32,
    /// [`crate::Settings::area`].
    pub area: Area,
    /// [`crate::Settings::radius_factor`].
    pub radius_factor: f64,
    /// Seconds of a pass.
    pub seconds: f64,
    /// Squared relative error after the given time: the mean over pixels of the squared error, divided by the squared radiance
    /// and a hundredth of the squared mean radiance.
    pub error: f64,
    /// The part of `error` that is not by photons: noise of direct light and of camera paths.
    pub direct_error: f64,
}

/// What was chosen.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Choice {
    /// [`crate::Settings::photons`].
    pub photons: u32,
    /// [`crate::Settings::area`].
    pub area: Area,
    /// [`crate::Settings::radius_factor`].
    pub radius_factor: f64,
    /// [`crate::Settings::bandwidth`].
    pub bandwidth: Bandwidth,
    /// All that were compared, by increasing error, with one radius for each map.
    pub candidates: Vec<Candidate>,
    /// Seconds of a pass that are proportional to the number of paths, until photon maps are built.
    pub photon_seconds: f64,
}

/// What may be chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// Exhaustive: a caller decides about each.
pub struct Open {
    /// [`crate::Settings::photons`], if radii are derived and shared, without a limit on memory and a given number of aimed paths.
    pub photons: bool,
    /// [`crate::Settings::area`], if the settings have [`Area::Surface`].
    pub area: bool,
    /// [`crate::Settings::radius_factor`], if it is 1 and radii are derived and shared.
    pub radius_factor: bool,
    /// [`crate::Settings::bandwidth`], if it is [`Bandwidth::Shared`] and radii are derived without a limit on memory.
    pub bandwidth: bool,
}

/// Pictures of trials have this fraction of the width and of the height.
const REDUCTION: u32 = 5;

/// Least width and height of these pictures, if the picture has as many.
const MIN_SIZE: u32 = 40;

/// The whole picture is timed too if passes with each of the settings take less than this part of the time together: small
/// pictures do not fill a GPU.
const TIMED_PART: f64 = 0.1;

/// Factors on radii that are tried, and those that may be chosen.
const TRIED: [f64; 3] = [0.7, 1.4, 2.0];
const POSSIBLE: [f64; 5] = [0.5, 0.7, 1.0, 1.4, 2.0];

/// Multiples of the number of paths that may be chosen.
const MULTIPLES: [f64; 6] = [0.125, 0.25, 0.5, 1.0, 2.0, 4.0];

impl Choice {
    /// No fewer paths are chosen: they would take hardly less time.
    pub const MIN_PHOTONS: u32 = 16_384;
}

impl<B: TransportBackend> Pipeline<B> {
    /// Compares the settings that are `open` for `seconds` of passes, and takes the best: afterwards the pipeline renders as if
    /// it had been made with them. The number of paths is not changed: if [`Choice::photons`] differs, a new pipeline has to be
    /// made, whose preparation takes time from such candidates. `None`, and nothing changes, if there is nothing to choose:
    /// without photon maps whose estimates are shown, with final gathering, whose rays would have to be tried too, or after
    /// the first pass.
    ///
    /// Two passes with all photons are rendered for a small part of the pixels, with other random numbers than those of the
    /// passes that count. The differences between the two give the variance; at the same visible points, the product of their
    /// differences from the trial with the least bias gives the squared bias. Times are measured, so that two choices may
    /// differ. `scene` is the one that the pipeline was made with.
    ///
    /// # Errors
    /// Errors of the backend.
    pub fn choose(&mut self, scene: &SceneView<'_>, seconds: f64, open: Open) -> Result<Option<Choice>> {
        let shown = self.maps.iter().any(|slot| is_shown(&self.settings, slot.kind));
        let derived = matches!(self.settings.estimator, Estimator::Radius { radius: None })
            && self.settings.irradiance_every.is_none();
        // With a fixed number of aimed paths, more of the others do not make the discs of caustics smaller.
        let is_aimed = matches!(self.settings.caustic_photons, CausticPhotons::Aimed(_));
        let open = Open {
            photons: open.photons && derived && self.cap.is_none() && self.bandwidth.is_none() && !is_aimed,
            area: open.area && self.stages.area.is_some(),
            radius_factor: open.radius_factor
                && derived
                && self.settings.radius_factor == 1.0
                && self.bandwidth.is_none(),
            bandwidth: open.bandwidth && derived && self.bandwidth.is_none() && self.cap.is_none(),
        };
        let nothing = !(open.photons || open.area || open.radius_factor || open.bandwidth);
        if nothing || !shown || self.settings.indirect == Indirect::Gather || self.passes > 0 {
            return Ok(None);
        }
        let (whole, seed) = (self.view, self.settings.seed);
        self.settings.seed = !seed;
        let result = self.compare(scene, seconds, (open, derived));
        (self.view, self.settings.seed) = (whole, seed);
        self.recover()?;
        let (candidates, photon_seconds) = result?;
        let now = self.settings.photons;
        let bandwidth = (self.settings.bandwidth, open.bandwidth);
        let Some((best, bandwidth)) = decide(&candidates, now, seconds, bandwidth) else { return Ok(None) };
        let Candidate { photons, area, radius_factor, .. } = best;
        let choice = Choice { photons, area, radius_factor, bandwidth, candidates, photon_seconds };
        self.take_choice(scene, &choice)?;
        Ok(Some(choice))
    }

    fn take_choice(&mut self, scene: &SceneView<'_>, choice: &Choice) -> Result<()> {
        if choice.area == Area::Disc {
            self.stages.area = None;
        }
        self.settings.area = choice.area;
        if choice.radius_factor != 1.0 {
            self.settings.radius_factor *= choice.radius_factor;
            for slot in &mut self.maps {
                slot.radius = radii::scaled(slot.radius, choice.radius_factor as f32);
            }
        }
        if choice.bandwidth == Bandwidth::PerPixel && self.bandwidth.is_none() {
            self.settings.bandwidth = Bandwidth::PerPixel;
            if !self.settings.errors {
                self.settings.errors = true;
                self.film = self.on.film(scene, self.view.width, self.view.height)?;
                self.on.keep_errors(&mut self.film)?;
                self.error_moments = Some(self.on.alloc("spreads", self.queries_of(self.view))?);
            }
            self.bandwidth = Self::own_radii(&self.settings, &self.view);
        }
        Ok(())
    }

    /// The candidates by increasing error, and the seconds of a pass that are proportional to the number of paths.
    fn compare(
        &mut self,
        scene: &SceneView<'_>,
        seconds: f64,
        (open, derived): (Open, bool),
    ) -> Result<(Vec<Candidate>, f64)> {
        let whole = self.view;
        let reduced = |length: u32| (length / REDUCTION).max(MIN_SIZE).min(length);
        let small = View { width: reduced(whole.width), height: reduced(whole.height), ..whole };
        let areas: &[Area] = match (open.area, self.stages.area.is_some()) {
            (true, _) => &[Area::Surface, Area::Disc],
            (false, true) => &[Area::Surface],
            (false, false) => &[Area::Disc],
        };
        // Radii tell the bias, even if none may be chosen.
        let tried: &[f64] = if derived { &TRIED } else { &[1.0] };
        let possible: &[f64] = if open.radius_factor { &POSSIBLE } else { &[1.0] };
        let settings: Vec<(Area, f64)> =
            areas.iter().flat_map(|&area| tried.iter().map(move |&factor| (area, factor))).collect();
        let mut film = self.on.film(scene, small.width, small.height)?;
        if self.settings.errors {
            self.on.keep_errors(&mut film)?;
        }
        std::mem::swap(&mut self.film, &mut film);
        self.view = small;
        let both = self.tried(0, &settings).and_then(|first| Ok([first, self.tried(1, &settings)?]));
        std::mem::swap(&mut self.film, &mut film);
        self.view = whole;
        let [first, second] = both?;
        let pixels = |view: View| f64::from(view.width) * f64::from(view.height);
        let more = pixels(whole) / pixels(small);
        // The lesser of two times: other programs only add to them. Until the whole picture is timed, the time for photons is
        // taken to be proportional to the number of paths.
        let (mut photons, look) = ([0.0, first.photons.min(second.photons)], first.look.min(second.look));
        let others = first.others(&second);
        let direct = [first.direct, second.direct];
        let mut trials: Vec<Trial> = settings
            .iter()
            .zip(first.shown.into_iter().zip(second.shown))
            .map(|(&(area, factor), ((one, once), (two, again)))| Trial {
                area,
                factor,
                passes: [one, two],
                seconds: (look + once.min(again)) * more,
            })
            .collect();
        if photons[1] + trials.iter().map(|trial| trial.seconds).sum::<f64>() < TIMED_PART * seconds {
            let timed = self.time_whole(&settings)?;
            photons = timed.photons;
            trials.iter_mut().zip(timed.shown).for_each(|(trial, seconds)| trial.seconds = timed.look + seconds);
        }
        let Some(least) = trials.first() else { return Ok((Vec::new(), photons[1])) };
        let weights = weights(least, &others);
        let reference = reference(&trials);
        let mut candidates = Vec::new();
        let now = f64::from(self.settings.photons);
        let multiples = MULTIPLES
            .iter()
            .filter(|&&more| more == 1.0 || open.photons && more * now >= f64::from(Choice::MIN_PHOTONS));
        let multiples: Vec<f64> = multiples.copied().collect();
        for &area in areas {
            let of_area: Vec<&Trial> = trials.iter().filter(|trial| trial.area == area).collect();
            let model = Model::new(&of_area, &reference, &direct, &weights, photons, self.settings.alpha);
            for &more in &multiples {
                let photons = (more * now).min(f64::from(u32::MAX)) as u32;
                // A new pipeline is prepared, with kernels that are compiled.
                let preparation = self.setup.total() - self.setup.get(Stage::Compile);
                let seconds = if more == 1.0 { seconds } else { (seconds - preparation).max(0.0) };
                candidates.extend(possible.iter().map(|&radius_factor| {
                    let [seconds, error, direct_error] = model.forecast(more, radius_factor, seconds);
                    Candidate { photons, area, radius_factor, seconds, error, direct_error }
                }));
            }
        }
        candidates.sort_by(|a, b| a.error.total_cmp(&b.error));
        Ok((candidates, photons[1]))
    }
}
