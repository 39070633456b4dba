//! Indirect light by final gathering (Jensen 1996).

use photon_core::glam::Vec3;
use photon_core::random::{Domain, Sampler, unit_f32};
use photon_core::{
    ErrorMoments, Estimate, EstimateParams, FinalGather, Layer, Lobe, MapKind, Maps, MediumStack, Pass, PerMap,
    PhotonFormat, Query, RandomKind, Result, offset, sampling,
};

use crate::cpu::{Cpu, CpuBuffer};
use crate::film::{CpuFilm, deposit};
use crate::index::Neighbours;
use crate::scene::CpuScene;
use crate::stages::error_moments::estimate_with_moments_at;
use crate::stages::estimate::{VisiblePoint, estimate_at};

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
        for (map, gather) in maps.photons.values().chain([&maps.irradiance]).flatten() {
            gather.validate_for(map.photon_format())?;
        }
        let max_bounces = self.max_bounces;
        on.pool.install(|| {
            film.for_queries(queries.as_slice(), PerMap::<Neighbours>::default, |scratch, _, query, pixel, errors| {
                let key = query.path;
                let sampler = Sampler::new(RandomKind::Counter, pass.seed, pass.index, Domain::Gather, key);
                let mut sum = Found::default();
                for ray in 0..rays {
                    let ray = (ray, rays, errors.is_some());
                    sum.add(&follow(scene, maps, query, sampler, ray, max_bounces, scratch), 1.0 / f64::from(rays));
                }
                deposit(pixel, Layer::Indirect, query.throughput, sum.irradiance);
                if let Some(errors) = errors {
                    errors.deposit_gathered(query, sum.bias, sum.narrow, sum.powers);
                }
            });
        });
        Ok(())
    }

    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Mono
    }
}

/// What rays find.
#[derive(Default)]
struct Found {
    irradiance: [f64; 3],
    /// The same by estimates over twice the area, less this.
    bias: [f64; 3],
    /// This, less the same by estimates over half the area.
    narrow: [f64; 3],
    /// Power of the photons, and its square.
    powers: [f64; 2],
}

impl Found {
    fn add(&mut self, other: &Self, share: f64) {
        for c in 0..3 {
            self.irradiance[c] += share * other.irradiance[c];
            self.bias[c] += share * other.bias[c];
            self.narrow[c] += share * other.narrow[c];
        }
        self.powers[0] += share * other.powers[0];
        self.powers[1] += share * share * other.powers[1];
    }

    /// Adds what an estimate and its spread tell.
    fn add_moments(&mut self, estimate: &Estimate, moments: &ErrorMoments, paths: u64) {
        if moments.photons == 0 || paths == 0 {
            return;
        }
        let area = std::f64::consts::PI * f64::from(estimate.radius_squared) * paths as f64;
        let (bias, narrow) = moments.biases(estimate);
        for c in 0..3 {
            self.bias[c] += bias[c] / area;
            self.narrow[c] += narrow[c] / area;
        }
        self.powers[0] += f64::from(moments.power);
        self.powers[1] += f64::from(moments.power_squared);
    }

    fn times(mut self, factor: [f32; 3]) -> Self {
        for c in 0..3 {
            let factor = f64::from(factor[c]);
            self.irradiance[c] *= factor;
            self.bias[c] *= factor;
            self.narrow[c] *= factor;
        }
        let mean = f64::from(factor[0] + factor[1] + factor[2]) / 3.0;
        self.powers = [self.powers[0] * mean, self.powers[1] * mean * mean];
        self
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
    (index, rays, with_errors): (u32, u32, bool),
    max_bounces: u32,
    scratch: &mut PerMap<Neighbours>,
) -> Found {
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
    // Of radiance over n², which refraction leaves as it is.
    let mut throughput = Vec3::ONE;
    let start = MediumStack::from_bits(query.media);
    let mut media = start;
    for bounce in 1..=max_bounces {
        let Some(surface) = scene.surface(&ray) else { break };
        let interface = scene.interface(&surface, media);
        throughput *= scene.attenuation(interface.before, surface.t);
        let bsdf = scene.bsdf(&surface, &interface);
        let lobe = match bsdf.split() {
            None => bsdf.choose(0.0),
            Some(_) => {
                let [choice, ..] = sampler.words(block + bounce);
                bsdf.choose(unit_f32(choice))
            }
        };
        match lobe {
            Lobe::SpecularReflection | Lobe::SpecularTransmission => {
                throughput *= bsdf.weight(lobe);
                ray = surface.spawn(lobe, bsdf.direction(lobe, ray.direction, surface.normal, 0.0, 0.0));
                if lobe == Lobe::SpecularTransmission {
                    media = interface.transmitted;
                }
            }
            Lobe::Diffuse => {
                let throughput = throughput * scene.radiance_scale(start, interface.before) * bsdf.weight(lobe);
                let mut found = Found::default();
                let at = |gather: &EstimateParams| VisiblePoint {
                    position: surface.point.into(),
                    normal: surface.normal,
                    radius: gather.radius_scale,
                };
                if let Some((map, gather)) = &maps.irradiance {
                    let estimate = estimate_at(map, at(gather), gather, &mut scratch[MapKind::Global]);
                    found.irradiance = estimate.flux.map(f64::from);
                    return found.times(throughput.to_array());
                }
                for (kind, map) in maps.photons.iter() {
                    let Some((map, gather)) = map else { continue };
                    let paths = maps.paths[kind];
                    let estimate = if with_errors {
                        let (estimate, moments) = estimate_with_moments_at(map, at(gather), gather);
                        found.add_moments(&estimate, &moments, paths);
                        estimate
                    } else {
                        estimate_at(map, at(gather), gather, &mut scratch[kind])
                    };
                    for (sum, e) in found.irradiance.iter_mut().zip(estimate.irradiance(paths)) {
                        *sum += e;
                    }
                }
                // Radiance is irradiance times albedo over π; the π cancels.
                return found.times(throughput.to_array());
            }
        }
    }
    Found::default()
}
