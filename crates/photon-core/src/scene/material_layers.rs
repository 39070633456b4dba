//! The entries of a material in the shading tables.

use crate::scene::material::Material;
use crate::scene::texture::{
    Anisotropy, ClearcoatNormal, DiffuseTransmission, MaterialTextures, PartialTransmission, ShadingTables, SheenLayer,
};

/// Entries of [`ShadingTables`] for one material. `None` without an entry, and for one that has no effect.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct MaterialLayers<'a> {
    /// Its textures.
    pub textures: Option<&'a MaterialTextures>,
    /// The entry with its clearcoat.
    pub clearcoat: Option<&'a MaterialTextures>,
    /// Normals of the clearcoat that differ from those of the surface.
    pub clearcoat_normal: Option<&'a ClearcoatNormal>,
    /// Its anisotropy.
    pub anisotropy: Option<&'a Anisotropy>,
    /// Its diffuse transmission.
    pub diffuse_transmission: Option<&'a DiffuseTransmission>,
    /// The share of it that is glass.
    pub partial_transmission: Option<&'a PartialTransmission>,
    /// Its sheen.
    pub sheen: Option<&'a SheenLayer>,
}

impl<'a> ShadingTables<'a> {
    /// The entries of a material.
    #[must_use]
    pub fn layers(&self, material: &Material) -> MaterialLayers<'a> {
        let Some(index) = (material.textures as usize).checked_sub(1) else { return MaterialLayers::default() };
        let Some(textures) = self.material_textures.get(index) else { return MaterialLayers::default() };
        let clearcoat = Some(textures).filter(|textures| textures.clearcoat_factor > 0.0);
        let clearcoat_normal = self.clearcoat_normals.get(index).filter(|normal| normal.is_own != 0);
        MaterialLayers {
            textures: Some(textures),
            clearcoat,
            clearcoat_normal: clearcoat_normal.filter(|_| clearcoat.is_some()),
            anisotropy: self.anisotropies.get(textures.anisotropy as usize),
            diffuse_transmission: self.diffuse_transmissions.get(index).filter(|entry| entry.factor > 0.0),
            partial_transmission: self.partial_transmissions.get(index).filter(|entry| entry.factor > 0.0),
            sheen: self.sheens.get(index).filter(|sheen| sheen.color != [0.0; 3]),
        }
    }
}

impl MaterialLayers<'_> {
    /// Whether a texture is read that is no normal map of the surface and no alpha.
    pub(crate) fn is_textured(&self) -> bool {
        let used = |texture: u32| texture != MaterialTextures::NONE;
        let textures = self.textures.is_some_and(|of| {
            [
                of.base_color,
                of.emission,
                of.metallic_roughness,
                of.specular,
                of.specular_color,
                of.clearcoat,
                of.clearcoat_roughness,
            ]
            .into_iter()
            .any(used)
        });
        textures
            || self.clearcoat_normal.is_some_and(|of| used(of.texture))
            || self.anisotropy.is_some_and(|of| used(of.texture))
            || self.diffuse_transmission.is_some_and(|of| used(of.color_texture) || used(of.factor_texture))
            || self.sheen.is_some_and(|of| used(of.color_texture) || used(of.roughness_texture))
    }

    /// Whether the colours of layers are grey; those of textures and of the specular reflection are not looked at.
    pub(crate) fn are_grey(&self) -> bool {
        let is_grey = |[r, g, b]: [f32; 3]| r.to_bits() == g.to_bits() && g.to_bits() == b.to_bits();
        self.diffuse_transmission.is_none_or(|of| is_grey(of.color)) && self.sheen.is_none_or(|of| is_grey(of.color))
    }
}
