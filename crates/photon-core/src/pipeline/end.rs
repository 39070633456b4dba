//! How it goes on after a pass that failed, how it begins anew, and how it ends.

use super::{Pipeline, State};
use crate::backend::TransportBackend;
use crate::error::{Error, Result};
use crate::radius::radii;
use crate::radius::schedule::Schedule;
use crate::scene::SceneView;

impl<B: TransportBackend> Pipeline<B> {
    /// Ends it, and gives back what it worked on, ready for another render; all that this one had in
    /// memory is freed. Some drivers let a program open their devices only so many times.
    ///
    /// # Errors
    /// What the backend raises, deferred errors included; it is gone then.
    pub fn into_backend(self) -> Result<B> {
        // All that holds buffers: what is not named here would be dropped after the call below.
        let Self {
            mut on, scene, stages, film, rays, maps, queries, estimates, error_moments, points, bandwidth, ..
        } = self;
        drop((scene, stages, film, rays, maps, queries, estimates, error_moments, points, bandwidth));
        on.reset()?;
        Ok(on)
    }

    /// Begins another picture of the same scene with other random numbers: the same bits as of a new pipeline with that
    /// seed, without building the scene's tree and the kernels again. `scene` is the one it was made with; for a moment
    /// there are two films.
    ///
    /// # Errors
    /// [`Error::InvalidInput`] for a scene of another size or power, and what the backend raises; to be begun anew once
    /// more, or dropped, then.
    pub fn restart(&mut self, scene: &SceneView<'_>, seed: u64) -> Result<()> {
        if scene.units != self.units {
            let why = format!("has {:?}, and the pipeline was made with {:?}", scene.units, self.units);
            return Err(Error::InvalidInput { what: "scene", index: 0, why });
        }
        self.recover()?;
        self.state = State::RestartFailed;
        self.film = self.on.film(scene, self.view.width, self.view.height)?;
        if self.settings.errors {
            self.on.keep_errors(&mut self.film)?;
        }
        self.settings.seed = seed;
        let radius = radii::given(&self.settings, &self.units);
        self.maps.iter_mut().for_each(|slot| slot.radius = radius);
        self.schedule = Schedule::new(self.settings.alpha);
        self.passes = 0;
        self.points = None;
        self.bandwidth = Self::own_radii(&self.settings, &self.view);
        if let Some((plan, batch)) = self.cap {
            (self.settings.photons, self.batch) = (self.asked, batch);
            self.fit(plan)?;
        }
        if self.estimates.is_some() && radii::need_pilot(&self.settings) {
            self.pilot()?;
        }
        self.setup = self.on.timings()?;
        self.state = State::Ready;
        Ok(())
    }

    /// Puts back what a pass that failed had in its hands: photons that were in a map when it was given
    /// up are gone, and counts of paths that no film has.
    pub(super) fn recover(&mut self) -> Result<()> {
        for slot in self.maps.iter_mut().filter(|slot| slot.photons.is_none()) {
            slot.allocate(&mut self.on, slot.capacity, self.required.photon_format)?;
        }
        self.stages.tracer.take_tally(&mut self.on)?;
        if let Some(aimed) = &mut self.stages.aimed {
            aimed.tracer.take_tally(&mut self.on)?;
        }
        self.on.timings().map(drop)
    }
}
