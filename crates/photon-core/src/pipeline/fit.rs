//! Sizes of maps, batches and passes under a limit on memory.

use super::{PILOT_PASS, PILOT_PATHS, Pipeline, aimed, irradiance};
use crate::backend::TransportBackend;
use crate::backend::memory::MemoryPlan;
use crate::error::Result;
use crate::requirements::map_place::MapPlace;
use crate::scene::layout::Photon;
use crate::shading::flight::{FOCUSED_DEPOSITS, MAX_COLLISIONS};

/// Photons allocated per map for counting; those beyond the capacity are counted too.
const COUNTED: u64 = 65_536;

impl<B: TransportBackend> Pipeline<B> {
    pub(super) fn allocate_maps(&mut self, photons_per_path: f64) -> Result<()> {
        let paths = self.settings.photons.max(PILOT_PATHS);
        let guess = (f64::from(paths) * photons_per_path) as u64 + 1024;
        let aimed = self.aimed_paths(self.settings.photons).unwrap_or(0);
        let bounces = u64::from(self.settings.max_bounces);
        self.maps.iter_mut().try_for_each(|slot| {
            // A larger requested capacity could never be filled.
            let each = match slot.place {
                MapPlace::Surface | MapPlace::FromMedium => bounces,
                MapPlace::Reflection => 1,
                MapPlace::Medium => u64::from(FOCUSED_DEPOSITS) * (bounces + u64::from(MAX_COLLISIONS)),
            };
            let most = u64::from(self.settings.photons.max(aimed)) * each;
            let capacity = self.settings.photon_capacity.map_or(guess, |given| given.min(most));
            // A path stores at most one photon for reflections.
            let is_few = slot.place == MapPlace::Reflection;
            let capacity = if is_few { capacity.min(u64::from(paths.max(aimed))) } else { capacity };
            slot.allocate(&mut self.on, capacity, self.required.photon_format)
        })
    }

    /// Traces a few paths to count their photons, and sizes maps, batches and passes accordingly.
    pub(super) fn fit(&mut self, mut plan: MemoryPlan) -> Result<()> {
        let each = (plan.photons / (self.maps.len() as u64).max(1)).min(COUNTED);
        for slot in &mut self.maps {
            slot.allocate(&mut self.on, each, self.required.photon_format)?;
        }
        let paths = self.settings.photons.min(PILOT_PATHS).min(plan.batch);
        let per_path: Vec<f64> = self
            .emit_and_count(paths, plan.batch)?
            .into_iter()
            .map(|needed| needed as f64 / f64::from(paths))
            .collect();
        let all: f64 = per_path.iter().sum();
        let format = self.maps.iter().map(|slot| slot.photon_format(self.required.photon_format)).max();
        let format = format.unwrap_or(self.required.photon_format);
        let costs = aimed::costs(self.on.costs(format), &self.stages);
        plan.share(all, &irradiance::costs(&self.on, costs, &self.settings));
        self.batch = self.batch.min(plan.batch);
        self.settings.photons = plan.paths(all, self.settings.photons);
        // All are freed before the first is allocated.
        self.maps.iter_mut().for_each(|slot| slot.photons = None);
        for (slot, per_path) in self.maps.iter_mut().zip(per_path) {
            // Reserve for random variation: a thousand, and a twentieth.
            let expected = f64::from(self.settings.photons) * per_path;
            let own = (expected * 1.05) as u64 + 1024;
            let capacity = self.settings.photon_capacity.map_or(own, |given| given.min(own));
            slot.allocate(&mut self.on, capacity, self.required.photon_format)?;
        }
        Ok(())
    }

    /// Number of photons that `paths` paths, and the corresponding aimed ones, store in each map, whether
    /// or not they fit.
    fn emit_and_count(&mut self, paths: u32, batch: u32) -> Result<Vec<u64>> {
        if self.needs_others() {
            self.send_batch(PILOT_PASS, false, 0..paths)?;
            self.stages.tracer.take_tally(&mut self.on)?;
        }
        if let Some(aimed) = self.aimed_paths(paths) {
            for start in (0..aimed).step_by(batch.max(1) as usize) {
                self.send_batch(PILOT_PASS, true, start..start.saturating_add(batch).min(aimed))?;
            }
            if let Some(stages) = &mut self.stages.aimed {
                stages.tracer.take_tally(&mut self.on)?;
            }
        }
        let on = &mut self.on;
        let count = |photons: &Option<B::Buffer<Photon>>| match photons {
            Some(photons) => on.fill(photons).map(|fill| fill.needed),
            None => Ok(0),
        };
        self.maps.iter().map(|slot| &slot.photons).map(count).collect()
    }
}
