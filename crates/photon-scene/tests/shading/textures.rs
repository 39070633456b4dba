//! Textures of materials and their coordinates.

use photon_core::{MaterialTextures, TexelFormat, Wrap};
use photon_scene::{MaterialDesc, SceneBuilder, TextureDesc, TextureRef, VertexAttributes};

use crate::{SQUARE, TRIANGLES, UVS, built, square, with_uvs};

const TWO: [[u8; 4]; 2] = [[255, 0, 0, 255], [0, 255, 0, 255]];

fn textured(used: TextureRef) -> MaterialDesc {
    let mut material = MaterialDesc::lambert("tiles", [0.5, 0.25, 1.0]);
    material.textures.base_color = Some(used);
    material
}

#[test]
fn textures_in_use_are_kept_with_their_coordinates() {
    let mut builder = SceneBuilder::new();
    builder.texture(TextureDesc::srgb8("unused", 2, 1, &TWO));
    let tiles = builder.texture(TextureDesc::srgb8("tiles", 2, 1, &TWO).wrapped([Wrap::Mirror, Wrap::Clamp]));
    builder.material(textured(TextureRef::new(tiles).with_uv_set(9)));
    // Sets 0 and 2 are not used by a material of a mesh.
    let attributes = VertexAttributes::default().with_uvs(vec![vec![], UVS.to_vec(), UVS.to_vec()]);
    let scene = built(builder, attributes, textured(TextureRef::new(tiles).with_uv_set(1)));
    let view = scene.view();
    let tables = view.shading;
    assert_eq!((tables.textures.len(), tables.uses.len(), tables.uvs.len()), (1, 1, 2));
    assert_eq!((view.materials[0].textures, view.materials[1].textures), (0, 1));
    assert_eq!(tables.material_textures[0], MaterialTextures { base_color: 0, ..MaterialTextures::default() });
    assert_eq!((tables.uses[0].texture_index, tables.uses[0].uv_set), (0, 0));
    let texture = &tables.textures[0];
    assert_eq!((texture.format, texture.wrap), (TexelFormat::Srgb8, [Wrap::Mirror, Wrap::Clamp]));
    assert_eq!(texture.texels[..], [0xFF00_00FF, 0xFF00_FF00]);
    assert_eq!(tables.uvs[0], [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
    assert_eq!(view.materials[1].albedo, [0.5, 0.25, 1.0]);
}

#[test]
fn textures_of_one_colour_are_factors() {
    // 188 is the sRGB code nearest to a linear half.
    for (image, factor) in [
        (TextureDesc::srgb8("even", 2, 1, &[[188, 255, 0, 7], [188, 255, 0, 9]]), [0.502_886_5, 1.0, 0.0]),
        (TextureDesc::linear8("even", 1, 1, &[[51, 255, 0, 255]]), [0.2, 1.0, 0.0]),
        (TextureDesc::float32("even", 1, 2, &[[0.25, 0.5, 1.0, 0.0], [0.25, 0.5, 1.0, 1.0]]), [0.25, 0.5, 1.0]),
    ] {
        let mut builder = SceneBuilder::new();
        let image = builder.texture(image);
        let scene = built(builder, with_uvs(UVS), textured(TextureRef::new(image)));
        let view = scene.view();
        for (channel, albedo) in [0.5, 0.25, 1.0].into_iter().enumerate() {
            let expected = albedo * factor[channel];
            assert!((f64::from(view.materials[0].albedo[channel]) - expected).abs() < 1e-6, "{:?}", view.materials[0]);
        }
        assert!(view.shading.textures.is_empty() && view.shading.uvs.is_empty() && view.materials[0].textures == 0);
    }
}

#[test]
fn textures_without_effect_are_dropped() {
    let mut builder = SceneBuilder::new();
    let tiles = builder.texture(TextureDesc::srgb8("tiles", 2, 1, &TWO));
    let flat = builder.texture(TextureDesc::linear8("flat", 1, 2, &[[128, 127, 255, 0], [128, 127, 255, 1]]));
    let mut material = MaterialDesc::lambert("black", [0.0; 3]);
    material.textures.base_color = Some(TextureRef::new(tiles));
    material.textures.emission = Some(TextureRef::new(tiles));
    material.textures.normal = Some(TextureRef::new(flat));
    let scene = built(builder, with_uvs(UVS), material);
    assert!(scene.view().shading.material_textures.is_empty() && scene.view().lights.is_empty());
}

/// The table's coordinates of the first triangle, for a texture with these wrap modes and this transform.
fn packed(
    wrap: [Wrap; 2],
    transform: [[f64; 3]; 2],
    uvs: [[f64; 2]; 4],
) -> ([[f32; 2]; 3], [[f32; 3]; 2], Vec<String>) {
    let mut builder = SceneBuilder::new();
    let tiles = builder.texture(TextureDesc::srgb8("tiles", 2, 1, &TWO).wrapped(wrap));
    let scene = built(builder, with_uvs(uvs), textured(TextureRef::new(tiles).with_transform(transform)));
    let tables = scene.view().shading;
    (tables.uvs[0], tables.uses[0].transform, scene.warnings().to_vec())
}

#[test]
fn repeated_coordinates_are_recentred_by_whole_numbers() {
    const REPEAT: [Wrap; 2] = [Wrap::Repeat; 2];
    let plain = TextureRef::IDENTITY;
    let far = |by: f64| UVS.map(|[u, v]| [u * 0.5 + by + 0.25, v * 0.5 - by]);
    let near = [[0.25, 0.5], [0.75, 0.5], [0.75, 0.0]];
    for by in [0.0, 3.0, 1e6, 1e12] {
        assert_eq!(packed(REPEAT, plain, far(by)).0, near, "{by}");
    }
    // Even numbers if the texture is mirrored, and none if it is clamped or scaled by a fraction.
    assert_eq!(packed([Wrap::Mirror, Wrap::Repeat], plain, far(3.0)).0, near.map(|[u, v]| [u + 1.0, v]));
    let moved = near.map(|[u, v]| [u + 3.0, v - 3.0]);
    assert_eq!(packed([Wrap::Clamp, Wrap::Repeat], plain, far(3.0)).0, near.map(|[u, v]| [u + 3.0, v]));
    assert_eq!(packed(REPEAT, [[0.5, 0.25, 0.0], [0.0, 2.0, 0.0]], far(3.0)).0, moved);
    // A turn by a right angle is one of whole numbers.
    assert_eq!(packed(REPEAT, [[0.0, 1.0, 7.25], [-1.0, 0.0, -7.25]], far(3.0)), {
        (near, [[0.0, 1.0, 0.25], [-1.0, 0.0, 0.75]], Vec::new())
    });
}

/// V10: extreme coordinates. V11: extreme transforms.
#[test]
fn extreme_coordinates_are_finite_and_reported() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (uvs, _, warnings) = packed([Wrap::Clamp; 2], TextureRef::IDENTITY, [[bad, 0.5], UVS[1], UVS[2], UVS[3]]);
        assert_eq!(uvs, [[0.0, 0.5], [1.0, 1.0], [1.0, 0.0]]);
        assert!(
            warnings.iter().any(|text| text.starts_with("2 triangles have texture coordinates that are not finite"))
        );
    }
    for far in [1e30, 1e300] {
        let (uvs, _, warnings) = packed([Wrap::Clamp; 2], TextureRef::IDENTITY, UVS.map(|[u, v]| [u * far, v]));
        assert!(uvs.as_flattened().iter().all(|part| part.is_finite()) && warnings.len() == 1, "{warnings:?}");
    }
    let same = packed([Wrap::Repeat; 2], TextureRef::IDENTITY, [[1e6 + 0.5; 2]; 4]);
    assert!(same.0 == [[0.5; 2]; 3] && same.2.is_empty());
    for scale in [0.0, 1e9, 1e-9, -1e9] {
        let (_, transform, _) = packed([Wrap::Repeat; 2], [[scale, 0.0, 1e9 + 0.5], [0.0, scale, 1e30]], UVS);
        assert_eq!(transform, [[scale as f32, 0.0, 0.5], [0.0, scale as f32, 0.0]]);
    }
}

