//! Indirect light by final gathering (Jensen 1996).

use photon_core::glam::Vec3;
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{FinalGather, Layer, Maps, Material, Pass, Query, RandomKind, Result, bsdf, offset, sampling};

use crate::cpu::{Cpu, CpuBuffer};
use crate::estimate::estimate_at;
use crate::film::{CpuFilm, deposit};
use crate::index::Neighbours;
use crate::scene::{CpuScene, VACUUM};
use crate::trace::{boundary, entered};

/// Rays from the queries to where the maps are read.
#[derive(Debug)]
pub(crate) struct CpuGather {
    pub(crate) max_bounces: u32,
}

impl FinalGather<Cpu> for CpuGather {
    fn gather(
        &mut self,
        on: &mut Cpu,
        scene: &CpuScene,
        maps: &Maps<'_, Cpu>,
        pass: Pass,
        queries: &CpuBuffer<Query>,
        rays: u32,
        film: &mut CpuFilm,
    ) -> Result<()> {
        let max_bounces = self.max_bounces;
        on.pool.install(|| {
            film.for_queries(
                queries.as_slice(),
                || [Neighbours::default(), Neighbours::default(), Neighbours::default()],
                |scratch, _, query, pixel| {
                    let key = query.path;
                    let sampler = Sampler::new(RandomKind::Counter, pass.seed, pass.index, Domain::Gather, key);
                    let mut sum = [0.0; 3];
                    for ray in 0..rays {
                        let found = follow(scene, maps, query, sampler, (ray, rays), max_bounces, scratch);
                        for c in 0..3 {
                            sum[c] += found[c] / f64::from(rays);
                        }
                    }
                    deposit(pixel, Layer::Indirect, query.weight, sum);
                },
            );
        });
        Ok(())
    }
}

/// What one ray contributes to the irradiance: π times the radiance that it finds, since its
/// direction has density cos θ/π. What comes straight from a light, or from one by mirrors and glass
/// alone, is not its to count.
fn follow(
    scene: &CpuScene,
    maps: &Maps<'_, Cpu>,
    query: &Query,
    mut sampler: Sampler,
    (index, rays): (u32, u32),
    max_bounces: u32,
    scratch: &mut [Neighbours; 3],
) -> [f64; 3] {
    let block = index * max_bounces.saturating_add(1);
    let [u, v, ..] = sampler.words(block);
    let normal = Vec3::from(query.normal);
    // One stratum of the height for each ray.
    let u = ((index as f32 + unit_f32(u)) / rays as f32).min(1.0 - f32::EPSILON);
    let mut ray = photon_core::Ray {
        origin: offset::off_surface(query.position.into(), normal),
        direction: sampling::cosine_hemisphere(normal, u, unit_f32(v)),
        t_max: f32::INFINITY,
    };
    let mut weight = Vec3::ONE;
    let mut medium = VACUUM;
    for bounce in 1..=max_bounces {
        let Some(surface) = scene.surface(&ray) else { break };
        let material = &scene.materials[surface.material as usize];
        weight *= scene.transmittance(&surface, medium);
        let albedo = Vec3::from(material.albedo);
        match material.kind {
            Material::MIRROR => {
                weight *= albedo;
                ray = surface.leave(bsdf::reflect(ray.direction, surface.normal));
            }
            Material::DIELECTRIC | Material::THIN => {
                let (reflectance, beyond) = boundary(material, &surface, ray.direction);
                let [choice, ..] = sampler.words(block + bounce);
                if unit_f32(choice) < reflectance {
                    ray = surface.leave(bsdf::reflect(ray.direction, surface.normal));
                } else {
                    weight *= albedo;
                    ray = surface.pass(beyond);
                    medium = entered(material, &surface, medium);
                }
            }
            _ => {
                let mut irradiance = [0.0; 3];
                for (map, scratch) in [&maps.direct, &maps.caustic, &maps.global].into_iter().zip(scratch) {
                    let Some((map, gather)) = map else { continue };
                    let point = surface.point.into();
                    let estimate = estimate_at(map, point, surface.normal, gather.radius_scale, gather, scratch);
                    for (sum, e) in irradiance.iter_mut().zip(estimate.irradiance(maps.paths)) {
                        *sum += e;
                    }
                }
                // Radiance is irradiance times albedo over π; the π cancels.
                let factor = (weight * albedo).to_array();
                return std::array::from_fn(|c| f64::from(factor[c]) * irradiance[c]);
            }
        }
    }
    [0.0; 3]
}
