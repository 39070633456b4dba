//! Checks that there is something to render.

use crate::error::{Error, Result};
use crate::requirements::features::Features;
use crate::requirements::gloss_caustics::roughest_caustic;
use crate::requirements::{Requirements, has_receiver, light_features};
use crate::scene::SceneView;
use crate::settings::{Indirect, Settings};

/// Lights that camera paths meet, by themselves or by way of mirrors and glass.
const VISIBLE: Features = Features::AREA_LIGHTS.union(Features::ENVIRONMENT).union(Features::SUN);

/// At least one light has to emit power. At least one surface has to store photons or to reflect light that shadow rays find,
/// or else a light has to be visible: directly, in mirrors or through glass.
pub(super) fn check_scene(scene: &SceneView<'_>) -> Result<()> {
    let mut lit = scene.lights.iter().filter(|light| light.power.iter().any(|&p| p > 0.0)).peekable();
    // Without triangles, no light reaches anything, which is not its fault.
    let or_empty = |error| if scene.triangles.is_empty() { Error::NoTriangles } else { error };
    if lit.peek().is_none() {
        return Err(or_empty(Error::NoLight));
    }
    let is_seen = lit.any(|light| light_features(light).intersects(VISIBLE));
    if is_seen || has_receiver(scene) { Ok(()) } else { Err(or_empty(Error::NoReceiver)) }
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

/// Whether reflections of this scene show caustics of all lights from photons. Camera paths leave these out, so that stages
/// which do not estimate them would lose light.
pub(super) fn all_lights(
    scene: &SceneView<'_>,
    settings: &Settings,
    required: &Requirements,
    is_estimated: bool,
) -> Result<bool> {
    let Some(least) = required.caustic_roughness(settings) else { return Ok(false) };
    match least <= roughest_caustic(scene) {
        true if !is_estimated => Err(Error::InvalidSetting {
            name: "caustic-roughness",
            value: least.to_string(),
            hint: "these stages, or their estimator, have no photons for reflections: leave it out",
        }),
        found => Ok(found),
    }
}
