//! Finds how many paths fill a map, and the search radius: once, on the CPU, so that all
//! backends render the same.

use backend_cpu::Cpu;
use photon_core::{Backend, IndexKind, Photon, Result};

use crate::experiment::{Experiment, MapParams};
use crate::studio::Studio;

/// Number of paths of the sample.
const PATHS: u32 = 1 << 18;
/// Maximum search distance, in normalised space.
const FARTHEST: f64 = 0.25;

/// Size of one map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    /// Paths that store about the required number of photons in it.
    pub(crate) paths: u32,
    /// Photon capacity that it needs.
    pub(crate) capacity: u64,
    /// Search radius, normalised space.
    pub(crate) radius: f32,
}

/// Both maps; `None` for a map that is not used.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sizes {
    pub(crate) caustic: Option<Size>,
    pub(crate) global: Option<Size>,
}

/// Maps of a sample of photons, from which sizes are extrapolated.
pub(crate) struct Calibration {
    on: Cpu,
    stages: photon_core::MapStages<Cpu>,
    /// The caustic and the global map; `None` if no photon was stored.
    maps: [Option<(<Cpu as Backend>::PhotonMap, u64)>; 2],
}

impl Calibration {
    pub(crate) fn new(mut studio: Studio<'_, Cpu>) -> Result<Self> {
        let buffers = studio.sample(&Experiment::large(1)[0], PATHS)?;
        let mut on = studio.on;
        let mut stages = on.map_stages(IndexKind::Morton)?;
        let mut build = |photons: <Cpu as Backend>::Buffer<Photon>| -> Result<_> {
            let count = on.fill(&photons)?.length;
            if count == 0 {
                return Ok(None);
            }
            Ok(Some((stages.builder.build(&mut on, photons)?, count)))
        };
        let [caustic, global] = buffers;
        let maps = [build(caustic)?, build(global)?];
        Ok(Self { on, stages, maps })
    }

    /// Sizes of the maps of a experiment.
    pub(crate) fn sizes(&mut self, experiment: &Experiment) -> Result<Sizes> {
        let mut global = self.size(1, experiment.global.as_ref())?;
        let mut caustic = self.size(0, experiment.caustic.as_ref())?;
        if let (true, Some(caustic), Some(global), Some((_, found))) =
            (experiment.together, &mut caustic, &mut global, &self.maps[0])
        {
            // The caustic photons that the paths of the global map store, and a radius for them.
            let landing = *found as f64 / f64::from(PATHS) * f64::from(global.paths);
            let wanted = experiment.caustic.map_or(0.0, |map| f64::from(map.photons));
            caustic.radius = (f64::from(caustic.radius) * (wanted / landing).sqrt()).min(FARTHEST) as f32;
            caustic.paths = global.paths;
            caustic.capacity = room(landing);
        }
        Ok(Sizes { caustic, global })
    }

    fn size(&mut self, lane: usize, wanted: Option<&MapParams>) -> Result<Option<Size>> {
        let (Some(wanted), Some((map, found))) = (wanted, &self.maps[lane]) else { return Ok(None) };
        let (photons, found) = (f64::from(wanted.photons), *found as f64);
        let paths = (photons / found * f64::from(PATHS)).ceil();
        // The number of neighbours in the sample that is nearest to what corresponds to the required number in the map.
        let asked = (f64::from(wanted.neighbours) * found / photons).clamp(8.0, (found / 8.0).max(8.0)) as u32;
        let cosine = plan_cosine(wanted);
        let typical = self.stages.estimator.neighbour_radius(&mut self.on, map, asked, cosine)?;
        // At uniform density, numbers grow with the square of the radius.
        let scale = f64::from(wanted.neighbours) / photons * found / f64::from(asked);
        let radius = typical.map_or(FARTHEST, |radius| (f64::from(radius) * scale.sqrt()).min(FARTHEST));
        Ok(Some(Size { paths: paths as u32, capacity: room(photons), radius: radius as f32 }))
    }
}

/// Margin for the variance of photon numbers, which LCGs make larger than that of independent photons.
fn room(photons: f64) -> u64 {
    (photons * 1.5) as u64 + 4096
}

fn plan_cosine(map: &MapParams) -> f32 {
    if map.search == photon_core::Search::Radius { 0.7 } else { -1.0 }
}
