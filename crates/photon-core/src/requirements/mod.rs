//! What a renderer must support to render a scene: derived from scene and settings, never declared.

pub(crate) mod explain;
pub(crate) mod features;
pub(crate) mod gloss_caustics;
pub(crate) mod map_kind;
pub(crate) mod map_place;
pub(crate) mod photon_format;

use crate::error::{Error, Result};
use crate::requirements::features::Features;
use crate::requirements::gloss_caustics::{has_gloss_caustics, roughest_caustic, shows_gloss_caustics};
use crate::requirements::map_kind::{MapKind, PerMap};
use crate::requirements::photon_format::PhotonFormat;
use crate::scene::SceneView;
use crate::scene::light::Light;
use crate::scene::material::{Material, MaterialKind};
use crate::scene::media::MediaFeatures;
use crate::scene::medium::Medium;
use crate::scene::solids::{Solids, boundary_media};
use crate::scene::texture::{MaterialTextures, ShadingTables};
use crate::settings::{CausticPhotons, Direct, Indirect, Settings};
use crate::shading::light_sampler::MAX_LIGHTS;

/// The features, maps and stages that are needed for a scene.
///
/// A pure function of scene and settings. What is not needed is not compiled into a kernel, not allocated
/// and not built. Requirements that lack something are an error; those that include too much do not change
/// a bit of the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Requirements {
    /// Lobes and lights.
    pub features: Features,
    /// What nested or overlapping solids need.
    pub media: MediaFeatures,
    /// Which photon maps are filled.
    pub maps: PerMap<bool>,
    /// Whether the caustic map is filled by separate, aimed paths, unless [`crate::ProjectionMap`] finds
    /// that this is not worthwhile.
    pub aimed: bool,
    /// Light may reach glossy surfaces by way of perfect mirrors or smooth glass, and is shown in their reflection from
    /// photons: that of point, spot and directional lights, at least: [`crate::GlossCaustics`].
    pub gloss_caustics: bool,
    /// Reflections at least as rough as [`Settings::caustic_roughness`] show such light of all lights; implies
    /// `gloss_caustics`.
    pub gloss_caustics_of_all_lights: bool,
    /// Direct light is computed with shadow rays.
    pub shadow_rays: bool,
    /// Shadow rays from triangles with vertex normals start outside the mesh: [`crate::shadow_terminator`].
    pub terminator_offset: bool,
    /// Indirect light is computed by final gathering.
    pub final_gather: bool,
    /// Photon format of the maps.
    pub photon_format: PhotonFormat,
}

impl Requirements {
    /// The smallest requirements that render `scene` exactly. In a scene that [`SceneView::validate`]
    /// refuses, indices out of range are skipped.
    #[must_use]
    pub fn of(scene: &SceneView<'_>, settings: &Settings) -> Self {
        let receives = has_receiver(scene);
        let maps = PerMap::from_fn(|kind| match kind {
            MapKind::Caustic => receives && reads(settings, kind) && specular_is_lit(scene),
            MapKind::Direct | MapKind::Global => receives && reads(settings, kind),
        });
        let features = Features::of(scene);
        let shadow_rays = receives && settings.direct == Direct::Nee;
        let samples_lights = shadow_rays || features.intersects(Features::FOLLOWED);
        let shows = maps[MapKind::Caustic] && shows_gloss_caustics(settings);
        let all_lights = shows && settings.caustic_roughness.is_some_and(|least| least <= roughest_caustic(scene));
        Self {
            features,
            media: Solids::of(scene).features(),
            maps,
            aimed: maps[MapKind::Caustic] && settings.caustic_photons != CausticPhotons::Shared,
            gloss_caustics: shows && (all_lights || has_gloss_caustics(scene)),
            gloss_caustics_of_all_lights: all_lights,
            shadow_rays,
            terminator_offset: settings.terminator_offset && samples_lights && !scene.shading.normals.is_empty(),
            final_gather: receives && settings.indirect == Indirect::Gather,
            photon_format: PhotonFormat::of(scene, settings),
        }
    }

    /// Everything that the settings allow, for any scene: the same picture, with more work.
    #[must_use]
    pub fn everything(settings: &Settings) -> Self {
        let maps = PerMap::from_fn(|kind| reads(settings, kind));
        Self {
            features: Features::ALL,
            media: MediaFeatures::ALL,
            maps,
            aimed: maps[MapKind::Caustic] && settings.caustic_photons != CausticPhotons::Shared,
            gloss_caustics: shows_gloss_caustics(settings),
            gloss_caustics_of_all_lights: shows_gloss_caustics(settings) && settings.caustic_roughness.is_some(),
            shadow_rays: settings.direct == Direct::Nee,
            terminator_offset: settings.terminator_offset,
            final_gather: settings.indirect == Indirect::Gather,
            photon_format: PhotonFormat::Full,
        }
    }

    /// Whether lights are sampled: by shadow rays from queries, or from the glossy surfaces and the rough glass of a scene that has the
    /// features `present`.
    #[must_use]
    pub fn samples_lights(&self, present: Features) -> bool {
        self.shadow_rays || present.intersects(Features::FOLLOWED)
    }

