//! What a renderer must model to render a scene: derived, never declared.

use crate::error::{Error, Result};
use crate::features::Features;
use crate::kept::Kept;
use crate::layout::{Light, Material};
use crate::map_kind::{MapKind, PerMap};
use crate::scene::SceneView;
use crate::settings::{CausticPhotons, Direct, Indirect, Settings};

/// What stages are built for.
///
/// A pure function of scene and settings. What is absent is not compiled into a kernel, not
/// allocated and not built. Too little is an error, too much changes no bit of the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Requirements {
    /// Lobes and lights.
    pub features: Features,
    /// Which photon maps are filled.
    pub maps: PerMap<bool>,
    /// The caustic map has paths of light of its own, which are aimed: unless [`crate::Aim`] finds that it does
    /// not pay.
    pub aimed: bool,
    /// Direct light is asked for with shadow rays.
    pub shadow_rays: bool,
    /// Indirect light is gathered.
    pub final_gather: bool,
    /// How much of each photon the maps keep.
    pub kept: Kept,
}

impl Requirements {
    /// The least that renders `scene` exactly.
    #[must_use]
    pub fn of(scene: &SceneView<'_>, settings: &Settings) -> Self {
        let mut features = Features::NONE;
        for material in scene.materials_in_use() {
            features = features.union(material_features(material));
        }
        for light in scene.lights {
            features = features.union(light_features(light));
        }
        let maps = PerMap::from_fn(|kind| match kind {
            MapKind::Caustic => reads(settings, kind) && specular_is_lit(scene),
            MapKind::Direct | MapKind::Global => reads(settings, kind),
        });
        Self {
            features,
            maps,
            aimed: maps[MapKind::Caustic] && settings.caustic_photons != CausticPhotons::Shared,
            shadow_rays: settings.direct == Direct::Nee,
            final_gather: settings.indirect == Indirect::Gather,
            kept: Kept::of(scene, settings),
        }
    }

    /// Everything that the settings allow, whatever the scene: the same picture, more work.
    #[must_use]
    pub fn everything(settings: &Settings) -> Self {
        let maps = PerMap::from_fn(|kind| reads(settings, kind));
        Self {
            features: Features::ALL,
            maps,
            aimed: maps[MapKind::Caustic] && settings.caustic_photons != CausticPhotons::Shared,
            shadow_rays: settings.direct == Direct::Nee,
            final_gather: settings.indirect == Indirect::Gather,
            kept: Kept::Whole,
        }
    }

    /// Whether stages built for `self` can render what needs `needed`.
    ///
    /// # Errors
    /// [`Error::MissingFeatures`].
    pub fn check(&self, needed: Features) -> Result<()> {
        let missing = needed.without(self.features);
        if missing == Features::NONE { Ok(()) } else { Err(Error::MissingFeatures { missing }) }
    }

    /// Whether maps built for `self` keep what is `needed` of a photon.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`].
    pub fn check_kept(&self, needed: Kept) -> Result<()> {
        if self.kept >= needed {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "what maps keep of a photon",
            value: self.kept.name().into(),
            mend: "more of it is read; derive the requirements from this scene and these settings",
        })
    }
}

/// Whether the settings read a map: at what the camera sees, or where final-gather rays land.
fn reads(settings: &Settings, kind: MapKind) -> bool {
    let gather = settings.indirect == Indirect::Gather;
    match kind {
        MapKind::Direct => settings.direct == Direct::Photons || gather,
        MapKind::Caustic => settings.caustics || gather,
        MapKind::Global => settings.indirect != Indirect::None,
    }
}

/// What one material makes a kernel do.
#[must_use]
pub fn material_features(material: &Material) -> Features {
    let lobe = match material.kind {
        Material::MIRROR => Features::MIRROR,
        Material::DIELECTRIC => Features::DIELECTRIC,
        Material::THIN => Features::THIN,
        _ => Features::DIFFUSE,
    };
    let absorbs = material.kind == Material::DIELECTRIC && material.absorption != [0.0; 3];
    if absorbs { lobe.union(Features::ABSORPTION) } else { lobe }
}

/// What one light makes a kernel do.
#[must_use]
pub fn light_features(light: &Light) -> Features {
    match light.kind {
        Light::POINT => Features::POINT_LIGHTS,
        Light::SPOT => Features::SPOT_LIGHTS,
        Light::DIRECTIONAL => Features::DIRECTIONAL_LIGHTS,
        _ => Features::AREA_LIGHTS,
    }
}

/// Whether some light could shine on some specular surface: whether the box about all specular
/// triangles is not wholly behind every light. Errs on the side of yes; blockers are not looked at.
fn specular_is_lit(scene: &SceneView<'_>) -> bool {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for (triangle, facet) in scene.triangles.iter().zip(scene.facets) {
        if scene.materials[facet.material as usize].is_diffuse() {
            continue;
        }
        for &vertex in triangle {
            let p = scene.positions[vertex as usize];
            for axis in 0..3 {
                low[axis] = low[axis].min(p[axis]);
                high[axis] = high[axis].max(p[axis]);
            }
        }
    }
    if low[0] > high[0] {
        return false;
    }
    // The corner of the box that lies farthest along a direction, as a height over a plane.
    let reach = |normal: [f32; 3], origin: [f32; 3]| -> f32 {
        (0..3).map(|a| normal[a] * (if normal[a] > 0.0 { high[a] } else { low[a] } - origin[a])).sum()
    };
    scene.lights.iter().any(|light| match light.kind {
        Light::TRIANGLE => {
            let normal = scene.facets[light.primitive as usize].normal;
            // The triangle's own plane: heights of rounding size do not count as in front.
            scene.triangles[light.primitive as usize].iter().any(|&vertex| {
                light.flags & Light::BOTH_SIDES != 0 || reach(normal, scene.positions[vertex as usize]) > 1e-6
            })
        }
        // A cone narrower than a half space reaches no further than the half space does.
        Light::SPOT if light.versine_outer <= 1.0 => reach(light.direction, light.position) > 0.0,
        _ => true,
    })
}
