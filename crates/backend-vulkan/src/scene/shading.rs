//! Vertex attributes and textures on the device.

use bytemuck::{Pod, Zeroable};
use photon_core::texture::byte_values;
use photon_core::{AlbedoTable, Features, Result, RoughGlassTable, SceneView, SheenTable};

use super::{BLOCK, Upload};

host_struct! {
    /// `ShadingRef` of scene.glsl.
    struct ShadingRef {
        normals: u64,
        tangents: u64,
        colors: u64,
        uvs: u64,
        material_textures: u64,
        uses: u64,
        textures: u64,
        values: u64,
        albedos: u64,
        has_normals: u32,
        rough_ratios: u32,
        anisotropies: u64,
        diffuse_transmissions: u64,
        clearcoat_normals: u64,
        sheens: u64,
        partial_transmissions: u64,
        /// The record is a multiple of 16 bytes.
        reserved: u64,
    }
}

host_struct! {
    /// `Texture` of texture.glsl.
    struct Texture {
        texels: u64,
        width: u32,
        height: u32,
        format: u32,
        wrap_u: u32,
        wrap_v: u32,
        filter_mode: u32,
    }
}

/// Uploads the tables in [`SceneView::shading`], those of triangles in BVH order; returns the address of their record,
/// or 0 for a scene without any.
pub(super) fn upload(upload: &mut Upload<'_>, view: &SceneView<'_>, order: &[u32]) -> Result<u64> {
    let tables = &view.shading;
    let followed = Features::of(view).intersects(Features::FOLLOWED);
    if tables.is_empty() && !followed {
        return Ok(0);
    }
    let mut record = ShadingRef::zeroed();
    record.has_normals = u32::from(!tables.normals.is_empty());
    record.normals = attribute(upload, "vertex normals", tables.normals, order)?;
    record.tangents = attribute(upload, "vertex tangents", tables.tangents, order)?;
    record.colors = attribute(upload, "vertex colours", tables.colors, order)?;
    record.uvs = uvs(upload, view, order)?;
    if !tables.material_textures.is_empty() {
        let images = tables.textures.iter().map(|texture| image(upload, texture)).collect::<Result<Vec<_>>>()?;
        // A material may have factors without textures.
        if !images.is_empty() {
            record.textures = upload.table("textures", &images)?;
            record.uses = upload.table("textures", tables.uses)?;
        }
        record.material_textures = upload.table("textures", tables.material_textures)?;
        if !tables.anisotropies.is_empty() {
            record.anisotropies = upload.table("textures", tables.anisotropies)?;
        }
        if !tables.diffuse_transmissions.is_empty() {
            record.diffuse_transmissions = upload.table("textures", tables.diffuse_transmissions)?;
        }
        if !tables.clearcoat_normals.is_empty() {
            record.clearcoat_normals = upload.table("textures", tables.clearcoat_normals)?;
        }
        if !tables.sheens.is_empty() {
            record.sheens = upload.table("textures", tables.sheens)?;
        }
        if !tables.partial_transmissions.is_empty() {
            record.partial_transmissions = upload.table("textures", tables.partial_transmissions)?;
        }
        record.values = upload.table("textures", byte_values().as_flattened())?;
    }
    if followed {
        let glass = RoughGlassTable::new(view)?;
        record.rough_ratios = glass.len() as u32;
        let mut entries: Vec<[f32; 2]> = AlbedoTable::get().entries().iter().copied().chain(glass.all()).collect();
        if Features::of(view).contains(Features::SHEEN) {
            entries.extend_from_slice(bytemuck::cast_slice(SheenTable::get().entries()));
        }
        record.albedos = upload.table("albedos of glossy surfaces", &entries)?;
    }
    upload.table("scene", &[record])
}

/// A table with an entry for each triangle, in BVH order; 0 if it is empty.
fn attribute<T: Pod + Send + Sync>(
    upload: &mut Upload<'_>,
    label: &'static str,
    table: &[T],
    order: &[u32],
) -> Result<u64> {
    if table.is_empty() {
        return Ok(0);
    }
    upload.by_triangle(label, order, |id| table[id as usize])
}

/// The UV sets, one after another, each in BVH order.
fn uvs(upload: &mut Upload<'_>, view: &SceneView<'_>, order: &[u32]) -> Result<u64> {
    let (table, triangles) = (view.shading.uvs, view.triangles.len());
    if table.is_empty() {
        return Ok(0);
    }
    let address = upload.room::<[[f32; 2]; 3]>("texture coordinates", table.len())?;
    for (set, table) in table.chunks(triangles).enumerate() {
        for (block, ids) in order.chunks(BLOCK).enumerate() {
            let part: Vec<[[f32; 2]; 3]> = ids.iter().map(|&id| table[id as usize]).collect();
            upload.write(set * triangles + block * BLOCK, &part)?;
        }
    }
    Ok(address)
}

fn image(upload: &mut Upload<'_>, texture: &photon_core::Texture) -> Result<Texture> {
    Ok(Texture {
        texels: upload.table("textures", &texture.texels)?,
        width: texture.width,
        height: texture.height,
        format: texture.format as u32,
        wrap_u: texture.wrap[0] as u32,
        wrap_v: texture.wrap[1] as u32,
        filter_mode: texture.filter as u32,
    })
}
