//! What a renderer must model to render a scene: derived, never declared.

pub(crate) mod explain;
pub(crate) mod features;
pub(crate) mod map_kind;
pub(crate) mod photon_format;

use crate::error::{Error, Result};
use crate::requirements::features::Features;
use crate::requirements::map_kind::{MapKind, PerMap};
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::SceneView;
use crate::scene::layout::{Light, Material, MaterialKind, Medium};
use crate::scene::media::MediaFeatures;
use crate::scene::solids::Solids;
use crate::settings::{CausticPhotons, Direct, Indirect, Settings};

/// What stages are built for.
///
/// A pure function of scene and settings. What is absent is not compiled into a kernel, not
/// allocated and not built. Too little is an error, too much changes no bit of the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Requirements {
    /// Lobes and lights.
    pub features: Features,
    /// What solids need that lie within each other, or overlap.
    pub media: MediaFeatures,
    /// Which photon maps are filled.
    pub maps: PerMap<bool>,
    /// The caustic map has paths of light of its own, which are aimed: unless [`crate::ProjectionMap`] finds that it does
    /// not pay.
    pub aimed: bool,
    /// Direct light is asked for with shadow rays.
    pub shadow_rays: bool,
    /// Indirect light is gathered.
    pub final_gather: bool,
    /// How much of each photon the maps keep.
    pub photon_format: PhotonFormat,
}

impl Requirements {
    /// The least that renders `scene` exactly. Of a scene that [`SceneView::validate`] refuses, what is out of
    /// range is skipped.
    #[must_use]
    pub fn of(scene: &SceneView<'_>, settings: &Settings) -> Self {
        let maps = PerMap::from_fn(|kind| match kind {
            MapKind::Caustic => reads(settings, kind) && specular_is_lit(scene),
            MapKind::Direct | MapKind::Global => reads(settings, kind),
        });
        Self {
            features: Features::of(scene),
            media: Solids::of(scene).features(),
            maps,
            aimed: maps[MapKind::Caustic] && settings.caustic_photons != CausticPhotons::Shared,
            shadow_rays: settings.direct == Direct::Nee,
            final_gather: settings.indirect == Indirect::Gather,
            photon_format: PhotonFormat::of(scene, settings),
        }
    }

    /// Everything that the settings allow, whatever the scene: the same picture, more work.
    #[must_use]
    pub fn everything(settings: &Settings) -> Self {
        let maps = PerMap::from_fn(|kind| reads(settings, kind));
        Self {
            features: Features::ALL,
            media: MediaFeatures::ALL,
            maps,
            aimed: maps[MapKind::Caustic] && settings.caustic_photons != CausticPhotons::Shared,
            shadow_rays: settings.direct == Direct::Nee,
            final_gather: settings.indirect == Indirect::Gather,
            photon_format: PhotonFormat::Full,
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

    /// Whether stages built for `self` can follow paths through media that need `needed`.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`].
    pub fn check_media(&self, needed: MediaFeatures) -> Result<()> {
        if self.media.contains(needed) {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "what stages model of media",
            value: self.media.to_string(),
            hint: "solids of this scene lie within each other or overlap; derive the requirements from it",
        })
    }

    /// Whether maps built for `self` keep what is `needed` of a photon.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`].
    pub fn check_format(&self, needed: PhotonFormat) -> Result<()> {
        if self.photon_format >= needed {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "what maps keep of a photon",
            value: self.photon_format.name().into(),
            hint: "more of it is read; derive the requirements from this scene and these settings",
        })
    }
}

impl Features {
    /// The lobes of the materials in use, and the lights: what a kernel must model to render `scene`. Indices out
    /// of range are skipped.
    #[must_use]
    pub fn of(scene: &SceneView<'_>) -> Self {
        let materials = scene.materials_in_use().map(|material| material_features(material, scene.media));
        materials.chain(scene.lights.iter().map(light_features)).fold(Self::NONE, Self::union)
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

/// What one material makes a kernel do; `media` is the scene's table.
#[must_use]
pub fn material_features(material: &Material, media: &[Medium]) -> Features {
    match material.kind() {
        MaterialKind::Lambert => Features::DIFFUSE,
        MaterialKind::Mirror => Features::MIRROR,
        MaterialKind::Thin => Features::THIN,
        MaterialKind::Dielectric => {
            let absorbs = media.get(material.medium as usize).is_some_and(|medium| medium.absorption != [0.0; 3]);
            if absorbs { Features::DIELECTRIC.union(Features::ABSORPTION) } else { Features::DIELECTRIC }
        }
    }
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
    for (triangle, primitive) in scene.triangles.iter().zip(scene.primitives) {
        if scene.materials.get(primitive.material as usize).is_none_or(Material::is_diffuse) {
            continue;
        }
        for p in triangle.iter().filter_map(|&vertex| scene.positions.get(vertex as usize)) {
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
            let primitive = light.primitive as usize;
            let (Some(primitive), Some(triangle)) = (scene.primitives.get(primitive), scene.triangles.get(primitive))
            else {
                return false;
            };
            let mut corners = triangle.iter().filter_map(|&vertex| scene.positions.get(vertex as usize));
            // The triangle's own plane: heights of rounding size do not count as in front.
            corners.any(|&corner| light.flags & Light::BOTH_SIDES != 0 || reach(primitive.normal, corner) > 1e-6)
        }
        // A cone narrower than a half space reaches no further than the half space does.
        Light::SPOT if light.versine_outer <= 1.0 => reach(light.direction, light.position) > 0.0,
        _ => true,
    })
}
