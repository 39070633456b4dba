//! Checks that there is something to render.

use crate::error::{Error, Result};
use crate::requirements::features::Features;
use crate::scene::SceneView;
use crate::scene::material::MaterialKind;
use crate::settings::{Indirect, Settings};

/// At least one light has to emit power, and at least one surface has to scatter light towards the camera that is not
/// a mirror image: to store photons, or to reflect light that shadow rays find.
pub(super) fn check_scene(scene: &SceneView<'_>) -> Result<()> {
    let lit = scene.lights.iter().any(|light| light.power.iter().any(|&p| p > 0.0));
    if !lit {
        return Err(Error::NoLight);
    }
    let keeps = scene.primitives.iter().flat_map(|primitive| scene.materials_of(primitive)).any(|material| {
        let scatters = material.is_diffuse() && material.albedo.iter().any(|&a| a > 0.0);
        scatters || material.kind() == MaterialKind::Glossy || material.is_rough_glass()
    });
    if keeps { Ok(()) } else { Err(Error::NoReceiver) }
}

/// Precomputed irradiance is relative to the geometric normal, and would lose the shading normals.
pub(super) fn check_irradiance(scene: &SceneView<'_>, settings: &Settings) -> Result<()> {
    match settings.irradiance_every {
        Some(every)
            if settings.indirect == Indirect::Gather && Features::of(scene).contains(Features::SHADING_NORMALS) =>
        {
            Err(Error::InvalidSetting {
                name: "irradiance-every",
                value: every.to_string(),
                hint: "cannot be used in a scene with vertex normals or normal maps: leave it out",
            })
        }
        _ => Ok(()),
    }
}
