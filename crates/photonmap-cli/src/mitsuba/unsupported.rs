//! What is not written for Mitsuba is refused, so that nothing is lost silently.

use photon_core::{Material, MaterialTextures};
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
    let textures =
        |index: u32| index.checked_sub(1).and_then(|index| view.shading.material_textures.get(index as usize));
    for (name, material) in scene.material_names().zip(view.materials) {
        if material.has_alpha() {
            return refused(
                format!("the alpha of material '{name}'"),
                "write a .glb, which has it, or make the material opaque (alpha = 1 in an override file)",
            );
        }
        let Some(textures) = textures(material.textures) else { continue };
        if textures.clearcoat_factor > 0.0 {
            return refused(
                format!("the clearcoat of material '{name}'"),
                "write a .glb, which has it, or remove it (clearcoat = 0 in an override file)",
            );
        }
        if textures.anisotropy != MaterialTextures::NONE {
            return refused(
                format!("the anisotropy of material '{name}'"),
                "write a .glb, which has it, or remove it (anisotropy = 0 in an override file)",
            );
        }
        if material.flags & Material::DIFFUSE_TRANSMISSION != 0 {
            return refused(
                format!("the diffuse transmission of material '{name}'"),
                "write a .glb, which has it, or remove it (diffuse_transmission = 0 in an override file)",
            );
        }
        let sheen = view.shading.sheens.get(material.textures as usize - 1);
        if sheen.is_some_and(|sheen| sheen.color != [0.0; 3]) {
            return refused(
                format!("the sheen of material '{name}'"),
                "write a .glb, which has it, or remove it (sheen = 0 in an override file)",
            );
        }
        let share = view.shading.partial_transmissions.get(material.textures as usize - 1);
        let uses = [
            ("transmission", share.map_or(MaterialTextures::NONE, |share| share.factor_texture)),
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
