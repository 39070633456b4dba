//! How much of each estimate's disc lies on the surface.

use photon_core::area::{self, HEIGHT, LEAST_RADIUS, RINGS, SHEETS, SPOKES};
use photon_core::glam::Vec3;
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{
    AreaProbe, Estimate, Gather, Material, Pass, Query, RandomKind, Ray, Result, math, offset, sampling,
};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::scene::{CpuScene, Surface};

/// Queries that a thread takes at a time.
const BLOCK: usize = 64;

/// Short rays about each query.
#[derive(Debug)]
pub(crate) struct CpuArea;

impl AreaProbe<Cpu> for CpuArea {
    fn correct(
        &mut self,
        on: &mut Cpu,
        scene: &CpuScene,
        pass: Pass,
        queries: &CpuBuffer<Query>,
        gather: &Gather,
        estimates: &mut CpuBuffer<Estimate>,
    ) -> Result<()> {
        on.pool.install(|| {
            estimates.data.par_chunks_mut(BLOCK).zip(queries.data.par_chunks(BLOCK)).for_each(
                |(estimates, queries)| {
                    for (estimate, query) in estimates.iter_mut().zip(queries) {
                        // Where there is no light there is none to be mended.
                        if estimate.photons > 0 {
                            estimate.radius_squared *=
                                share(scene, pass, query, gather, estimate.radius_squared.sqrt());
                        }
                    }
                },
            );
        });
        Ok(())
    }
}

/// The share of the disc of that radius about the query that lies on its surface.
fn share(scene: &CpuScene, pass: Pass, query: &Query, gather: &Gather, radius: f32) -> f32 {
    if radius < LEAST_RADIUS {
        return 1.0;
    }
    let normal = Vec3::from(query.normal);
    let (tangent, bitangent) = sampling::basis(normal);
    let mut sampler = Sampler::new(RandomKind::Counter, pass.seed, pass.index, Domain::Area, query.path);
    let [turn, shift, ..] = sampler.words(0).map(unit_f32);
    let from = offset::off_surface(query.position.into(), normal);
    // Under a ceiling, from half its height.
    let up = Ray { origin: from, direction: normal, t_max: HEIGHT * radius };
    let height = opaque(scene, up).map_or(HEIGHT * radius, |(t, _)| 0.5 * t);
    let apex = from + normal * height;
    let (mut found, mut all) = (0.0, 0.0);
    for spoke in 0..SPOKES {
        let (sine, cosine) = math::sin_cos_turns(area::spoke_turns(spoke, turn));
        let direction = tangent * cosine + bitangent * sine;
        let along = Ray { origin: apex, direction, t_max: radius };
        let free = opaque(scene, along).map_or(radius, |(t, _)| t);
        for ring in 0..RINGS {
            let probe = area::probe(gather.kernel, spoke, ring, shift);
            all += probe.weight;
            let away = probe.distance * radius;
            let down = Ray { origin: apex + direction * away, direction: -normal, t_max: 2.0 * height };
            let Some((_, surface)) = opaque(scene, down) else { continue };
            let material = &scene.materials[surface.material as usize];
            let keeps = material.is_diffuse() && material.albedo != [0.0; 3];
            let off = (surface.point - Vec3::from(query.position)).dot(normal).abs();
            let flat = !gather.is_flat() || off <= gather.max_plane_distance * radius;
            let same = keeps && flat && surface.normal.dot(normal) >= gather.min_normal_cosine;
            if same && (away <= free || !enclosed(scene, &surface)) {
                found += probe.weight;
            }
        }
    }
    area::share(found, all)
}

/// Whether it lies within a solid, where no photon lands: what is above it turns its back.
fn enclosed(scene: &CpuScene, surface: &Surface) -> bool {
    let up = Ray {
        origin: offset::off_surface(surface.point, surface.normal),
        direction: surface.normal,
        t_max: f32::INFINITY,
    };
    opaque(scene, up).is_some_and(|(_, above)| !above.front)
}

/// The nearest surface that is not glass, and how far away.
fn opaque(scene: &CpuScene, mut ray: Ray) -> Option<(f32, Surface)> {
    let mut passed = 0.0;
    for _ in 0..=SHEETS {
        let surface = scene.surface(&ray)?;
        let kind = scene.materials[surface.material as usize].kind;
        if kind != Material::DIELECTRIC && kind != Material::THIN {
            return Some((passed + surface.t, surface));
        }
        passed += surface.t;
        ray = Ray { t_max: ray.t_max - surface.t, ..surface.pass(ray.direction) };
    }
    None
}
