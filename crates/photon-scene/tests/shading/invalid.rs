//! Errors of textures and vertex attributes, each with the name of the object at fault.

use photon_scene::{MaterialDesc, SceneBuilder, TextureDesc, TextureRef, VertexAttributes};

use crate::{UVS, square, with_uvs};

/// The error of a scene whose only square has a texture.
#[track_caller]
fn refused(change: impl FnOnce(&mut TextureDesc, &mut MaterialDesc, &mut VertexAttributes)) -> String {
    let mut image = TextureDesc::srgb8("tiles", 2, 1, &[[255; 4], [0; 4]]);
    let mut material = MaterialDesc::lambert("wall", [0.5; 3]);
    let mut attributes = with_uvs(UVS);
    let mut builder = SceneBuilder::new();
    // A first texture, so that the second can be moved to another builder.
    let used = builder.texture(TextureDesc::srgb8("first", 1, 1, &[[255; 4]]));
    material.textures.base_color = Some(TextureRef::new(used));
    change(&mut image, &mut material, &mut attributes);
    let second = builder.texture(image);
    if let Some(used) = &mut material.textures.base_color {
        used.texture = if used.texture == TextureRef::new(second).texture { used.texture } else { second };
    }
    let material = builder.material(material);
    square(&mut builder, attributes, material);
    builder.build().err().map(|error| error.to_string()).expect("an error")
}

#[track_caller]
fn names(error: &str, parts: &[&str]) {
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");
}

#[test]
fn images_of_the_wrong_size_are_refused() {
    names(&refused(|image, _, _| image.image.width = 3), &["texture 'tiles'", "2 words", "need 3"]);
    for (width, height) in [(0, 1), (1, 0), (65_537, 1), (u32::MAX, u32::MAX)] {
        let error = refused(|image, _, _| (image.image.width, image.image.height) = (width, height));
        names(&error, &["texture 'tiles'", "between 1 and 65536"]);
    }
}

/// V9: more words of floats than kernels can count are refused by the size, whatever is there.
#[test]
fn float_images_beyond_8_gib_are_refused() {
    for (height, part) in [(8192, "2 words of texels, but 65536 × 8192"), (8193, "more than 8 GiB")] {
        let error = refused(|image, _, _| {
            (image.image.width, image.image.height) = (65_536, height);
            image.image.format = photon_core::TexelFormat::Float32;
        });
        names(&error, &["texture 'tiles'", part]);
    }
}

/// V7: texels that are not finite or negative.
#[test]
fn invalid_texels_are_refused() {
    for bad in [f32::NAN, f32::INFINITY, -1e-9] {
        let error =
            refused(|image, _, _| *image = TextureDesc::float32("sky", 1, 2, &[[1.0; 4], [0.0, bad, 0.0, 1.0]]));
        names(&error, &["texture 'sky'", "texel 1"]);
    }
    let bright = TextureDesc::float32("bright", 1, 2, &[[1.0; 4], [2.0; 4]]);
    names(&refused(|image, _, _| *image = bright), &["material 'wall'", "'bright'", "must not exceed 1"]);
}

#[test]
fn unknown_textures_and_sets_are_refused() {
    let mut other = SceneBuilder::new();
    let foreign = (0..3).map(|_| other.texture(TextureDesc::srgb8("x", 1, 1, &[[0; 4]]))).last().unwrap();
    let error = refused(|_, material, _| material.textures.emission = Some(TextureRef::new(foreign)));
    names(&error, &["material 'wall'", "emission", "number 2", "2 of this builder"]);
    let error = refused(|_, material, _| {
        let used = material.textures.base_color.as_mut().unwrap();
        used.uv_set = 1;
    });
    names(&error, &["mesh 'square'", "material 'wall'", "UV set 1", "the mesh has 1"]);
    names(&refused(|_, _, attributes| attributes.uvs.clear()), &["mesh 'square'", "UV set 0", "the mesh has 0"]);
}

#[test]
fn lists_of_the_wrong_length_and_numbers_that_are_not_finite_are_refused() {
    names(&refused(|_, _, a| a.normals = vec![[0.0; 3]; 3]), &["mesh 'square'", "normals", "3 for 4 vertices"]);
    names(&refused(|_, _, a| a.tangents = vec![[0.0; 4]; 5]), &["mesh 'square'", "tangents", "5 for 4 vertices"]);
    names(&refused(|_, _, a| a.colors = vec![[0.0; 4]; 1]), &["mesh 'square'", "colors", "1 for 4 vertices"]);
    names(&refused(|_, _, a| a.uvs[0].truncate(2)), &["mesh 'square'", "UV set 0", "2 for 4 vertices"]);
    names(&refused(|_, _, a| a.colors = vec![[f64::NAN; 4]; 4]), &["mesh 'square'", "vertex 0 has NaN"]);
    let error = refused(|_, material, _| material.textures.base_color.as_mut().unwrap().transform[1][2] = f64::NAN);
    names(&error, &["material 'wall'", "transform"]);
    let error = refused(|_, material, _| material.textures.normal_scale = 1e300);
    names(&error, &["material 'wall'", "normal_scale"]);
}
