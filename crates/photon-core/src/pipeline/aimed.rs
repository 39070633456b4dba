//! Light paths aimed at mirrors and glass: whether there are any, and how many.

use std::time::Instant;

use super::Pipeline;
use crate::backend::TransportBackend;
use crate::backend::memory::Costs;
use crate::backend::stages::{Aimed, Stages};
use crate::error::Result;
use crate::projection::ProjectionMap;
use crate::requirements::Requirements;
use crate::scene::SceneView;
use crate::settings::Settings;

/// All stages of the backend, including those for aimed paths if these are worthwhile; and the seconds that it took to find
/// out.
pub(super) fn stages<B: TransportBackend>(
    on: &mut B,
    scene: &SceneView<'_>,
    settings: &Settings,
    required: &Requirements,
) -> Result<(Stages<B>, f64)> {
    let mut stages = on.stages(required, settings)?;
    if !required.aimed {
        return Ok((stages, 0.0));
    }
    let begun = Instant::now();
    let chosen = ProjectionMap::chosen(scene, settings, required);
    let seconds = begun.elapsed().as_secs_f64();
    if let Ok((projection, paths)) = chosen {
        let aimed = on.aimed(required, settings, &projection)?;
        stages.aimed = aimed.map(|(emitter, tracer)| Aimed { emitter, tracer, paths });
    }
    Ok((stages, seconds))
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
