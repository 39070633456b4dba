//! Irradiance estimation from the photons near a point.

use photon_core::glam::Vec3;
use photon_core::memory::{self, OutOfMemory};
use photon_core::{
    ErrorMoments, Estimate, EstimateParams, PhotonFormat, Query, RadianceEstimator, ReflectionLobe, Result, Search,
    neighbour_radius, octahedral,
};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::index::Neighbours;
use crate::map::power::Power;
use crate::map::{CpuMap, Powers};
use crate::stages::error_moments::estimate_with_moments_at;
use crate::stages::photon_powers::{PhotonPowers, Reflected, Shaded, Stored};

/// Lower bound on the squared radius that an estimate divides by.
const MIN_RADIUS_SQUARED: f32 = neighbour_radius::MIN_RADIUS * neighbour_radius::MIN_RADIUS;

/// Queries per parallel task.
const BLOCK: usize = 256;

/// Estimates irradiance from photon maps.
#[derive(Debug)]
pub(crate) struct CpuEstimator;

impl RadianceEstimator<Cpu> for CpuEstimator {
    fn estimate(
        &mut self,
        on: &mut Cpu,
        map: &CpuMap,
        queries: &CpuBuffer<Query>,
        gather: &EstimateParams,
        estimates: &mut CpuBuffer<Estimate>,
    ) -> Result<()> {
        gather.validate_for(map.photon_format())?;
        let needed = queries.data.len();
        estimates.reset(needed, needed.min(estimates.capacity as usize));
        on.pool.install(|| {
            estimates.data.par_chunks_mut(BLOCK).with_max_len(1).zip(queries.data.par_chunks(BLOCK)).try_for_each(
                |(out, queries)| {
                    on.stop.check()?;
                    // Neighbouring queries have similar radii, which the scratch memory remembers.
                    let mut scratch = scratch_for(map, gather)?;
                    for (estimate, query) in out.iter_mut().zip(queries) {
                        *estimate = estimate_at(map, VisiblePoint::of(query, gather), gather, &mut scratch);
                    }
                    Ok(())
                },
            )
        })
    }

    fn estimate_with_moments(
        &mut self,
        on: &mut Cpu,
        map: &CpuMap,
        queries: &CpuBuffer<Query>,
        gather: &EstimateParams,
        estimates: &mut CpuBuffer<Estimate>,
        error_moments: &mut CpuBuffer<ErrorMoments>,
    ) -> Result<()> {
        gather.validate_moments()?;
        gather.validate_for(map.photon_format())?;
        let needed = queries.data.len();
        let fit = needed.min(estimates.capacity.min(error_moments.capacity) as usize);
        estimates.reset(needed, fit);
        error_moments.reset(needed, fit);
        on.pool.install(|| {
            let out =
                estimates.data.par_chunks_mut(BLOCK).with_max_len(1).zip(error_moments.data.par_chunks_mut(BLOCK));
            out.zip(queries.data.par_chunks(BLOCK)).try_for_each(|((estimates, error_moments), queries)| {
                on.stop.check()?;
                for ((estimate, moments), query) in estimates.iter_mut().zip(error_moments).zip(queries) {
                    (*estimate, *moments) = estimate_with_moments_at(map, VisiblePoint::of(query, gather), gather);
                }
                Ok(())
            })
        })
    }

    fn neighbour_radius(
        &mut self,
        on: &mut Cpu,
        map: &CpuMap,
        neighbours: u32,
        min_normal_cosine: f32,
    ) -> Result<Option<f32>> {
        // Searches are limited to the largest permitted radius.
        const LIMIT: f32 = neighbour_radius::MAX_RADIUS * neighbour_radius::MAX_RADIUS;
        let count = map.len().min(neighbour_radius::SAMPLE as usize);
        if map.len() <= neighbours as usize {
            return Ok(None);
        }
        let mut radii = memory::with_capacity(count, "search radii")?;
        on.pool.install(|| {
            (0..count)
                .into_par_iter()
                .with_max_len(64)
                .map(|i| {
                    let photon = map.stored(i * map.len() / count);
                    let normal = octahedral::unpack(photon.normal);
                    let mut scratch = Neighbours::default();
                    let accept = |slot| map.normal(slot).dot(normal) >= min_normal_cosine;
                    map.index().nearest(photon.position, neighbours as usize + 1, LIMIT, accept, &mut scratch);
                    let nearest = scratch.as_slice();
                    (nearest.len() > neighbours as usize).then(|| nearest[neighbours as usize].d2)
                })
                .collect_into_vec(&mut radii);
        });
        let found = radii.into_iter().flatten().collect();
        Ok(Some(neighbour_radius::median(found, count as u32)))
    }

    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Mono
    }

    fn weighs_reflections(&self) -> bool {
        true
    }
}

