//! Textures, their coordinates and vertex attributes.

use glam::{DMat4, DVec3};
use photon_core::{Filter, TexelFormat, Wrap};

use super::super::attributes;
use super::file::{File, data_uri, floats, png, says};
use crate::builder::SceneBuilder;
use crate::describe::MaterialDesc;
use crate::mesh::VertexAttributes;
use crate::texture::TextureRef;

const PIXELS: [[u8; 4]; 2] = [[255, 0, 0, 255], [0, 0, 255, 255]];

/// A file whose triangle has texture coordinates in the sets 0 and 1, and whose only image has two colours.
fn textured(material: &str) -> File {
    let mut data = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    data.extend(floats(&[0., 1., 1., 1., 0., 0., 0.5, 0.5, 2., 0.25, 0.75, 3.]));
    let uri = data_uri("image/png", &png(&PIXELS));
    File::new()
        .data(&data)
        .with("bufferViews", r#"[{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 48}]"#)
        .with(
            "accessors",
            r#"[{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
                {"bufferView": 1, "byteOffset": 24, "componentType": 5126, "count": 3, "type": "VEC2"}]"#,
        )
        .with(
            "meshes",
            r#"[{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 2}, "material": 0}]}]"#,
        )
        .material(material)
        .with("textures", r#"[{"source": 0}]"#)
        .with("images", format!(r#"[{{"uri": "{uri}", "name": "tiles"}}]"#))
}

const BASE: &str = r#""pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.5, 0.25, 1, 1], "baseColorTexture": {"index": 0}}"#;

#[test]
fn base_colour_textures_keep_their_factor_and_texels() {
    let (builder, report) = textured(BASE).load();
    let material = &builder.materials[0];
    assert_eq!(material.surface, MaterialDesc::plastic("it", [0.5, 0.25, 1.0], 1.0).surface);
    let used = material.textures.base_color.expect("a texture");
    assert_eq!((used.uv_set, used.transform), (0, TextureRef::IDENTITY));
    let image = &builder.textures[0].image;
    assert_eq!((image.width, image.height, image.format), (2, 1, TexelFormat::Srgb8));
    assert_eq!(image.texels[..], PIXELS.map(u32::from_le_bytes));
    assert_eq!((image.wrap, image.filter), ([Wrap::Repeat; 2], Filter::Linear));
    assert_eq!(builder.meshes[0].attributes.uvs, [vec![[0., 1.], [1., 1.], [0., 0.]]]);
    assert!(report.is_exact(), "{report}");
    builder.build().unwrap().view().validate().unwrap();
    // A texture of one colour is a factor.
    let uri = data_uri("image/png", &png(&[[255, 0, 255, 255]; 3]));
    let (builder, _) = textured(BASE).with("images", format!(r#"[{{"uri": "{uri}"}}]"#)).load();
    assert_eq!(builder.materials[0], MaterialDesc::plastic("it", [0.5, 0.0, 1.0], 1.0));
    assert!(builder.textures.is_empty() && builder.meshes[0].attributes.uvs.is_empty());
}

#[test]
fn one_image_is_decoded_for_each_encoding_and_shared() {
    let json = r#""pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 0}}, "emissiveFactor": [2, 2, 2], "emissiveTexture": {"index": 0, "texCoord": 1}, "normalTexture": {"index": 0, "scale": 0.5}"#;
    let (builder, report) = textured(json).load();
    let textures = &builder.materials[0].textures;
    assert_eq!(builder.textures.len(), 2);
    assert_eq!(textures.base_color.unwrap().texture, textures.emission.unwrap().texture);
    assert_eq!((textures.emission.unwrap().uv_set, textures.normal_scale), (1, 0.5));
    assert_eq!(builder.materials[0].emission, [2.0; 3]);
    let formats: Vec<TexelFormat> = builder.textures.iter().map(|desc| desc.image.format).collect();
    assert_eq!(formats, [TexelFormat::Srgb8, TexelFormat::Linear8]);
    assert!(std::sync::Arc::ptr_eq(&builder.textures[0].image.texels, &builder.textures[1].image.texels));
    assert_eq!(builder.meshes[0].attributes.uvs.len(), 2);
    assert!(report.is_exact(), "{report}");
    builder.build().unwrap().view().validate().unwrap();
}

#[test]
fn samplers_set_wrap_modes_and_filter() {
    for (json, wrap, filter) in [
        ("{}", [Wrap::Repeat; 2], Filter::Linear),
        (r#"{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}"#, [Wrap::Clamp, Wrap::Mirror], Filter::Nearest),
        (r#"{"wrapS": 10497, "magFilter": 9729, "minFilter": 9984}"#, [Wrap::Repeat; 2], Filter::Linear),
    ] {
        let file =
            textured(BASE).with("textures", r#"[{"source": 0, "sampler": 0}]"#).with("samplers", format!("[{json}]"));
        let image = &file.load().0.textures[0].image;
        assert_eq!((image.wrap, image.filter), (wrap, filter), "{json}");
    }
    let of = |json: &str| {
        textured(BASE)
            .with("textures", r#"[{"source": 0, "sampler": 0}]"#)
            .with("samplers", format!("[{json}]"))
            .load()
            .1
    };
    let report = of(r#"{"wrapS": 1, "magFilter": 3}"#);
    assert!(says(&report, "it", "wrap mode") && says(&report, "it", "magFilter"), "{report}");
    assert!(of(r#"{"wrapS": 33071, "magFilter": 9728}"#).is_exact());
    let error = textured(BASE).with("textures", r#"[{"source": 0, "sampler": 3}]"#).error();
    assert!(error.contains("sampler 3"), "{error}");
}

#[test]
fn transforms_and_their_sets_are_read() {
    let json = BASE.replace(
        r#"{"index": 0}"#,
        r#"{"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0.25], "scale": [2, 4], "texCoord": 1}}}"#,
    );
    let (builder, report) = textured(&json).with("extensionsRequired", r#"["KHR_texture_transform"]"#).load();
    let used = builder.materials[0].textures.base_color.unwrap();
    assert_eq!((used.uv_set, used.transform), (1, [[2.0, 0.0, 0.5], [0.0, 4.0, 0.25]]));
    assert!(report.is_exact() && builder.meshes[0].attributes.uvs[0].is_empty(), "{report}");
    let json = r#""normalTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"rotation": 1}}}"#;
    assert!(says(&textured(json).load().1, "material 'it'", "normal map is turned"));
}

#[test]
fn webp_takes_the_place_of_the_standard_image() {
    let mut bytes = Vec::new();
    let encoder = image_webp::WebPEncoder::new(&mut bytes);
    encoder.encode(&[9, 99, 199, 8, 88, 188], 2, 1, image_webp::ColorType::Rgb8).unwrap();
    let images = [data_uri("image/png", &png(&PIXELS)), data_uri("image/webp", &bytes)];
    let file = textured(BASE)
        .with("extensionsRequired", r#"["EXT_texture_webp"]"#)
        .with("textures", r#"[{"source": 0, "extensions": {"EXT_texture_webp": {"source": 1}}}]"#)
        .with("images", format!(r#"[{{"uri": "{}"}}, {{"uri": "{}"}}]"#, images[0], images[1]));
    let (builder, report) = file.load();
    assert_eq!(builder.textures[0].image.texels[0], u32::from_le_bytes([9, 99, 199, 255]));
    assert!(report.is_exact(), "{report}");
}

#[test]
fn meshes_without_the_coordinates_are_reported() {
    let bare = r#"[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]"#;
    let (builder, report) = textured(BASE).with("meshes", bare).load();
    assert_eq!(builder.meshes[0].attributes.uvs, [vec![[0.0; 2]; 3]]);
    assert!(says(&report, "mesh 0 primitive 0", "TEXCOORD_0") && says(&report, "mesh 0", "material 'it'"), "{report}");
    builder.build().unwrap();
    // Too few coordinates, and a set that cannot exist.
    let few = r#"[{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}]"#;
    let accessors = r#"[{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}, {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC2"}]"#;
    let (_, report) = textured(BASE).with("meshes", few).with("accessors", accessors).load();
    assert!(says(&report, "mesh 0 primitive 0", "there are 2 for 3 vertices"), "{report}");
    let json = BASE.replace(r#"{"index": 0}"#, r#"{"index": 0, "texCoord": 4294967295}"#);
    let (builder, report) = textured(&json).load();
    assert!(builder.textures.is_empty() && says(&report, "it", "TEXCOORD_4294967295"), "{report}");
    let error = textured(BASE).with("meshes", few.replace("\"TEXCOORD_0\": 1", "\"TEXCOORD_0\": 0")).error();
    assert!(error.contains("accessor 0") && error.contains("Vec2"), "{error}");
}

/// Quantised coordinates, normals and colours (`KHR_mesh_quantization`).
#[test]
fn attributes_may_be_of_any_component_type() {
    let mut data = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    data.extend([0, 255, 255, 51, 0, 0]);
    data.extend([0, 0, 127, 0, 0, 127, 64, 0, 64_u8]);
    data.extend([255, 0, 51, 255, 255, 255, 255, 255, 0_u8]);
    let views = r#"[{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}, {"buffer": 0, "byteOffset": 42, "byteLength": 9}, {"buffer": 0, "byteOffset": 51, "byteLength": 9}]"#;
    let accessors = r#"[{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"bufferView": 1, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC2"},
        {"bufferView": 2, "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3"},
        {"bufferView": 3, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC3"}]"#;
    let mesh = r#"[{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "NORMAL": 2, "COLOR_0": 3}, "material": 0}]}]"#;
    let file = textured(BASE).data(&data).with("bufferViews", views).with("accessors", accessors).with("meshes", mesh);
    let (builder, report) = file.load();
    let attributes = &builder.meshes[0].attributes;
    assert_eq!(attributes.uvs[0], [[0.0, 1.0], [1.0, 0.2], [0.0, 0.0]]);
    assert_eq!(attributes.normals[..2], [[0.0, 0.0, 1.0]; 2]);
    assert_eq!(attributes.colors, [[1.0, 0.0, 0.2, 1.0], [1.0; 4], [1.0, 1.0, 0.0, 1.0]]);
    assert!(report.is_exact(), "{report}");
    builder.build().unwrap().view().validate().unwrap();
}

/// A triangle whose vertices all have this normal, and this tangent with the sign 1, placed by a transform: its geometric
/// normal, normal and tangent.
fn placed(normal: DVec3, tangent: DVec3, matrix: DMat4) -> (DVec3, DVec3, f64) {
    let mut attributes = VertexAttributes::default()
        .with_normals(vec![normal.to_array()])
        .with_tangents(vec![tangent.extend(1.0).to_array()]);
    attributes::transform(&mut attributes, &matrix);
    let [x, y, z, sign] = attributes.tangents[0];
    (DVec3::from(attributes.normals[0]).normalize_or_zero(), DVec3::new(x, y, z).normalize_or_zero(), sign)
}

/// Traps of non-uniform scales and mirrors: normals stay perpendicular to the surface, bitangents follow it.
#[test]
fn normals_and_tangents_follow_their_node() {
    let (a, b) = (DVec3::new(1.0, 0.5, 0.0), DVec3::new(-0.25, 1.0, 0.75));
    let normal = a.cross(b).normalize_or_zero();
    for scale in [DVec3::ONE, DVec3::new(2.0, 1.0, 0.25), DVec3::new(1e-150, 2e-150, 1e-150), DVec3::splat(1e150)] {
        for flip in [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::splat(-1.0)] {
            let matrix = DMat4::from_rotation_y(0.7) * DMat4::from_scale(scale * flip);
            let mirrored = flip.element_product() < 0.0;
            let (found, tangent, sign) = placed(normal, a.normalize_or_zero(), matrix);
            let place = |v: DVec3| matrix.transform_vector3(v).normalize_or_zero();
            // The front stays the front: the winding is reversed in a mirror.
            let front = place(a).cross(place(b)) * if mirrored { -1.0 } else { 1.0 };
            assert!(found.distance(front.normalize_or_zero()) < 1e-12, "{scale} {flip}");
            assert!(tangent.distance(place(a)) < 1e-12, "{scale} {flip}");
            // The bitangent of the unplaced triangle, placed, is on the side that the sign says.
            let bitangent = place(normal.cross(a));
            assert!(found.cross(tangent).dot(bitangent) * sign > 0.0, "{scale} {flip}");
        }
    }
}

#[test]
fn a_mirrored_node_keeps_normals_on_the_front() {
    let mut data = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    data.extend(floats(&[0.1, 0.0, 1.0, 0.0, 0.1, 1.0, 0.0, 0.0, 1.0]));
    let file = File::new()
        .data(&data)
        .with("bufferViews", r#"[{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 36}]"#)
        .with(
            "accessors",
            r#"[{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"}]"#,
        )
        .with("meshes", r#"[{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "material": 0}]}]"#)
        .with("nodes", r#"[{"mesh": 0, "scale": [-1, 1, 1]}]"#);
    let (builder, report) = file.load();
    assert_eq!(builder.meshes[0].attributes.normals[0], [-0.1_f32, 0.0, 1.0].map(f64::from));
    let scene = builder.build().unwrap();
    assert!(scene.warnings().iter().all(|text| !text.contains("normals")), "{:?}", scene.warnings());
    let (normals, geometric) = (scene.view().shading.normals, scene.view().primitives[0].normal);
    assert_eq!(geometric, [0.0, 0.0, 1.0]);
    let first = photon_core::octahedral::unpack(normals[0][0]);
    assert!(first.z > 0.9 && first.x < -0.05, "{first}");
    assert!(!says(&report, "file", "normals"), "{report}");
}

/// The size of a scene's tables does not depend on attributes that no material needs.
#[test]
fn attributes_that_nothing_needs_are_not_read() {
    let (builder, _) = textured(r#""pbrMetallicRoughness": {"metallicFactor": 0}"#).load();
    assert_eq!(builder.meshes[0].attributes, VertexAttributes::default());
    assert!(SceneBuilder::new().textures.is_empty() && builder.textures.is_empty());
}
