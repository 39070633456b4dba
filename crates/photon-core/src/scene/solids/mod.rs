//! The solids of a scene: whether their bounding boxes overlap, and which of them contain a point.

mod components;
mod locator;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};

use crate::scene::SceneView;
use crate::scene::material::MaterialKind;
use crate::scene::media::{MediaFeatures, MediumStack};
use crate::scene::medium::Medium;

pub use locator::{Locator, crossing};

/// A connected set of boundary triangles of one medium.
#[derive(Debug)]
struct Solid {
    medium: u32,
    triangles: Vec<u32>,
    low: Vec3,
    high: Vec3,
}

/// All solids of a scene.
#[derive(Debug)]
pub struct Solids<'a> {
    scene: SceneView<'a>,
    solids: Vec<Solid>,
}

impl<'a> Solids<'a> {
    /// Groups the dielectric triangles of a scene into connected boundaries, in one pass over all triangles if there
    /// are none. Triangles are connected if they share a vertex and a medium. In a scene that
    /// [`SceneView::validate`] refuses, triangles with indices out of range are skipped.
    #[must_use]
    pub fn of(scene: &SceneView<'a>) -> Self {
        let boundary: Vec<(u32, u32)> = (0..)
            .zip(scene.primitives)
            .filter_map(|(triangle, primitive)| {
                let material = scene.materials_of(primitive).find(|of| of.kind() == MaterialKind::Dielectric)?;
                let corners = scene.triangles.get(triangle as usize)?;
                let fits = corners.iter().all(|&vertex| (vertex as usize) < scene.positions.len());
                fits.then_some((triangle, material.medium))
            })
            .collect();
        if boundary.is_empty() {
            return Self { scene: *scene, solids: Vec::new() };
        }
        Self { scene: *scene, solids: components::group(scene, &boundary) }
    }

    /// What kernels have to support for these solids: [`MediaFeatures::NESTED`] if the bounding boxes of
    /// two of them overlap; [`MediaFeatures::DISPERSION`], with which it comes, if the refractive index of one depends on the
    /// wavelength; [`MediaFeatures::SCATTERING`], [`MediaFeatures::AMBIENT`], [`MediaFeatures::PHASES`] and
    /// [`MediaFeatures::GRIDS`] for the media inside and around them, and [`MediaFeatures::BOUNDARIES`].
    #[must_use]
    pub fn features(&self) -> MediaFeatures {
        let around = self.scene.media.first();
        let inside = || self.solids.iter().filter_map(|solid| self.scene.media.get(solid.medium as usize));
        let is_dispersive = inside().any(Medium::is_dispersive);
        let matched = boundary_media(&self.scene);
        let scattering: Vec<&Medium> =
            around.into_iter().chain(inside()).chain(matched).filter(|medium| medium.scatters()).collect();
        let scatters = !scattering.is_empty();
        let has_phases = scattering.iter().any(|medium| medium.phase != 0);
        let is_ambient = around.is_some_and(Medium::attenuates);
        let mut filled =
            self.solids.iter().map(|solid| solid.medium).chain(self.scene.boundaries.media.iter().copied());
        let has_grids = filled.any(|medium| self.scene.grids.of(medium).is_some());
        let mut features = MediaFeatures::NONE;
        features.set(MediaFeatures::GRIDS, has_grids);
        features.set(MediaFeatures::DISPERSION, is_dispersive);
        features.set(MediaFeatures::SCATTERING, scatters);
        features.set(MediaFeatures::AMBIENT, is_ambient);
        features.set(MediaFeatures::PHASES, has_phases);
        features.set(MediaFeatures::BOUNDARIES, !self.scene.boundaries.is_empty());
        features.set(MediaFeatures::NESTED, is_dispersive || self.overlap());
        features
    }

    /// Whether the bounding boxes of two of them overlap.
    pub(crate) fn overlap(&self) -> bool {
        boxes_meet(&self.solids)
    }

    /// Builds the structure that finds the solids around a point.
    #[must_use]
    pub fn locate(&self) -> Locator<'_> {
        Locator::new(self)
    }

    /// The same as `locate().at(point)`, without building the locator if the point is outside of all bounding boxes.
    #[must_use]
    pub fn at(&self, point: [f32; 3]) -> MediumStack {
        let at = Vec3::from(point);
        let near = |solid: &Solid| at.cmpge(solid.low).all() && at.cmple(solid.high).all();
        if self.solids.iter().any(near) { self.locate().at(point) } else { MediumStack::VACUUM }
    }
}

impl Solids<'_> {
    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.scene.triangles[triangle as usize]
            .map(|vertex| Vec3::from(self.scene.positions[vertex as usize]).as_dvec3())
    }
}

/// The media behind boundaries, each once. Indices out of range are skipped.
pub(crate) fn boundary_media<'a>(scene: &SceneView<'a>) -> impl Iterator<Item = &'a Medium> + use<'a> {
    let mut used = vec![false; scene.media.len()];
    for &medium in scene.boundaries.media {
        if let Some(used) = used.get_mut(medium as usize) {
            *used = true;
        }
    }
    scene.media.iter().zip(used).filter_map(|(medium, used)| used.then_some(medium))
}

/// Whether the bounding boxes of two of them overlap.
fn boxes_meet(solids: &[Solid]) -> bool {
    let mut by_place: Vec<&Solid> = solids.iter().collect();
    by_place.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    by_place.iter().enumerate().any(|(index, solid)| {
        let mut beside = by_place[index + 1..].iter().take_while(|other| other.low.x <= solid.high.x);
        beside.any(|other| solid.low.cmple(other.high).all() && other.low.cmple(solid.high).all())
    })
}
