//! The search radius of each map.

use crate::backend::stages::{EstimateParams, Search};
use crate::neighbour_radius;
use crate::radius::progressive::radius_squared_factor;
use crate::requirements::map_kind::MapKind;
use crate::scene::units::Units;
use crate::settings::{Estimator, Settings};

/// Number of photons of a map within the derived radius around a typical photon in the first pass. Caustics
/// are sharp, so that more noise per pass is accepted; scattered light is smooth.
pub(crate) const fn neighbours(kind: MapKind) -> u32 {
    match kind {
        MapKind::Direct => 24,
        MapKind::Caustic => 12,
        MapKind::Global => 64,
    }
}

/// Lower bound of derived radii, normalised: about 16 steps of [`crate::offset::STEP`]. Offsets and rounding of positions make
/// densities within radii of 5·10⁻⁶ 0.6 % too large, and within 2.5·10⁻⁶ 5 %.
const LEAST: f32 = 1.6e-5;

/// If no map has enough photons: a fiftieth of the scene.
const FALLBACK: f32 = 0.02;

/// Radius of a nearest-photon search without a given limit: a tenth of the scene. Without one, a query with
/// few photons nearby would search the whole map.
const NEAREST_LIMIT: f32 = 0.1;

/// A radius times a factor, within the bounds of derived radii. Normalised space.
pub(crate) fn scaled(radius: f32, factor: f32) -> f32 {
    (radius * factor).clamp(LEAST, neighbour_radius::MAX_RADIUS)
}

/// Whether radii are derived from the photons of a pilot pass.
pub(crate) fn need_pilot(settings: &Settings) -> bool {
    match settings.estimator {
        Estimator::Radius { radius } => radius.is_none(),
        Estimator::Knn { .. } => false,
        Estimator::Paper(paper) => paper.radius.is_none(),
    }
}

/// The radius for all maps if it is given, normalised space.
pub(crate) fn given(settings: &Settings, units: &Units) -> f32 {
    let radius = match settings.estimator {
        Estimator::Radius { radius } => radius.map_or(FALLBACK, |r| units.length(r)),
        Estimator::Knn { max_radius, .. } => max_radius.map_or(NEAREST_LIMIT, |r| units.length(r)),
        Estimator::Paper(paper) => paper.radius.map_or(FALLBACK, |r| units.length(r)),
    };
    // Radii larger than the scene all have the same effect there; those smaller than the rounding of
    // positions find nothing, but their squares must not become zero.
    radius.clamp(1e-12, 4.0)
}

/// Scales a pilot's radius around `asked` photons of `pilot` paths to that around `wanted` photons of
/// `photons` paths.
pub(crate) fn from_pilot(radius: Option<f32>, asked: u32, pilot: u32, wanted: u32, photons: u32) -> f32 {
    let Some(radius) = radius else { return FALLBACK };
    let factor = f64::from(wanted) * f64::from(pilot) / (f64::from(asked) * f64::from(photons));
    ((f64::from(radius) * factor.sqrt()) as f32).clamp(LEAST, neighbour_radius::MAX_RADIUS)
}

/// Estimate parameters of pass `index` for a map whose first radius is `radius`.
pub(crate) fn gather(settings: &Settings, radius: f32, index: u32) -> EstimateParams {
    let (search, shrink) = match settings.estimator {
        Estimator::Radius { .. } => (Search::Radius, radius_squared_factor(index, settings.alpha).sqrt()),
        Estimator::Knn { k, .. } => (Search::KNearest { k }, 1.0),
        Estimator::Paper(p) => (Search::Paper { max: p.max, threshold: p.threshold, factor: p.factor }, 1.0),
    };
    EstimateParams {
        search,
        kernel: settings.kernel,
        radius_scale: radius * shrink as f32,
        min_normal_cosine: settings.min_normal_cosine,
        max_plane_distance: settings.plane_distance(),
        shading_normals: false,
        reflection: false,
        anisotropy: false,
        sheen: false,
        marked: false,
    }
}
