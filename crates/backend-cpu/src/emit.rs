//! Photons leave the lights.

use photon_core::glam::Vec3;
use photon_core::random::{BLOCK_LIGHT, BLOCK_START, Domain, Sampler, unit_f32};
use photon_core::{Batch, Emitter, Light, PhotonRay, Result, light_probability, offset, pick_light, sampling};
use rayon::prelude::*;

use crate::cpu::{Cpu, CpuBuffer};
use crate::scene::CpuScene;

/// Sends photons out in proportion to the power of the lights.
#[derive(Debug)]
pub(crate) struct CpuEmitter;

impl Emitter<Cpu> for CpuEmitter {
    fn emit(&mut self, on: &mut Cpu, scene: &CpuScene, batch: &Batch, rays: &mut CpuBuffer<PhotonRay>) -> Result<()> {
        rays.clear();
        let count = batch.paths.len();
        rays.needed = count as u64;
        let fit = count.min(rays.capacity as usize);
        rays.data.resize(fit, PhotonRay::default());
        on.pool.install(|| {
            rays.data.par_iter_mut().with_min_len(1024).enumerate().for_each(|(index, ray)| {
                let path = batch.paths.start + index as u32;
                let pass = batch.pass;
                let mut sampler = Sampler::new(pass.random, pass.seed, pass.index, Domain::Photon, path);
                *ray = emit(scene, &mut sampler, path);
            });
        });
        Ok(())
    }
}

/// The ray of one path. Every path carries the power of its light over the light's probability.
#[inline]
fn emit(scene: &CpuScene, sampler: &mut Sampler, path: u32) -> PhotonRay {
    let [choice, a, b, side] = sampler.words(BLOCK_LIGHT);
    let [c, d, ..] = sampler.words(BLOCK_START);
    let (a, b, c, d) = (unit_f32(a), unit_f32(b), unit_f32(c), unit_f32(d));
    let index = pick_light(&scene.light_starts, choice);
    let light = &scene.lights[index];
    let share = light_probability(&scene.light_starts, index);
    let position = Vec3::from(light.position);
    let along = Vec3::from(light.direction);
    let (origin, direction) = match light.kind {
        Light::POINT => (position, sampling::uniform_sphere(c, d)),
        Light::SPOT => {
            let versine = sampling::spot_versine(light.versine_inner, light.versine_outer, c);
            (position, sampling::about(along, versine, d))
        }
        Light::DIRECTIONAL => {
            let (x, y) = sampling::disc(a, b);
            let (tangent, bitangent) = sampling::basis(along);
            ((tangent * x + bitangent * y - along) * light.radius, along)
        }
        _ => {
            let primitive = light.primitive as usize;
            let (u, v) = sampling::triangle(a, b);
            let point = offset::within(scene.vertices[primitive], u, v);
            let front = Vec3::from(scene.facets[primitive].normal);
            let back = light.flags & Light::BOTH_SIDES != 0 && side >> 31 == 1;
            let normal = if back { -front } else { front };
            (offset::off_surface(point, normal), sampling::cosine_hemisphere(normal, c, d))
        }
    };
    PhotonRay {
        origin: origin.into(),
        path,
        direction: direction.into(),
        light: index as u32,
        power: light.power.map(|p| (f64::from(p) / share) as f32),
        reserved: 0,
    }
}
