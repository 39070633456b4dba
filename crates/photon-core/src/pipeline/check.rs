//! Checks that there is something to render.

use crate::error::{Error, Result};
use crate::requirements::features::Features;
use crate::requirements::gloss_caustics::roughest_caustic;
use crate::requirements::{Requirements, has_receiver, light_features};
use crate::scene::SceneView;
use crate::scene::media::MediaFeatures;
use crate::scene::solids::Solids;
use crate::settings::{Direct, Estimator, Indirect, Settings};

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

/// Media that scatter light are rendered with a radius, from photon maps; light from infinity never arrives through a medium
/// without bounds.
pub(super) fn check_media(scene: &SceneView<'_>, settings: &Settings) -> Result<()> {
    let media = Solids::of(scene).features();
    if media.contains(MediaFeatures::AMBIENT) && Features::of(scene).intersects(Features::INFINITE_LIGHTS) {
        return Err(Error::InvalidSetting {
            name: "[medium]",
            value: "without bounds, in a scene with light from infinity".into(),
            hint: "no such light would arrive: give it a box (box = [[x, y, z], [x, y, z]]), or use other lights",
        });
    }
    if !media.contains(MediaFeatures::SCATTERING) {
        return Ok(());
    }
    if let Some((index, medium)) = (0..).zip(scene.media).find(|(_, medium)| medium.is_too_dense()) {
        let free_path = scene.units.length_to_user(1.0 / medium.extinction().max_element());
        let albedo = medium.diffuse_albedo();
        let why = format!(
            "light goes {free_path:.1e} between collisions, less than the offsets of rays from surfaces: use a surface of \
             kind \"lambert\" with albedo {albedo:.3?}"
        );
        return Err(Error::InvalidInput { what: "medium", index, why });
    }
    let refuse = |name: &'static str, value: &str, hint: &'static str| {
        Err(Error::InvalidSetting { name, value: format!("{value}, in a scene with media that scatter light"), hint })
    };
    if settings.direct == Direct::Photons {
        return refuse("direct", "photons", "light of lights in media is found by shadow rays: use --direct nee");
    }
    if settings.transparent_background && media.intersects(MediaFeatures::AMBIENT.union(MediaFeatures::BOUNDARIES)) {
        return refuse("transparent-background", "true", "fog hides what is behind it: leave it out");
    }
    if !matches!(settings.estimator, Estimator::Radius { .. }) {
        return refuse(
            "estimator",
            "not the radius estimator",
            "photons around a segment are found by a radius: use it",
        );
    }
    Ok(())
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
