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
use crate::settings::{Area, Bandwidth, CausticPhotons, Estimator};
use decide::decide;
use forecast::{Model, Trial, reference, variance, weights, with_gather_rays};

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
    /// [`crate::Settings::gather_rays`]; `None` without final gathering.
    pub gather_rays: Option<u32>,
    /// Seconds of a pass.
    pub seconds: f64,
    /// Squared relative error after the given time: the mean over pixels of the squared error, divided by the squared radiance
    /// and a hundredth of the squared mean radiance.
    pub error: f64,
    /// The part of `error` that is not by photons at visible points: noise of direct light, camera paths and gather rays.
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
    /// [`crate::Settings::gather_rays`]; `None` without final gathering.
    pub gather_rays: Option<u32>,
    /// All that were compared, by increasing error, with one radius for each map.
    pub candidates: Vec<Candidate>,
    /// Seconds of a pass that are proportional to the number of paths, until photon maps are built.
    pub photon_seconds: f64,
}

/// What may be chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// Exhaustive: a caller decides about each.
pub struct Open {
    /// [`crate::Settings::photons`], if radii are derived and shared, without a limit on memory, a given number of aimed paths and
    /// final gathering.
    pub photons: bool,
    /// [`crate::Settings::area`], if the settings have [`Area::Surface`], without final gathering.
    pub area: bool,
    /// [`crate::Settings::radius_factor`], if it is 1 and radii are derived and shared, without final gathering.
    pub radius_factor: bool,
    /// [`crate::Settings::bandwidth`], if it is [`Bandwidth::Shared`] and radii are derived without a limit on memory and
    /// without final gathering.
    pub bandwidth: bool,
    /// [`crate::Settings::gather_rays`], with final gathering.
    pub gather_rays: bool,
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

/// Numbers of gather rays that are tried, and those that may be chosen.
const TRIED_RAYS: [u32; 2] = [1, 4];
const POSSIBLE_RAYS: [u32; 3] = [1, 4, 16];

/// [`TIMED_PART`] with final gathering, which takes more of it.
const TIMED_PART_OF_RAYS: f64 = 0.01;

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
    /// without photon maps whose estimates are shown, or after the first pass. With final gathering only the number of its rays
    /// is chosen; whether there is final gathering is a matter of other stages. The bias of what its rays find in maps is not
    /// counted.
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
        let gathers = self.stages.gather.is_some();
        let is_aimed = matches!(self.settings.caustic_photons, CausticPhotons::Aimed(_));
        let open = Open {
            photons: open.photons && !gathers && derived && self.cap.is_none() && self.bandwidth.is_none() && !is_aimed,
            area: open.area && !gathers && self.stages.area.is_some(),
            radius_factor: open.radius_factor
                && !gathers
                && derived
                && self.settings.radius_factor == 1.0
                && self.bandwidth.is_none(),
            bandwidth: open.bandwidth && !gathers && derived && self.bandwidth.is_none() && self.cap.is_none(),
            gather_rays: open.gather_rays && gathers,
        };
        let something = open.photons || open.area || open.radius_factor || open.bandwidth;
        if !(something && shown || open.gather_rays) || self.passes > 0 {
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
        let Candidate { photons, area, radius_factor, gather_rays, .. } = best;
        let choice = Choice { photons, area, radius_factor, bandwidth, gather_rays, candidates, photon_seconds };
        self.take_choice(scene, &choice)?;
        Ok(Some(choice))
    }

