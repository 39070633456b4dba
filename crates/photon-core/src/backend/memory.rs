//! A hard limit on memory, kept by smaller batches and passes of fewer photons.
//!
//! The memory of scene and picture is fixed. The rest is divided between photons in flight and photons in
//! the maps; a few paths are traced beforehand to count how many photons a path stores.

use crate::error::{Error, Result};

/// Memory of a backend at the peak of a pass, in bytes: upper bounds, rounded up from its allocations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// Exhaustive: a backend must state every cost.
pub struct Costs {
    /// Per photon of a map: as stored, and as arranged for searching, including scratch memory for that.
    pub photon: u64,
    /// Per photon of the current batch that is not in its map yet.
    pub under_way: u64,
    /// Per path of a batch, besides its photons.
    pub path: u64,
    /// Per pixel of the picture, besides its queries and the film.
    pub pixel: u64,
    /// Per query, with its estimate.
    pub query: u64,
}

/// Number of photons of all maps, and of paths of a batch, that fit into memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MemoryPlan {
    pub(crate) photons: u64,
    pub(crate) batch: u32,
    left: u64,
}

/// With memory for fewer photons than this, rendering is refused.
const MIN_PATHS: u64 = 4096;

impl MemoryPlan {
    /// Divides what `fixed` bytes leave of `cap`, before the number of photons per path is known: assumes
    /// [`BUSY`].
    ///
    /// # Errors
    /// [`Error::OverMemory`] if that is not even enough for a few thousand photons.
    pub(crate) fn new(cap: u64, fixed: u64, costs: &Costs) -> Result<Self> {
        let least = MIN_PATHS * (costs.photon + costs.path + BUSY * costs.under_way);
        let needed = fixed.saturating_add(least);
        if needed > cap {
            return Err(Error::OverMemory { needed, allowed: cap });
        }
        let left = cap - fixed;
        let mut plan = Self { photons: 0, batch: 0, left };
        plan.share(BUSY as f64, costs);
        Ok(plan)
    }

    /// Divides it again, with the measured number of photons per path in all maps.
    pub(crate) fn share(&mut self, photons_per_path: f64, costs: &Costs) {
        // A quarter for photons in flight, which batches keep few; the rest is for the maps.
        let under_way = self.left / 4;
        let per_path = costs.path as f64 + photons_per_path * costs.under_way as f64;
        self.batch = (under_way as f64 / per_path).clamp(1.0, f64::from(u32::MAX)) as u32;
        self.photons = (self.left - under_way) / costs.photon;
    }

    /// Number of paths per pass whose photons fit, less a twentieth for random variation; at least 1.
    pub(crate) fn paths(&self, photons_per_path: f64, wanted: u32) -> u32 {
        let fit = self.photons as f64 * 0.95 / photons_per_path.max(1e-9);
        fit.min(f64::from(wanted)).max(1.0) as u32
    }
}

/// Photons per path before they are counted: those of a bright closed room.
const BUSY: u64 = 4;

#[cfg(test)]
mod tests {
    use super::*;

    const COSTS: Costs = Costs { photon: 100, under_way: 50, path: 60, pixel: 300, query: 100 };

    #[test]
    fn what_is_planned_fits() {
        for cap in [10_000_000_u64, 1 << 30, 1 << 40] {
            for busy in [0.1, 1.0, 7.5, 100.0] {
                let mut plan = MemoryPlan::new(cap, 1_000_000, &COSTS).unwrap();
                plan.share(busy, &COSTS);
                let batch = f64::from(plan.batch);
                let under_way = batch * (60.0 + busy * 50.0);
                let total = 1_000_000.0 + under_way + (plan.photons * COSTS.photon) as f64;
                assert!(total <= cap as f64 * 1.001, "{cap} {busy}: {plan:?}");
                assert!(f64::from(plan.paths(busy, u32::MAX)) * busy <= plan.photons as f64);
            }
        }
    }

    #[test]
    fn what_can_never_fit_is_an_error() {
        let error = MemoryPlan::new(1_000_000, 900_000, &COSTS).unwrap_err();
        assert!(matches!(error, Error::OverMemory { allowed: 1_000_000, needed } if needed > 1_000_000), "{error}");
        assert!(MemoryPlan::new(10_000_000, 900_000, &COSTS).unwrap().paths(1.0, 500) == 500);
    }
}
