//! The picture in progress.

use photon_core::{
    Aim, AimedStages, Area, Backend as _, Costs, Error, ErrorPixel, Estimate, Film, FilmPixel, Kept, Layer, MapKind,
    Query, Requirements, Result, SceneView, Settings, Spread, Stages, TransportBackend,
};
use rayon::prelude::*;

use crate::area::CpuArea;
use crate::cpu::{Cpu, CpuBuffer};
use crate::direct::CpuDirect;
use crate::emit::{CpuAimedEmitter, CpuEmitter};
use crate::estimate::CpuEstimator;
use crate::eye::CpuEye;
use crate::gather::CpuGather;
use crate::irradiance::CpuIrradiance;
use crate::map::CpuBuilder;
use crate::scene::CpuScene;
use crate::trace::CpuTracer;

/// Sums over finished passes, and the pass in progress apart from them.
#[derive(Debug)]
pub struct CpuFilm {
    pub(crate) film: Film,
    pub(crate) pending: Vec<FilmPixel>,
    /// As many as `film.errors`.
    pending_errors: Vec<ErrorPixel>,
}

impl CpuFilm {
    /// Calls `work` with every query, the present pass of its pixel, and what tells its errors if they
    /// are kept; rows in parallel. Queries are in order of pixels.
    pub(crate) fn for_queries<S: Send>(
        &mut self,
        queries: &[Query],
        scratch: impl Fn() -> S + Sync,
        work: impl Fn(&mut S, usize, &Query, &mut FilmPixel, Option<&mut ErrorPixel>) + Sync,
    ) {
        let width = self.film.width;
        let mut errors = self.pending_errors.chunks_mut(width as usize);
        let rows: Vec<_> = self.pending.chunks_mut(width as usize).map(|pixels| (pixels, errors.next())).collect();
        rows.into_par_iter().enumerate().for_each(|(row, (pixels, mut errors))| {
            let first = row as u32 * width;
            let start = queries.partition_point(|query| query.pixel < first);
            let mut scratch = scratch();
            for (index, query) in queries.iter().enumerate().skip(start) {
                let column = (query.pixel - first) as usize;
                let Some(pixel) = pixels.get_mut(column) else { break };
                work(&mut scratch, index, query, pixel, errors.as_mut().and_then(|errors| errors.get_mut(column)));
            }
        });
    }
}

/// Adds `weight × value` to a layer.
#[inline]
pub(crate) fn deposit(pixel: &mut FilmPixel, layer: Layer, weight: [f32; 3], value: [f64; 3]) {
    for c in 0..3 {
        pixel.layers[layer as usize][c] += f64::from(weight[c]) * value[c];
    }
}

impl TransportBackend for Cpu {
    type Scene = CpuScene;
    type Film = CpuFilm;

    fn prepare(&mut self, scene: &SceneView<'_>, required: &Requirements) -> Result<CpuScene> {
        CpuScene::new(self, scene, required)
    }

    fn stages(&mut self, required: &Requirements, settings: &Settings) -> Result<Stages<Self>> {
        Ok(Stages {
            emitter: Box::new(CpuEmitter),
            tracer: Box::new(CpuTracer::new(settings, required.features)),
            eye: Box::new(CpuEye { max_bounces: settings.max_bounces }),
            direct: if required.shadow_rays { Some(Box::new(CpuDirect)) } else { None },
            gather: if required.final_gather {
                Some(Box::new(CpuGather { max_bounces: settings.max_bounces }))
            } else {
                None
            },
            irradiance: settings.irradiance_every.map(|_| Box::new(CpuIrradiance) as Box<_>),
            area: if settings.area == Area::Surface { Some(Box::new(CpuArea)) } else { None },
            aimed: None,
            map: photon_core::MapStages {
                builder: Box::new(CpuBuilder::new(settings.index)),
                estimator: Box::new(CpuEstimator),
            },
        })
    }

    fn aimed(&mut self, required: &Requirements, settings: &Settings, aim: &Aim) -> Result<Option<AimedStages<Self>>> {
        self.note_memory("aimed photons", aim.bytes());
        Ok(Some((Box::new(CpuAimedEmitter::new(aim.clone())), Box::new(CpuTracer::aimed(settings, required.features)))))
    }

    fn costs(&self, kept: Kept) -> Costs {
        // A photon: as stored; normal and flux in the order of its index, 22 of the index; 52 more while that is
        // sorted, and 4 for normals while they are counted. Under way: vectors that double, and the part of a
        // buffer that is being made of them.
        // A pixel: a copy of the film when it is read.
        Costs {
            photon: kept.bytes() + 12 + kept.flux_bytes() + 22 + 56,
            under_way: 96,
            path: 48,
            pixel: size_of::<FilmPixel>() as u64,
            query: 224,
        }
    }

