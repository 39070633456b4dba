//! Tells the backend what passes will ask of it, before the scene is prepared.

use super::estimate::is_shown;
use super::slot::MapSlot;
use super::{check, photon_format};
use crate::backend::TransportBackend;
use crate::backend::announcement::{AnnouncedMap, Announcement};
use crate::backend::stages::{EstimateParams, Stages, View};
use crate::error::Result;
use crate::radius::radii;
use crate::requirements::Requirements;
use crate::requirements::features::Features;
use crate::requirements::map_place::MapPlace;
use crate::scene::SceneView;
use crate::settings::Settings;

/// Facts of the scene that decide about factors on the power of photons, beside the settings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    /// Whether surfaces of the scene have shading normals.
    shading_normals: bool,
    /// Whether the scene has anisotropic surfaces.
    anisotropy: bool,
    /// Whether it has sheen.
    sheen: bool,
    /// [`EstimateParams::marked`], for reflections.
    marked: bool,
}

impl Weights {
    /// # Errors
    /// [`crate::Error::InvalidSetting`] if caustics in reflections are required and not estimated.
    pub(super) fn new(
        scene: &SceneView<'_>,
        settings: &Settings,
        required: &Requirements,
        estimates_reflections: bool,
    ) -> Result<Self> {
        let features = Features::of(scene);
        let all_lights = check::all_lights(scene, settings, required, estimates_reflections)?;
        Ok(Self {
            shading_normals: features.contains(Features::SHADING_NORMALS),
            anisotropy: features.contains(Features::ANISOTROPY),
            sheen: features.contains(Features::SHEEN),
            marked: all_lights && features.intersects(Features::DELTA_LIGHTS),
        })
    }

    /// Estimate parameters of pass `index` for a map at `place` whose first radius is `radius`.
    pub(super) fn params(self, settings: &Settings, place: MapPlace, radius: f32, index: u32) -> EstimateParams {
        let is_reflected = place == MapPlace::Reflection;
        EstimateParams {
            shading_normals: self.shading_normals,
            reflection: is_reflected,
            anisotropy: is_reflected && self.anisotropy,
            sheen: is_reflected && self.sheen,
            marked: is_reflected && self.marked,
            ..radii::gather(settings, radius, index)
        }
    }
}

/// Announces passes by these stages.
pub(super) fn announce<B: TransportBackend>(
    on: &mut B,
    (scene, view): (&SceneView<'_>, View),
    (settings, required): (&Settings, &Requirements),
    stages: &Stages<B>,
    is_aimed: bool,
) -> Result<()> {
    let has_reflections = required.gloss_caustics && stages.map.estimator.weighs_reflections();
    let format = required.photon_format.max(photon_format::least(stages));
    let weights = Weights::new(scene, settings, required, has_reflections)?;
    let slots = MapSlot::<B>::of(settings, required, (has_reflections, stages.media.is_some()), 1.0);
    let maps = slots.iter().map(|slot| AnnouncedMap {
        kind: slot.kind,
        place: slot.place,
        photon_format: slot.photon_format(format),
        is_shown: is_shown(settings, slot.kind, slot.place),
        gather: weights.params(settings, slot.place, slot.radius, 0),
    });
    let has_pilot = required.maps.any() && radii::need_pilot(settings);
    on.announce(&Announcement { scene, view, settings, required, is_aimed, has_pilot, maps: maps.collect() })
}
