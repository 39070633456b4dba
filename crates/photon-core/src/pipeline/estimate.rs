//! Estimates from the maps of a pass.

use super::Pipeline;
use super::photons::Sent;
use super::slot::BuiltMap;
use crate::backend::stages::{EstimateBuffers, EstimateParams, Maps, Pass};
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::radius::radii;
use crate::requirements::map_kind::{MapKind, PerMap};
use crate::settings::{Direct, Indirect, Settings};

/// Whether visible points are estimated from a map directly, and not only at the hits of final-gather rays.
fn is_shown(settings: &Settings, kind: MapKind) -> bool {
    match kind {
        MapKind::Direct => settings.direct == Direct::Photons,
        MapKind::Caustic => settings.caustics,
        MapKind::Global => settings.indirect == Indirect::Map,
    }
}

impl<B: TransportBackend> Pipeline<B> {
    /// Builds the maps, estimates from them at the queries, and adds the results to the film.
    pub(super) fn estimate(&mut self, index: u32, sent: &Sent, queries: u64) -> Result<()> {
        self.on.mark(Some(Stage::Build));
        let paths = sent.per_map();
        let maps = self.build_maps(index, &paths)?;
        let pass = Pass { seed: self.settings.seed, index, random: self.settings.random };
        if queries > 0 {
            for built in &maps {
                if is_shown(&self.settings, built.kind) {
                    self.show(built, pass)?;
                }
            }
        }
        let gathers_rays = self.stages.gather.is_some() && queries > 0;
        self.on.mark(gathers_rays.then_some(Stage::Gather));
        let irradiance = if gathers_rays { self.irradiance(&maps, pass)? } else { None };
        if let (Some(stage), true) = (&mut self.stages.gather, gathers_rays) {
            let mut photons = PerMap::default();
            for built in &maps {
                photons[built.kind] = Some((&built.map, built.gather));
            }
            let lent = Maps { photons, irradiance: irradiance.as_ref().map(|(map, gather)| (map, *gather)), paths };
            let rays = self.settings.gather_rays;
            stage.gather(&mut self.on, &self.scene, &lent, pass, &self.queries, rays, &mut self.film)?;
        }
        self.on.mark(None);
        self.reclaim_irradiance(irradiance);
        for built in maps {
            if let Some(slot) = self.maps.iter_mut().find(|slot| slot.kind == built.kind) {
                slot.photons = Some(self.stages.map.builder.reclaim(built.map));
            }
        }
        Ok(())
    }

    /// Builds a map for each kind that has photons; empty ones are left out.
    fn build_maps(&mut self, index: u32, paths: &PerMap<u64>) -> Result<Vec<BuiltMap<B>>> {
        let mut maps = Vec::with_capacity(self.maps.len());
        for slot in &mut self.maps {
            let Some(filled) = slot.photons.take() else { continue };
            let length = self.on.fill(&filled)?.length;
            if length == 0 {
                slot.photons = Some(filled);
                continue;
            }
            let map = self.stages.map.builder.build(&mut self.on, filled)?;
            let gather = EstimateParams {
                shading_normals: self.shading_normals,
                ..radii::gather(&self.settings, slot.radius, index)
            };
            maps.push(BuiltMap { kind: slot.kind, map, length, gather, paths: paths[slot.kind] });
        }
        Ok(maps)
    }

    /// Adds the estimates from one map at the queries to the film.
    fn show(&mut self, built: &BuiltMap<B>, pass: Pass) -> Result<()> {
        let BuiltMap { kind, map, gather, paths, .. } = built;
        let Some(estimates) = &mut self.estimates else { return Ok(()) };
        self.on.mark(Some(Stage::Estimate));
        let (on, estimator) = (&mut self.on, &mut self.stages.map.estimator);
        match &mut self.error_moments {
            None => estimator.estimate(on, map, &self.queries, gather, estimates)?,
            Some(error_moments) => {
                estimator.estimate_with_moments(on, map, &self.queries, gather, estimates, error_moments)?
            }
        }
        if let Some(area) = &mut self.stages.area {
            let buffers = EstimateBuffers { estimates, error_moments: self.error_moments.as_mut() };
            area.correct(on, &self.scene, pass, &self.queries, gather, buffers)?;
        }
        on.mark(Some(Stage::Film));
        if let Some(error_moments) = &self.error_moments {
            on.accumulate_errors(&mut self.film, *kind, &self.queries, estimates, error_moments, *paths)?;
        }
        on.accumulate(&mut self.film, kind.layer(), &self.queries, estimates, *paths)
    }
}