/// Scratch memory for the searches of `gather` in `map`.
pub(crate) fn scratch_for(map: &CpuMap, gather: &EstimateParams) -> Result<Neighbours, OutOfMemory> {
    match gather.search {
        Search::KNearest { k: most } | Search::Paper { max: most, .. } => {
            Neighbours::for_nearest(map.len().min(most as usize))
        }
        Search::Radius | Search::NearestPhoton => Ok(Neighbours::default()),
    }
}

/// The point at which irradiance is estimated.
#[derive(Clone, Copy)]
pub(crate) struct VisiblePoint {
    pub(crate) position: [f32; 3],
    /// Unit normal, on the visible side.
    pub(crate) normal: Vec3,
    pub(crate) radius: f32,
    pub(crate) factor: PowerFactor,
}

/// What the power of each photon is multiplied by.
#[derive(Clone, Copy)]
pub(crate) enum PowerFactor {
    /// 1: diffuse, without shading normals.
    Even,
    /// Diffuse, with this shading normal.
    Shaded(Vec3),
    /// The reflection of a glossy surface; if there is a `mark`, from those photons that count for the query with this word:
    /// [`photon_core::gloss_caustics::counts`].
    Reflected { lobe: ReflectionLobe, mark: Option<u32> },
}

impl PowerFactor {
    /// For a diffuse surface with the shading normal `shading`.
    pub(crate) fn diffuse(shading: Vec3, gather: &EstimateParams) -> Self {
        if gather.shading_normals { Self::Shaded(shading) } else { Self::Even }
    }

    fn of(query: &Query, gather: &EstimateParams) -> Self {
        if gather.reflection {
            let (wo, normal) = (octahedral::unpack(query.offset_or_wo), octahedral::unpack(query.shading_normal));
            let anisotropy = if gather.anisotropy { query.path } else { 0 };
            let lobe = ReflectionLobe::with_anisotropy([query.media, query.coat], anisotropy, wo, normal);
            return Self::Reflected { lobe, mark: gather.marked.then_some(query.offset_or_wo) };
        }
        if gather.shading_normals { Self::Shaded(octahedral::unpack(query.shading_normal)) } else { Self::Even }
    }
}

impl VisiblePoint {
    fn of(query: &Query, gather: &EstimateParams) -> Self {
        let radius = query.radius * gather.radius_scale;
        let factor = PowerFactor::of(query, gather);
        Self { position: query.position, normal: query.normal.into(), radius, factor }
    }

    /// Vector from the point to a photon.
    #[inline]
    pub(crate) fn to(&self, map: &CpuMap, slot: u32) -> Vec3 {
        Vec3::from(map.index().position(slot)) - Vec3::from(self.position)
    }

    /// Distance of a photon from the tangent plane at the point.
    #[inline]
    pub(crate) fn off_plane(&self, map: &CpuMap, slot: u32) -> f32 {
        self.to(map, slot).dot(self.normal).abs()
    }
}

/// The estimate at `point`.
pub(crate) fn estimate_at(
    map: &CpuMap,
    point: VisiblePoint,
    gather: &EstimateParams,
    scratch: &mut Neighbours,
) -> Estimate {
    match (map.powers(), point.factor) {
        (Powers::Grey(powers), _) => estimate_of(map, Stored(powers), point, gather, scratch),
        (Powers::Colour(powers), PowerFactor::Even) => estimate_of(map, Stored(powers), point, gather, scratch),
        (Powers::Colour(powers), PowerFactor::Shaded(shading)) => {
            estimate_of(map, Shaded(powers, shading), point, gather, scratch)
        }
        (Powers::Colour(powers), PowerFactor::Reflected { lobe, mark }) => {
            estimate_of(map, Reflected { powers, lobe, mark }, point, gather, scratch)
        }
    }
}

