//! Direct lighting by next-event estimation.

use photon_core::glam::Vec3;
use photon_core::memory::{self, OutOfMemory};
use photon_core::random::{Domain, Sampler, evenly_spread};
use photon_core::{
    Coat, DirectLight, Features, Layer, MediumStack, Pass, Query, RandomKind, Ray, Result, octahedral, offset,
    shading_normal, shadow_terminator,
};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::film::{CpuFilm, deposit};
use crate::scene::CpuScene;
use crate::stages::light_sample::sample;
use crate::stages::light_sampler::LightSampler;

/// Traces shadow rays to points on the lights.
#[derive(Debug)]
pub(crate) struct CpuDirect;

impl DirectLight<Cpu> for CpuDirect {
    fn light(
        &mut self,
        on: &mut Cpu,
        scene: &CpuScene,
        pass: Pass,
        queries: &CpuBuffer<Query>,
        shadow_rays: u32,
        film: &mut CpuFilm,
    ) -> Result<()> {
        let irradiance = match (scene.present.intersects(SHADED), scene.present.intersects(Features::RANDOM_SURFACES)) {
            (_, true) => traced::<true, true>,
            (true, false) => traced::<true, false>,
            (false, false) => traced::<false, false>,
        };
        let in_batches = if scene.traces_batches() {
            let queries = queries.as_slice();
            let mut found = memory::zeroed(queries.len(), "direct light")?;
            let chunks = found.par_chunks_mut(BATCH).with_max_len(1).zip(queries.par_chunks(BATCH));
            on.pool.install(|| {
                chunks.try_for_each(|(found, chunk)| {
                    on.stop.check()?;
                    traced_in_batch(scene, pass, chunk, shadow_rays, found).map_err(photon_core::Error::from)
                })
            })?;
            Some(found)
        } else {
            None
        };
        film.for_queries(
            on,
            queries.as_slice(),
            || Ok(()),
            |(), index, query, pixel, _| {
                let irradiance = match &in_batches {
                    Some(irradiance) => irradiance[index],
                    None => irradiance(scene, pass, query, shadow_rays),
                };
                deposit(pixel, Layer::Direct, query.throughput, irradiance);
            },
        )?;
        scene.check_caster()
    }
}

/// What shadow rays need a kernel of their own for.
const SHADED: Features = Features::SHADING_NORMALS.union(Features::TEXTURED_LIGHTS).union(Features::GLOSSY);

/// Queries whose shadow rays are traced together in batches.
const BATCH: usize = 1024;

/// Direct irradiance. `ALPHA`: surfaces are in the way of shadow rays with a probability.
fn traced<const SHADED: bool, const ALPHA: bool>(scene: &CpuScene, pass: Pass, query: &Query, rays: u32) -> [f64; 3] {
    irradiance::<SHADED>(scene, pass, query, rays, |ray, low| scene.occluded_with::<ALPHA>(ray, || low))
}

/// Direct irradiance at each query, in a scene without alpha: the lights are sampled once to collect the shadow rays, and
/// once more to use what they hit.
fn traced_in_batch(
    scene: &CpuScene,
    pass: Pass,
    queries: &[Query],
    rays: u32,
    found: &mut [[f64; 3]],
) -> Result<(), OutOfMemory> {
    let (mut all, mut hits) = (Vec::new(), Vec::new());
    for query in queries {
        memory::reserve_doubling(&mut all, rays as usize, "shadow rays")?;
        irradiance::<true>(scene, pass, query, rays, |ray, _| {
            all.push(*ray);
            true
        });
    }
    if !all.is_empty() {
        memory::reserve(&mut hits, all.len(), "shadow rays")?;
        scene.hit_many(&all, &mut hits);
    }
    let mut hits = hits.into_iter();
    let mut is_hit = || hits.next().flatten().is_some();
    for (found, query) in found.iter_mut().zip(queries) {
        *found = irradiance::<true>(scene, pass, query, rays, |_, _| is_hit());
    }
    Ok(())
}

/// Direct irradiance: the mean over `rays` shadow rays; `occluded` says for a ray and a random word whether something is in
/// its way.
#[inline(always)]
fn irradiance<const SHADED: bool>(
    scene: &CpuScene,
    pass: Pass,
    query: &Query,
    rays: u32,
    mut occluded: impl FnMut(&Ray, u32) -> bool,
) -> [f64; 3] {
    let mut sampler =
        Sampler::new(RandomKind::Counter, pass.seed, pass.index, Domain::Shadow, query.path).of_sample(pass.sample);
    let (mut position, mut normal) = (Vec3::from(query.position), Vec3::from(query.normal));
    let has_shading_normals = SHADED && scene.present.contains(Features::SHADING_NORMALS);
    let shading = if has_shading_normals { octahedral::unpack(query.shading_normal) } else { normal };
    if has_shading_normals && query.offset_or_wo != 0 {
        // The smooth surface instead of the triangle.
        position += shadow_terminator::unpack(query.offset_or_wo);
        normal = shading;
    }
    let light_sampler = LightSampler::for_rays(scene, rays, position, normal);
    let from = offset::off_surface(position, normal);
    // Cosine to the shading normal; 0 or below on the far side of the surface.
    let cosine_of = |direction: Vec3| {
        if has_shading_normals { shading_normal::cosine(direction, normal, shading) } else { normal.dot(direction) }
    };
    let mut sum = [0.0; 3];
    let is_systematic = scene.light_groups.starts() != 0;
    let first = sampler.words(0);
    let mut draw = |ray: u32| {
        let [choice, _, _, low] = if ray == 0 { first } else { sampler.words(ray) };
        let choice = if is_systematic { first[0] } else { choice };
        let [u, v] = evenly_spread([first[1], first[2]], ray);
        // Each ray samples its own stratum of the lights, with groups at the same place within it.
        let choice = (((u64::from(ray) << 32) | u64::from(choice)) / u64::from(rays)) as u32;
        ([choice, low], [u, v, low])
    };
    for first in (0..rays).step_by(2) {
        // Lights are picked for two rays at a time.
        let (words, points) = draw(first);
        let (picked, points) = if first + 1 < rays {
            let (others, more) = draw(first + 1);
            (light_sampler.pick([words, others]), [points, more])
        } else {
            // The second is not used.
            let [picked] = light_sampler.pick([words]);
            ([picked; 2], [points; 2])
        };
        let rest = (rays - first) as usize;
        for ((index, share), [u, v, low]) in picked.into_iter().zip(points).take(rest) {
            let Some(sampled) = sample::<SHADED>(scene, &scene.lights[index], from, Some(normal), [u, v]) else {
                continue;
            };
            let ray = sampled.ray;
            let cosine = cosine_of(ray.direction);
            if !(cosine > 0.0) {
                continue;
            }
            let mut value = sampled.times(cosine);
            if SHADED && query.coat != 0 {
                value *= Coat::from_bits(query.coat).entering(ray.direction.dot(shading));
            }
            if value != Vec3::ZERO && !occluded(&ray, low) {
                // The segment is unoccluded, so all of it lies in the query's medium.
                let value = value * scene.attenuation(&ray, ray.t_max, MediumStack::from_bits(query.media));
                for c in 0..3 {
                    sum[c] += f64::from(value[c]) / share;
                }
            }
        }
    }
    sum.map(|s| s / f64::from(rays))
}
