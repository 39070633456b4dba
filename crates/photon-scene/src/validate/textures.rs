//! Validation of textures and vertex attributes.

use photon_core::{TexelFormat, Texture};

use crate::builder::SceneBuilder;
use crate::describe::MaterialDesc;
use crate::error::SceneError;
use crate::mesh::Mesh;

/// Largest number of texels in a row, and of rows.
const MAX_SIDE: u32 = 65_536;

/// Checks all textures, and how materials use them.
pub(super) fn check(scene: &SceneBuilder) -> Result<(), SceneError> {
    for desc in &scene.textures {
        check_image(&desc.image).map_err(|(what, hint)| SceneError::Texture {
            texture: desc.name.clone(),
            what,
            hint,
        })?;
    }
    scene.materials.iter().try_for_each(|material| check_material(material, scene))
}

fn check_image(image: &Texture) -> Result<(), (String, &'static str)> {
    let (width, height) = (image.width, image.height);
    let sides = 1..=MAX_SIDE;
    if !sides.contains(&width) || !sides.contains(&height) {
        return Err((format!("it has {width} × {height} texels"), "each side must lie between 1 and 65536"));
    }
    let needed = u64::from(width) * u64::from(height) * image.format.words() as u64;
    if image.format.is_float() && needed > Texture::MAX_FLOAT_WORDS {
        return Err((format!("its {width} × {height} texels of floats need more than 8 GiB"), "use a smaller image"));
    }
    let found = image.texels.len();
    if found as u64 != needed {
        let what =
            format!("it has {found} words of texels, but {width} × {height} of {:?} need {needed}", image.format);
        return Err((what, "give one word, or four of floats, for each texel"));
    }
    if image.format == TexelFormat::Float32 {
        let mut values = image.texels.iter().map(|&word| f32::from_bits(word));
        if let Some(place) = values.position(|value| !(value.is_finite() && value >= 0.0)) {
            let (texel, value) = (place / 4, f32::from_bits(image.texels[place]));
            return Err((format!("texel {texel} has the value {value}"), "values must be finite numbers, at least 0"));
        }
    }
    Ok(())
}

fn check_material(desc: &MaterialDesc, scene: &SceneBuilder) -> Result<(), SceneError> {
    let fault = |property, value: String, hint| {
        Err(SceneError::Material { material: desc.name.clone(), property, value, hint })
    };
    let textures = &desc.textures;
    for (name, scale) in
        [("normal_scale", textures.normal_scale), ("clearcoat_normal_scale", textures.clearcoat_normal_scale)]
    {
        if !(scale as f32).is_finite() {
            return fault(name, scale.to_string(), "it must be a finite number in single precision");
        }
    }
    for (slot, used) in desc.textures.all() {
        let Some(texture) = scene.textures.get(used.texture.0 as usize) else {
            return Err(SceneError::TextureId {
                material: desc.name.clone(),
                slot,
                texture: used.texture.0,
                textures: scene.textures.len(),
            });
        };
        if !used.transform.as_flattened().iter().all(|part| (*part as f32).is_finite()) {
            let value = format!("{:?}", used.transform);
            return fault("the transform of a texture", value, "each number must be finite in single precision");
        }
        let is_bounded = slot == "emission" || texture.image.format != TexelFormat::Float32;
        if !is_bounded && texture.image.texels.iter().any(|&word| f32::from_bits(word) > 1.0) {
            return fault(slot, format!("the texture '{}'", texture.name), "its values must not exceed 1");
        }
    }
    Ok(())
}

/// Checks the vertex attributes of a mesh, and that it has the UV sets of its material.
pub(super) fn check_mesh(mesh: &Mesh, material: &MaterialDesc) -> Result<(), SceneError> {
    let vertices = mesh.positions.len();
    let attributes = &mesh.attributes;
    let fault = |attribute: &str, what: String, hint| {
        Err(SceneError::Attribute { mesh: mesh.name.to_string(), attribute: attribute.to_owned(), what, hint })
    };
    let mut lists = vec![
        ("normals".to_owned(), attributes.normals.len()),
        ("tangents".to_owned(), attributes.tangents.len()),
        ("colors".to_owned(), attributes.colors.len()),
    ];
    lists.extend(attributes.uvs.iter().enumerate().map(|(set, uvs)| (format!("UV set {set}"), uvs.len())));
    if let Some((name, found)) = lists.into_iter().find(|(_, found)| *found != 0 && *found != vertices) {
        let what = format!("there are {found} for {vertices} vertices");
        return fault(&name, what, "give one for each vertex, or none");
    }
    if let Some(vertex) = attributes.colors.iter().position(|color| color.iter().any(|part| part.is_nan())) {
        return fault("colors", format!("vertex {vertex} has NaN"), "each channel must be a number");
    }
    for (slot, used) in material.textures.all() {
        let set = used.uv_set;
        let is_there = attributes.uvs.get(set as usize).is_some_and(|uvs| uvs.len() == vertices);
        if !is_there && !mesh.triangles.is_empty() {
            let (mesh, material, sets) = (mesh.name.to_string(), material.name.clone(), attributes.uvs.len());
            return Err(SceneError::UvSet { mesh, material, slot, set, sets });
        }
    }
    Ok(())
}
