//! Media along rays: all that attenuates light is found here.

use photon_core::glam::Vec3;
use photon_core::{Columns, Features, MediumStack, Ray, Segment, flight};

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

    /// Integral of the density along a part of a ray: its length, where the medium is homogeneous.
    #[inline]
    pub(crate) fn column(&self, ray: &Ray, stretch: &Stretch) -> f32 {
        match self.grids.view().of(stretch.medium) {
            None => stretch.to - stretch.from,
            Some(density) => density.column(ray.origin, ray.direction, [stretch.from, stretch.to]),
        }
    }

    /// Distance from the origin of a ray within which a part of it has a column.
    #[inline]
    pub(crate) fn place(&self, ray: &Ray, stretch: &Stretch, column: f32) -> f32 {
        match self.grids.view().of(stretch.medium) {
            None => stretch.from + column,
            Some(density) => density.place(ray.origin, ray.direction, [stretch.from, stretch.to], column),
        }
    }

    /// The columns along a segment in the medium with this index; `None` if it is homogeneous.
    #[inline]
    pub(crate) fn columns(&self, segment: &Segment, medium: u32) -> Option<Columns<'_>> {
        let density = self.grids.view().of(medium)?;
        Some(Columns::new(density, segment.origin, segment.direction, segment.length))
    }

    /// Transmittance per channel of a part of a ray.
    #[inline]
    pub(crate) fn stretch_transmittance(&self, ray: &Ray, stretch: &Stretch) -> Vec3 {
        flight::transmittance(self.medium_at(stretch.medium), self.column(ray, stretch))
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
