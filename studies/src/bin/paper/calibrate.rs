//! How many paths fill a map, and within what radius it is read: found once, on the CPU, so that all
//! backends render the same.

use backend_cpu::Cpu;
use photon_core::{Backend, IndexKind, Photon, Result};

use crate::plan::{MapPlan, Plan};
use crate::studio::Studio;

/// Paths of the sample.
const PATHS: u32 = 1 << 18;
/// No photon is looked for farther than this, in normalised space.
const FARTHEST: f64 = 0.25;

/// One map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    /// Paths that leave about as many photons in it as are wanted.
    pub(crate) paths: u32,
    /// Photons that it must have room for.
    pub(crate) capacity: u64,
    /// Normalised space.
    pub(crate) radius: f32,
}

/// Both maps; `None` where there is none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sizes {
    pub(crate) caustic: Option<Size>,
    pub(crate) global: Option<Size>,
}

/// Maps of a sample of photons.
pub(crate) struct Calibration {
    on: Cpu,
    stages: photon_core::MapStages<Cpu>,
    /// The caustic and the global one; `None` where no photon landed.
    maps: [Option<(<Cpu as Backend>::PhotonMap, u64)>; 2],
}

impl Calibration {
    pub(crate) fn new(mut studio: Studio<'_, Cpu>) -> Result<Self> {
        let buffers = studio.sample(&Plan::large(1)[0], PATHS)?;
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

    /// What the maps of a plan take.
    pub(crate) fn sizes(&mut self, plan: &Plan) -> Result<Sizes> {
        let mut global = self.size(1, plan.global.as_ref())?;
        let mut caustic = self.size(0, plan.caustic.as_ref())?;
        if let (true, Some(caustic), Some(global), Some((_, found))) =
            (plan.together, &mut caustic, &mut global, &self.maps[0])
        {
            // As many caustic photons as the paths of the global map leave, and a radius for those.
            let landing = *found as f64 / f64::from(PATHS) * f64::from(global.paths);
            let wanted = plan.caustic.map_or(0.0, |map| f64::from(map.photons));
            caustic.radius = (f64::from(caustic.radius) * (wanted / landing).sqrt()).min(FARTHEST) as f32;
            caustic.paths = global.paths;
            caustic.capacity = room(landing);
        }
        Ok(Sizes { caustic, global })
    }

    fn size(&mut self, lane: usize, wanted: Option<&MapPlan>) -> Result<Option<Size>> {
        let (Some(wanted), Some((map, found))) = (wanted, &self.maps[lane]) else { return Ok(None) };
        let (photons, found) = (f64::from(wanted.photons), *found as f64);
        let paths = (photons / found * f64::from(PATHS)).ceil();
        // As many neighbours among the sample's photons as are wanted among the map's, as near as can be.
        let asked = (f64::from(wanted.neighbours) * found / photons).clamp(8.0, (found / 8.0).max(8.0)) as u32;
        let cosine = plan_cosine(wanted);
        let typical = self.stages.estimator.neighbour_radius(&mut self.on, map, asked, cosine)?;
        // Around a place of even density, numbers grow as squares of radii.
        let scale = f64::from(wanted.neighbours) / photons * found / f64::from(asked);
        let radius = typical.map_or(FARTHEST, |radius| (f64::from(radius) * scale.sqrt()).min(FARTHEST));
        Ok(Some(Size { paths: paths as u32, capacity: room(photons), radius: radius as f32 }))
    }
}

/// Numbers of photons scatter; LCGs scatter them more than chance does.
fn room(photons: f64) -> u64 {
    (photons * 1.5) as u64 + 4096
}

fn plan_cosine(map: &MapPlan) -> f32 {
    if map.search == photon_core::Search::Radius { 0.7 } else { -1.0 }
}
