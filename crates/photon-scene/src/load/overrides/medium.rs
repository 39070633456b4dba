//! Media of override files: that around all solids, and keys of media that exist in the format alone.

use super::super::schema::{Material, Medium};
use super::Overrides;
use crate::builder::SceneBuilder;
use crate::describe::{AmbientMedium, GridDesc, PhaseDesc, PhaseKeys};
use crate::error::SceneError;
use crate::load::budget::Budget;
use crate::load::gltf::leaves_folder;
use std::path::Path;

impl Overrides {
    /// Sets the ambient medium; keys that are not given keep what the scene has.
    pub(super) fn medium(&self, with: &Medium, scene: &mut SceneBuilder) -> Result<(), SceneError> {
        let before = scene.medium.unwrap_or_default();
        let scattering = with.scattering.map_or(before.scattering, |given| given.rgb());
        let absorption = with.absorption.map_or(before.absorption, |given| given.rgb());
        let keys = PhaseKeys {
            phase: with.phase.as_deref(),
            anisotropy: with.anisotropy,
            droplet_micrometres: with.droplet_micrometres,
        };
        let phase = self.phase("[medium]", before.phase, keys)?;
        let medium = AmbientMedium::new(scattering, absorption).with_phase(phase);
        scene.medium(AmbientMedium { bounds: with.bounds.or(before.bounds), ..medium });
        Ok(())
    }

    /// The grid that a material is given in place of `before`.
    pub(super) fn grid(
        &self,
        name: &str,
        before: Option<&GridDesc>,
        with: &Material,
        budget: &Budget,
    ) -> Result<Option<GridDesc>, SceneError> {
        let mut grid = match &with.grid {
            Some(file) => {
                // As the images of scene files: what a stranger's file names is in its folder.
                if leaves_folder(&file.to_string_lossy()) {
                    let file = file.display();
                    let what =
                        format!("material '{name}' has the grid {file}, outside the folder of the override file");
                    return Err(self.fault(what, "put it into that folder or below it"));
                }
                let folder = self.path.parent().unwrap_or(Path::new(""));
                Some(GridDesc::read_budgeted(&folder.join(file), budget)?)
            }
            None => before.cloned(),
        };
        let others = [("transform", with.transform.is_some()), ("density_scale", with.density_scale.is_some())];
        if let (None, Some((key, _))) = (&grid, others.into_iter().find(|(_, is_given)| *is_given)) {
            let what = format!("material '{name}' has the key {key}, but no grid");
            return Err(self.fault(what, "give it a grid of densities, a .vol or .nvdb file"));
        }
        if let Some(transform) = with.transform {
            grid = grid.map(|grid| grid.with_transform(transform));
        }
        if let Some(scale) = with.density_scale {
            grid = grid.map(|grid| grid.with_density_scale(scale));
        }
        Ok(grid)
    }

    /// The phase function of a medium with these keys.
    pub(super) fn phase(&self, what: &str, before: PhaseDesc, keys: PhaseKeys<'_>) -> Result<PhaseDesc, SceneError> {
        before.with_keys(keys).map_err(|error| match error {
            SceneError::Phase { what: keys, hint } => self.fault(format!("{what} has {keys}"), hint),
            other => other,
        })
    }
}
