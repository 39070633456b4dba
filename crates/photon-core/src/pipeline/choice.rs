//! The choice of areas, radii, photons and gather rays for a time or an error, by trials.

mod bias;
mod compare;
mod curve;
mod decide;
mod forecast;
mod trials;

use super::Pipeline;
use super::estimate::is_shown;
use crate::backend::TransportBackend;
use crate::error::Result;
use crate::radius::radii;
use crate::scene::SceneView;
use crate::settings::{Area, Bandwidth, CausticPhotons, Estimator};
use decide::decide;

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
    /// [`crate::Settings::bandwidth`]. If the settings already had [`Bandwidth::PerPixel`], forecasts are those of shared radii.
    pub bandwidth: Bandwidth,
    /// [`crate::Settings::gather_rays`]; `None` without final gathering.
    pub gather_rays: Option<u32>,
    /// Seconds of a pass.
    pub seconds: f64,
    /// Squared relative error after the given time: the mean over pixels of the squared error, divided by the squared radiance
    /// and a hundredth of the squared mean radiance. Bias counts with what may be hidden by noise.
    pub error: f64,
    /// The part of `error` that is not by photons at visible points: noise of direct light, gather rays and camera
    /// paths, which lead to other visible points in each pass.
    pub direct_error: f64,
}

/// What settings are chosen for.
#[derive(Clone, Copy, Debug, PartialEq)]
// Exhaustive: a caller decides what it wants.
pub enum Goal {
    /// The least error after so many seconds of passes.
    Time(f64),
    /// The least error after the time that so many passes with the present settings are expected to take, without the seconds
    /// that radii per pixel add; with final gathering, passes with one ray.
    Passes(u32),
    /// The least time until an error is expected, or the least error if that takes longer than allowed.
    Error {
        /// Root mean square of the relative error: [`Candidate::error`] is its square.
        error: f64,
        /// Most seconds of passes.
        most_seconds: f64,
    },
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
    /// Seconds of passes that it was chosen for.
    pub seconds: f64,
    /// All that were compared, by increasing error.
    pub candidates: Vec<Candidate>,
    /// Seconds of a pass that are proportional to the number of paths, until photon maps are built.
    pub photon_seconds: f64,
}

/// What may be chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// Exhaustive: a caller decides about each.
pub struct Open {
    /// [`crate::Settings::photons`], if radii are derived and shared, without a limit on memory, without a given number of aimed
    /// paths, and without final gathering.
    pub photons: bool,
    /// [`crate::Settings::area`], if the settings have [`Area::Surface`], without final gathering.
    pub area: bool,
    /// [`crate::Settings::radius_factor`], if it is 1 and radii are derived and shared, without final gathering. The chosen one
    /// is at most 1 where photons are aimed and less than a twentieth of the pixels have caustics.
    pub radius_factor: bool,
    /// [`crate::Settings::bandwidth`], if it is [`Bandwidth::Shared`] and radii are derived without a limit on memory and
    /// without final gathering.
    pub bandwidth: bool,
    /// [`crate::Settings::gather_rays`], with final gathering.
    pub gather_rays: bool,
}

impl Choice {
    /// The candidate that was chosen.
    #[must_use]
    pub fn chosen(&self) -> Option<&Candidate> {
        self.candidates.iter().find(|each| {
            (each.photons, each.area, each.radius_factor, each.bandwidth, each.gather_rays)
                == (self.photons, self.area, self.radius_factor, self.bandwidth, self.gather_rays)
        })
    }

    /// No fewer paths are chosen: they would take hardly less time.
    pub const MIN_PHOTONS: u32 = 16_384;
}

impl<B: TransportBackend> Pipeline<B> {
    /// Compares the settings that are `open`, and takes the best for the `goal`: afterwards the pipeline renders as if it had been
    /// made with them. The number of paths is not changed: if [`Choice::photons`] differs, [`Pipeline::with_settings`] takes it,
    /// whose preparation takes time from such candidates. `None`, and nothing changes, if there is nothing to choose, or after the
    /// first pass. With final gathering only the number of its rays is chosen, and the bias of what they find in maps is not
    /// counted; without it, maps whose estimates are shown are necessary. Whether to use final gathering is not chosen: that needs
    /// other stages.
    ///
    /// Two passes with all photons are rendered for a small part of the pixels, with other random numbers than those of the
    /// passes that count. The differences between the two give the variance; at the same visible points, the product of their
    /// differences from the trial with the least bias gives the squared bias. Times are measured, so that two choices may
    /// differ. `scene` is the one that the pipeline was made with.
    ///
    /// # Errors
    /// Errors of the backend.
    pub fn choose(&mut self, scene: &SceneView<'_>, goal: Goal, open: Open) -> Result<Option<Choice>> {
        let shown = self.maps.iter().any(|slot| is_shown(&self.settings, slot.kind));
        let derived = matches!(self.settings.estimator, Estimator::Radius { radius: None })
            && self.settings.irradiance_every.is_none();
        let gathers = self.stages.gather.is_some();
        // With a fixed number of aimed paths, more of the others do not make the discs of caustics smaller.
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
        let result = self.compare(scene, goal, (open, derived));
        (self.view, self.settings.seed) = (whole, seed);
        self.recover()?;
        let (comparison, seconds) = result?;
        let (candidates, photon_seconds) = (comparison.candidates(seconds), comparison.photon_seconds);
        let now = self.settings.photons;
        let Some(best) = decide(&candidates, now, seconds) else { return Ok(None) };
        let Candidate { photons, area, radius_factor, bandwidth, gather_rays, .. } = best;
        let choice =
            Choice { photons, area, radius_factor, bandwidth, gather_rays, seconds, candidates, photon_seconds };
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
            self.bandwidth = Self::own_radii(&self.settings);
        }
        Ok(())
    }
}