#[test]
fn meshes_of_other_materials_have_no_coordinates_and_two_sets_are_two_rows() {
    let mut builder = SceneBuilder::new();
    let tiles = builder.texture(TextureDesc::srgb8("tiles", 2, 1, &TWO));
    let first = builder.material(textured(TextureRef::new(tiles)));
    let second = builder.material(textured(TextureRef::new(tiles).with_uv_set(3)));
    let plain = builder.material(MaterialDesc::lambert("plain", [0.5; 3]));
    builder.mesh("plain", SQUARE.map(|[x, y, _]| [x, y, 1.0]).to_vec(), TRIANGLES.to_vec(), plain);
    square(&mut builder, with_uvs(UVS), first);
    let uvs = vec![vec![], vec![], vec![], UVS.to_vec()];
    square(&mut builder, VertexAttributes::default().with_uvs(uvs), second);
    let scene = builder.build().unwrap();
    scene.view().validate().unwrap();
    let tables = scene.view().shading;
    let corners = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    let none = [[0.0; 2]; 3];
    let first = [0, 1, 2].map(|mesh| scene.triangle_sources().position(|source| source == (mesh, 0)).expect("a mesh"));
    assert_eq!(first.map(|triangle| tables.uvs[triangle]), [none, corners, none]);
    assert_eq!(first.map(|triangle| tables.uvs[6 + triangle]), [none, none, corners]);
    assert_eq!((tables.textures.len(), tables.uses[1].uv_set), (1, 1));
}
