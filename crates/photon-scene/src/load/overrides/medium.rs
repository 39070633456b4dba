//! Media of override files: that around all solids, and keys of media that exist in the format alone.

use super::super::schema::{Material, Medium};
use super::Overrides;
use crate::builder::SceneBuilder;
use crate::describe::{AmbientMedium, PhaseDesc, PhaseKeys};
use crate::error::SceneError;

impl Overrides {
    /// Sets the ambient medium; keys that are not given keep what the scene has.
    pub(super) fn medium(&self, with: &Medium, scene: &mut SceneBuilder) -> Result<(), SceneError> {
        if with.bounds.is_some() {
            let what = "[medium] has the key box, which is not supported yet".to_owned();
            let hint =
                "leave it out for a medium without bounds, or put a closed box of kind \"boundary\" around the scene";
            return Err(self.fault(what, hint));
        }
        let before = scene.medium.unwrap_or_default();
        let scattering = with.scattering.map_or(before.scattering, |given| given.rgb());
        let absorption = with.absorption.map_or(before.absorption, |given| given.rgb());
        let keys = PhaseKeys {
            phase: with.phase.as_deref(),
            anisotropy: with.anisotropy,
            droplet_micrometres: with.droplet_micrometres,
        };
        let phase = self.phase("[medium]", before.phase, keys)?;
        scene.medium(AmbientMedium::new(scattering, absorption).with_phase(phase));
        Ok(())
    }

    /// Refuses what materials cannot have yet.
    pub(super) fn check_media_keys(&self, name: &str, with: &Material) -> Result<(), SceneError> {
        let what = format!("material '{name}'");
        let grid = [
            ("grid", with.grid.is_some()),
            ("transform", with.transform.is_some()),
            ("density_scale", with.density_scale.is_some()),
        ];
        match grid.into_iter().find(|(_, is_given)| *is_given) {
            Some((key, _)) => {
                let what = format!("{what} has the key {key}, but grids of densities are not supported yet");
                Err(self.fault(what, "leave it out: the medium is the same everywhere in the solid"))
            }
            None => Ok(()),
        }
    }

    /// The phase function of a medium with these keys.
    pub(super) fn phase(&self, what: &str, before: PhaseDesc, keys: PhaseKeys<'_>) -> Result<PhaseDesc, SceneError> {
        before.with_keys(keys).map_err(|error| match error {
            SceneError::Phase { what: keys, hint } => self.fault(format!("{what} has {keys}"), hint),
            other => other,
        })
    }
}
