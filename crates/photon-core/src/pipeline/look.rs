//! The first camera sample of a pass: camera paths and direct light.

use super::Pipeline;
use crate::backend::stages::{EyeBuffers, Pass};
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;

impl<B: TransportBackend> Pipeline<B> {
    /// Traces the camera paths of pass `index`, and their direct light with the random numbers of camera sample `shadow_sample`.
    /// Returns the number of queries, and of paths that were truncated.
    pub(super) fn look(&mut self, index: u32, shadow_sample: u32) -> Result<(u64, u64)> {
        let pass = Pass::new(&self.settings, index);
        self.camera_paths(pass)?;
        if let Some((_, Some(factors))) = &self.bandwidth {
            self.on.scale_radii(&mut self.queries, factors)?;
            if let Some(segments) = &mut self.segments {
                self.on.scale_radii(segments, factors)?;
            }
        }
        if let (Some(caustics), Some(reflections)) = (&mut self.stages.gloss_caustics, &mut self.reflections) {
            let buffers = EyeBuffers { queries: reflections, segments: None };
            caustics.eye.trace_eye(&mut self.on, &self.scene, &self.view, pass, &mut self.film, buffers)?;
            if let Some((_, Some(factors))) = &self.bandwidth {
                self.on.scale_radii(reflections, factors)?;
            }
        }
        self.direct_light(pass, shadow_sample)?;
        self.on.mark(None);
        Ok((self.on.fill(&self.queries)?.length, self.stages.eye.truncated(&mut self.on)?))
    }

    /// Traces the camera paths of the samples of `pass`.
    pub(super) fn camera_paths(&mut self, pass: Pass) -> Result<()> {
        self.on.mark(Some(Stage::Eye));
        let buffers = EyeBuffers { queries: &mut self.queries, segments: self.segments.as_mut() };
        self.stages.eye.trace_eye(&mut self.on, &self.scene, &self.view, pass, &mut self.film, buffers)
    }
}
