//! Implements [`TransportBackend`]: prepares scenes and creates the stages of a pass.

use std::time::Duration;

use photon_core::{
    AimedStages, Area, Backend as _, Costs, FilmPixel, GlossCaustics, MapStages, MediaFeatures, MediaStages,
    PhotonFormat, ProjectionMap, Query, Requirements, Result, SceneView, Settings, Stage, Stages, StopCondition,
    TransportBackend, segments_per_pixel,
};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::map::CpuBuilder;
use crate::scene::CpuScene;
use crate::stages::area::CpuArea;
use crate::stages::beam_estimate::CpuBeamEstimator;
use crate::stages::direct::CpuDirect;
use crate::stages::emit::{CpuAimedEmitter, CpuEmitter};
use crate::stages::estimate::CpuEstimator;
use crate::stages::eye::CpuEye;
use crate::stages::final_gather::CpuGather;
use crate::stages::irradiance::CpuIrradiance;
use crate::stages::medium_direct::CpuMediumDirect;
use crate::stages::trace::CpuTracer;

impl TransportBackend for Cpu {
    type Scene = CpuScene;

    fn prepare(&mut self, scene: &SceneView<'_>, required: &Requirements) -> Result<CpuScene> {
        let scene = CpuScene::new(self, scene, required)?;
        let seconds = Duration::from_secs_f64(scene.build_seconds);
        self.timings.add(Stage::Bvh, scene.build_seconds);
        if let Some((_, since)) = &mut self.running {
            *since += seconds;
        }
        Ok(scene)
    }

    fn stages(&mut self, required: &Requirements, settings: &Settings) -> Result<Stages<Self>> {
        Ok(Stages {
            emitter: Box::new(CpuEmitter),
            tracer: Box::new(CpuTracer::new(settings, required)),
            eye: Box::new(CpuEye {
                max_bounces: settings.max_bounces,
                hides_background: settings.transparent_background,
                reflections: false,
                most_segments: segments_per_pixel(required),
                terminator_offset: required.terminator_offset,
                caustic_roughness: required.caustic_roughness(settings),
                truncated: 0,
            }),
            direct: if required.shadow_rays { Some(Box::new(CpuDirect)) } else { None },
            gather: if required.final_gather {
                let on_surface = settings.area == Area::Surface;
                Some(Box::new(CpuGather { max_bounces: settings.max_bounces, on_surface, truncated: 0 }))
            } else {
                None
            },
            irradiance: settings.irradiance_every.map(|_| Box::new(CpuIrradiance) as Box<_>),
            area: if settings.area == Area::Surface { Some(Box::new(CpuArea)) } else { None },
            aimed: None,
            gloss_caustics: required.gloss_caustics.then(|| GlossCaustics {
                tracer: Box::new(CpuTracer::for_reflections(settings, required)),
                eye: Box::new(CpuEye {
                    max_bounces: settings.max_bounces,
                    hides_background: false,
                    reflections: true,
                    most_segments: 0,
                    terminator_offset: required.terminator_offset,
                    caustic_roughness: required.caustic_roughness(settings),
                    truncated: 0,
                }),
            }),
            media: required
                .media
                .contains(MediaFeatures::SCATTERING)
                .then(|| MediaStages { direct: Box::new(CpuMediumDirect), estimator: Box::new(CpuBeamEstimator) }),
            map: MapStages { builder: Box::new(CpuBuilder::new(settings.index)), estimator: Box::new(CpuEstimator) },
        })
    }

    fn aimed(
        &mut self,
        required: &Requirements,
        settings: &Settings,
        projection: &ProjectionMap,
    ) -> Result<Option<AimedStages<Self>>> {
        self.note_memory("aimed photons", projection.bytes());
        Ok(Some((Box::new(CpuAimedEmitter::new(projection.clone())), Box::new(CpuTracer::aimed(settings, required)))))
    }

    fn stop_when(&mut self, condition: Option<StopCondition>) {
        self.stop.0 = condition;
    }

    fn costs(&self, photon_format: PhotonFormat) -> Costs {
        // Per photon: the stored record; normal and flux in index order, plus 22 bytes of the index; 52 more while
        // the index is sorted, and 4 for normals while they are counted. In flight: vectors that grow by doubling,
        // and the chunk of a buffer that is built from them.
        // Per pixel: a copy of the film when it is read.
        Costs {
            photon: photon_format.bytes() + 12 + photon_format.flux_bytes() + 22 + 56,
            under_way: 96,
            path: 48,
            pixel: size_of::<FilmPixel>() as u64,
            query: 224,
        }
    }

    fn scale_radii(&mut self, queries: &mut CpuBuffer<Query>, factors: &CpuBuffer<u32>) -> Result<()> {
        self.pool.install(|| {
            queries.data.par_iter_mut().with_min_len(4096).for_each(|query| {
                query.radius *= factors.data.get(query.pixel as usize).map_or(1.0, |&bits| f32::from_bits(bits));
            });
        });
        Ok(())
    }

    fn memory(&self, scene: &CpuScene) -> Vec<(String, u64)> {
        let bytes = |count: usize, size: usize| (count * size) as u64;
        let mut memory = vec![
            ("triangles".to_owned(), bytes(scene.vertices.len(), 40) + bytes(scene.primitives.len(), 16)),
            ("materials".to_owned(), bytes(scene.materials.len(), 48)),
            ("lights".to_owned(), bytes(scene.lights.len(), 64 + 4)),
            ("bvh".to_owned(), scene.caster.bytes()),
        ];
        memory.extend(scene.boundaries.as_ref().map(|boundaries| ("boundaries".to_owned(), boundaries.bytes())));
        memory.extend(scene.shading_memory());
        memory.extend(self.noted_memory().iter().cloned());
        memory
    }

    fn reset(&mut self) -> Result<()> {
        self.forget_memory();
        self.timings().map(drop)
    }
}
