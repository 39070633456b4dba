//! The film: the image being accumulated.

use photon_core::memory::OutOfMemory;
use photon_core::{
    Display, DisplayImage, ErrorMoments, ErrorPixel, Estimate, Film, FilmBackend, FilmPixel, Layer, MapKind, Query,
    Result, Units, memory,
};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};

/// Sums over finished passes, with the pass in progress held separately.
#[derive(Debug)]
pub struct CpuFilm {
    pub(crate) film: Film,
    pub(crate) pending: Vec<FilmPixel>,
    /// Same length as `film.errors`.
    pending_errors: Vec<ErrorPixel>,
}

impl CpuFilm {
    /// Calls `work` with every query, the current pass of its pixel, and the pixel's error statistics if the film
    /// has them. Rows run in parallel. Queries must be ordered by pixel.
    pub(crate) fn for_queries<S: Send>(
        &mut self,
        on: &Cpu,
        queries: &[Query],
        scratch: impl Fn() -> Result<S, OutOfMemory> + Sync,
        work: impl Fn(&mut S, usize, &Query, &mut FilmPixel, Option<&mut ErrorPixel>) + Sync,
    ) -> Result<()> {
        let width = self.film.width;
        let mut errors = self.pending_errors.chunks_mut(width as usize);
        let rows = self.pending.chunks_mut(width as usize).map(|pixels| (pixels, errors.next()));
        let rows = memory::collected(rows, "rows of the film")?;
        let stop = &on.stop;
        let each_row = |(row, (pixels, mut errors)): (usize, (&mut [FilmPixel], Option<&mut [ErrorPixel]>))| {
            stop.check()?;
            let first = row as u32 * width;
            let start = queries.partition_point(|query| query.pixel < first);
            let mut scratch = scratch()?;
            for (index, query) in queries.iter().enumerate().skip(start) {
                let column = (query.pixel - first) as usize;
                let Some(pixel) = pixels.get_mut(column) else { break };
                work(&mut scratch, index, query, pixel, errors.as_mut().and_then(|errors| errors.get_mut(column)));
            }
            Ok(())
        };
        // One row at a time, as in all stages: rayon alone makes four parts for two threads, of which one may have all the work.
        on.pool.install(|| rows.into_par_iter().with_max_len(1).enumerate().try_for_each(each_row))
    }
}

impl CpuFilm {
    /// Reports its memory as that of the film.
    fn note(&self, on: &mut Cpu) {
        let bytes = size_of_val(self.film.pixels.as_slice()) + size_of_val(self.pending.as_slice());
        on.note_memory("film", bytes as u64);
        if let Some(errors) = &self.film.errors {
            on.note_memory(
                "film: errors",
                (size_of_val(errors.as_slice()) + size_of_val(self.pending_errors.as_slice())) as u64,
            );
        }
    }
}

/// Adds `weight × value` to a layer of `pixel`.
#[inline]
pub(crate) fn deposit(pixel: &mut FilmPixel, layer: Layer, weight: [f32; 3], value: [f64; 3]) {
    for c in 0..3 {
        pixel.layers[layer as usize][c] += f64::from(weight[c]) * value[c];
    }
}

impl FilmBackend for Cpu {
    type Film = CpuFilm;

    fn film(&mut self, units: Units, width: u32, height: u32) -> Result<CpuFilm> {
        let film = Film::new(width, height, units)?;
        let pending = Film::new(width, height, units)?.pixels;
        let film = CpuFilm { film, pending, pending_errors: Vec::new() };
        film.note(self);
        Ok(film)
    }

    fn accumulate(
        &mut self,
        film: &mut CpuFilm,
        layer: Layer,
        queries: &CpuBuffer<Query>,
        estimates: &CpuBuffer<Estimate>,
        paths: u64,
    ) -> Result<()> {
        let estimates = estimates.as_slice();
        film.for_queries(
            self,
            queries.as_slice(),
            || Ok(()),
            |(), index, query, pixel, _| {
                if let Some(estimate) = estimates.get(index) {
                    deposit(pixel, layer, query.throughput, estimate.irradiance(paths));
                }
            },
        )
    }

    fn keep_errors(&mut self, film: &mut CpuFilm) -> Result<()> {
        let count = film.film.pixels.len();
        let zeros = || memory::filled(count, ErrorPixel::default(), "film: errors");
        film.film.errors = Some(zeros()?);
        film.pending_errors = zeros()?;
        film.note(self);
        Ok(())
    }

    fn accumulate_errors(
        &mut self,
        film: &mut CpuFilm,
        kind: MapKind,
        queries: &CpuBuffer<Query>,
        estimates: &CpuBuffer<Estimate>,
        error_moments: &CpuBuffer<ErrorMoments>,
        paths: u64,
    ) -> Result<()> {
        let (queries, estimates, error_moments) = (queries.as_slice(), estimates.as_slice(), error_moments.as_slice());
        film.for_queries(
            self,
            queries,
            || Ok(()),
            |(), index, query, _, errors| {
                if let (Some(errors), Some(estimate), Some(moments)) =
                    (errors, estimates.get(index), error_moments.get(index))
                {
                    errors.deposit(kind, query, estimate, moments, paths);
                }
            },
        )
    }

    fn average_samples(&mut self, film: &mut CpuFilm, layers: &[Layer], samples: u32) -> Result<()> {
        let samples_of_pass = f64::from(samples);
        self.pool.install(|| {
            film.pending.par_iter_mut().with_min_len(4096).for_each(|pixel| {
                for &layer in layers {
                    pixel.layers[layer as usize].iter_mut().for_each(|sum| *sum /= samples_of_pass);
                }
            });
        });
        film.film.camera_samples = samples;
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
        film.note(self);
        film.pending.fill(FilmPixel::default());
        film.pending_errors.fill(ErrorPixel::default());
        Ok(())
    }

    fn clear_film(&mut self, film: &mut CpuFilm) -> Result<()> {
        film.film.pixels.fill(FilmPixel::default());
        film.film.errors.iter_mut().for_each(|errors| errors.fill(ErrorPixel::default()));
        (film.film.passes, film.film.camera_samples) = (0, 1);
        self.abandon_pass(film)
    }

    fn read_film(&mut self, film: &CpuFilm) -> Result<Film> {
        film.film.try_clone()
    }

    fn read_display(&mut self, film: &mut CpuFilm, display: &Display, clamp: bool) -> Result<DisplayImage> {
        display.validate()?;
        Ok(film.film.display_clamped(display, clamp))
    }
}
