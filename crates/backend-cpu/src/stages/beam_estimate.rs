//! The beam radiance estimate: light that photons of a medium scatter along a segment.

use std::f32::consts::SQRT_2;

use photon_core::glam::Vec3;
use photon_core::phase::Phase;
use photon_core::{
    BeamEstimator, BeamParams, ErrorMoments, Estimate, EstimateBuffers, Kernel, Medium, Query, Result, Segment,
    Vectors, flight, sampling,
};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::index::{Batches, WIDTH};
use crate::map::power::Power as _;
use crate::map::{CpuMap, Powers};
use crate::scene::CpuScene;
use crate::stages::error_moments::Sums;

/// Segments per parallel task.
const BLOCK: usize = 64;

/// Estimates along segments.
#[derive(Debug)]
pub(crate) struct CpuBeamEstimator;

impl BeamEstimator<Cpu> for CpuBeamEstimator {
    fn estimate(
        &mut self,
        on: &mut Cpu,
        scene: &CpuScene,
        map: &CpuMap,
        segments: &CpuBuffer<Query>,
        params: &BeamParams,
        buffers: EstimateBuffers<'_, Cpu>,
    ) -> Result<()> {
        let Powers::Colour(powers) = map.powers() else {
            return map.photon_format().check_full("photons in media");
        };
        let photons = Photons { map, powers };
        let EstimateBuffers { estimates, error_moments } = buffers;
        let needed = segments.data.len();
        let fit = needed.min(estimates.capacity as usize);
        let Some(error_moments) = error_moments else {
            estimates.reset(needed, fit);
            return on.pool.install(|| {
                let blocks = estimates.data.par_chunks_mut(BLOCK).with_max_len(1).zip(segments.data.par_chunks(BLOCK));
                blocks.try_for_each(|(estimates, segments)| {
                    on.stop.check()?;
                    for (estimate, query) in estimates.iter_mut().zip(segments) {
                        (*estimate, _) = photons.along::<false>(scene, query, params);
                    }
                    Ok(())
                })
            });
        };
        let fit = fit.min(error_moments.capacity as usize);
        estimates.reset(needed, fit);
        error_moments.reset(needed, fit);
        on.pool.install(|| {
            let out =
                estimates.data.par_chunks_mut(BLOCK).with_max_len(1).zip(error_moments.data.par_chunks_mut(BLOCK));
            out.zip(segments.data.par_chunks(BLOCK)).try_for_each(|((estimates, error_moments), segments)| {
                on.stop.check()?;
                for ((estimate, moments), query) in estimates.iter_mut().zip(error_moments).zip(segments) {
                    (*estimate, *moments) = photons.along::<true>(scene, query, params);
                }
                Ok(())
            })
        })
    }
}

/// The photons of media.
struct Photons<'a> {
    map: &'a CpuMap,
    powers: &'a [Vec3],
}

impl Photons<'_> {
    /// Light that they scatter along a segment; with `MOMENTS`, the error moments of the photons within √2 times the radius.
    fn along<const MOMENTS: bool>(
        &self,
        scene: &CpuScene,
        query: &Query,
        params: &BeamParams,
    ) -> (Estimate, ErrorMoments) {
        let segment = Segment::of(query);
        let (medium, _) = scene.medium(segment.media);
        match scene.columns(&segment, medium) {
            None => self.sum::<MOMENTS>(scene, query, params, |distance| distance),
            Some(columns) => self.sum::<MOMENTS>(scene, query, params, |distance| columns.to(distance)),
        }
    }

    /// The same, by the column to each distance along the segment.
    fn sum<const MOMENTS: bool>(
        &self,
        scene: &CpuScene,
        query: &Query,
        params: &BeamParams,
        column: impl Fn(f32) -> f32,
    ) -> (Estimate, ErrorMoments) {
        let segment = Segment::of(query);
        let (index, medium) = scene.medium(segment.media);
        // In dense media photons are closer together than a mean free path, or are noise.
        let radius = (params.radius * query.radius).min(0.5 / medium.extinction().max_element());
        let wide = if MOMENTS { SQRT_2 * radius } else { radius };
        let mut beam = Beam::<MOMENTS, _> {
            photons: self,
            segment,
            index,
            is_only: self.map.has_only_medium(index),
            medium,
            phase: Phase::of(medium),
            column,
            kernel: params.kernel,
            radius,
            wide,
            axes: if MOMENTS { sampling::basis(segment.direction).into() } else { [Vec3::ZERO; 2] },
            sum: [0.0; 3],
            power_sums: [0.0; 2],
            count: 0,
            sums: Sums::default(),
        };
        let (origin, direction) = (segment.origin.into(), segment.direction.into());
        self.map.index().batches_along(origin, direction, segment.length, wide, &mut beam);
        let estimate = Estimate {
            flux: beam.sum.map(|sum| sum as f32),
            radius_squared: radius * radius,
            photons: beam.count,
            power_sums: beam.power_sums.map(|sum| sum as f32),
            ..Estimate::default()
        };
        (estimate, beam.sums.finish(|rgb| rgb))
    }
}

