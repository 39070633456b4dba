//! Area correction: the share of each estimate's disc that lies on the surface.

use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

use photon_core::area::{self, HEIGHT, MIN_RADIUS, RINGS, SHEETS, SPOKES};
use photon_core::glam::Vec3;
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{
    AreaProbe, ErrorMoments, Estimate, EstimateBuffers, EstimateParams, Features, Hit, Lobe, Pass, Query, RandomKind,
    Ray, Result, SurfaceInteraction, anisotropy, math, offset, sampling,
};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::scene::CpuScene;
use crate::stages::clear_disc::{FlatDisc, ON_PLANE, Place};

/// Queries per parallel task.
const BLOCK: usize = 64;

/// Triangles around a query; where there are more, probes are traced.
const MAX_NEAR: usize = 24;

/// The estimate's radius, and the wide and narrow radius of the error moments, relative to the estimate's.
const RADII: [f32; 3] = [1.0, SQRT_2, FRAC_1_SQRT_2];

/// Traces short rays around each query.
#[derive(Debug)]
pub(crate) struct CpuArea;

impl AreaProbe<Cpu> for CpuArea {
    fn correct(
        &mut self,
        on: &mut Cpu,
        scene: &CpuScene,
        pass: Pass,
        queries: &CpuBuffer<Query>,
        gather: &EstimateParams,
        buffers: EstimateBuffers<'_, Cpu>,
    ) -> Result<()> {
        let estimates =
            buffers.estimates.data.par_chunks_mut(BLOCK).with_max_len(1).zip(queries.data.par_chunks(BLOCK));
        let has_alpha = scene.present.intersects(Features::RANDOM_SURFACES);
        let around = |query| Around { scene, pass, query, gather, has_alpha };
        on.pool.install(|| match buffers.error_moments {
            None => estimates.try_for_each(|(estimates, queries)| {
                on.stop.check()?;
                for (estimate, query) in estimates.iter_mut().zip(queries) {
                    around(query).correct(estimate);
                }
                Ok::<(), photon_core::Error>(())
            }),
            Some(error_moments) => estimates.zip(error_moments.data.par_chunks_mut(BLOCK)).try_for_each(
                |((estimates, queries), error_moments)| {
                    on.stop.check()?;
                    for ((estimate, query), moments) in estimates.iter_mut().zip(queries).zip(error_moments) {
                        around(query).correct_with_moments(estimate, moments);
                    }
                    Ok(())
                },
            ),
        })?;
        scene.check_caster()
    }
}

/// The surroundings of a query.
#[derive(Clone, Copy)]
pub(crate) struct Around<'a> {
    pub(crate) scene: &'a CpuScene,
    pub(crate) pass: Pass,
    pub(crate) query: &'a Query,
    pub(crate) gather: &'a EstimateParams,
    /// Whether surfaces may have holes.
    pub(crate) has_alpha: bool,
}

impl<'a> Around<'a> {
    fn disc(&self, estimate: &Estimate) -> Disc<'a> {
        let Self { scene, pass, query, gather, .. } = *self;
        Disc { scene, pass, query, gather, radius: estimate.radius_squared.sqrt() }
    }

    /// Divides an estimate by the share of its disc that lies on the surface.
    pub(crate) fn correct(&self, estimate: &mut Estimate) {
        // An estimate of 0 needs no correction.
        if estimate.photons > 0 {
            let disc = self.disc(estimate);
            let shares = if self.has_alpha { disc.shares::<false, true>() } else { disc.shares::<false, false>() };
            estimate.radius_squared *= shares[0];
        }
    }

    /// The same with error moments, which are divided by the shares of their own discs.
    pub(crate) fn correct_with_moments(&self, estimate: &mut Estimate, moments: &mut ErrorMoments) {
        if moments.photons > 0 {
            let disc = self.disc(estimate);
            let [share, wide, narrow] =
                if self.has_alpha { disc.shares::<true, true>() } else { disc.shares::<true, false>() };
            estimate.radius_squared *= share;
            moments.wide = moments.wide.map(|flux| flux * (share / wide));
            moments.narrow = moments.narrow.map(|flux| flux * (share / narrow));
        }
    }
}

