//! Indirect light by final gathering (Jensen 1996).

use std::sync::atomic::{AtomicU64, Ordering};

use photon_core::glam::Vec3;
use photon_core::memory::OutOfMemory;
use photon_core::random::{Domain, GOLDEN_STEP, Sampler, unit_f32};
use photon_core::{
    Coat, ErrorMoments, Estimate, EstimateParams, Features, FinalGather, Layer, Layers, Lobe, MapKind, Maps,
    MediumStack, Pass, PerMap, PhotonFormat, Query, RandomKind, Result, Scattering, SkipLimit, Vertex, Wavelength,
    glossy, most_total_reflections, octahedral, offset, sampling, shading_normal,
};

use crate::cpu::{Cpu, CpuBuffer};
use crate::film::{CpuFilm, deposit};
use crate::index::Neighbours;
use crate::scene::CpuScene;
use crate::stages::area::Around;
use crate::stages::error_moments::estimate_with_moments_at;
use crate::stages::estimate::scratch_for;
use crate::stages::estimate::{PowerFactor, VisiblePoint, estimate_at};

/// Traces gather rays from the queries to the points where the maps are evaluated.
#[derive(Debug)]
pub(crate) struct CpuGather {
    pub(crate) max_bounces: u32,
    /// Whether estimates where rays land are divided by the area on the surface.
    pub(crate) on_surface: bool,
    /// [`FinalGather::truncated`].
    pub(crate) truncated: u64,
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
        let Self { max_bounces, on_surface, .. } = *self;
        let truncated = AtomicU64::new(0);
        let follow = match (
            scene.present.intersects(Features::SHADED) || scene.disperses,
            scene.present.intersects(Features::RANDOM_SURFACES),
        ) {
            (_, true) => follow::<true, true>,
            (true, false) => follow::<true, false>,
            (false, false) => follow::<false, false>,
        };
        film.for_queries(
            on,
            queries.as_slice(),
            || scratch(maps),
            |scratch, _, query, pixel, errors| {
                let key = query.path;
                let sampler = Sampler::new(RandomKind::Counter, pass.seed, pass.index, Domain::Gather, key);
                let (mut sum, mut cut) = (Found::default(), 0);
                for ray in 0..rays {
                    let ray = (ray, rays, errors.is_some());
                    let found = follow(scene, maps, query, sampler, ray, (max_bounces, pass, on_surface), scratch);
                    sum.add(&found, 1.0 / f64::from(rays));
                    cut += u64::from(found.is_truncated);
                }
                if cut > 0 {
                    truncated.fetch_add(cut, Ordering::Relaxed);
                }
                deposit(pixel, Layer::Indirect, query.throughput, sum.irradiance);
                if let Some(errors) = errors {
                    errors.deposit_gathered(query, sum.bias, sum.narrow, sum.powers);
                }
            },
        )?;
        self.truncated = truncated.into_inner();
        scene.check_caster()
    }

    fn truncated(&mut self, _on: &mut Cpu) -> Result<u64> {
        Ok(self.truncated)
    }

    fn required_format(&self) -> PhotonFormat {
        PhotonFormat::Mono
    }
}

/// Scratch memory for the searches in each map.
fn scratch(maps: &Maps<'_, Cpu>) -> Result<PerMap<Neighbours>, OutOfMemory> {
    let mut all = PerMap::<Neighbours>::default();
    // The nearest point of irradiance needs none of its own.
    for (kind, map) in maps.photons.iter() {
        if let Some((map, gather)) = map {
            all[kind] = scratch_for(map, gather)?;
        }
    }
    Ok(all)
}

/// What gather rays find.
#[derive(Default)]
struct Found {
    irradiance: [f64; 3],
    /// The same from estimates over twice the area, minus `irradiance`.
    bias: [f64; 3],
    /// `irradiance` minus the same from estimates over half the area.
    narrow: [f64; 3],
    /// Sum of the photons' power, and sum of its square.
    powers: [f64; 2],
    /// Whether the ray met as many surfaces as it may, and found nothing.
    is_truncated: bool,
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

