//! Light paths aimed at mirrors and glass: whether there are any, and how many.

use std::mem::discriminant;
use std::time::Instant;

use super::Pipeline;
use super::announce::announce;
use crate::backend::TransportBackend;
use crate::backend::memory::Costs;
use crate::backend::stages::{Aimed, Stages, View};
use crate::error::Result;
use crate::memory;
use crate::projection::ProjectionMap;
use crate::requirements::Requirements;
use crate::scene::SceneView;
use crate::settings::{CausticPhotons, Settings};

/// Whether paths of a scene are aimed, and where to; and the settings on which that depends.
pub(super) struct Aiming {
    caustic_photons: CausticPhotons,
    /// [`Requirements::aims_alone`].
    alone: bool,
    /// `None` if none are aimed.
    map: Option<ProjectionMap>,
    /// Seconds that it took to find out.
    pub(super) seconds: f64,
}

/// Upper bound on the memory for finding out: its grids, lists of cells and pairs have limits that no scene changes.
const BYTES: u64 = 64 << 20;

impl Aiming {
    fn new(scene: &SceneView<'_>, settings: &Settings, required: &Requirements) -> Result<Self> {
        let begun = Instant::now();
        memory::check(BYTES, "the projection map")?;
        let chosen = ProjectionMap::chosen(scene, settings, required);
        Ok(Self {
            caustic_photons: settings.caustic_photons,
            alone: required.aims_alone(),
            map: chosen.ok().map(|(map, _)| map),
            seconds: begun.elapsed().as_secs_f64(),
        })
    }

    fn is_for(&self, settings: &Settings, required: &Requirements) -> bool {
        // The number of aimed paths does not matter.
        let is_alike = discriminant(&self.caustic_photons) == discriminant(&settings.caustic_photons);
        is_alike && self.alone == required.aims_alone()
    }
}

/// All stages of the backend, including those for aimed paths if these are worthwhile; and whether they are, which may be
/// `known` from other settings in the same scene.
pub(super) fn stages<B: TransportBackend>(
    on: &mut B,
    (scene, view): (&SceneView<'_>, View),
    settings: &Settings,
    required: &Requirements,
    known: Option<Aiming>,
) -> Result<(Stages<B>, Option<Aiming>)> {
    let mut stages = on.stages(required, settings)?;
    announce(on, (scene, view), (settings, required), &stages, required.aimed)?;
    if !required.aimed {
        return Ok((stages, known));
    }
    let known = known.filter(|known| known.is_for(settings, required));
    let aiming = known.map_or_else(|| Aiming::new(scene, settings, required), Ok)?;
    if let Some(map) = &aiming.map {
        let aimed = on.aimed(required, settings, map)?;
        let paths = map.aimed_paths(settings, required);
        stages.aimed = aimed.map(|(emitter, tracer)| Aimed { emitter, tracer, paths });
    }
    if stages.aimed.is_none() {
        announce(on, (scene, view), (settings, required), &stages, false)?;
    }
    Ok((stages, Some(aiming)))
}

/// Memory of a backend with all its tracers: those for aimed paths, and for caustics in reflections, have memory of their
/// own.
pub(super) fn costs<B: TransportBackend>(costs: Costs, stages: &Stages<B>) -> Costs {
    let more = u64::from(stages.aimed.is_some()) + u64::from(stages.gloss_caustics.is_some());
    Costs { path: costs.path + more * (costs.path / 2), ..costs }
}

impl<B: TransportBackend> Pipeline<B> {
    /// Number of aimed paths in a pass with `others` other paths; `None` if none are aimed.
    pub(super) fn aimed_paths(&self, others: u32) -> Option<u32> {
        let aimed = self.stages.aimed.as_ref()?;
        if others == self.asked {
            return Some(aimed.paths);
        }
        // Rounded down like half of a number, so that a reduced pass equals a pass of that size.
        let paths = u64::from(aimed.paths) * u64::from(others) / u64::from(self.asked.max(1));
        Some((paths as u32).max(1))
    }

    /// Whether a map is filled by paths that are not aimed.
    pub(super) fn needs_others(&self) -> bool {
        let aims = self.stages.aimed.is_some();
        self.maps.iter().any(|slot| !(aims && slot.kind.is_aimed()))
    }
}