    /// [`Settings::caustic_roughness`], if some reflection may show caustics of all lights. In a scene whose
    /// [`roughest_caustic`] is below it, none does.
    #[must_use]
    pub fn caustic_roughness(&self, settings: &Settings) -> Option<f32> {
        settings.caustic_roughness.filter(|_| self.gloss_caustics_of_all_lights)
    }

    /// Whether no other map than that of aimed photons is filled.
    pub(crate) fn aims_alone(&self) -> bool {
        self.maps.iter().all(|(kind, &filled)| kind.is_aimed() || !filled)
    }

    /// Whether [`crate::TransportBackend::prepare`] makes the same of a scene for `other`.
    pub(crate) fn prepares_like(&self, other: &Self) -> bool {
        let read = |of: &Self| (of.features, of.media, of.shadow_rays, of.terminator_offset);
        read(self) == read(other)
    }

    /// Checks that stages built for `self` support the features `needed`.
    ///
    /// # Errors
    /// [`Error::MissingFeatures`].
    pub fn check(&self, needed: Features) -> Result<()> {
        let missing = needed.without(self.features);
        if missing == Features::NONE { Ok(()) } else { Err(Error::MissingFeatures { missing }) }
    }

    /// Checks that stages built for `self` can trace paths through media that need `needed`.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`].
    pub fn check_media(&self, needed: MediaFeatures) -> Result<()> {
        if self.media.contains(needed) {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "the media features of the stages",
            value: self.media.to_string(),
            hint: "media of this scene are nested, have boundaries, scatter or disperse light; derive the requirements from it",
        })
    }

    /// Checks that maps built for `self` store the photon format `needed`.
    ///
    /// # Errors
    /// [`Error::InvalidSetting`].
    pub fn check_format(&self, needed: PhotonFormat) -> Result<()> {
        if self.photon_format >= needed {
            return Ok(());
        }
        Err(Error::InvalidSetting {
            name: "the photon format of the maps",
            value: self.photon_format.name().into(),
            hint: "more fields are needed; derive the requirements from this scene and these settings",
        })
    }
}

impl Features {
    /// The lobes of the materials in use, and the lights: what kernels must support to render `scene`.
    /// Indices out of range are skipped.
    #[must_use]
    pub fn of(scene: &SceneView<'_>) -> Self {
        let materials = scene.materials_in_use().map(|material| material_features(material, scene));
        let all = materials.chain(scene.lights.iter().map(light_features)).fold(Self::NONE, Self::union);
        let is_ambient = scene.media.first().is_some_and(Medium::attenuates);
        let is_bounded = boundary_media(scene).any(Medium::attenuates);
        let ambient = if is_ambient || is_bounded { Self::ABSORPTION } else { Self::NONE };
        let lit = if scene.lights.is_empty() { Self::TEXTURED_LIGHTS } else { Self::NONE };
        let many = if scene.lights.len() > MAX_LIGHTS { Self::LIGHT_TREE } else { Self::NONE };
        let portals = !scene.portals.is_empty() && all.intersects(Self::INFINITE_LIGHTS);
        let through = if portals { Self::PORTALS } else { Self::NONE };
        all.without(lit).union(many).union(through).union(ambient)
    }
}

/// Whether a medium scatters light, or some surface is neither a perfect mirror, smooth glass nor black: it stores photons, or
/// reflects light that shadow rays find. Without one, camera paths alone find the light.
pub(crate) fn has_receiver(scene: &SceneView<'_>) -> bool {
    if Solids::of(scene).features().contains(MediaFeatures::SCATTERING) {
        return true;
    }
    scene.primitives.iter().flat_map(|primitive| scene.materials_of(primitive)).any(|material| {
        let scatters = material.is_diffuse() && material.albedo.iter().any(|&a| a > 0.0);
        scatters || material.kind() == MaterialKind::Glossy || material.is_rough_glass()
    })
}

/// Whether the settings read a map: at visible points, or at the hits of final-gather rays.
fn reads(settings: &Settings, kind: MapKind) -> bool {
    let gather = settings.indirect == Indirect::Gather;
    match kind {
        MapKind::Direct => settings.direct == Direct::Photons || gather,
        MapKind::Caustic => settings.caustics || gather,
        MapKind::Global => settings.indirect != Indirect::None,
    }
}

/// Whether camera paths and photons go on from a material by reflection or refraction: a sheet that transmits diffusely may
/// have a base alone.
pub(crate) fn reflects(material: &Material, scene: &SceneView<'_>) -> bool {
    let layers = scene.shading.layers(material);
    let is_matte = material.flags & Material::DIFFUSE_TRANSMISSION != 0
        && (material.metallic, material.specular) == (0.0, 0.0)
        && layers.clearcoat.is_none()
        && layers.sheen.is_none();
    material.is_specular() && !is_matte
}

