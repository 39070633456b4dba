//! Media of override files: that around all solids, and keys of media that exist in the format alone.

use super::super::schema::{Material, Medium};
use super::Overrides;
use crate::builder::SceneBuilder;
use crate::describe::AmbientMedium;
use crate::error::SceneError;

impl Overrides {
    /// Sets the ambient medium; keys that are not given keep what the scene has.
    pub(super) fn medium(&self, with: &Medium, scene: &mut SceneBuilder) -> Result<(), SceneError> {
        self.phase("[medium]", with.phase.as_deref(), with.droplet_micrometres.is_some())?;
        if with.bounds.is_some() {
            let what = "[medium] has the key box, which is not supported yet".to_owned();
            let hint =
                "leave it out for a medium without bounds, or put a closed box of kind \"boundary\" around the scene";
            return Err(self.fault(what, hint));
        }
        let before = scene.medium.unwrap_or_default();
        let scattering = with.scattering.map_or(before.scattering, |given| given.rgb());
        let absorption = with.absorption.map_or(before.absorption, |given| given.rgb());
        let anisotropy = with.anisotropy.unwrap_or(before.anisotropy);
        scene.medium(AmbientMedium::new(scattering, absorption).with_anisotropy(anisotropy));
        Ok(())
    }

    /// Refuses what materials cannot have yet.
    pub(super) fn check_media_keys(&self, name: &str, with: &Material) -> Result<(), SceneError> {
        let what = format!("material '{name}'");
        self.phase(&what, with.phase.as_deref(), with.droplet_micrometres.is_some())?;
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

    fn phase(&self, what: &str, phase: Option<&str>, has_droplets: bool) -> Result<(), SceneError> {
        let hint = "use \"hg\", the Henyey-Greenstein function with the mean cosine of the key anisotropy";
        match phase {
            Some("rayleigh" | "mie") => {
                let phase = phase.unwrap_or_default();
                Err(self.fault(format!("{what} has the phase \"{phase}\", which is not supported yet"), hint))
            }
            Some("hg") | None if has_droplets => {
                let hint = "leave it out: it belongs to the phase \"mie\", which is not supported yet";
                Err(self.fault(format!("{what} has the key droplet_micrometres"), hint))
            }
            Some("hg") | None => Ok(()),
            Some(other) => Err(self.fault(format!("{what} has the unknown phase \"{other}\""), hint)),
        }
    }
}
