//! The radius within which each map is searched.

use crate::backend::stages::{EstimateParams, Search};
use crate::neighbour_radius;
use crate::radius::progressive::radius_squared_factor;
use crate::requirements::map_kind::MapKind;
use crate::scene::units::Units;
use crate::settings::{Estimator, Settings};

/// Photons of a map that the first pass is to find within the derived radius, where a typical photon lies.
/// Caustics are sharp, so that they are worth more noise per pass; light that has been scattered is smooth.
pub(crate) const fn neighbours(kind: MapKind) -> u32 {
    match kind {
        MapKind::Direct => 24,
        MapKind::Caustic => 12,
        MapKind::Global => 64,
    }
}

/// Where no map can tell: a fiftieth of the scene.
const FALLBACK: f32 = 0.02;

/// How far a nearest-photon search goes where nobody said: a tenth of the scene. Without a limit,
/// a query that few photons can serve would look through the whole map.
const NEAREST_LIMIT: f32 = 0.1;

/// A radius times a factor, within the bounds of those that are derived. Normalised space.
pub(crate) fn scaled(radius: f32, factor: f32) -> f32 {
    (radius * factor).clamp(1e-6, neighbour_radius::MAX_RADIUS)
}

/// Whether radii must be derived from photons.
pub(crate) fn need_pilot(settings: &Settings) -> bool {
    match settings.estimator {
        Estimator::Radius { radius } => radius.is_none(),
        Estimator::Knn { .. } => false,
        Estimator::Paper(paper) => paper.radius.is_none(),
    }
}

/// The radius of all maps where it is given, normalised space.
pub(crate) fn given(settings: &Settings, units: &Units) -> f32 {
    let radius = match settings.estimator {
        Estimator::Radius { radius } => radius.map_or(FALLBACK, |r| units.length(r)),
        Estimator::Knn { max_radius, .. } => max_radius.map_or(NEAREST_LIMIT, |r| units.length(r)),
        Estimator::Paper(paper) => paper.radius.map_or(FALLBACK, |r| units.length(r)),
    };
    // A normalised radius beyond the scene is as good as any other there; below it, as small as
    // the rounding of positions, nothing is found anyway but a square of it must not vanish.
    radius.clamp(1e-12, 4.0)
}

/// From a pilot's radius around `asked` photons of `pilot` paths to that around `wanted` of `photons`.
pub(crate) fn from_pilot(radius: Option<f32>, asked: u32, pilot: u32, wanted: u32, photons: u32) -> f32 {
    let Some(radius) = radius else { return FALLBACK };
    let factor = f64::from(wanted) * f64::from(pilot) / (f64::from(asked) * f64::from(photons));
    ((f64::from(radius) * factor.sqrt()) as f32).clamp(1e-6, neighbour_radius::MAX_RADIUS)
}

/// How pass `index` reads a map whose first radius is `radius`.
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
        max_plane_distance: settings.max_plane_distance,
    }
}
