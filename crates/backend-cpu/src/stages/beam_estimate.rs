//! The beam radiance estimate: light that photons of a medium scatter along a segment.

use photon_core::glam::Vec3;
use photon_core::phase::Phase;
use photon_core::{BeamEstimator, BeamParams, Estimate, Query, Result, Segment, math};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::map::{CpuMap, Powers};
use crate::scene::CpuScene;

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
        estimates: &mut CpuBuffer<Estimate>,
    ) -> Result<()> {
        let Powers::Colour(powers) = map.powers() else {
            return map.photon_format().check_full("photons in media");
        };
        let photons = Photons { map, powers };
        estimates.clear();
        estimates.needed = segments.data.len() as u64;
        let fit = segments.data.len().min(estimates.capacity as usize);
        estimates.data.resize(fit, Estimate::default());
        on.pool.install(|| {
            let blocks = estimates.data.par_chunks_mut(BLOCK).zip(segments.data.par_chunks(BLOCK));
            blocks.for_each(|(estimates, segments)| {
                for (estimate, query) in estimates.iter_mut().zip(segments) {
                    *estimate = photons.along(scene, query, params);
                }
            });
        });
        Ok(())
    }
}

/// The photons of media.
struct Photons<'a> {
    map: &'a CpuMap,
    powers: &'a [Vec3],
}

impl Photons<'_> {
    /// Light that they scatter along a segment.
    fn along(&self, scene: &CpuScene, query: &Query, params: &BeamParams) -> Estimate {
        let segment = Segment::of(query);
        let (medium, _) = scene.medium(segment.media);
        match scene.columns(&segment, medium) {
            None => self.sum(scene, query, params, |distance| distance.max(0.0)),
            Some(columns) => self.sum(scene, query, params, |distance| columns.to(distance)),
        }
    }

    /// The estimate, by the column to each distance along the segment.
    fn sum(&self, scene: &CpuScene, query: &Query, params: &BeamParams, column: impl Fn(f32) -> f32) -> Estimate {
        let Self { map, powers } = *self;
        let segment = Segment::of(query);
        let (index, medium) = scene.medium(segment.media);
        let (extinction, phase) = (medium.extinction(), Phase::of(medium));
        // In dense media photons are closer together than a mean free path, or are noise.
        let radius = (params.radius * query.radius).min(0.5 / extinction.max_element());
        let squared = radius * radius;
        let mut estimate = Estimate { radius_squared: squared, ..Estimate::default() };
        let mut sum = [0.0_f64; 3];
        map.index().along(segment.origin.into(), segment.direction.into(), segment.length, radius, |slot, t, d2| {
            let from_origin = Vec3::from(map.index().position(slot)) - segment.origin;
            if !map.has_medium(slot, index) || !segment.contains(from_origin) {
                return;
            }
            let weight =
                params.kernel.weight((d2 / squared).min(1.0)) * phase.value(map.direction(slot), segment.direction);
            let power = powers[slot as usize] * weight;
            let depth = extinction * column(t);
            for c in 0..3 {
                sum[c] += f64::from(power[c] * math::exp_neg(depth[c]));
            }
            estimate.photons += 1;
        });
        estimate.flux = sum.map(|sum| sum as f32);
        estimate
    }
}
