//! `TransportBackend` for Vulkan: all stages of a pass.

use std::time::Instant;

use photon_core::random::Domain;
use photon_core::{
    AimedStages, Announcement, Area, Backend, Error, GlossCaustics, MediaFeatures, MediaStages, PhotonFormat,
    ProjectionMap, Query, Requirements, Result, SceneView, Settings, Stage, Stages, StopCondition, TransportBackend,
};

use crate::device::buffer::VulkanBuffer;
use crate::map::estimate::VulkanEstimator;
use crate::map::estimate::beam::VulkanBeamEstimator;
use crate::scene::VulkanScene;
use crate::stages::area::VulkanArea;
use crate::stages::direct::{self, VulkanDirect};
use crate::stages::emit::{VulkanAimedEmitter, VulkanEmitter};
use crate::stages::eye::{self, EyePaths, VulkanEye};
use crate::stages::final_gather::VulkanGather;
use crate::stages::irradiance::VulkanIrradiance;
use crate::stages::medium_direct;
use crate::stages::trace::{PhotonPaths, VulkanTracer};
use crate::vulkan::Vulkan;

impl TransportBackend for Vulkan {
    type Scene = VulkanScene;

    fn is_gpu(&self) -> bool {
        !self.limits().is_software()
    }

    fn batch(&self) -> u32 {
        // A batch takes as long as its longest path, however few paths it has: a GPU needs many paths at a
        // time.
        if self.limits().is_software() { 1 << 18 } else { 1 << 22 }
    }

    fn most_photons(&self) -> u64 {
        let costs = self.costs(PhotonFormat::Full);
        (self.limits().device_memory / 4 / costs.photon).min(self.limits().max_allocation / PhotonFormat::Full.bytes())
    }

    fn samples_together(&self, pixels: u64) -> u32 {
        // A dispatch takes as long as its longest path, however few it has.
        (u64::from(self.dispatch_limits.pixels_of_samples) / pixels).clamp(1, 64) as u32
    }

    fn stop_when(&mut self, condition: Option<StopCondition>) {
        if condition.is_none() && matches!(self.fault, Some(Error::Cancelled)) {
            // Of a mark: its pass is abandoned already, or has no more commands.
            self.fault = None;
        }
        self.recorder.stop_when(condition);
    }

    fn prepare(&mut self, scene: &SceneView<'_>, required: &Requirements) -> Result<VulkanScene> {
        // Work of the host, which timestamps of the device do not show.
        let start = Instant::now();
        let given = self.tree.as_ref().is_some_and(|(tree, _)| tree.order.len() == scene.triangles.len());
        let scene = VulkanScene::new(self, scene, required)?;
        let within = if given { 0.0 } else { scene.build_seconds };
        self.profile.add(Stage::Bvh, scene.build_seconds);
        self.profile.add(Stage::Prepare, start.elapsed().as_secs_f64() - within);
        Ok(scene)
    }

    fn stages(&mut self, required: &Requirements, settings: &Settings) -> Result<Stages<Self>> {
        Ok(Stages {
            emitter: Box::new(VulkanEmitter),
            tracer: Box::new(VulkanTracer::new(self, settings, PhotonPaths::new(settings))?),
            eye: Box::new(VulkanEye::new(self, settings, EyePaths::new(settings, required))?),
            direct: if required.shadow_rays {
                Some(Box::new(VulkanDirect { kernel: direct::kernel, domain: Domain::Shadow }))
            } else {
                None
            },
            gather: if required.final_gather {
                let area = (settings.area == Area::Surface).then_some(VulkanArea);
                let estimator = Box::new(VulkanEstimator::default());
                Some(Box::new(VulkanGather::new(self, settings.max_bounces, estimator, area)?))
            } else {
                None
            },
            irradiance: settings.irradiance_every.map(|_| Box::new(VulkanIrradiance) as Box<_>),
            area: if settings.area == Area::Surface { Some(Box::new(VulkanArea)) } else { None },
            aimed: None,
            gloss_caustics: if required.gloss_caustics {
                let photons = PhotonPaths::for_reflections(settings, required);
                let eye = EyePaths::for_reflections(settings, required);
                Some(GlossCaustics {
                    tracer: Box::new(VulkanTracer::new(self, settings, photons)?),
                    eye: Box::new(VulkanEye::new(self, settings, eye)?),
                })
            } else {
                None
            },
            media: if required.media.contains(MediaFeatures::SCATTERING) {
                Some(MediaStages {
                    direct: Box::new(VulkanDirect { kernel: medium_direct::kernel, domain: Domain::Segment }),
                    estimator: Box::new(VulkanBeamEstimator::default()),
                })
            } else {
                None
            },
            map: self.map_stages(settings.index)?,
        })
    }

    fn announce(&mut self, announcement: &Announcement<'_>) -> Result<()> {
        announce::announce(self, announcement)
    }

    fn aimed(
        &mut self,
        _required: &Requirements,
        settings: &Settings,
        projection: &ProjectionMap,
    ) -> Result<Option<AimedStages<Self>>> {
        let tracer = VulkanTracer::new(self, settings, PhotonPaths::aimed(settings))?;
        Ok(Some((Box::new(VulkanAimedEmitter::new(self, projection)?), Box::new(tracer))))
    }

    fn scale_radii(&mut self, queries: &mut VulkanBuffer<Query>, factors: &VulkanBuffer<u32>) -> Result<()> {
        eye::scale_radii(self, queries, factors)
    }

    fn memory(&self, scene: &VulkanScene) -> Vec<(String, u64)> {
        let tables = scene.bytes().iter().map(|&(label, bytes)| (label.to_owned(), bytes));
        tables.chain(self.memory.iter().cloned()).collect()
    }

    fn reset(&mut self) -> Result<()> {
        self.timings()?;
        self.finish()?;
        // Frees buffers of the previous render that the next one may not need; pipelines are kept.
        self.device.free_spares();
        self.memory.clear();
        Ok(())
    }
}

mod announce;
#[cfg(test)]
mod tests;
