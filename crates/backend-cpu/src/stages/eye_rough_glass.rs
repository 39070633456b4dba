//! Rough glass on camera paths.
//!
//! A path samples a light there, on either side, and continues by a sampled direction. The light that each of them finds is
//! weighted by the balance heuristic, as at glossy surfaces.

use photon_core::glam::Vec3;
use photon_core::random::{BLOCK_LIGHT_SIDES, BLOCK_LIGHTS, BLOCK_SURFACES, Sampler, unit_f32};
use photon_core::{FilmPixel, Interface, Layer, Lobe, MediumStack, RoughGlass, SurfaceInteraction, glossy};

use super::eye::{Eye, Path};
use super::eye_glossy::{Reflection, Side};
use crate::film::deposit;

/// Rough glass where a camera path arrives.
pub(crate) struct RoughPoint<'a> {
    pub(crate) surface: &'a SurfaceInteraction,
    /// As [`super::eye_glossy::GlossyPoint::surface`]. Only for the side of the path: light that is transmitted has no
    /// offset.
    pub(crate) lit: &'a SurfaceInteraction,
    /// Shading normal.
    pub(crate) normal: Vec3,
    pub(crate) interface: &'a Interface,
    pub(crate) glass: &'a RoughGlass,
}

impl RoughPoint<'_> {
    /// The side of the path, or the one beyond.
    fn side(&self, stays: bool) -> Side {
        let (start, normals) = if stays {
            (self.lit.start, [self.lit.normal, self.normal])
        } else {
            (self.surface.start, [-self.surface.normal, -self.normal])
        };
        Side {
            start,
            normals,
            media: if stays { self.interface.before } else { self.interface.transmitted },
            probability: if stays { self.glass.light_side() } else { 1.0 - self.glass.light_side() },
        }
    }
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
        let words = sampler(path.branch).words(BLOCK_LIGHTS + path.surfaces);
        let [side, ..] = sampler(path.branch).words(BLOCK_LIGHT_SIDES + path.surfaces);
        let stays = unit_f32(side) < at.glass.light_side();
        let side = at.side(stays);
        let evaluate =
            |direction| at.glass.evaluate(&self.scene.rough_glass, -path.ray.direction, direction, at.normal);
        if let Some(value) = self.sampled_light::<ALPHA>(words, &side, evaluate) {
            let camera = MediumStack::from_bits(self.view.camera.media);
            let seen = path.throughput * self.scene.radiance_scale(camera, side.media, path.wavelength);
            deposit(pixel, Layer::Emission, seen.into(), value.to_array().map(f64::from));
        }
    }

    /// Continues the path by reflection or transmission. Returns whether it goes on.
    pub(crate) fn scatter(&self, path: &mut Path, at: &RoughPoint<'_>, sampler: &impl Fn(u32) -> Sampler) -> bool {
        path.surfaces += 1;
        if self.ends(path, sampler) {
            return false;
        }
        let [choice, u, v, _] = sampler(path.branch).words(BLOCK_SURFACES + path.surfaces);
        let sampled =
            at.glass.sample(&self.scene.rough_glass, -path.ray.direction, at.normal, [choice, u, v].map(unit_f32));
        let stays = sampled.lobe == Lobe::SpecularReflection;
        let side = at.side(stays);
        let [geometric, shading] = side.normals;
        path.throughput *= sampled.found.weight(glossy::limited(sampled.direction, geometric, shading));
        if path.throughput == Vec3::ZERO {
            return false;
        }
        // Lights on this side are sampled with that probability: it divides the density, so as not to be a factor
        // elsewhere.
        path.reflected = Reflection::new(sampled.found.pdf / side.probability, side.start, geometric);
        path.media = side.media;
        let from = if stays { at.lit } else { at.surface };
        path.ray = from.spawn(sampled.lobe, sampled.direction);
        true
    }
}
