//! Validation of vertex attributes and textures.

use super::{Check, each, index, require};
use crate::error::{Error, Result};
use crate::scene::SceneView;
use crate::scene::material::{Material, MaterialKind};
use crate::scene::texture::{
    Anisotropy, ClearcoatNormal, DiffuseTransmission, MaterialTextures, PartialTransmission, ShadingTables, SheenLayer,
    Texture, TextureUse,
};

/// Largest number of texels in a row, and of rows: their indices stay exact in `f32`.
const MAX_TEXELS: u32 = 65_536;

/// Checks [`SceneView::shading`] and the references of materials to it.
pub(super) fn check(view: &SceneView<'_>) -> Result<()> {
    let tables = &view.shading;
    let triangles = view.triangles.len();
    let whole = |what, length: usize, multiple: bool| {
        let fits =
            length == 0 || length == triangles || (multiple && triangles > 0 && length.is_multiple_of(triangles));
        if fits {
            return Ok(());
        }
        let value = format!("{length} entries for {triangles} triangles");
        Err(Error::InvalidScene { what, value, hint: "it must be empty, or have one entry for each triangle" })
    };
    whole("shading.normals", tables.normals.len(), false)?;
    whole("shading.tangents", tables.tangents.len(), false)?;
    whole("shading.colors", tables.colors.len(), false)?;
    whole("shading.uvs", tables.uvs.len(), true)?;
    let sets = tables.uvs.len().checked_div(triangles).unwrap_or(0);
    each("texture coordinate", tables.uvs, |corners| {
        require(corners.as_flattened().iter().all(|c| c.is_finite()), || format!("{corners:?} must be finite"))
    })?;
    each("texture", tables.textures, check_texture)?;
    each("texture use", tables.uses, |used| check_use(used, tables.textures.len(), sets))?;
    each("anisotropy", tables.anisotropies, |anisotropy| check_anisotropy(anisotropy, tables.uses.len()))?;
    each("material_textures entry", tables.material_textures, |material| check_material(material, tables))?;
    for (what, count) in [
        ("shading.diffuse_transmissions", tables.diffuse_transmissions.len()),
        ("shading.clearcoat_normals", tables.clearcoat_normals.len()),
        ("shading.sheens", tables.sheens.len()),
        ("shading.partial_transmissions", tables.partial_transmissions.len()),
    ] {
        let entries = tables.material_textures.len();
        if count != 0 && count != entries {
            let value = format!("{count} entries for {entries} of material_textures");
            return Err(Error::InvalidScene { what, value, hint: "it must be empty, or have one for each" });
        }
    }
    each("clearcoat_normals entry", tables.clearcoat_normals, |entry| check_clearcoat(entry, tables))?;
    each("sheens entry", tables.sheens, |entry| check_sheen(entry, tables.uses.len()))?;
    each("partial_transmissions entry", tables.partial_transmissions, |entry| {
        check_partial(entry, tables.uses.len(), view.materials)
    })?;
    each("diffuse_transmissions entry", tables.diffuse_transmissions, |entry| {
        check_transmission(entry, tables.uses.len())
    })?;
    each("material", view.materials, |material| {
        let (textures, count) = (material.textures as usize, tables.material_textures.len());
        require(textures <= count, || format!("its textures {textures} are out of range, {count} entries exist"))?;
        let entry = textures.checked_sub(1).and_then(|index| tables.diffuse_transmissions.get(index));
        check_glass(material, view)?;
        // The glass of a surface shares the entry of the surface, and does not read it.
        let transmits = entry.is_some_and(|entry| entry.factor > 0.0) && !material.kind().transmits();
        let is_flagged = material.flags & Material::DIFFUSE_TRANSMISSION != 0;
        require(transmits == is_flagged && (!transmits || material.kind() == MaterialKind::Glossy), || {
            "it must be glossy and have Material::DIFFUSE_TRANSMISSION, or its entry of diffuse_transmissions the factor 0"
                .to_owned()
        })
    })
}

