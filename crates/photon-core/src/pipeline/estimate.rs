//! Estimates from the maps of a pass.

use super::Pipeline;
use super::irradiance::POINT_KERNEL;
use super::photons::Sent;
use super::slot::{BuiltMap, MapSlot};
use crate::backend::stages::{EstimateBuffers, EstimateParams, Maps, Pass};
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::requirements::map_kind::{MapKind, PerMap};
use crate::requirements::map_place::MapPlace;
use crate::settings::{Direct, Indirect, Settings};

/// Whether camera paths read a map directly, and not only at the hits of final-gather rays.
pub(super) fn is_shown(settings: &Settings, kind: MapKind, place: MapPlace) -> bool {
    match kind {
        MapKind::Direct => settings.direct == Direct::Photons,
        MapKind::Caustic => settings.caustics,
        MapKind::Global if place == MapPlace::Surface => settings.indirect == Indirect::Map,
        MapKind::Global => settings.indirect != Indirect::None,
    }
}

impl<B: TransportBackend> Pipeline<B> {
    /// Builds the maps, estimates from them at the queries, and adds the results to the film. Returns the number of
    /// final-gather rays that were truncated.
    pub(super) fn estimate(&mut self, index: u32, sent: &Sent, queries: u64) -> Result<u64> {
        self.on.mark(Some(Stage::Build));
        let paths = sent.per_map();
        let maps = self.build_maps(index, &paths)?;
        let pass = Pass::new(&self.settings, index);
        for built in &maps {
            let is_seen = queries > 0 || !built.place.is_on_visible_surfaces();
            if is_seen && is_shown(&self.settings, built.kind, built.place) {
                match built.place {
                    MapPlace::Surface | MapPlace::Reflection | MapPlace::FromMedium => self.show(built, pass)?,
                    MapPlace::Medium => self.show_medium(built)?,
                }
            }
        }
        let mut truncated = 0;
        if queries > 0 {
            self.gather(&maps, pass, paths, self.settings.gather_rays)?;
            if let Some(stage) = &mut self.stages.gather {
                truncated = stage.truncated(&mut self.on)?;
            }
        }
        self.on.mark(None);
        self.reclaim_maps(maps);
        Ok(truncated)
    }

    /// Adds the light that `rays` final-gather rays from each query find in the maps to the film, if there is final gathering.
    pub(super) fn gather(&mut self, maps: &[BuiltMap<B>], pass: Pass, paths: PerMap<u64>, rays: u32) -> Result<()> {
        if self.stages.gather.is_none() {
            return Ok(());
        }
        self.on.mark(Some(Stage::Gather));
        // Light that a glossy surface reflects onto the start of a gather ray is in the caustic map there.
        let gathered = || maps.iter().filter(|built| built.place == MapPlace::Surface);
        let irradiance = self.irradiance(gathered, pass)?;
        if let Some(stage) = &mut self.stages.gather {
            let mut photons = PerMap::default();
            for built in gathered() {
                let kernel = if irradiance.is_some() { POINT_KERNEL } else { built.gather.kernel };
                photons[built.kind] = Some((&built.map, EstimateParams { kernel, ..built.gather }));
            }
            let lent = Maps { photons, irradiance: irradiance.as_ref().map(|(map, gather)| (map, *gather)), paths };
            stage.gather(&mut self.on, &self.scene, &lent, pass, &self.queries, rays, &mut self.film)?;
        }
        self.on.mark(None);
        self.reclaim_irradiance(irradiance);
        Ok(())
    }

    /// Takes the buffers of maps back for the photons of the next pass.
    pub(super) fn reclaim_maps(&mut self, maps: Vec<BuiltMap<B>>) {
        for built in maps {
            let mut slots = self.maps.iter_mut();
            if let Some(slot) = slots.find(|slot| (slot.kind, slot.place) == (built.kind, built.place)) {
                slot.photons = Some(self.stages.map.builder.reclaim(built.map));
            }
        }
    }

    /// Builds a map for each kind that has photons; empty ones are left out.
    pub(super) fn build_maps(&mut self, index: u32, paths: &PerMap<u64>) -> Result<Vec<BuiltMap<B>>> {
        let mut maps = Vec::with_capacity(self.maps.len());
        for slot in &mut self.maps {
            let Some(filled) = slot.photons.take() else { continue };
            let length = self.on.fill(&filled)?.length;
            if length == 0 {
                slot.photons = Some(filled);
                continue;
            }
            let map = self.stages.map.builder.build(&mut self.on, filled)?;
            let gather = self.weights.params(&self.settings, slot.place, slot.radius, index);
            let MapSlot { kind, place, .. } = *slot;
            maps.push(BuiltMap { kind, place, map, length, gather, paths: paths[kind] });
        }
        Ok(maps)
    }

    /// Adds the estimates from one map at the queries to the film.
    pub(super) fn show(&mut self, built: &BuiltMap<B>, pass: Pass) -> Result<()> {
        let BuiltMap { kind, place, map, gather, paths, .. } = built;
        let queries = if *place == MapPlace::Reflection { self.reflections.as_ref() } else { Some(&self.queries) };
        let Some(queries) = queries else { return Ok(()) };
        let Some(estimates) = &mut self.estimates else { return Ok(()) };
        self.on.mark(Some(Stage::Estimate));
        let (on, estimator) = (&mut self.on, &mut self.stages.map.estimator);
        match &mut self.error_moments {
            None => estimator.estimate(on, map, queries, gather, estimates)?,
            Some(error_moments) => {
                estimator.estimate_with_moments(on, map, queries, gather, estimates, error_moments)?
            }
        }
        if let Some(area) = &mut self.stages.area {
            let buffers = EstimateBuffers { estimates, error_moments: self.error_moments.as_mut() };
            area.correct(on, &self.scene, pass, queries, gather, buffers)?;
        }
        on.mark(Some(Stage::Film));
        if let Some(error_moments) = &self.error_moments {
            on.accumulate_errors(&mut self.film, *kind, queries, estimates, error_moments, *paths)?;
        }
        on.accumulate(&mut self.film, kind.layer(), queries, estimates, *paths)
    }
}
