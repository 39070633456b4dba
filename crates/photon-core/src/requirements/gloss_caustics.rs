//! Whether caustics are shown in the reflection of glossy surfaces, and of which lights.

use crate::requirements::features::Features;
use crate::requirements::reflects;
use crate::scene::SceneView;
use crate::scene::material::{Material, MaterialKind};
use crate::scene::solids::Solids;
use crate::scene::texture::MaterialTextures;
use crate::settings::{Estimator, Settings};
use crate::shading::rough_glass;

/// Whether caustics are shown in the reflections of glossy surfaces, if there are any. The paper's equation has no BSDF.
pub(super) fn shows_gloss_caustics(settings: &Settings) -> bool {
    settings.caustics && !matches!(settings.estimator, Estimator::Paper(_))
}

/// Whether `scene` can have caustics that only photons find in the reflection of glossy surfaces.
pub(crate) fn has_gloss_caustics(scene: &SceneView<'_>) -> bool {
    scene.materials_in_use().any(|material| is_glossy(material, scene))
        && Features::of(scene).intersects(Features::DELTA_LIGHTS)
        && has_perfect_specular(scene)
}

/// The largest [`Settings::caustic_roughness`] with which reflections of `scene` can have caustics of lights with extent: an
/// upper bound on the roughness of the narrowest part of its glossy reflections. Negative if there is no such light, or no
/// perfect mirror and no smooth glass.
#[must_use]
pub fn roughest_caustic(scene: &SceneView<'_>) -> f32 {
    let glossy = scene.materials_in_use().filter(|material| is_glossy(material, scene));
    let roughest = glossy.map(|material| most_narrowest(material, scene)).fold(-1.0, f32::max);
    let with_extent = Features::AREA_LIGHTS.union(Features::ENVIRONMENT);
    let is_lit = || Features::of(scene).intersects(with_extent) && has_perfect_specular(scene);
    if roughest >= 0.0 && is_lit() { roughest } else { -1.0 }
}

fn is_glossy(material: &Material, scene: &SceneView<'_>) -> bool {
    material.kind() == MaterialKind::Glossy && reflects(material, scene)
}

/// An upper bound on [`crate::gloss_caustics::narrowest`] over the points of a material.
fn most_narrowest(material: &Material, scene: &SceneView<'_>) -> f32 {
    let used = |texture: u32| texture != MaterialTextures::NONE;
    let layers = scene.shading.layers(material);
    let Some(textures) = layers.textures else { return material.roughness };
    // Texels of a host may be above 1; where a texture has a weight of 0, that part is absent.
    let mut most = if used(textures.metallic_roughness) { f32::INFINITY } else { material.roughness };
    if let Some(coat) = layers.clearcoat.filter(|of| !used(of.clearcoat) && !used(of.clearcoat_roughness)) {
        most = most.min(coat.clearcoat_roughness_factor);
    }
    if let Some(sheen) = layers.sheen.filter(|sheen| !used(sheen.color_texture) && !used(sheen.roughness_texture)) {
        most = most.min(sheen.roughness);
    }
    most
}

/// Whether a surface can be a perfect mirror or smooth glass.
fn has_perfect_specular(scene: &SceneView<'_>) -> bool {
    // Rough glass is smooth where a texture makes it so, and between equal media, which solids that overlap may have.
    let nested = || Solids::of(scene).overlap();
    scene.materials_in_use().any(|material| match material.kind() {
        MaterialKind::Mirror => true,
        MaterialKind::Thin => !material.is_rough_glass() || material.textures != 0,
        MaterialKind::Dielectric => {
            let is_matched = (material.ior - 1.0).abs() < rough_glass::MIN_CONTRAST;
            !material.is_rough_glass() || material.textures != 0 || is_matched || nested()
        }
        MaterialKind::Lambert | MaterialKind::Glossy => false,
    })
}
