//! The beam radiance estimate: light that photons of a medium scatter along a segment.

use std::f32::consts::SQRT_2;

use photon_core::glam::Vec3;
use photon_core::phase::Phase;
use photon_core::{
    BeamEstimator, BeamParams, ErrorMoments, Estimate, EstimateBuffers, Query, Result, Segment, flight, sampling,
};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
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
        let Self { map, powers } = *self;
        let segment = Segment::of(query);
        let Segment { origin, direction, length, .. } = segment;
        let (index, medium) = scene.medium(segment.media);
        let phase = Phase::of(medium);
        // In dense media photons are closer together than a mean free path, or are noise.
        let radius = (params.radius * query.radius).min(0.5 / medium.extinction().max_element());
        let squared = radius * radius;
        let mut estimate = Estimate { radius_squared: squared, ..Estimate::default() };
        let mut sum = [0.0_f64; 3];
        let mut power_sums = [0.0_f64; 2];
        let mut sums = Sums::<[f64; 3]>::default();
        let wide = if MOMENTS { SQRT_2 * radius } else { radius };
        let (tangent, bitangent) = if MOMENTS { sampling::basis(direction) } else { (Vec3::ZERO, Vec3::ZERO) };
        map.index().along(origin.into(), direction.into(), length, wide, |slot, t, d2| {
            let from_origin = Vec3::from(map.index().position(slot)) - origin;
            if !map.has_medium(slot, index) {
                return;
            }
            let Some(distance) = segment.distance(from_origin) else { return };
            let transmittance = flight::transmittance(medium, column(distance));
            let power = powers[slot as usize] * phase.value(map.direction(slot), direction) * transmittance;
            let u = d2 / squared;
            if !MOMENTS || (d2 <= squared && (-8.0 * radius..=length + 8.0 * radius).contains(&t)) {
                power.add(&mut sum, params.kernel.weight(u.min(1.0)));
                estimate.photons += 1;
                let mean = f64::from(power.mean());
                power_sums = [power_sums[0] + mean, power_sums[1] + mean * mean];
            }
            if MOMENTS {
                let offset = from_origin / wide;
                if 2.0 * u <= 1.0 {
                    power.add(&mut sums.narrow, params.kernel.weight(2.0 * u));
                }
                power.add(&mut sums.wide, params.kernel.weight((0.5 * u).min(1.0)));
                sums.add(f64::from(power.mean()), [offset.dot(tangent), offset.dot(bitangent)]);
            }
        });
        estimate.flux = sum.map(|sum| sum as f32);
        estimate.power_sums = power_sums.map(|sum| sum as f32);
        (estimate, sums.finish(|rgb| rgb))
    }
}