    fn film(&mut self, scene: &SceneView<'_>, width: u32, height: u32) -> Result<CpuFilm> {
        let film = Film::new(width, height, scene.units)?;
        let pending = Film::new(width, height, scene.units)?.pixels;
        let bytes = (film.pixels.len() + pending.len()) * size_of::<FilmPixel>();
        self.note_memory("film", bytes as u64);
        Ok(CpuFilm { film, pending, pending_errors: Vec::new() })
    }

    fn fold(
        &mut self,
        film: &mut CpuFilm,
        layer: Layer,
        queries: &CpuBuffer<Query>,
        estimates: &CpuBuffer<Estimate>,
        paths: u64,
    ) -> Result<()> {
        let estimates = estimates.as_slice();
        self.pool.install(|| {
            film.for_queries(
                queries.as_slice(),
                || (),
                |(), index, query, pixel, _| {
                    if let Some(estimate) = estimates.get(index) {
                        deposit(pixel, layer, query.weight, estimate.irradiance(paths));
                    }
                },
            );
        });
        Ok(())
    }

    fn keep_errors(&mut self, film: &mut CpuFilm) -> Result<()> {
        let count = film.film.pixels.len();
        let bytes = (count * size_of::<ErrorPixel>()) as u64;
        let zeros = || {
            let mut zeros = Vec::new();
            zeros.try_reserve_exact(count).map_err(|_| Error::OutOfMemory { label: "film: errors", bytes })?;
            zeros.resize(count, ErrorPixel::default());
            Ok::<_, Error>(zeros)
        };
        film.film.errors = Some(zeros()?);
        film.pending_errors = zeros()?;
        self.note_memory("film: errors", 2 * bytes);
        Ok(())
    }

    fn fold_errors(
        &mut self,
        film: &mut CpuFilm,
        kind: MapKind,
        queries: &CpuBuffer<Query>,
        estimates: &CpuBuffer<Estimate>,
        spreads: &CpuBuffer<Spread>,
        paths: u64,
    ) -> Result<()> {
        let (queries, estimates, spreads) = (queries.as_slice(), estimates.as_slice(), spreads.as_slice());
        self.pool.install(|| {
            film.for_queries(
                queries,
                || (),
                |(), index, query, _, errors| {
                    if let (Some(errors), Some(estimate), Some(spread)) =
                        (errors, estimates.get(index), spreads.get(index))
                    {
                        errors.deposit(kind, query, estimate, spread, paths);
                    }
                },
            );
        });
        Ok(())
    }

    fn scale_radii(&mut self, queries: &mut CpuBuffer<Query>, factors: &CpuBuffer<u32>) -> Result<()> {
        self.pool.install(|| {
            queries.data.par_iter_mut().with_min_len(4096).for_each(|query| {
                query.radius *= factors.data.get(query.pixel as usize).map_or(1.0, |&bits| f32::from_bits(bits));
            });
        });
        Ok(())
    }

    fn end_pass(&mut self, film: &mut CpuFilm) -> Result<()> {
        self.pool.install(|| {
            if let Some(errors) = &mut film.film.errors {
                let pending = &mut film.pending_errors;
                errors.par_iter_mut().with_min_len(4096).zip(pending).for_each(|(sum, pass)| {
                    sum.end_pass(pass);
                    *pass = ErrorPixel::default();
                });
            }
            let sums = film.film.pixels.par_iter_mut().with_min_len(4096);
            sums.zip(&mut film.pending).for_each(|(sum, pass)| {
                let radiance = pass.layers.iter().flatten().sum::<f64>() / 3.0;
                sum.add(&FilmPixel { square: radiance * radiance, ..*pass });
                *pass = FilmPixel::default();
            });
        });
        film.film.passes += 1;
        Ok(())
    }

    fn abandon_pass(&mut self, film: &mut CpuFilm) -> Result<()> {
        film.pending.fill(FilmPixel::default());
        film.pending_errors.fill(ErrorPixel::default());
        Ok(())
    }

    fn read_film(&mut self, film: &CpuFilm) -> Result<Film> {
        Ok(film.film.clone())
    }

    fn memory(&self, scene: &CpuScene) -> Vec<(String, u64)> {
        let bytes = |count: usize, size: usize| (count * size) as u64;
        let mut memory = vec![
            ("triangles".to_owned(), bytes(scene.vertices.len(), 40) + bytes(scene.facets.len(), 16)),
            ("materials".to_owned(), bytes(scene.materials.len(), 48)),
            ("lights".to_owned(), bytes(scene.lights.len(), 64 + 4)),
            ("bvh".to_owned(), scene.caster.bytes()),
        ];
        memory.extend(self.noted_memory().iter().cloned());
        memory
    }

    fn renew(&mut self) -> Result<()> {
        self.forget_memory();
        self.timings().map(drop)
    }
}
