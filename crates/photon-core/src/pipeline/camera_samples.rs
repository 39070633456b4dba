//! Camera samples of a pass after the first: camera paths and direct light alone.

use super::Pipeline;
use crate::backend::stages::Pass;
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::film::Layer;
use crate::settings::Direct;

impl<B: TransportBackend> Pipeline<B> {
    /// Adds the other camera samples of pass `index` to the light of the first, and averages: emission seen by the camera and
    /// direct light of shadow rays. What the first has read from the maps counts in full. Returns the number of camera paths of
    /// all samples that were truncated; `None` if there is one sample.
    pub(super) fn other_samples(&mut self, index: u32) -> Result<Option<u64>> {
        let samples = self.settings.camera_samples;
        if samples < 2 {
            return Ok(None);
        }
        for sample in 1..samples {
            self.camera_sample(Pass { sample, ..Pass::new(&self.settings, index) })?;
        }
        self.on.mark(Some(Stage::Film));
        let averaged: &[Layer] = match self.settings.direct {
            Direct::Nee => &[Layer::Emission, Layer::Direct],
            Direct::Photons | Direct::None => &[Layer::Emission],
        };
        self.on.average_samples(&mut self.film, averaged, samples)?;
        self.on.mark(None);
        self.stages.eye.truncated(&mut self.on).map(Some)
    }

    /// Traces the camera paths of one sample, and their shadow rays.
    fn camera_sample(&mut self, pass: Pass) -> Result<()> {
        self.on.mark(Some(Stage::Eye));
        self.stages.eye.trace_eye(&mut self.on, &self.scene, &self.view, pass, &mut self.film, &mut self.queries)?;
        self.direct_light(pass, pass.sample)?;
        self.on.mark(None);
        Ok(())
    }

    /// Adds the light of shadow rays from the queries of a camera sample, and from its segments in media, if there are any. They
    /// have the random numbers of camera sample `shadow_sample`.
    pub(super) fn direct_light(&mut self, pass: Pass, shadow_sample: u32) -> Result<()> {
        let shadows = Pass { sample: shadow_sample, ..pass };
        if let (Some(media), Some(segments)) = (&mut self.stages.media, &mut self.segments) {
            self.on.mark(Some(Stage::Eye));
            media.eye.trace_eye(&mut self.on, &self.scene, &self.view, pass, &mut self.film, segments)?;
            if self.settings.direct == Direct::Nee {
                self.on.mark(Some(Stage::Direct));
                let rays = self.settings.shadow_rays;
                media.direct.light(&mut self.on, &self.scene, shadows, segments, rays, &mut self.film)?;
            }
        }
        if let Some(direct) = &mut self.stages.direct {
            self.on.mark(Some(Stage::Direct));
            let rays = self.settings.shadow_rays;
            direct.light(&mut self.on, &self.scene, shadows, &self.queries, rays, &mut self.film)?;
        }
        Ok(())
    }
}