/// The features that a material of `scene` needs.
#[must_use]
pub fn material_features(material: &Material, scene: &SceneView<'_>) -> Features {
    let lobes = match material.kind() {
        MaterialKind::Lambert => Features::DIFFUSE,
        MaterialKind::Mirror => Features::MIRROR,
        MaterialKind::Thin => Features::THIN,
        MaterialKind::Glossy if material.is_diffuse() => Features::GLOSSY.union(Features::DIFFUSE),
        MaterialKind::Glossy => Features::GLOSSY,
        MaterialKind::Dielectric => {
            let absorbs = scene.media.get(material.medium as usize).is_some_and(Medium::attenuates);
            if absorbs { Features::DIELECTRIC.union(Features::ABSORPTION) } else { Features::DIELECTRIC }
        }
    };
    let rough = if material.is_rough_glass() { Features::ROUGH_GLASS } else { Features::NONE };
    let shading = shading_features(material, &scene.shading);
    let alpha = if material.has_alpha() { alpha_features(material) } else { Features::NONE };
    let partial = if material.has_partial_transmission() { Features::PARTIAL_TRANSMISSION } else { Features::NONE };
    lobes.union(rough).union(shading).union(alpha).union(partial)
}

/// The features that the vertex attributes and textures of a material need.
fn shading_features(material: &Material, tables: &ShadingTables<'_>) -> Features {
    let when = |holds: bool, features: Features| if holds { features } else { Features::NONE };
    let attributes = when(!tables.normals.is_empty(), Features::SHADING_NORMALS)
        .union(when(!tables.colors.is_empty(), Features::VERTEX_COLORS));
    let layers = tables.layers(material);
    let Some(textures) = layers.textures else { return attributes };
    let used = |index: u32| index != MaterialTextures::NONE;
    let is_glossy = material.kind() == MaterialKind::Glossy;
    attributes
        .union(when(layers.is_textured(), Features::TEXTURES))
        .union(when(is_glossy && textures.has_specular_color(), Features::SPECULAR_COLORS))
        .union(when(is_glossy && layers.clearcoat.is_some(), Features::CLEARCOAT))
        .union(when(is_glossy && layers.clearcoat.is_some() && material.is_emissive(), Features::COATED_LIGHTS))
        .union(when(is_glossy && layers.sheen.is_some(), Features::SHEEN))
        .union(when(is_glossy && layers.anisotropy.is_some(), Features::ANISOTROPY))
        .union(when(is_glossy && layers.clearcoat_normal.is_some(), Features::CLEARCOAT_NORMALS))
        .union(when(is_glossy && layers.diffuse_transmission.is_some(), Features::DIFFUSE_TRANSMISSION))
        .union(when(used(textures.normal), Features::NORMAL_MAPS.union(Features::SHADING_NORMALS)))
        .union(when(used(textures.emission) && material.is_emissive(), Features::TEXTURED_LIGHTS))
}

/// The features that a material with alpha needs.
fn alpha_features(material: &Material) -> Features {
    if material.is_emissive() { Features::ALPHA.union(Features::TEXTURED_LIGHTS) } else { Features::ALPHA }
}

/// The features that a light needs.
#[must_use]
pub fn light_features(light: &Light) -> Features {
    match light.kind {
        Light::POINT => Features::POINT_LIGHTS,
        Light::SPOT => Features::SPOT_LIGHTS,
        Light::DIRECTIONAL if light.is_sun() => Features::DIRECTIONAL_LIGHTS.union(Features::SUN),
        Light::DIRECTIONAL => Features::DIRECTIONAL_LIGHTS,
        Light::ENVIRONMENT => Features::ENVIRONMENT,
        _ => Features::AREA_LIGHTS,
    }
}

/// Whether a light could reach a specular surface: whether the bounding box of all specular triangles is
/// not completely behind every light. Conservative: may return true for unlit surfaces, and ignores
/// occlusion.
fn specular_is_lit(scene: &SceneView<'_>) -> bool {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for (triangle, primitive) in scene.triangles.iter().zip(scene.primitives) {
        if !scene.materials_of(primitive).any(|material| reflects(material, scene)) {
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
    // Height over a plane of the corner of the box that is farthest along the normal.
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
            // The triangle's own plane: heights of the size of rounding errors do not count as in front.
            corners.any(|&corner| light.flags & Light::BOTH_SIDES != 0 || reach(primitive.normal, corner) > 1e-6)
        }
        // A cone of less than a hemisphere reaches no farther than the hemisphere.
        Light::SPOT if light.versine_outer <= 1.0 => reach(light.direction, light.position) > 0.0,
        _ => true,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_prepared_for_features_media_and_shadow_rays() {
        let all = Requirements::everything(&Settings::default());
        let others = [
            Requirements { features: Features::NONE, ..all },
            Requirements { media: MediaFeatures::NONE, ..all },
            Requirements { shadow_rays: !all.shadow_rays, ..all },
            Requirements { terminator_offset: !all.terminator_offset, ..all },
        ];
        assert!(others.iter().all(|other| !all.prepares_like(other)));
        let same = Requirements {
            maps: PerMap::from_fn(|_| false),
            aimed: !all.aimed,
            gloss_caustics: !all.gloss_caustics,
            final_gather: !all.final_gather,
            photon_format: PhotonFormat::Mono,
            ..all
        };
        assert!(all.prepares_like(&same));
    }
}