/// An estimate's disc around a query.
struct Disc<'a> {
    scene: &'a CpuScene,
    pass: Pass,
    query: &'a Query,
    gather: &'a EstimateParams,
    radius: f32,
}

impl Disc<'_> {
    /// Whether a disc with radius `far` lies within one triangle, with nothing above it: all probes would find that
    /// triangle. For scenes without alpha, and if the ray caster tells which triangles are near.
    // Not inlined, and without a call of `interaction`, so that rays are as fast as without it.
    #[inline(never)]
    fn is_clear(&self, far: f32) -> bool {
        let Self { scene, query, gather, radius, .. } = *self;
        if far >= scene.largest_inradius() {
            return false;
        }
        // Points within the rounding of coordinates have to be near enough for each of the radii.
        if gather.is_flat() && gather.max_plane_distance * FRAC_1_SQRT_2 * radius < 4.0 * ON_PLANE {
            return false;
        }
        let (centre, normal) = (Vec3::from(query.position), Vec3::from(query.normal));
        let disc = FlatDisc { centre, normal, radius: far, height: HEIGHT * radius };
        let (low, high) = disc.bounds();
        let mut room = [0; MAX_NEAR];
        let Some(near) = scene.caster.overlapping(low, high, &mut room) else { return false };
        let mut holder = None;
        for &triangle in near {
            match disc.place(scene.vertices[triangle as usize]) {
                Place::Apart => {}
                // Of two in the same place, the rays decide. A caster may report one twice.
                Place::Holds if holder.is_none_or(|known| known == triangle) => holder = Some(triangle),
                Place::Holds | Place::Other => return false,
            }
        }
        let Some(primitive) = holder else { return false };
        let down = Ray { origin: centre + normal * disc.height, direction: -normal, t_max: 2.0 * disc.height };
        let surface = scene.interaction(&down, &Hit { t: disc.height, primitive, u: 1.0 / 3.0, v: 1.0 / 3.0 });
        self.keeps(&surface) && !scene.materials[surface.material as usize].kind().transmits()
    }

    /// Whether the photons that the estimate counts are stored on the surface, by its material and its normal.
    fn keeps(&self, surface: &SurfaceInteraction) -> bool {
        let material = &self.scene.materials[surface.material as usize];
        let keeps = if self.gather.reflection { material.has_reflection() } else { material.stores_photons() };
        keeps && surface.normal.dot(Vec3::from(self.query.normal)) >= self.gather.min_normal_cosine
    }

    /// The share of the disc that lies on the query's surface. With `SECOND`, also the shares of the discs with √2
    /// and 1/√2 times its radius; otherwise these are 1. With `ALPHA`, surfaces may have holes; those that are there with
    /// a probability count as there, since the photons stored on them stand for all that arrive.
    fn shares<const SECOND: bool, const ALPHA: bool>(&self) -> [f32; 3] {
        let Self { scene, query, gather, radius, .. } = *self;
        if radius < MIN_RADIUS {
            return [1.0; 3];
        }
        let normal = Vec3::from(query.normal);
        let far = if SECOND { SQRT_2 * radius } else { radius };
        if !ALPHA && self.is_clear(far) {
            return [1.0; 3];
        }
        let (tangent, bitangent) = sampling::basis(normal);
        // The word for the path may have the anisotropy, which is that of many queries.
        let key = if gather.anisotropy && anisotropy::is_packed(query.path) { query.pixel } else { query.path };
        let mut sampler = Sampler::new(RandomKind::Counter, self.pass.seed, self.pass.index, Domain::Area, key);
        let [turn, shift, ..] = sampler.words(0).map(unit_f32);
        let from = offset::off_surface(query.position.into(), normal);
        // Under a ceiling, the apex is at half the ceiling's height.
        let up = Ray { origin: from, direction: normal, t_max: HEIGHT * radius };
        let height = opaque::<ALPHA>(scene, up).map_or(HEIGHT * radius, |(t, _)| 0.5 * t);
        let apex = from + normal * height;
        // Obstacles above half the plane distance may keep photons from the surface, or have photons on top that do
        // not count.
        let most = gather.max_plane_distance * radius;
        let level = from + normal * if gather.is_flat() { height.min(0.5 * most) } else { height };
        let height_over = |surface: &SurfaceInteraction| (surface.point - Vec3::from(query.position)).dot(normal);
        let (mut found, mut all) = ([0.0; 3], [0.0; 3]);
        let discs = if SECOND { 3 } else { 1 };
        for spoke in 0..SPOKES {
            // Sums of each spoke, as on a GPU, where it has an invocation of its own.
            let (mut found_by, mut all_by) = ([0.0; 3], [0.0; 3]);
            let (sine, cosine) = math::sin_cos_turns(area::spoke_turns(spoke, turn));
            let direction = tangent * cosine + bitangent * sine;
            let free = opaque::<ALPHA>(scene, Ray { origin: level, direction, t_max: far }).map_or(far, |(t, _)| t);
            // From the outermost ring inwards: if a ring lies on the surface and is not occluded, so do all rings
            // inside it.
            let mut whole = false;
            for ring in (0..RINGS + u32::from(SECOND)).rev() {
                let (distance, weight) = if ring < RINGS {
                    (area::probe(gather.kernel, spoke, ring, shift), 1.0)
                } else {
                    (area::outer_distance(spoke, shift), 0.0)
                };
                let [wide, narrow] = if SECOND { area::second_weights(gather.kernel, distance) } else { [0.0; 2] };
                let weights = [weight, wide, narrow];
                (0..discs).for_each(|i| all_by[i] += weights[i]);
                if whole {
                    (0..discs).for_each(|i| found_by[i] += weights[i]);
                    continue;
                }
                let away = distance * radius;
                let down = Ray { origin: apex + direction * away, direction: -normal, t_max: 2.0 * height };
                // Those farther above do not hide it: whether something stands in between is seen along the spoke.
                let above = |surface: &SurfaceInteraction| gather.is_flat() && height_over(surface) > most;
                let Some((_, surface)) = opaque_where::<ALPHA>(scene, down, above) else { continue };
                let off = height_over(&surface).abs();
                let is_open = away <= free;
                if self.keeps(&surface) && (is_open || !enclosed::<ALPHA>(scene, &surface)) {
                    // The outer probe exists only if error moments are requested. It must not decide for the rings
                    // inside it, since the image must be the same either way.
                    whole = ring < RINGS && is_open && (!gather.is_flat() || off <= most);
                    for i in 0..discs {
                        let most = gather.max_plane_distance * (RADII[i] * radius);
                        found_by[i] += if !gather.is_flat() || off <= most { weights[i] } else { 0.0 };
                    }
                }
            }
            for i in 0..discs {
                found[i] += found_by[i];
                all[i] += all_by[i];
            }
        }
        [0, 1, 2].map(|i| area::share(found[i], all[i]))
    }
}