    fn take_choice(&mut self, scene: &SceneView<'_>, choice: &Choice) -> Result<()> {
        if choice.area == Area::Disc {
            self.stages.area = None;
        }
        self.settings.area = choice.area;
        self.settings.gather_rays = choice.gather_rays.unwrap_or(self.settings.gather_rays);
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
        let (rays, timed_part): (&[u32], f64) =
            if open.gather_rays { (&TRIED_RAYS, TIMED_PART_OF_RAYS) } else { (&[], TIMED_PART) };
        let mut film = self.on.film(scene, small.width, small.height)?;
        if self.settings.errors {
            self.on.keep_errors(&mut film)?;
        }
        std::mem::swap(&mut self.film, &mut film);
        self.view = small;
        let both = self.tried(0, rays, &settings).and_then(|first| Ok([first, self.tried(1, rays, &settings)?]));
        std::mem::swap(&mut self.film, &mut film);
        self.view = whole;
        let [first, second] = both?;
        let pixels = |view: View| f64::from(view.width) * f64::from(view.height);
        let more = pixels(whole) / pixels(small);
        // The lesser of two times: other programs only add to them. Until the whole picture is timed, the time for photons is
        // taken to be proportional to the number of paths.
        let (mut photons, look) = ([0.0, first.photons.min(second.photons)], first.look.min(second.look));
        let radiance_of_others = first.others(&second);
        let mut gathering: [f64; TRIED_RAYS.len()] =
            std::array::from_fn(|number| first.gathering(number).min(second.gathering(number)) * more);
        let sampled: [[Vec<f64>; 2]; TRIED_RAYS.len()] =
            std::array::from_fn(|number| [first.sampled(number), second.sampled(number)]);
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
        let all = trials.iter().map(|trial| trial.seconds).chain(gathering).sum::<f64>();
        if photons[1] + all < timed_part * seconds {
            let timed = self.time_whole(rays, &settings)?;
            photons = timed.photons;
            gathering.iter_mut().zip(timed.gathering).for_each(|(gathering, seconds)| *gathering = seconds);
            trials.iter_mut().zip(timed.shown).for_each(|(trial, seconds)| trial.seconds = timed.look + seconds);
        }
        let Some(least) = trials.first() else { return Ok((Vec::new(), photons[1])) };
        let weights = weights(least, &radiance_of_others);
        let reference = reference(&trials);
        let mut candidates = Vec::new();
        let now = f64::from(self.settings.photons);
        let multiples = MULTIPLES
            .iter()
            .filter(|&&more| more == 1.0 || open.photons && more * now >= f64::from(Choice::MIN_PHOTONS));
        let multiples: Vec<f64> = multiples.copied().collect();
        // A new pipeline is prepared, with kernels that are compiled.
        let preparation = self.setup.total() - self.setup.get(Stage::Compile);
        let variances = sampled.each_ref().map(|both| variance(both, &weights));
        let tried = std::array::from_fn(|number| (TRIED_RAYS[number], [variances[number], gathering[number]]));
        // The numbers of gather rays, the variance that does not depend on photons, and the seconds of the rays.
        let others: Vec<(Option<u32>, [f64; 2])> = match open.gather_rays {
            true => POSSIBLE_RAYS.iter().map(|&rays| (Some(rays), with_gather_rays(tried, rays))).collect(),
            false => vec![(None, [variances[0], 0.0])],
        };
        for (&(gather_rays, [others, gathering]), &area) in
            others.iter().flat_map(|each| areas.iter().map(move |area| (each, area)))
        {
            let of_area: Vec<&Trial> = trials.iter().filter(|trial| trial.area == area).collect();
            let photons = [photons[0] + gathering, photons[1]];
            let model = Model::new(&of_area, &reference, others, &weights, photons, self.settings.alpha);
            for &more in &multiples {
                let photons = (more * now).min(f64::from(u32::MAX)) as u32;
                let seconds = if more == 1.0 { seconds } else { (seconds - preparation).max(0.0) };
                candidates.extend(possible.iter().map(|&radius_factor| {
                    let [seconds, error, direct_error] = model.forecast(more, radius_factor, seconds);
                    Candidate { photons, area, radius_factor, gather_rays, seconds, error, direct_error }
                }));
            }
        }
        candidates.sort_by(|a, b| a.error.total_cmp(&b.error));
        Ok((candidates, photons[1]))
    }
}