fn check_clearcoat(of: &ClearcoatNormal, tables: &ShadingTables<'_>) -> Check {
    let (scale, used, uses) = (of.scale, of.texture, tables.uses.len());
    require(scale.is_finite(), || format!("its scale {scale} must be finite"))?;
    require(used == MaterialTextures::NONE || (used as usize) < uses, || {
        format!("its texture {used} is out of range, {uses} uses exist")
    })?;
    require(used == MaterialTextures::NONE || !tables.tangents.is_empty(), || {
        "it has a normal map, but the scene has no tangents".to_owned()
    })
}

fn check_sheen(of: &SheenLayer, uses: usize) -> Check {
    let (roughness, color) = (of.roughness, of.color);
    require((0.0..=1.0).contains(&roughness), || format!("its roughness {roughness} must lie between 0 and 1"))?;
    require(color.iter().all(|part| (0.0..=1.0).contains(part)), || {
        format!("its color {color:?} must lie between 0 and 1")
    })?;
    [of.color_texture, of.roughness_texture].into_iter().try_for_each(|used| {
        require(used == MaterialTextures::NONE || (used as usize) < uses, || {
            format!("its texture {used} is out of range, {uses} uses exist")
        })
    })
}

fn check_transmission(of: &DiffuseTransmission, uses: usize) -> Check {
    let (factor, color) = (of.factor, of.color);
    require((0.0..=1.0).contains(&factor), || format!("its factor {factor} must lie between 0 and 1"))?;
    require(color.iter().all(|part| (0.0..=1.0).contains(part)), || {
        format!("its color {color:?} must lie between 0 and 1")
    })?;
    [of.color_texture, of.factor_texture].into_iter().try_for_each(|used| {
        require(used == MaterialTextures::NONE || (used as usize) < uses, || {
            format!("its texture {used} is out of range, {uses} uses exist")
        })
    })
}

fn check_partial(of: &PartialTransmission, uses: usize, materials: &[Material]) -> Check {
    let (factor, used) = (of.factor, of.factor_texture);
    require((0.0..=1.0).contains(&factor), || format!("its factor {factor} must lie between 0 and 1"))?;
    require(used == MaterialTextures::NONE || (used as usize) < uses, || {
        format!("its texture {used} is out of range, {uses} uses exist")
    })?;
    index("material", of.glass, materials.len())
}

/// Checks the glass of a material that is partly glass.
fn check_glass(material: &Material, view: &SceneView<'_>) -> Check {
    if !material.has_partial_transmission() {
        return Ok(());
    }
    require(matches!(material.kind(), MaterialKind::Lambert | MaterialKind::Glossy), || {
        "it has Material::PARTIAL_TRANSMISSION, but only Lambertian and glossy surfaces can be partly glass".to_owned()
    })?;
    let entry = (material.textures as usize).checked_sub(1);
    let Some(entry) = entry.and_then(|index| view.shading.partial_transmissions.get(index)) else {
        return Err("it has Material::PARTIAL_TRANSMISSION, and needs an entry of partial_transmissions".to_owned());
    };
    let glass = &view.materials[entry.glass as usize];
    require(glass.kind().transmits() && !glass.has_partial_transmission(), || {
        format!("its glass, material {}, must be thin or dielectric", entry.glass)
    })?;
    require(!(material.has_alpha() && glass.kind() == MaterialKind::Dielectric), || {
        "it has Material::ALPHA, but its glass is a solid, whose boundary must be closed; use MaterialKind::Thin"
            .to_owned()
    })?;
    let sides = |of: &Material| of.flags & Material::EMITS_BOTH_SIDES;
    let has_same_textures = material.emission == [0.0; 3] || glass.textures == material.textures;
    require(glass.emission == material.emission && sides(glass) == sides(material) && has_same_textures, || {
        format!("its glass, material {}, must emit the same light", entry.glass)
    })
}

