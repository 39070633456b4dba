//! Irradiance precomputed at the positions of photons, for final-gather rays (Christensen 1999).

use super::Pipeline;
use super::slot::BuiltMap;
use crate::backend::memory::Costs;
use crate::backend::stages::{EstimateBuffers, EstimateParams, Pass, Search};
use crate::backend::{Backend, Stage, TransportBackend};
use crate::error::Result;
use crate::requirements::features::Features;
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::SceneView;
use crate::scene::layout::{Estimate, Photon, Query};
use crate::settings::kernel::Kernel;
use crate::settings::{Area, Indirect, Settings};

/// Points of precomputed irradiance; the buffers are reused from pass to pass.
pub(super) struct Points<B: Backend> {
    queries: B::Buffer<Query>,
    estimates: B::Buffer<Estimate>,
    /// The points, while they are not in a map.
    found: Option<B::Buffer<Photon>>,
    capacity: u64,
}

/// Kernel for estimates at a photon's position, and where rays land far from any. Such an estimate includes that photon, which is
/// one too many; but a ray that takes this point as the nearest one has no nearer point around its hit, which is one too few.
///
/// With the constant kernel both effects cancel for any number n of photons in a disc, if points count up to [`REACH`] and the
/// maps are searched beyond. Let T be the number of points expected within that reach of a hit. Where the nearest is within it,
/// the empty disc around the hit lies in the disc of the estimate, and the mean is n (1 − e^−T) + T e^−T; else the map has T
/// photons too few there: (n − T) e^−T. The sum is n. With longer reach, single photons of a sparse map would light all that is
/// nearer to them than to others, and energy would be gained without bounds as radii shrink.
pub(super) const POINT_KERNEL: Kernel = Kernel::Constant;

/// Distance up to which a point counts, in radii of the map with the least.
const REACH: f32 = 0.5;

/// Every so many photons have a point where areas are those on the surface, if nothing else is asked for: the probes of all
/// rays would take several times as long as the rays.
const EVERY: u32 = 4;

/// The settings with points of irradiance for final gathering that divides by areas on the surface. Where points are not possible,
/// since there are vertex normals or error estimates, each ray probes.
pub(crate) fn with_points(scene: &SceneView<'_>, settings: Settings) -> Settings {
    let gathers = settings.indirect == Indirect::Gather && settings.area == Area::Surface && !settings.errors;
    if !gathers || Features::of(scene).contains(Features::SHADING_NORMALS) {
        return settings;
    }
    Settings { irradiance_every: settings.irradiance_every.or(Some(EVERY)), ..settings }
}

/// Memory of the backend, including the points.
pub(super) fn costs<B: TransportBackend>(on: &B, costs: Costs, settings: &Settings) -> Costs {
    // Points are full photons.
    let point = size_of::<Query>() as u64 + size_of::<Estimate>() as u64 + on.costs(PhotonFormat::Full).photon;
    let points = settings.irradiance_every.map_or(0, |every| (point + point / 8).div_ceil(u64::from(every.max(1))));
    Costs { photon: costs.photon + points, ..costs }
}

impl<B: TransportBackend> Pipeline<B> {
    /// A map of irradiance at every n-th photon of `maps`, and its estimate parameters; `None` if it is not
    /// required.
    pub(super) fn irradiance<'a, I: Iterator<Item = &'a BuiltMap<B>>>(
        &mut self,
        maps: impl Fn() -> I,
        pass: Pass,
    ) -> Result<Option<(B::PhotonMap, EstimateParams)>> {
        let (Some(every), Some(stage)) = (self.settings.irradiance_every, &mut self.stages.irradiance) else {
            return Ok(None);
        };
        let count: u64 = maps().map(|built| built.length.div_ceil(u64::from(every))).sum();
        if count == 0 {
            return Ok(None);
        }
        let on = &mut self.on;
        let points = match self.points.take().filter(|points| points.capacity >= count) {
            Some(points) => points,
            None => {
                let capacity = count + count / 8;
                Points {
                    queries: on.alloc("irradiance places", capacity)?,
                    estimates: on.alloc("irradiance estimates", capacity)?,
                    found: None,
                    capacity,
                }
            }
        };
        let points = self.points.insert(points);
        let mut found = match points.found.take() {
            Some(found) => found,
            None => on.alloc("irradiance", points.capacity)?,
        };
        on.clear(&mut points.queries)?;
        for BuiltMap { map, .. } in maps() {
            stage.places(on, map, every, &mut points.queries)?;
        }
        let mut least = f32::INFINITY;
        let mut first = true;
        for BuiltMap { map, gather, paths, .. } in maps() {
            let gather = &EstimateParams { kernel: POINT_KERNEL, ..*gather };
            self.stages.map.estimator.estimate(on, map, &points.queries, gather, &mut points.estimates)?;
            if let Some(area) = &mut self.stages.area {
                let buffers = EstimateBuffers { estimates: &mut points.estimates, error_moments: None };
                area.correct(on, &self.scene, pass, &points.queries, gather, buffers)?;
            }
            stage.add(on, &points.queries, &points.estimates, *paths, first, &mut found)?;
            first = false;
            least = least.min(gather.radius_scale);
        }
        on.mark(Some(Stage::Build));
        let built = self.stages.map.builder.build(on, found)?;
        on.mark(Some(Stage::Gather));
        // The nearest point that faces the same way.
        let gather = EstimateParams {
            radius_scale: REACH * least,
            min_normal_cosine: self.settings.min_normal_cosine,
            ..EstimateParams::new(Search::NearestPhoton)
        };
        Ok(Some((built, gather)))
    }

    /// Returns the storage of the points for reuse.
    pub(super) fn reclaim_irradiance(&mut self, map: Option<(B::PhotonMap, EstimateParams)>) {
        if let (Some((map, _)), Some(points)) = (map, &mut self.points) {
            points.found = Some(self.stages.map.builder.reclaim(map));
        }
    }
}
