//! Every stage of a pass.

use photon_core::{
    Aim, AimedStages, Area, Backend, Estimate, Film, Layer, MapKind, Query, Requirements, Result, SceneView, Settings,
    Spread, Stages, TransportBackend,
};

use crate::area::VulkanArea;
use crate::buffer::VulkanBuffer;
use crate::direct::VulkanDirect;
use crate::estimate::VulkanEstimator;
use crate::eye::{self, VulkanEye};
use crate::film::{self, VulkanFilm};
use crate::final_gather::VulkanGather;
use crate::irradiance::VulkanIrradiance;
use crate::photons::{VulkanAimedEmitter, VulkanEmitter, VulkanTracer};
use crate::scene::VulkanScene;
use crate::vulkan::Vulkan;

impl TransportBackend for Vulkan {
    type Scene = VulkanScene;
    type Film = VulkanFilm;

    fn batch(&self) -> u32 {
        // A batch takes as long as its longest path, however few there are: a GPU wants many at a time.
        if self.limits().subgroup_size >= 16 { 1 << 22 } else { 1 << 18 }
    }

    fn prepare(&mut self, scene: &SceneView<'_>, required: &Requirements) -> Result<VulkanScene> {
        VulkanScene::new(self, scene, required)
    }

    fn stages(&mut self, required: &Requirements, settings: &Settings) -> Result<Stages<Self>> {
        Ok(Stages {
            emitter: Box::new(VulkanEmitter),
            tracer: Box::new(VulkanTracer::new(self, settings, required.features)?),
            eye: Box::new(VulkanEye::new(self, settings.max_bounces)?),
            direct: if required.shadow_rays { Some(Box::new(VulkanDirect)) } else { None },
            gather: if required.final_gather {
                Some(Box::new(VulkanGather::new(settings.max_bounces, Box::new(VulkanEstimator::default()))))
            } else {
                None
            },
            irradiance: settings.irradiance_every.map(|_| Box::new(VulkanIrradiance) as Box<_>),
            area: if settings.area == Area::Surface { Some(Box::new(VulkanArea)) } else { None },
            aimed: None,
            map: self.map_stages(settings.index)?,
        })
    }

    fn aimed(&mut self, required: &Requirements, settings: &Settings, aim: &Aim) -> Result<Option<AimedStages<Self>>> {
        let tracer = VulkanTracer::aimed(self, settings, required.features)?;
        Ok(Some((Box::new(VulkanAimedEmitter::new(self, aim)?), Box::new(tracer))))
    }

    fn film(&mut self, scene: &SceneView<'_>, width: u32, height: u32) -> Result<VulkanFilm> {
        VulkanFilm::new(self, width, height, scene.units)
    }

    fn fold(
        &mut self,
        film: &mut VulkanFilm,
        layer: Layer,
        queries: &VulkanBuffer<Query>,
        estimates: &VulkanBuffer<Estimate>,
        paths: u64,
    ) -> Result<()> {
        film::fold(self, film, layer, queries, estimates, paths)
    }

    fn keep_errors(&mut self, film: &mut VulkanFilm) -> Result<()> {
        film::errors::keep(self, film)
    }

    fn fold_errors(
        &mut self,
        film: &mut VulkanFilm,
        kind: MapKind,
        queries: &VulkanBuffer<Query>,
        estimates: &VulkanBuffer<Estimate>,
        spreads: &VulkanBuffer<Spread>,
        paths: u64,
    ) -> Result<()> {
        film::errors::fold(self, film, kind, queries, estimates, spreads, paths)
    }

    fn scale_radii(&mut self, queries: &mut VulkanBuffer<Query>, factors: &VulkanBuffer<u32>) -> Result<()> {
        eye::scale_radii(self, queries, factors)
    }

    fn end_pass(&mut self, film: &mut VulkanFilm) -> Result<()> {
        film::end_pass(self, film)
    }

    fn abandon_pass(&mut self, film: &mut VulkanFilm) -> Result<()> {
        film::abandon_pass(self, film)
    }

    fn read_film(&mut self, film: &VulkanFilm) -> Result<Film> {
        film::read(self, film)
    }

    fn memory(&self, scene: &VulkanScene) -> Vec<(String, u64)> {
        let tables = scene.bytes().iter().map(|&(label, bytes)| (label.to_owned(), bytes));
        tables.chain(self.memory.iter().cloned()).collect()
    }

    fn renew(&mut self) -> Result<()> {
        self.timings()?;
        self.finish()?;
        // What the last render freed and the next may not want; pipelines stay.
        self.device.free_spares();
        self.memory.clear();
        Ok(())
    }
}

#[cfg(test)]
mod tests;
