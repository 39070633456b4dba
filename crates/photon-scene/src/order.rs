//! Order of meshes and lights, from what they are: nothing depends on their order in a file.
//!
//! Of two surfaces at exactly one distance a ray meets that of the lower index, and lights are chosen by their index.

use std::cmp::Ordering;
use std::sync::Arc;

use glam::DVec3;
use photon_core::{Light, Texture};

use crate::describe::MaterialDesc;
use crate::mesh::Mesh;
use crate::texture::{TextureDesc, TexturesDesc};

/// Sorts meshes by what they are. Returns the index that each had before. Meshes that differ in their names at most keep
/// their order; the order of the triangles of a mesh is its own.
pub(crate) fn sort_meshes(meshes: &mut Vec<Mesh>, materials: &[MaterialDesc], textures: &[TextureDesc]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..meshes.len() as u32).collect();
    order.sort_by(|&a, &b| {
        let [a, b] = [a, b].map(|index| &meshes[index as usize]);
        by_geometry(a, b).then_with(|| {
            let [a, b] = [a, b].map(|mesh| &materials[mesh.material.0 as usize]);
            by_material(a, b, textures)
        })
    });
    let mut taken: Vec<Option<Mesh>> = meshes.drain(..).map(Some).collect();
    meshes.extend(order.iter().filter_map(|&index| taken[index as usize].take()));
    order
}

/// Sorts lights that are no surfaces, with their powers, by kind, then by their numbers.
pub(crate) fn sort_lights(lights: &mut [(Light, DVec3)]) {
    lights.sort_by_cached_key(|(light, power)| {
        let words: [u32; size_of::<Light>() / 4] = bytemuck::cast(*light);
        (light.kind, words, power.to_array().map(f64::to_bits))
    });
}

/// Most meshes differ in the first vertex.
fn by_geometry(a: &Mesh, b: &Mesh) -> Ordering {
    let (first, second) = (&a.attributes, &b.attributes);
    compared(&a.positions, &b.positions)
        .then_with(|| a.triangles.cmp(&b.triangles))
        .then_with(|| compared(&first.normals, &second.normals))
        .then_with(|| compared(&first.tangents, &second.tangents))
        .then_with(|| compared(&first.colors, &second.colors))
        .then_with(|| {
            let by_set = first.uvs.iter().zip(&second.uvs).map(|(a, b)| compared(a, b));
            by_set.fold(first.uvs.len().cmp(&second.uvs.len()), Ordering::then)
        })
}

/// Lexicographic order of the bits.
fn compared<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> Ordering {
    let [a, b] = [a, b].map(|rows| rows.as_flattened().iter().map(|part| part.to_bits()));
    a.cmp(b)
}

/// Names and the order of materials and textures do not count.
fn by_material(a: &MaterialDesc, b: &MaterialDesc, textures: &[TextureDesc]) -> Ordering {
    if a.is_alike(b) {
        return Ordering::Equal;
    }
    let text = |desc: &MaterialDesc| {
        let placed: Vec<_> = desc.textures.all().map(|(name, used)| (name, used.uv_set, used.transform)).collect();
        let scales = (desc.textures.normal_scale, desc.textures.clearcoat_normal_scale);
        let plain = MaterialDesc { name: String::new(), textures: TexturesDesc::default(), ..desc.clone() };
        format!("{:?}", (plain, placed, scales))
    };
    text(a).cmp(&text(b)).then_with(|| {
        let images = |desc: &MaterialDesc| -> Vec<_> {
            desc.textures.all().map(|(_, used)| &textures[used.texture.0 as usize].image).collect()
        };
        let pairs = images(a).into_iter().zip(images(b));
        let by_image = pairs.map(|(a, b)| {
            let form = |image: &Texture| format!("{:?}", (image.width, image.format, image.wrap, image.filter));
            let is_shared = Arc::ptr_eq(&a.texels, &b.texels);
            let by_texel = || if is_shared { Ordering::Equal } else { a.texels.cmp(&b.texels) };
            form(a).cmp(&form(b)).then_with(by_texel)
        });
        by_image.fold(Ordering::Equal, Ordering::then)
    })
}