/// Whether the surface lies inside a solid, where no photon lands: the surface above it is seen from the back.
fn enclosed<const ALPHA: bool>(scene: &CpuScene, surface: &SurfaceInteraction) -> bool {
    let up = Ray {
        origin: offset::off_surface(surface.point, surface.normal),
        direction: surface.normal,
        t_max: f32::INFINITY,
    };
    opaque::<ALPHA>(scene, up).is_some_and(|(_, above)| !above.front)
}

/// The nearest intersection with a surface that does not transmit, and its distance.
fn opaque<const ALPHA: bool>(scene: &CpuScene, ray: Ray) -> Option<(f32, SurfaceInteraction)> {
    opaque_where::<ALPHA>(scene, ray, |_| false)
}

/// The nearest one beyond surfaces that the ray `passes`.
fn opaque_where<const ALPHA: bool>(
    scene: &CpuScene,
    mut ray: Ray,
    mut passes: impl FnMut(&SurfaceInteraction) -> bool,
) -> Option<(f32, SurfaceInteraction)> {
    let mut passed = 0.0;
    for _ in 0..=SHEETS {
        let surface = scene.covered_surface::<ALPHA>(&ray)?;
        if !passes(&surface) && !scene.materials[surface.material as usize].kind().transmits() {
            return Some((passed + surface.t, surface));
        }
        passed += surface.t;
        ray = Ray { t_max: ray.t_max - surface.t, ..surface.spawn(Lobe::SpecularTransmission, ray.direction) };
    }
    None
}
