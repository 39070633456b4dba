//! Builds the tables of vertex attributes and textures, of which a scene without any of it has none.

mod fold;
mod mesh;
mod normals;
mod pyramid;
mod radiance;
mod tangents;
mod texel;
mod uvs;

use std::collections::{BTreeMap, BTreeSet};

use photon_core::{Material, MaterialTextures, ShadingTables, Texture, TextureUse};

use self::mesh::Census;
use crate::describe::MaterialDesc;
use crate::mesh::Mesh;
use crate::normalise::{Frame, Geometry};
use crate::texture::{TextureDesc, TextureId, TextureRef};

pub(crate) use self::fold::fold;
#[cfg(feature = "files")]
pub(crate) use self::normals::unit;
pub(crate) use self::radiance::Radiances;

/// The tables that [`ShadingTables`] borrows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tables {
    normals: Vec<[u32; 3]>,
    tangents: Vec<[u32; 3]>,
    colors: Vec<[[u32; 2]; 3]>,
    uvs: Vec<[[f32; 2]; 3]>,
    material_textures: Vec<MaterialTextures>,
    uses: Vec<TextureUse>,
    textures: Vec<Texture>,
}

impl Tables {
    pub(crate) fn view(&self) -> ShadingTables<'_> {
        ShadingTables {
            normals: &self.normals,
            tangents: &self.tangents,
            colors: &self.colors,
            uvs: &self.uvs,
            material_textures: &self.material_textures,
            uses: &self.uses,
            textures: &self.textures,
        }
    }
}

/// The parts of a builder that the tables are made of; validated, and the textures folded.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) meshes: &'a [Mesh],
    pub(crate) materials: &'a [MaterialDesc],
    pub(crate) textures: &'a [TextureDesc],
    pub(crate) frame: Frame,
}

impl Source<'_> {
    /// The texture of a use.
    fn image(&self, used: TextureRef) -> &Texture {
        &self.textures[used.texture.0 as usize].image
    }

    /// Whether there is anything that belongs in the tables.
    pub(crate) fn is_shaded(&self) -> bool {
        let textured = |mesh: &Mesh| self.materials[mesh.material.0 as usize].textures.all().next().is_some();
        self.meshes.iter().any(|mesh| !mesh.attributes.is_empty() || textured(mesh))
    }
}

/// Fills the tables, and [`Material::textures`] of each material.
pub(crate) fn tables(
    source: Source<'_>,
    geometry: &Geometry,
    materials: &mut [Material],
    warnings: &mut Vec<String>,
) -> Tables {
    let mut tables = Tables::default();
    if !source.is_shaded() {
        return tables;
    }
    let in_use: BTreeSet<u32> = geometry.primitives.iter().map(|&(_, material)| material).collect();
    let sets = tables.add_materials(source, &in_use, materials);
    let mut census = Census::default();
    tables.add_meshes(source, geometry, &sets, &mut census);
    census.warn(warnings);
    tables
}

impl Tables {
    /// Adds the textures of the materials in use. Returns where each UV set is in the table.
    fn add_materials(
        &mut self,
        source: Source<'_>,
        in_use: &BTreeSet<u32>,
        materials: &mut [Material],
    ) -> BTreeMap<u32, u32> {
        let used = || in_use.iter().map(|&index| &source.materials[index as usize]);
        let sets: BTreeSet<u32> = used().flat_map(|desc| desc.textures.all()).map(|(_, used)| used.uv_set).collect();
        let sets: BTreeMap<u32, u32> = sets.into_iter().zip(0..).collect();
        let mut indices: BTreeMap<TextureId, u32> = BTreeMap::new();
        for &index in in_use {
            let textures = &source.materials[index as usize].textures;
            if textures.all().next().is_none() {
                continue;
            }
            let mut add = |used: Option<TextureRef>| {
                let Some(used) = used else { return MaterialTextures::NONE };
                let image = source.image(used);
                let texture = *indices.entry(used.texture).or_insert_with(|| {
                    self.textures.push(image.clone());
                    self.textures.len() as u32 - 1
                });
                let transform = uvs::transform(&used, image.wrap);
                self.uses.push(TextureUse { transform, texture_index: texture, uv_set: sets[&used.uv_set] });
                self.uses.len() as u32 - 1
            };
            let textures = MaterialTextures {
                base_color: add(textures.base_color),
                emission: add(textures.emission),
                normal: add(textures.normal),
                normal_scale: textures.normal_scale as f32,
                ..MaterialTextures::default()
            };
            self.material_textures.push(textures);
            materials[index as usize].textures = self.material_textures.len() as u32;
        }
        sets
    }
}