fn check_texture(texture: &Texture) -> Check {
    let (width, height) = (texture.width, texture.height);
    require((1..=MAX_TEXELS).contains(&width) && (1..=MAX_TEXELS).contains(&height), || {
        format!("its size {width} × {height} must lie between 1 × 1 and {MAX_TEXELS} × {MAX_TEXELS}")
    })?;
    let words = u64::from(width) * u64::from(height) * texture.format.words() as u64;
    require(texture.format.words() == 1 || words <= Texture::MAX_FLOAT_WORDS, || {
        format!("its {width} × {height} texels of floats take up more than 8 GiB")
    })?;
    let found = texture.texels.len();
    require(found as u64 == words, || format!("it has {found} words of texels; {width} × {height} need {words}"))?;
    let float = texture.format == crate::scene::texture::TexelFormat::Float32;
    let sane = |word: &u32| f32::from_bits(*word).is_finite() && f32::from_bits(*word) >= 0.0;
    require(!float || texture.texels.iter().all(sane), || "a texel is negative or not a finite number".to_owned())
}

fn check_use(used: &TextureUse, textures: usize, sets: usize) -> Check {
    index("texture", used.texture_index, textures)?;
    index("UV set", used.uv_set, sets)?;
    require(used.transform.as_flattened().iter().all(|c| c.is_finite()), || {
        format!("its transform {:?} must be finite", used.transform)
    })
}

fn check_anisotropy(of: &Anisotropy, uses: usize) -> Check {
    let (strength, [x, y], used) = (of.strength, of.direction, of.texture);
    require((0.0..=1.0).contains(&strength), || format!("its strength {strength} must lie between 0 and 1"))?;
    require((x.hypot(y) - 1.0).abs() < 1e-3, || format!("its direction [{x}, {y}] must have the length 1"))?;
    require(used == MaterialTextures::NONE || (used as usize) < uses, || {
        format!("its texture {used} is out of range, {uses} uses exist")
    })
}

fn check_material(textures: &MaterialTextures, tables: &ShadingTables<'_>) -> Check {
    let uses = tables.uses.len();
    for (name, used) in [
        ("base_color", textures.base_color),
        ("emission", textures.emission),
        ("normal", textures.normal),
        ("metallic_roughness", textures.metallic_roughness),
        ("alpha", textures.alpha),
        ("specular", textures.specular),
        ("specular_color", textures.specular_color),
        ("clearcoat", textures.clearcoat),
        ("clearcoat_roughness", textures.clearcoat_roughness),
    ] {
        require(used == MaterialTextures::NONE || (used as usize) < uses, || {
            format!("its {name} texture {used} is out of range, {uses} uses exist")
        })?;
    }
    let color = textures.specular_color_factor;
    require(color.iter().all(|part| part.is_finite() && *part >= 0.0), || {
        format!("its specular_color_factor {color:?} must be finite and at least 0")
    })?;
    for (name, value) in [
        ("clearcoat_factor", textures.clearcoat_factor),
        ("clearcoat_roughness_factor", textures.clearcoat_roughness_factor),
    ] {
        require((0.0..=1.0).contains(&value), || format!("its {name} {value} must lie between 0 and 1"))?;
    }
    let scale = textures.normal_scale;
    require(scale.is_finite(), || format!("its normal_scale {scale} must be finite"))?;
    require(textures.normal == MaterialTextures::NONE || !tables.tangents.is_empty(), || {
        "it has a normal map, but the scene has no tangents".to_owned()
    })?;
    let (anisotropy, count) = (textures.anisotropy, tables.anisotropies.len());
    let is_some = anisotropy != MaterialTextures::NONE;
    require(!is_some || (anisotropy as usize) < count, || {
        format!("its anisotropy {anisotropy} is out of range, {count} exist")
    })?;
    require(!is_some || !tables.tangents.is_empty(), || "it is anisotropic, but the scene has no tangents".to_owned())
}
