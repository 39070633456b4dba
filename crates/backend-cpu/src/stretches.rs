//! Media along rays: all that attenuates light is found here.

use photon_core::glam::Vec3;
use photon_core::{Features, MediumStack, Ray, flight};

use crate::scene::CpuScene;

/// Part of a ray in one medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// Distance of its start from the origin of the ray.
    pub(crate) from: f32,
    /// Distance of its end.
    pub(crate) to: f32,
    /// Index of the medium.
    pub(crate) medium: u32,
}

impl CpuScene {
    /// The parts of a ray that starts in `media`, in order; `end` is the distance of its first surface, infinite without one.
    #[inline]
    pub(crate) fn stretches(&self, _ray: &Ray, end: f32, media: MediumStack) -> impl Iterator<Item = Stretch> {
        let (medium, _) = self.medium(media);
        std::iter::once(Stretch { from: 0.0, to: if end == f32::INFINITY { flight::FAR } else { end }, medium })
    }

    /// Transmittance per channel of a part of a ray.
    #[inline]
    pub(crate) fn stretch_transmittance(&self, _ray: &Ray, stretch: &Stretch) -> Vec3 {
        flight::transmittance(self.medium_at(stretch.medium), stretch.to - stretch.from)
    }

    /// Transmittance per channel of a ray that starts in `media` and meets no surface before the distance `end`.
    #[inline]
    pub(crate) fn transmittance(&self, ray: &Ray, end: f32, media: MediumStack) -> Vec3 {
        self.stretches(ray, end, media).map(|stretch| self.stretch_transmittance(ray, &stretch)).product()
    }

    /// As [`Self::transmittance`], but returns 1 immediately if nothing in the scene attenuates light.
    #[inline]
    pub(crate) fn attenuation(&self, ray: &Ray, end: f32, media: MediumStack) -> Vec3 {
        if !self.features.contains(Features::ABSORPTION) || !self.may_attenuate(media) {
            return Vec3::ONE;
        }
        self.transmittance(ray, end, media)
    }
}
