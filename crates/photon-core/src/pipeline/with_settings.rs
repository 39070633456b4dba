//! Other settings for the same scene and picture.

use super::{Pipeline, aimed, irradiance};
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::requirements::Requirements;
use crate::scene::SceneView;
use crate::settings::Settings;

impl<B: TransportBackend> Pipeline<B> {
    /// Ends the pipeline, and makes another one for the same scene and view: bitwise equal to that of [`Pipeline::new`] with these
    /// settings, with the backend's own stages and batches. What depends on the scene alone is kept: its tables on the device with
    /// the acceleration structure, and the cells of the lights for aimed paths. `scene` is the one that the pipeline was made
    /// with; it is not validated again.
    ///
    /// [`crate::Facts::setup`] has the seconds of what was kept, too.
    ///
    /// # Errors
    /// Those of [`Pipeline::new`] for valid scenes, and [`crate::Error::InvalidInput`] for a scene of another size or power; the
    /// backend is dropped then.
    pub fn with_settings(mut self, scene: &SceneView<'_>, settings: Settings) -> Result<Self> {
        self.check_same(scene)?;
        let required = Requirements::of(scene, &settings);
        let settings = irradiance::with_points(scene, settings);
        let (view, before, setup, known) = (self.view, self.required, self.setup, self.aiming.take());
        let (mut on, prepared) = self.without_stages();
        let prepared = Some(prepared).filter(|_| before.prepares_like(&required));
        on.reset()?;
        let is_kept = prepared.is_some();
        let (stages, aiming) = aimed::stages(&mut on, (scene, view), &settings, &required, known)?;
        let batch = on.batch();
        let mut pipeline = Self::assemble(on, scene, (view, prepared), settings, (required, stages), batch)?;
        if is_kept {
            [Stage::Prepare, Stage::Bvh].into_iter().for_each(|stage| pipeline.setup.add(stage, setup.get(stage)));
        }
        pipeline.add_aiming(aiming);
        Ok(pipeline)
    }
}
