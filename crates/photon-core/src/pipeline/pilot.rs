//! The pilot pass, from which radii are derived.

use super::estimate::is_shown;
use super::photons::per_map;
use super::slot::MapSlot;
use super::{PILOT_PASS, PILOT_PATHS, Pipeline};
use crate::backend::stages::{EstimateParams, EyeBuffers, Pass, Search, View};
use crate::backend::{Stage, TransportBackend};
use crate::error::Result;
use crate::radius::footprint::Footprint;
use crate::radius::radii;
use crate::requirements::map_place::MapPlace;
use crate::scene::layout::Query;
use crate::settings::Estimator;

impl<B: TransportBackend> Pipeline<B> {
    /// Traces a pilot pass to derive radii from the density of its photons, and from the footprints of pixels.
    pub(super) fn pilot(&mut self) -> Result<()> {
        let paths = self.settings.photons.min(PILOT_PATHS);
        let sent = self.emit_and_trace(PILOT_PASS, paths, &mut ())?;
        let all = self.settings.photons;
        let wanted_paths = per_map(all, self.aimed_paths(all));
        let traced_paths = per_map(sent.paths, sent.aimed);
        let footprint = Footprint::new(&self.view);
        let mut visible = None;
        for index in 0..self.maps.len() {
            let slot = &mut self.maps[index];
            let (kind, place) = (slot.kind, slot.place);
            let Some(photons) = slot.photons.take() else { continue };
            self.on.mark(Some(Stage::Build));
            let built = self.stages.map.builder.build(&mut self.on, photons)?;
            self.on.mark(Some(Stage::Estimate));
            if place == MapPlace::Medium {
                let wanted =
                    f64::from(radii::neighbours(kind)) * f64::from(traced_paths[kind]) / f64::from(wanted_paths[kind]);
                let radius = self.medium_radius(&built, wanted)?;
                let slot = &mut self.maps[index];
                slot.derived = Some((radius, 0.0));
                slot.radius = radii::scaled(radius, self.settings.radius_factor as f32);
                self.on.mark(None);
                slot.photons = Some(self.stages.map.builder.reclaim(built));
                continue;
            }
            let cosine = self.settings.min_normal_cosine;
            let (wanted, wanted_paths, traced) = (radii::neighbours(kind), wanted_paths[kind], traced_paths[kind]);
            let share = f64::from(traced) / f64::from(wanted_paths);
            let asked = ((f64::from(wanted) * share) as u32).max(8);
            let typical = self.stages.map.estimator.neighbour_radius(&mut self.on, &built, asked, cosine)?;
            let radius = radii::from_pilot(typical, asked, traced, wanted, wanted_paths);
            // The estimator of Lin and Wang remains that of the paper; reflections show their light in other places.
            let bounded = matches!(self.settings.estimator, Estimator::Radius { .. })
                && is_shown(&self.settings, kind, place)
                && place.is_on_visible_surfaces()
                && f64::from(radius) < footprint.most();
            let least =
                if bounded && typical.is_some() { self.least_radius(&footprint, &built, &mut visible)? } else { 0.0 };
            let slot: &mut MapSlot<B> = &mut self.maps[index];
            slot.derived = Some((radius, least));
            slot.radius = radii::scaled(radius.max(least), self.settings.radius_factor as f32);
            self.on.mark(None);
            slot.photons = Some(self.stages.map.builder.reclaim(built));
        }
        Ok(())
    }

    /// Traces the camera paths of `view` in the pilot pass. What they see of lights belongs to no film.
    pub(super) fn pilot_camera_paths(&mut self, view: &View) -> Result<()> {
        self.on.mark(Some(Stage::Eye));
        let pass = Pass::new(&self.settings, PILOT_PASS);
        let mut film = self.on.film(self.units, view.width, view.height)?;
        let buffers = EyeBuffers { queries: &mut self.queries, segments: self.segments.as_mut() };
        self.stages.eye.trace_eye(&mut self.on, &self.scene, view, pass, &mut film, buffers)?;
        self.on.abandon_pass(&mut film)?;
        drop(film);
        // Memory is again reported for the film of the picture.
        self.on.abandon_pass(&mut self.film)?;
        self.on.mark(Some(Stage::Estimate));
        Ok(())
    }

    /// The smallest useful radius of a map: [`Footprint::bound`]. `visible` are the visible points of the pilot pass, once
    /// they are known.
    fn least_radius(
        &mut self,
        footprint: &Footprint,
        map: &B::PhotonMap,
        visible: &mut Option<Vec<Query>>,
    ) -> Result<f32> {
        if visible.is_none() {
            self.pilot_camera_paths(&footprint.joined)?;
            let mut queries = Vec::new();
            self.on.download(&self.queries, &mut queries)?;
            footprint.search(&mut queries);
            *visible = Some(queries);
        }
        let (Some(queries), Some(estimates)) = (visible, &mut self.estimates) else { return Ok(0.0) };
        if queries.is_empty() {
            return Ok(0.0);
        }
        let gather = EstimateParams {
            min_normal_cosine: self.settings.min_normal_cosine,
            max_plane_distance: self.settings.plane_distance(),
            ..EstimateParams::new(Search::Radius)
        };
        let uploaded = self.on.upload("queries of the pilot pass", queries)?;
        self.stages.map.estimator.estimate(&mut self.on, map, &uploaded, &gather, estimates)?;
        let mut found = Vec::new();
        self.on.download(estimates, &mut found)?;
        Ok(footprint.bound(queries, &found))
    }
}
