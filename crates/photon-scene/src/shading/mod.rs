//! Builds the tables of vertex attributes and textures, of which a scene without any of it has none.

mod alpha;
mod anisotropy;
mod clearcoat;
mod diffuse_transmission;
mod fold;
mod mesh;
mod normals;
mod pyramid;
mod radiance;
mod sheen;
mod specular_color;
mod tangents;
mod texel;
mod transmission;
mod uvs;

use std::collections::{BTreeMap, BTreeSet};

use photon_core::{Material, MaterialTextures, OwnedShadingTables, Texture, TextureUse};

use self::mesh::Census;
use crate::describe::MaterialDesc;
use crate::mesh::Mesh;
use crate::normalise::{Frame, Geometry};
use crate::texture::{TextureDesc, TextureId, TextureRef};

pub(crate) use self::alpha::fold_alpha;
#[cfg(feature = "files")]
pub(crate) use self::alpha::uniform_alpha;
pub(crate) use self::fold::fold;
#[cfg(feature = "files")]
pub(crate) use self::fold::uniform;
pub(crate) use self::fold::{is_smooth_metal, simplest};
#[cfg(feature = "files")]
pub(crate) use self::normals::unit;
pub(crate) use self::radiance::Radiances;
#[cfg(feature = "files")]
pub(crate) use self::specular_color::index_of;

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
        let textured = |mesh: &Mesh| has_record(&self.materials[mesh.material.0 as usize]);
        self.meshes.iter().any(|mesh| !mesh.attributes.is_empty() || textured(mesh))
    }
}

/// Whether a material needs an entry of [`MaterialTextures`].
fn has_record(desc: &MaterialDesc) -> bool {
    desc.textures.all().next().is_some()
        || desc.specular_color != [1.0; 3]
        || desc.clearcoat > 0.0
        || desc.anisotropy > 0.0
        || desc.diffuse_transmission > 0.0
        || desc.transmission > 0.0
        || desc.sheen_color != [0.0; 3]
}

/// Fills the tables, and [`Material::textures`] of each material.
pub(crate) fn tables(
    source: Source<'_>,
    geometry: &Geometry,
    materials: &mut [Material],
    warnings: &mut Vec<String>,
) -> OwnedShadingTables {
    let mut tables = OwnedShadingTables::default();
    if !source.is_shaded() {
        return tables;
    }
    let in_use: BTreeSet<u32> = geometry.primitives.iter().map(|&(_, material)| material).collect();
    let sets = add_materials(&mut tables, source, &in_use, materials);
    let mut census = Census::default();
    mesh::add_meshes(&mut tables, source, geometry, &sets, &mut census);
    census.warn(warnings);
    tables
}

/// Adds the textures of the materials in use. Returns where each UV set is in the table.
fn add_materials(
    tables: &mut OwnedShadingTables,
    source: Source<'_>,
    in_use: &BTreeSet<u32>,
    materials: &mut [Material],
) -> BTreeMap<u32, u32> {
    let used = || in_use.iter().map(|&index| &source.materials[index as usize]);
    let sets: BTreeSet<u32> = used().flat_map(|desc| desc.textures.all()).map(|(_, used)| used.uv_set).collect();
    let sets: BTreeMap<u32, u32> = sets.into_iter().zip(0..).collect();
    let mut indices: BTreeMap<TextureId, u32> = BTreeMap::new();
    // Their glass is after all materials, in the same order.
    let mut glass = source.materials.len();
    for &index in in_use {
        let desc = &source.materials[index as usize];
        let textures = &desc.textures;
        if !has_record(desc) {
            continue;
        }
        let mut add = |used: Option<TextureRef>| {
            let Some(used) = used else { return MaterialTextures::NONE };
            let image = source.image(used);
            let texture = *indices.entry(used.texture).or_insert_with(|| {
                tables.textures.push(image.clone());
                tables.textures.len() as u32 - 1
            });
            let transform = uvs::transform(&used, image.wrap);
            tables.uses.push(TextureUse { transform, texture_index: texture, uv_set: sets[&used.uv_set] });
            tables.uses.len() as u32 - 1
        };
        let base_color = add(textures.base_color);
        let anisotropy = anisotropy::record(desc, add(textures.anisotropy));
        let (color, share) = (add(textures.diffuse_transmission_color), add(textures.diffuse_transmission));
        tables.diffuse_transmissions.push(diffuse_transmission::record(desc, color, share));
        let coat = add(textures.clearcoat_normal);
        tables.clearcoat_normals.push(clearcoat::record(desc, coat));
        let share = add(textures.transmission);
        tables.partial_transmissions.push(transmission::record(desc, share, glass as u32));
        let (color, roughness) = (add(textures.sheen_color), add(textures.sheen_roughness));
        tables.sheens.push(sheen::record(desc, color, roughness));
        let textures = MaterialTextures {
            base_color,
            emission: add(textures.emission),
            normal: add(textures.normal),
            normal_scale: textures.normal_scale as f32,
            metallic_roughness: add(textures.metallic_roughness),
            alpha: if textures.alpha == textures.base_color { base_color } else { add(textures.alpha) },
            specular: add(textures.specular),
            specular_color: add(textures.specular_color),
            clearcoat: add(textures.clearcoat),
            clearcoat_roughness: add(textures.clearcoat_roughness),
            clearcoat_factor: desc.clearcoat as f32,
            clearcoat_roughness_factor: desc.clearcoat_roughness as f32,
            specular_color_factor: desc.specular_color.map(|part| part as f32),
            anisotropy: anisotropy::add(&mut tables.anisotropies, anisotropy),
        };
        tables.material_textures.push(textures);
        materials[index as usize].textures = tables.material_textures.len() as u32;
        if desc.transmission > 0.0 {
            materials[glass].textures = tables.material_textures.len() as u32;
            glass += 1;
        }
    }
    if tables.diffuse_transmissions.iter().all(|entry| entry.factor == 0.0) {
        tables.diffuse_transmissions = Vec::new();
    }
    if tables.partial_transmissions.iter().all(|entry| entry.factor == 0.0) {
        tables.partial_transmissions = Vec::new();
    }
    if tables.clearcoat_normals.iter().all(|entry| entry.is_own == 0) {
        tables.clearcoat_normals = Vec::new();
    }
    if tables.sheens.iter().all(|entry| entry.color == [0.0; 3]) {
        tables.sheens = Vec::new();
    }
    sets
}
