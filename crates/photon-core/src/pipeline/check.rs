//! Checks that there is something to render.

use crate::error::{Error, Result};
use crate::scene::SceneView;

/// At least one light has to emit power, and at least one surface has to store photons.
pub(super) fn check_scene(scene: &SceneView<'_>) -> Result<()> {
    let lit = scene.lights.iter().any(|light| light.power.iter().any(|&p| p > 0.0));
    if !lit {
        return Err(Error::NoLight);
    }
    let keeps = scene.primitives.iter().any(|primitive| {
        let material = &scene.materials[primitive.material as usize];
        material.is_diffuse() && material.albedo.iter().any(|&a| a > 0.0)
    });
    if keeps { Ok(()) } else { Err(Error::NoReceiver) }
}