/// A segment, and the sums over its photons.
struct Beam<'a, const MOMENTS: bool, C> {
    photons: &'a Photons<'a>,
    segment: Segment,
    /// Its medium, by index and as it is; and whether all photons are in it.
    index: u32,
    is_only: bool,
    medium: &'a Medium,
    phase: Phase,
    /// From a distance along the segment.
    column: C,
    kernel: Kernel,
    radius: f32,
    /// The radius of the search.
    wide: f32,
    /// Unit vectors across the segment, for error moments.
    axes: [Vec3; 2],
    sum: [f64; 3],
    power_sums: [f64; 2],
    count: u32,
    sums: Sums<[f64; 3]>,
}

impl<const MOMENTS: bool, C: Fn(f32) -> f32> Batches for Beam<'_, MOMENTS, C> {
    #[inline(always)]
    fn accepts(&self, slot: u32) -> bool {
        self.is_only || self.photons.map.has_medium(slot, self.index)
    }

    #[inline(always)]
    fn take(&mut self, slots: &[u32; WIDTH], d2: &[f32; WIDTH], count: usize) {
        let Photons { map, powers } = *self.photons;
        let (mut offsets, mut directions): (Vectors<WIDTH>, Vectors<WIDTH>) = Default::default();
        for lane in 0..WIDTH {
            let offset = Vec3::from(map.index().position(slots[lane])) - self.segment.origin;
            (0..3).for_each(|c| offsets[c][lane] = offset[c]);
        }
        for lane in 0..WIDTH {
            let direction = map.direction(slots[lane]);
            (0..3).for_each(|c| directions[c][lane] = direction[c]);
        }
        let distances = self.segment.distances(&offsets);
        let mut columns = [0.0; WIDTH];
        for lane in (0..count).filter(|&lane| !distances[lane].is_nan()) {
            columns[lane] = (self.column)(distances[lane]);
        }
        let transmittances = flight::transmittances(self.medium, &columns);
        let values = self.phase.values(&directions, self.segment.direction);
        for lane in 0..count {
            if distances[lane].is_nan() {
                continue;
            }
            let transmittance = Vec3::from(transmittances.map(|channel| channel[lane]));
            let power = powers[slots[lane] as usize] * values[lane] * transmittance;
            self.add(power, Vec3::from(offsets.map(|axis| axis[lane])), d2[lane]);
        }
    }
}

impl<const MOMENTS: bool, C> Beam<'_, MOMENTS, C> {
    /// Adds a photon that shows this much of its power, at an offset from the start and a squared distance from the line.
    #[inline(always)]
    fn add(&mut self, power: Vec3, offset: Vec3, d2: f32) {
        let Segment { direction, length, .. } = self.segment;
        let squared = self.radius * self.radius;
        let u = d2 / squared;
        let reach = 8.0 * self.radius;
        if !MOMENTS || (d2 <= squared && (-reach..=length + reach).contains(&offset.dot(direction))) {
            power.add(&mut self.sum, self.kernel.weight(u.min(1.0)));
            self.count += 1;
            let mean = f64::from(power.mean());
            self.power_sums = [self.power_sums[0] + mean, self.power_sums[1] + mean * mean];
        }
        if MOMENTS {
            if 2.0 * u <= 1.0 {
                power.add(&mut self.sums.narrow, self.kernel.weight(2.0 * u));
            }
            power.add(&mut self.sums.wide, self.kernel.weight((0.5 * u).min(1.0)));
            let offset = offset / self.wide;
            self.sums.add(f64::from(power.mean()), self.axes.map(|axis| offset.dot(axis)));
        }
    }
}