    /// Adds the error terms of one estimate.
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

/// The contribution of one ray to the irradiance: π times the incoming radiance, since directions are sampled with
/// density cos θ/π. Light that arrives straight from a light source, or from one through mirrors and glass only, is
/// not counted here. `SHADED`: surfaces have textures or shading normals; `ALPHA`: alpha.
fn follow<const SHADED: bool, const ALPHA: bool>(
    scene: &CpuScene,
    maps: &Maps<'_, Cpu>,
    query: &Query,
    mut sampler: Sampler,
    (index, rays, with_errors): (u32, u32, bool),
    (max_bounces, pass, on_surface): (u32, Pass, bool),
    scratch: &mut PerMap<Neighbours>,
) -> Found {
    let block = index * max_bounces.saturating_add(1);
    let [[u, ..], [_, v, ..]] = [block, 0].map(|block| sampler.words(block));
    let normal = Vec3::from(query.normal);
    // Each ray samples its own stratum in height, and turns by a golden angle from the ray before.
    let u = ((index as f32 + unit_f32(u)) / rays as f32).min(1.0 - f32::EPSILON);
    let v = v.wrapping_add(index.wrapping_mul(GOLDEN_STEP));
    let shades = SHADED && scene.present.contains(Features::SHADING_NORMALS);
    let axis = if shades { octahedral::unpack(query.shading_normal) } else { normal };
    let mut ray = photon_core::Ray {
        origin: offset::off_surface(query.position.into(), normal),
        direction: sampling::cosine_hemisphere(axis, u, unit_f32(v)),
        t_max: f32::INFINITY,
    };
    // Throughput of radiance over n², which refraction leaves unchanged.
    let mut throughput = Vec3::ONE;
    if shades {
        // Directions are sampled about the shading normal; the cosine may be smaller than that to it.
        let ratio =
            shading_normal::cosine(ray.direction, normal, axis) / ray.direction.dot(axis).max(f32::MIN_POSITIVE);
        if !(ratio > 0.0) {
            return Found::default();
        }
        throughput *= ratio.min(1.0);
    }
    if SHADED && query.coat != 0 {
        throughput *= Coat::from_bits(query.coat).entering(ray.direction.dot(axis));
    }
    let start = MediumStack::from_bits(query.media);
    let mut media = start;
    let mut wavelength = Wavelength::NONE;
    let mut total = 0;
    for bounce in 1..=max_bounces {
        let (mut surface, hit) = match scene.hit_with::<ALPHA>(&ray, || sampler.words(block + bounce)[3]) {
            Ok(Some(found)) => found,
            Ok(None) => return Found::default(),
            Err(SkipLimit) => break,
        };
        let mut material = &scene.materials[surface.material as usize];
        let evaluated = if SHADED { Some(scene.shade(&surface, &hit)) } else { None };
        let (mut normal, mut layers) = (surface.normal, Layers::NONE);
        if let Some(evaluated) = &evaluated {
            (material, normal, layers) = (&evaluated.material, evaluated.normal, evaluated.layers);
            if material.is_specular() {
                normal = shading_normal::bend(normal, -ray.direction);
                surface = surface.with_cosine_to(normal, ray.direction);
            }
        }
        let mut interface = scene.interface(&surface, media);
        throughput *= scene.attenuation(&ray, surface.t, interface.before);
        if SHADED && scene.disperses {
            scene.disperse(&mut interface, &mut wavelength, &mut throughput, || sampler.wavelength(index));
        }
        let wo = -ray.direction;
        let vertex = Vertex {
            material,
            layers: &layers,
            wo,
            cosine: surface.cosine,
            interface: &interface,
            carries_light: false,
        };
        let rules = if SHADED { scene.features } else { scene.features.difference(Features::FOLLOWED) };
        // The bounce's random numbers, if they are needed.
        let mut words = || sampler.words(block + bounce).map(unit_f32);
        let albedo = match Scattering::at(rules, &scene.rough_glass, &vertex) {
            Scattering::Glossy(glossy) => {
                let [choice, u, v, _] = words();
                let first = glossy.specular_probability();
                if choice < first {
                    let (direction, reflected) = glossy.sample(wo, normal, u, v);
                    throughput *= reflected.weight(glossy::limited(direction, surface.normal, normal) / first);
                    if throughput == Vec3::ZERO {
                        return Found::default();
                    }
                    ray = surface.spawn(Lobe::SpecularReflection, direction);
                    continue;
                }
                let second = glossy.transmission_probability();
                if second > 0.0 && glossy::rest_of(choice, first) < second {
                    // The light of the other side.
                    (surface.normal, normal) = (-surface.normal, -normal);
                    glossy.transmitted() / ((1.0 - first) * second)
                } else {
                    let albedo = glossy.diffuse() / (1.0 - first);
                    if second > 0.0 { albedo / (1.0 - second) } else { albedo }
                }
            }
            Scattering::RoughGlass(glass) => {
                let [choice, u, v, _] = words();
                let sampled = glass.sample(&scene.rough_glass, wo, normal, [choice, u, v]);
                let stays = sampled.lobe == Lobe::SpecularReflection;
                let towards = |normal: Vec3| if stays { normal } else { -normal };
                let (geometric, shading) = (towards(surface.normal), towards(normal));
                throughput *= sampled.found.weight(glossy::limited(sampled.direction, geometric, shading));
                if throughput == Vec3::ZERO {
                    return Found::default();
                }
                media = if stays { interface.before } else { interface.transmitted };
                ray = surface.spawn(sampled.lobe, sampled.direction);
                continue;
            }
            Scattering::Simple(bsdf) => {
                let lobe = bsdf.choose(if bsdf.split().is_some() { words()[0] } else { 0.0 });
                if lobe != Lobe::Diffuse {
                    total += u32::from(bsdf.is_total());
                    if total > most_total_reflections(max_bounces) {
                        break;
                    }
                    throughput *= bsdf.weight(lobe);
                    let mut direction = bsdf.direction(lobe, ray.direction, normal, 0.0, 0.0);
                    if SHADED {
                        direction = shading_normal::on_side_of(lobe, direction, surface.normal);
                    }
                    ray = surface.spawn(lobe, direction);
                    if lobe == Lobe::SpecularTransmission {
                        media = interface.transmitted;
                    }
                    continue;
                }
                bsdf.weight(lobe)
            }
        };
        let throughput = throughput * scene.radiance_scale(start, interface.before, wavelength) * albedo;
        let mut found = Found::default();
        let at = |gather: &EstimateParams| VisiblePoint {
            position: surface.point.into(),
            normal: surface.normal,
            radius: gather.radius_scale,
            factor: PowerFactor::diffuse(normal, gather),
        };
        if let Some((map, gather)) = &maps.irradiance {
            let estimate = estimate_at(map, at(gather), gather, &mut scratch[MapKind::Global]);
            if estimate.photons > 0 {
                found.irradiance = estimate.flux.map(f64::from);
                return found.times(throughput.to_array());
            }
        }
        let landing = Query {
            position: surface.point.into(),
            normal: surface.normal.into(),
            path: query.path,
            ..Query::default()
        };
        for (kind, map) in maps.photons.iter() {
            let Some((map, gather)) = map else { continue };
            let paths = maps.paths[kind];
            let around = Around { scene, pass, query: &landing, gather, has_alpha: ALPHA };
            let estimate = if with_errors {
                let (mut estimate, mut moments) = estimate_with_moments_at(map, at(gather), gather);
                if on_surface {
                    around.correct_with_moments(&mut estimate, &mut moments);
                }
                found.add_moments(&estimate, &moments, paths);
                estimate
            } else {
                let mut estimate = estimate_at(map, at(gather), gather, &mut scratch[kind]);
                if on_surface {
                    around.correct(&mut estimate);
                }
                estimate
            };
            for (sum, e) in found.irradiance.iter_mut().zip(estimate.irradiance(paths)) {
                *sum += e;
            }
        }
        // Outgoing radiance is irradiance × albedo / π; the π cancels.
        return found.times(throughput.to_array());
    }
    Found { is_truncated: true, ..Found::default() }
}
