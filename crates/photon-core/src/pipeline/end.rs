//! How it goes on after a pass that failed, and how it ends.

use super::Pipeline;
use crate::backend::TransportBackend;
use crate::error::Result;

impl<B: TransportBackend> Pipeline<B> {
    /// Ends it, and gives back what it worked on, ready for another render; all that this one had in
    /// memory is freed. Some drivers let a program open their devices only so many times.
    ///
    /// # Errors
    /// What the backend raises, deferred errors included; it is gone then.
    pub fn into_backend(self) -> Result<B> {
        // All that holds buffers: what is not named here would be dropped after the call below.
        let Self { mut on, scene, stages, film, rays, photons, queries, estimates, spreads, points, bandwidth, .. } =
            self;
        drop((scene, stages, film, rays, photons, queries, estimates, spreads, points, bandwidth));
        on.renew()?;
        Ok(on)
    }

    /// Puts back what a pass that failed had in its hands: photons that were in a map when it was given
    /// up are gone, and counts of paths that no film has.
    pub(super) fn recover(&mut self) -> Result<()> {
        let wanted = [self.required.direct_map, self.required.caustic_map, self.required.global_map];
        for map in (0..3).filter(|&map| wanted[map]) {
            if self.photons[map].is_none() {
                self.allocate(map, self.capacities[map])?;
            }
        }
        self.stages.tracer.take_tally(&mut self.on)?;
        if let Some(aimed) = &mut self.stages.aimed {
            aimed.tracer.take_tally(&mut self.on)?;
        }
        self.on.timings()?;
        self.failed = false;
        Ok(())
    }
}
