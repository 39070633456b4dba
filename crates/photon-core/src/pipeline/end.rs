//! Recovery after a failed pass, restart, and the end of a pipeline.

use super::{Pipeline, State};
use crate::backend::{StageTimings, TransportBackend};
use crate::error::{Error, Result};
use crate::film::film_tally::FilmTally;
use crate::film::pass_set::PassSet;
use crate::radius::radii;
use crate::radius::schedule::Schedule;
use crate::scene::SceneView;

impl<B: TransportBackend> Pipeline<B> {
    /// Ends the pipeline and returns its backend, ready for another render; all memory of this render is
    /// freed. Some drivers allow a program to open their devices only a limited number of times.
    ///
    /// # Errors
    /// Errors of the backend, including deferred ones; the backend is dropped then.
    pub fn into_backend(self) -> Result<B> {
        let (mut on, scene) = self.without_stages();
        drop(scene);
        on.reset()?;
        Ok(on)
    }

    /// The backend and the prepared scene; all other memory of this render is freed.
    pub(super) fn without_stages(self) -> (B, B::Scene) {
        // Everything that holds buffers: fields that are not named here would be dropped only after the
        // call below.
        let Self {
            on,
            scene,
            stages,
            film,
            rays,
            maps,
            queries,
            sample_queries,
            sample_segments,
            reflections,
            segments,
            estimates,
            error_moments,
            points,
            bandwidth,
            ..
        } = self;
        drop((stages, film, rays, maps, queries, sample_queries, reflections, segments, sample_segments));
        drop((estimates, error_moments, points, bandwidth));
        (on, scene)
    }

    /// Starts another picture of the same scene with other random numbers: bitwise equal to that of a new
    /// pipeline with that seed, without building the acceleration structure and the kernels again. `scene`
    /// is the one that the pipeline was made with; two films exist for a moment.
    ///
    /// # Errors
    /// [`Error::InvalidInput`] for a scene of another size or power, and errors of the backend; after an
    /// error, the pipeline has to be restarted again or dropped.
    pub fn restart(&mut self, scene: &SceneView<'_>, seed: u64) -> Result<()> {
        self.check_same(scene)?;
        self.recover()?;
        (self.state, self.read) = (State::RestartFailed, None);
        self.film = self.on.film(self.units, self.view.width, self.view.height)?;
        if self.settings.errors {
            self.on.keep_errors(&mut self.film)?;
        }
        self.settings.seed = seed;
        [self.settings.camera_samples, self.settings.shadow_rays, self.settings.gather_rays] = self.asked_rays;
        self.settings.photons = self.asked;
        let radius = radii::given(&self.settings, &self.units);
        self.maps.iter_mut().for_each(|slot| (slot.radius, slot.derived) = (radius, None));
        self.schedule = Schedule::new(self.settings.alpha);
        (self.passes, self.contains, self.tally) = (0, PassSet::default(), FilmTally::default());
        (self.cut, self.lacks_samples) = (false, false);
        self.points = None;
        self.bandwidth = Self::own_radii(&self.settings);
        if let Some((plan, batch)) = self.cap {
            self.batch = batch;
            self.fit(plan)?;
        }
        if self.estimates.is_some() && radii::need_pilot(&self.settings) {
            self.pilot()?;
        }
        let before = std::mem::replace(&mut self.setup, self.on.timings()?);
        StageTimings::OF_SCENE.into_iter().for_each(|stage| self.setup.add(stage, before.get(stage)));
        self.state = State::Ready;
        Ok(())
    }

    /// Whether `scene` can be the one that the pipeline was made with.
    pub(super) fn check_same(&self, scene: &SceneView<'_>) -> Result<()> {
        if scene.units == self.units {
            return Ok(());
        }
        let why = format!("has {:?}, but the pipeline was made with {:?}", scene.units, self.units);
        Err(Error::InvalidInput { what: "scene", index: 0, why })
    }

    /// Restores the state after a failed pass: reallocates the photons of maps that were lost, and discards
    /// the counts of paths that are in no film.
    pub(super) fn recover(&mut self) -> Result<()> {
        for slot in self.maps.iter_mut().filter(|slot| slot.photons.is_none()) {
            slot.allocate(&mut self.on, slot.capacity, self.required.photon_format)?;
        }
        self.stages.tracer.take_tally(&mut self.on)?;
        if let Some(aimed) = &mut self.stages.aimed {
            aimed.tracer.take_tally(&mut self.on)?;
        }
        self.forget_repeated_tallies()?;
        self.on.timings().map(drop)
    }
}
