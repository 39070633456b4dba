//! What is not written for Mitsuba is refused, so that nothing is lost silently.

use photon_core::MaterialTextures;
use photon_scene::Scene;

use crate::fault::Fault;

/// Checks the whole scene.
///
/// # Errors
/// [`Fault::Input`], which names the first material with a texture, or the vertex attributes.
pub(super) fn refuse(scene: &Scene) -> Result<(), Fault> {
    let view = scene.view();
    let refused =
        |what: String, remedy: &str| Err(Fault::input(format!("{what} cannot be written for Mitsuba; {remedy}")));
    for (name, material) in scene.material_names().zip(view.materials) {
        if material.has_alpha() {
            return refused(
                format!("the alpha of material '{name}'"),
                "write a .glb, which has it, or make the material opaque (alpha = 1 in an override file)",
            );
        }
        let layers = view.shading.layers(material);
        let Some(textures) = layers.textures else { continue };
        let present = [
            ("clearcoat", layers.clearcoat.is_some()),
            ("anisotropy", layers.anisotropy.is_some()),
            ("diffuse_transmission", layers.diffuse_transmission.is_some()),
            ("sheen", layers.sheen.is_some()),
        ];
        if let Some((key, _)) = present.into_iter().find(|(_, is_present)| *is_present) {
            return refused(
                format!("the {} of material '{name}'", key.replace('_', " ")),
                &format!("write a .glb, which has it, or remove it ({key} = 0 in an override file)"),
            );
        }
        let uses = [
            ("transmission", layers.partial_transmission.map_or(MaterialTextures::NONE, |share| share.factor_texture)),
            ("base colour", textures.base_color),
            ("emission", textures.emission),
            ("normal", textures.normal),
            ("metallic-roughness", textures.metallic_roughness),
            ("specular colour", textures.specular_color),
        ];
        if let Some((slot, _)) = uses.into_iter().find(|(_, used)| *used != MaterialTextures::NONE) {
            return refused(
                format!("the {slot} texture of material '{name}'"),
                "write a .glb, which has it, or remove it first",
            );
        }
    }
    if !view.shading.normals.is_empty() {
        return refused("vertex normals".to_owned(), "write a .glb, which has them, or remove them first");
    }
    if !view.shading.colors.is_empty() {
        return refused("vertex colours".to_owned(), "write a .glb, which has them, or remove them first");
    }
    Ok(())
}