/// As [`estimate_at`], for photons of this power.
fn estimate_of<P: PhotonPowers>(
    map: &CpuMap,
    powers: P,
    point: VisiblePoint,
    gather: &EstimateParams,
    scratch: &mut Neighbours,
) -> Estimate {
    let VisiblePoint { position, normal, radius, .. } = point;
    let radius_squared = radius * radius;
    let accept = |slot: u32| map.normal(slot).dot(normal) >= gather.min_normal_cosine;
    match gather.search {
        Search::Radius if gather.is_flat() => within::<true, P>(map, powers, point, gather),
        Search::Radius => within::<false, P>(map, powers, point, gather),
        Search::KNearest { k } => {
            map.index().nearest(position, k as usize, radius_squared, accept, scratch);
            let nearest = scratch.as_slice();
            // If all k were found, the k-th only determines the radius of the disc that contains the others.
            let full = nearest.len() == k as usize;
            let (kept, reach) = match nearest.split_last() {
                Some((last, others)) if full => (others, last.d2),
                _ => (nearest, radius_squared),
            };
            let mut sum = Sum::new(reach);
            let scale = 1.0 / sum.radius_squared;
            for neighbour in kept {
                let weight = gather.kernel.weight((neighbour.d2 * scale).min(1.0));
                sum = sum.and(powers.of(map, neighbour.slot), weight);
            }
            sum.photons = nearest.len() as u32;
            sum.finish()
        }
        Search::NearestPhoton => {
            map.index().nearest(position, 1, radius_squared, accept, scratch);
            match scratch.as_slice() {
                [] => Sum::<P::Power>::new(radius_squared).finish(),
                [nearest, ..] => Sum::new(nearest.d2).and(powers.of(map, nearest.slot), 1.0).finish(),
            }
        }
        Search::Paper { max, threshold, factor } => {
            let cosine = |slot: u32| map.direction(slot).dot(normal);
            map.index().nearest(position, max as usize, radius_squared, |slot| cosine(slot) > 0.0, scratch);
            let nearest = scratch.as_slice();
            if nearest.len() < threshold as usize {
                return Sum::<P::Power>::new(radius_squared).finish();
            }
            let reach = match nearest.last() {
                Some(last) if nearest.len() == max as usize => last.d2,
                _ => radius_squared,
            };
            let mut sum = Sum::new(reach);
            for neighbour in nearest {
                sum = sum.and(powers.of(map, neighbour.slot), cosine(neighbour.slot) * factor);
            }
            sum.finish()
        }
    }
}

/// The estimate from all photons within the radius; if `FLAT`, only from those near the query's plane.
fn within<const FLAT: bool, P: PhotonPowers>(
    map: &CpuMap,
    powers: P,
    point: VisiblePoint,
    gather: &EstimateParams,
) -> Estimate {
    let radius_squared = point.radius * point.radius;
    let most = gather.max_plane_distance * point.radius;
    let sum = Sum::new(radius_squared);
    let scale = 1.0 / sum.radius_squared;
    let accept = |slot: u32| {
        map.normal(slot).dot(point.normal) >= gather.min_normal_cosine && !(FLAT && point.off_plane(map, slot) > most)
    };
    let sum = powers.fold_within(map, (point.position, radius_squared), accept, sum, |sum, _slot, d2, power| {
        sum.and(power, gather.kernel.weight((d2 * scale).min(1.0)))
    });
    sum.finish()
}

/// Σ weight·power.
pub(crate) struct Sum<P: Power> {
    flux: P::Sum,
    pub(crate) radius_squared: f32,
    photons: u32,
    flags: u32,
}

impl<P: Power> Sum<P> {
    pub(crate) fn new(radius_squared: f32) -> Self {
        let singular = radius_squared < MIN_RADIUS_SQUARED;
        Self {
            flux: P::Sum::default(),
            radius_squared: radius_squared.max(MIN_RADIUS_SQUARED),
            photons: 0,
            flags: if singular { Estimate::SINGULAR } else { 0 },
        }
    }

    /// Adds one photon. Takes and returns the sum by value, so that it stays in registers.
    #[inline]
    pub(crate) fn and(mut self, power: P, weight: f32) -> Self {
        power.add(&mut self.flux, weight);
        self.photons += 1;
        self
    }

    pub(crate) fn finish(self) -> Estimate {
        Estimate {
            flux: P::rgb(self.flux).map(|f| f as f32),
            radius_squared: self.radius_squared,
            photons: self.photons,
            flags: self.flags,
            power_sums: [0.0; 2],
        }
    }
}
