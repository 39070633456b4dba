//! Rough glass on camera paths.
//!
//! A path samples a light there, on either side, and continues by a sampled direction. The light that each of them finds is
//! weighted by the balance heuristic, as at glossy surfaces.

use photon_core::glam::Vec3;
use photon_core::random::{BLOCK_LIGHT_SIDES, BLOCK_LIGHTS, BLOCK_SURFACES, Sampler, unit_f32};
use photon_core::{FilmPixel, Interface, Layer, Lobe, MediumStack, RoughGlass, SurfaceInteraction, glossy, offset};

use super::eye::{Eye, Path};
use super::eye_glossy::{Reflection, balance};
use crate::film::deposit;
use crate::stages::light_sample;
use crate::stages::light_sampler::LightSampler;

/// Rough glass where a camera path arrives.
pub(crate) struct RoughPoint<'a> {
    pub(crate) surface: &'a SurfaceInteraction,
    /// Shading normal.
    pub(crate) normal: Vec3,
    pub(crate) interface: &'a Interface,
    pub(crate) glass: &'a RoughGlass,
}

impl Eye<'_> {
    /// Adds the light that a shadow ray from rough glass finds, on the side of the path or beyond.
    pub(crate) fn light_through<const ALPHA: bool>(
        &self,
        path: &Path,
        at: &RoughPoint<'_>,
        pixel: &mut FilmPixel,
        sampler: &impl Fn(u32) -> Sampler,
    ) {
        let (scene, surface) = (self.scene, at.surface);
        if scene.lights.is_empty() {
            return;
        }
        let [choice, u, v, low] = sampler(path.branch).words(BLOCK_LIGHTS + path.surfaces);
        let [side, ..] = sampler(path.branch).words(BLOCK_LIGHT_SIDES + path.surfaces);
        let stays = unit_f32(side) < at.glass.light_side();
        let of_side = if stays { at.glass.light_side() } else { 1.0 - at.glass.light_side() };
        let towards = |normal: Vec3| if stays { normal } else { -normal };
        let (geometric, shading) = (towards(surface.normal), towards(at.normal));
        let (index, share) = LightSampler::at(scene, surface.start, geometric).pick([choice, low]);
        let from = offset::off_surface(surface.start, geometric);
        let Some(sampled) = light_sample::sample::<true>(scene, &scene.lights[index], from, u, v) else { return };
        let direction = sampled.ray.direction;
        let found = at.glass.evaluate(&scene.rough_glass, -path.ray.direction, direction, at.normal);
        let value = sampled.times(glossy::limited(direction, geometric, shading)) * found.value;
        // NaN counts as no light.
        if !(value.max_element() > 0.0) || scene.occluded_with::<ALPHA>(&sampled.ray, || low) {
            return;
        }
        let share = share as f32 * of_side;
        let weight = balance(sampled.pdf * share, found.pdf);
        let media = if stays { at.interface.before } else { at.interface.transmitted };
        let value = value * scene.attenuation(media, sampled.ray.t_max) * (weight / share);
        let camera = MediumStack::from_bits(self.view.camera.media);
        let seen = path.throughput * scene.radiance_scale(camera, media);
        deposit(pixel, Layer::Emission, seen.into(), value.to_array().map(f64::from));
    }

    /// Continues the path by reflection or transmission. Returns whether it goes on.
    pub(crate) fn scatter(&self, path: &mut Path, at: &RoughPoint<'_>, sampler: &impl Fn(u32) -> Sampler) -> bool {
        path.surfaces += 1;
        if path.surfaces >= self.max_bounces {
            return false;
        }
        let [choice, u, v, _] = sampler(path.branch).words(BLOCK_SURFACES + path.surfaces);
        let sampled =
            at.glass.sample(&self.scene.rough_glass, -path.ray.direction, at.normal, [choice, u, v].map(unit_f32));
        let stays = sampled.lobe == Lobe::SpecularReflection;
        let towards = |normal: Vec3| if stays { normal } else { -normal };
        let (geometric, shading) = (towards(at.surface.normal), towards(at.normal));
        path.throughput *= sampled.found.weight(glossy::limited(sampled.direction, geometric, shading));
        if path.throughput == Vec3::ZERO {
            return false;
        }
        // Lights on this side are sampled with that probability: it divides the density, so as not to be a factor elsewhere.
        let of_side = if stays { at.glass.light_side() } else { 1.0 - at.glass.light_side() };
        path.reflected = Reflection::new(sampled.found.pdf / of_side, at.surface.start, geometric);
        path.media = if stays { at.interface.before } else { at.interface.transmitted };
        path.ray = at.surface.spawn(sampled.lobe, sampled.direction);
        true
    }
}
