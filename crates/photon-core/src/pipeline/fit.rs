//! Maps, batches and passes of the size that a cap on memory allows.

use super::{PILOT, PILOT_PATHS, Pipeline, aimed, irradiance};
use crate::backend::TransportBackend;
use crate::error::Result;
use crate::memory::Plan;

/// Photons of a map that are allocated to count how many there are; those beyond are counted too.
const COUNTED: u64 = 65_536;

impl<B: TransportBackend> Pipeline<B> {
    /// Counts the photons of a few paths, and makes maps, batches and passes so large that they fit.
    pub(super) fn fit(&mut self, mut plan: Plan) -> Result<()> {
        let wanted = [self.required.direct_map, self.required.caustic_map, self.required.global_map];
        let maps = wanted.iter().filter(|&&wanted| wanted).count() as u64;
        let each = (plan.photons / maps.max(1)).min(COUNTED);
        for (map, _) in wanted.iter().enumerate().filter(|(_, wanted)| **wanted) {
            self.allocate(map, each)?;
        }
        let paths = self.settings.photons.min(PILOT_PATHS).min(plan.batch);
        let per_path = self.emit_and_count(paths, plan.batch)?.map(|needed| needed as f64 / f64::from(paths));
        let all: f64 = per_path.iter().sum();
        let costs = aimed::costs(self.on.costs(self.required.kept), self.stages.aimed.is_some());
        plan.share(all, &irradiance::costs(&self.on, costs, &self.settings));
        self.batch = self.batch.min(plan.batch);
        self.settings.photons = plan.paths(all, self.settings.photons);
        for map in 0..3 {
            if self.photons[map].take().is_some() {
                // Room for chance: a thousand, and a twentieth.
                let expected = f64::from(self.settings.photons) * per_path[map];
                let own = (expected * 1.05) as u64 + 1024;
                self.allocate(map, self.settings.photon_capacity.map_or(own, |given| given.min(own)))?;
            }
        }
        Ok(())
    }

    /// How many photons so many paths, and the aimed ones that go with them, leave for each map, whether or
    /// not they fit.
    fn emit_and_count(&mut self, paths: u32, batch: u32) -> Result<[u64; 3]> {
        if self.needs_others() {
            self.send_batch(PILOT, false, 0..paths)?;
            self.stages.tracer.take_tally(&mut self.on)?;
        }
        if let Some(aimed) = self.aimed_paths(paths) {
            for start in (0..aimed).step_by(batch.max(1) as usize) {
                self.send_batch(PILOT, true, start..start.saturating_add(batch).min(aimed))?;
            }
            if let Some(stages) = &mut self.stages.aimed {
                stages.tracer.take_tally(&mut self.on)?;
            }
        }
        let mut counts = [0; 3];
        for (count, photons) in counts.iter_mut().zip(&self.photons) {
            if let Some(photons) = photons {
                *count = self.on.fill(photons)?.needed;
            }
        }
        Ok(counts)
    }
}
