//! Metal, roughness and specular reflection.

use photon_core::{MaterialKind, TexelFormat};

use super::file::{data_uri, png, says};
use super::materials::{read, textured};
use crate::describe::{MaterialDesc, Surface};
use crate::report::LoadReport;
use crate::shading::fold;

/// Whether nothing of the material is lost; its triangle has no texture coordinates.
fn is_exact(report: &LoadReport) -> bool {
    let text = report.to_string();
    !text.contains("approximated: material") && !text.contains("left out")
}

#[test]
fn the_default_material_is_a_rough_metal() {
    let (material, report) = read(r#""doubleSided": false"#);
    assert_eq!(material, MaterialDesc::metal("it", [1.0; 3], 1.0));
    assert!(report.lines.is_empty(), "{report}");
}

#[test]
fn factors_are_kept() {
    let json = r#""pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 0.75, 1], "metallicFactor": 0.25, "roughnessFactor": 0.5},
        "extensions": {"KHR_materials_specular": {"specularFactor": 0.75}, "KHR_materials_ior": {"ior": 1.25}}"#;
    let (material, report) = read(json);
    let expected =
        Surface::Glossy { base_color: [0.25, 0.5, 0.75], metallic: 0.25, roughness: 0.5, specular: 0.75, ior: 1.25 };
    assert_eq!(material.surface, expected);
    assert!(report.lines.is_empty(), "{report}");
}

#[test]
fn only_smooth_metals_are_rendered_as_mirrors() {
    for (roughness, metallic, is_mirror) in [
        (0.0, 1.0, true),
        // Widths below 0.001 are not rendered.
        (0.03, 1.0, true),
        (0.032, 1.0, false),
        (0.0, 0.99, false),
        (0.5, 1.0, false),
        (0.0, 0.0, false),
    ] {
        let json = format!(
            r#""pbrMetallicRoughness": {{"baseColorFactor": [1, 0.5, 0.25, 1], "roughnessFactor": {roughness}, "metallicFactor": {metallic}}}"#
        );
        let (builder, report) = super::file::File::new().material(&json).load();
        assert!(report.lines.is_empty(), "{report}");
        assert!(matches!(builder.materials[0].surface, Surface::Glossy { .. }), "{:?}", builder.materials[0]);
        let scene = builder.build().unwrap();
        let record = scene.view().materials[0];
        assert_eq!(record.kind() == MaterialKind::Mirror, is_mirror, "{record:?}");
        // Mirrors reflect as metals do.
        assert!(record.albedo == [1.0, 0.5, 0.25] && (!is_mirror || record.metallic == 1.0), "{record:?}");
    }
}

#[test]
fn without_specular_reflection_it_is_diffuse() {
    let of = |metallic: f64, extensions: &str| {
        let json = format!(
            r#""pbrMetallicRoughness": {{"baseColorFactor": [0.25, 0.5, 0.75, 1], "metallicFactor": {metallic}}}, "extensions": {{{extensions}}}"#
        );
        let (material, report) = read(&json);
        assert!(report.lines.is_empty(), "{report}");
        material
    };
    let diffuse = MaterialDesc::lambert("it", [0.25, 0.5, 0.75]);
    let none = r#""KHR_materials_specular": {"specularFactor": 0}"#;
    assert_eq!(of(0.0, none), diffuse);
    assert_eq!(of(0.0, r#""KHR_materials_ior": {"ior": 1}"#), diffuse);
    assert!(matches!(of(0.5, none).surface, Surface::Glossy { specular: 0.0, .. }));
}

#[test]
fn specular_colour_changes_the_reflectance_at_normal_incidence() {
    let of = |specular: &str| {
        read(&format!(
            r#""pbrMetallicRoughness": {{"metallicFactor": 0}}, "extensions": {{"KHR_materials_specular": {{{specular}}}}}"#
        ))
    };
    let coat = |material: &MaterialDesc| {
        let mut materials = [material.clone()];
        fold(&mut materials, &[]);
        let Surface::Glossy { specular, ior, .. } = materials[0].surface else { panic!("{material:?}") };
        (specular, ((ior - 1.0) / (ior + 1.0)).powi(2), materials[0].specular_color)
    };
    // A grey colour becomes a refractive index: 4 × 0.04.
    let (material, report) = of(r#""specularFactor": 0.5, "specularColorFactor": [4, 4, 4]"#);
    let (specular, f0, color) = coat(&material);
    assert!(specular == 0.5 && (f0 - 0.16).abs() < 1e-12 && report.lines.is_empty(), "{material:?}, {report}");
    assert_eq!(color, [1.0; 3]);
    let (material, report) = of(r#""specularColorFactor": [0, 1, 0.5]"#);
    assert!((coat(&material).1 - 0.04).abs() < 1e-12 && report.lines.is_empty(), "{material:?}, {report}");
    assert_eq!(coat(&material).2, [0.0, 1.0, 0.5]);
    // At most all light.
    let (_, f0, _) = coat(&of(r#""specularColorFactor": [99, 99, 99]"#).0);
    assert_eq!(f0, 1.0);
    let (material, report) = of(r#""specularFactor": 2"#);
    assert!(coat(&material).0 == 1.0 && says(&report, "it", "its specular factor 2.000 is replaced by 1"));
}

/// The alpha of one texture and the colours of the other are kept.
#[test]
fn specular_reflection_has_textures() {
    let json = r#""pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_specular": {"specularFactor": 0.5, "specularTexture": {"index": 0}}}"#;
    let texels = [[0, 0, 0, 255], [9, 9, 9, 0]];
    let (builder, report) = textured(json, &texels).load();
    let material = &builder.materials[0];
    let Surface::Glossy { specular, .. } = material.surface else { panic!("{material:?}") };
    let image = &builder.textures[material.textures.specular.unwrap().texture.0 as usize].image;
    assert_eq!((specular, &image.texels[..]), (0.5, &texels.map(u32::from_le_bytes)[..]));
    assert!(is_exact(&report), "{report}");
    let (builder, report) = textured(json, &[[7, 7, 7, 51]; 2]).load();
    assert!(matches!(builder.materials[0].surface, Surface::Glossy { specular: 0.1, .. }), "{builder:?}");
    assert!(builder.textures.is_empty() && report.is_exact(), "{report}");
    let json = json.replace("specularTexture", "specularColorTexture");
    let texels = [[255, 0, 9, 255], [0, 0, 0, 255]];
    let (builder, report) = textured(&json, &texels).load();
    let material = &builder.materials[0];
    let image = &builder.textures[material.textures.specular_color.unwrap().texture.0 as usize].image;
    assert_eq!((image.format, &image.texels[..]), (TexelFormat::Srgb8, &texels.map(u32::from_le_bytes)[..]));
    assert!(is_exact(&report) && material.specular_color == [1.0; 3], "{report}");
    let (builder, _) = textured(&json, &[[255, 0, 0, 255]; 2]).load();
    assert_eq!((builder.materials[0].specular_color, builder.textures.len()), ([1.0, 0.0, 0.0], 0));
}

const TEXTURED: &str = r#""pbrMetallicRoughness": {"roughnessFactor": 0.5, "metallicRoughnessTexture": {"index": 0}}"#;

#[test]
fn metal_and_roughness_have_a_linear_texture() {
    let texels = [[99, 0, 255, 255], [99, 255, 128, 255]];
    let (builder, report) = textured(TEXTURED, &texels).load();
    let material = &builder.materials[0];
    assert_eq!(material.surface, MaterialDesc::metal("it", [1.0; 3], 0.5).surface);
    let used = material.textures.metallic_roughness.expect("a texture");
    let image = &builder.textures[used.texture.0 as usize].image;
    assert_eq!((image.format, &image.texels[..]), (TexelFormat::Linear8, &texels.map(u32::from_le_bytes)[..]));
    assert!(is_exact(&report) && material.textures.base_color.is_none(), "{report}");
}

#[test]
fn a_uniform_texture_is_a_factor() {
    // Roughness is green, metal is blue.
    let (builder, report) = textured(TEXTURED, &[[99, 51, 102, 255], [99, 51, 102, 255]]).load();
    let material = &builder.materials[0];
    let Surface::Glossy { metallic, roughness, .. } = material.surface else { panic!("{material:?}") };
    assert!((metallic - 0.4).abs() < 1e-12 && (roughness - 0.1).abs() < 1e-12, "{material:?}");
    assert!(material.textures.metallic_roughness.is_none() && builder.textures.is_empty() && report.is_exact());
    let (builder, _) = textured(TEXTURED, &[[99, 0, 255, 255]]).load();
    assert_eq!(builder.materials[0], MaterialDesc::metal("it", [1.0; 3], 0.0));
}

fn specular_glossiness(json: &str) -> String {
    format!(r#""extensions": {{"KHR_materials_pbrSpecularGlossiness": {{{json}}}}}"#)
}

#[test]
fn specular_glossiness_is_a_coat_or_a_metal() {
    let of = |json: &str| read(&specular_glossiness(json));
    let (coat, report) =
        of(r#""diffuseFactor": [0.5, 0.25, 0, 1], "specularFactor": [0.04, 0.04, 0.04], "glossinessFactor": 0.75"#);
    let Surface::Glossy { base_color, metallic, roughness, specular, ior } = coat.surface else { panic!("{coat:?}") };
    assert_eq!((base_color, metallic, roughness, specular), ([0.5, 0.25, 0.0], 0.0, 0.25, 1.0));
    assert!(
        (ior - 1.5).abs() < 1e-12 && report.is_exact() && says(&report, "it", "refractive index 1.500"),
        "{report}"
    );
    // A colour, or a bright grey over a diffuse base: all light is reflected, times the specular colour.
    for specular in [[0.01, 0.02, 0.09], [0.5, 0.5, 0.5], [1.0, 0.75, 0.25]] {
        let [r, g, b] = specular;
        let (coat, report) = of(&format!(
            r#""diffuseFactor": [0.5, 0, 0, 1], "specularFactor": [{r}, {g}, {b}], "glossinessFactor": 0.25"#
        ));
        let base_color = [0.5, 0.0, 0.0];
        let expected = Surface::Glossy { base_color, metallic: 0.0, roughness: 0.75, specular: 1.0, ior: 0.0 };
        assert_eq!((&coat.surface, coat.specular_color), (&expected, specular));
        assert!(report.is_exact() && says(&report, "it", "a coat of its specular colour"), "{report}");
    }
    // Without specular reflection, it is diffuse.
    let (diffuse, _) = of(r#""diffuseFactor": [0.5, 0.25, 0, 1], "specularFactor": [0, 0, 0]"#);
    assert_eq!(diffuse, MaterialDesc::lambert("it", [0.5, 0.25, 0.0]));
    let (gold, report) =
        of(r#""diffuseFactor": [0, 0, 0, 1], "specularFactor": [1, 0.75, 0.25], "glossinessFactor": 0.5"#);
    assert_eq!(gold, MaterialDesc::metal("it", [1.0, 0.75, 0.25], 0.5));
    assert!(report.is_exact() && says(&report, "it", "a metal of its specular colour"), "{report}");
}

#[test]
fn specular_glossiness_textures() {
    let texels = [[255, 0, 0, 255], [0, 0, 255, 255]];
    let json = specular_glossiness(
        r#""diffuseFactor": [0.5, 1, 1, 1], "diffuseTexture": {"index": 0}, "specularFactor": [0.04, 0.04, 0.04]"#,
    );
    let (builder, report) = textured(&json, &texels).load();
    let material = &builder.materials[0];
    let Surface::Glossy { base_color, roughness, .. } = material.surface else { panic!("{material:?}") };
    assert_eq!((base_color, roughness), ([0.5, 1.0, 1.0], 0.0));
    assert!(material.textures.base_color.is_some() && is_exact(&report), "{report}");
    // Beside a bright specular colour, too.
    let json = json.replace("0.04, 0.04, 0.04", "1, 0, 0");
    let (builder, report) = textured(&json, &texels).load();
    let material = &builder.materials[0];
    assert!(material.textures.base_color.is_some() && material.specular_color == [1.0, 0.0, 0.0], "{report}");

    // The texture of both becomes a specular colour and a roughness: 1 − 0.5 · 102/255 in bytes is 204.
    let json = specular_glossiness(
        r#""diffuseFactor": [0, 0, 0, 1], "specularFactor": [1, 0.5, 1], "glossinessFactor": 0.5, "specularGlossinessTexture": {"index": 0}"#,
    );
    let (builder, report) = textured(&json, &[[255, 128, 0, 0], [255, 255, 255, 102]]).load();
    let material = &builder.materials[0];
    let expected = Surface::Glossy { base_color: [0.0; 3], metallic: 0.0, roughness: 1.0, specular: 1.0, ior: 0.0 };
    assert_eq!((&material.surface, material.specular_color), (&expected, [1.0, 0.5, 1.0]));
    let image = |used: Option<crate::TextureRef>| &builder.textures[used.unwrap().texture.0 as usize].image;
    let (color, rough) = (image(material.textures.specular_color), image(material.textures.metallic_roughness));
    assert_eq!((color.format, color.texels[0].to_le_bytes()[..3].to_vec()), (TexelFormat::Srgb8, vec![255, 128, 0]));
    let green: Vec<u8> = rough.texels.iter().map(|texel| texel.to_le_bytes()[1]).collect();
    assert_eq!((rough.format, green), (TexelFormat::Linear8, vec![255, 204]));
    assert!(is_exact(&report), "{report}");
    // Of one colour and glossiness, it is a factor.
    let (builder, report) = textured(&json, &[[255, 255, 255, 102]]).load();
    assert_eq!(builder.materials[0], MaterialDesc::metal("it", [1.0, 0.5, 1.0], 0.8));
    assert!(builder.textures.is_empty() && is_exact(&report), "{report}");
    // One that cannot be read leaves the factors.
    let uri = data_uri("image/png", &png(&texels)[..20]);
    let (builder, report) = textured(&json, &texels).with("images", format!(r#"[{{"uri": "{uri}"}}]"#)).load();
    assert_eq!(builder.materials[0], MaterialDesc::metal("it", [1.0, 0.5, 1.0], 0.5));
    assert!(says(&report, "it", "only its factor is used"), "{report}");
}

#[test]
fn bad_specular_glossiness_is_named() {
    for (json, word) in [
        (r#""glossinessFactor": 2"#, "roughness"),
        (r#""diffuseFactor": [0, 0, 0, 1], "specularFactor": [2, 1, 1]"#, "base_color"),
    ] {
        let (builder, _) = super::file::File::new().material(&specular_glossiness(json)).load();
        let error = builder.build().map(drop).unwrap_err().to_string();
        assert!(error.contains("material 'it'") && error.contains(word), "{error}");
    }
}

/// Factors and textures of a clearcoat are kept; what is not modelled is reported.
#[test]
fn clearcoats_are_read() {
    let of = |rest: &str| {
        format!(
            r#""pbrMetallicRoughness": {{"metallicFactor": 0}}, "extensions": {{"KHR_materials_clearcoat": {{{rest}}}}}"#
        )
    };
    let (material, report) = read(&of(r#""clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25"#));
    assert_eq!([material.clearcoat, material.clearcoat_roughness], [0.5, 0.25]);
    assert!(report.lines.is_empty(), "{report}");
    // The factor is 0 unless it is given.
    let (material, report) = read(&of(r#""clearcoatRoughnessFactor": 0.25"#));
    assert_eq!([material.clearcoat, material.clearcoat_roughness], [0.0; 2]);
    assert!(report.lines.is_empty(), "{report}");
    let bumpy = r#""clearcoatFactor": 1, "clearcoatNormalTexture": {"index": 0, "scale": 0.5}"#;
    let (builder, report) = textured(&of(bumpy), &[[51, 102, 230, 255], [128, 128, 255, 255]]).load();
    let found = &builder.materials[0].textures;
    let image = &builder.textures[found.clearcoat_normal.unwrap().texture.0 as usize].image;
    assert_eq!((image.format, found.clearcoat_normal_scale, found.normal), (TexelFormat::Linear8, 0.5, None));
    assert!(is_exact(&report), "{report}");

    let textures = r#""clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 1, "clearcoatTexture": {"index": 0}, "clearcoatRoughnessTexture": {"index": 0}"#;
    let texels = [[51, 102, 0, 255], [255, 0, 0, 255]];
    let (builder, report) = textured(&of(textures), &texels).load();
    let found = &builder.materials[0];
    let image = &builder.textures[found.textures.clearcoat.unwrap().texture.0 as usize].image;
    assert_eq!((image.format, &image.texels[..]), (TexelFormat::Linear8, &texels.map(u32::from_le_bytes)[..]));
    assert!(found.textures.clearcoat_roughness.is_some() && is_exact(&report), "{report}");
    let (builder, _) = textured(&of(textures), &[[51, 102, 0, 255]; 2]).load();
    let found = &builder.materials[0];
    assert_eq!([found.clearcoat, found.clearcoat_roughness, builder.textures.len() as f64], [0.1, 0.4, 0.0]);
    // Glass has none.
    let glass = r#""pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_clearcoat": {"clearcoatFactor": 1}}"#;
    assert!(says(&read(glass).1, "it", "its clearcoat, which glass"));
}

/// Share, colour and textures of diffuse transmission are kept; what is not modelled is reported.
#[test]
fn diffuse_transmission_is_read() {
    let of = |rest: &str| {
        format!(
            r#""pbrMetallicRoughness": {{"metallicFactor": 0}}, "extensions": {{"KHR_materials_diffuse_transmission": {{{rest}}}}}"#
        )
    };
    let (material, report) =
        read(&of(r#""diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorFactor": [0.25, 1, 0]"#));
    assert_eq!((material.diffuse_transmission, material.diffuse_transmission_color), (0.5, [0.25, 1.0, 0.0]));
    assert!(report.lines.is_empty(), "{report}");
    let (material, report) = read(&of(""));
    assert_eq!((material.diffuse_transmission, material.diffuse_transmission_color), (0.0, [1.0; 3]));
    assert!(report.lines.is_empty(), "{report}");
    // The share is alpha, linear; the colour sRGB.
    let both = r#""diffuseTransmissionFactor": 0.5, "diffuseTransmissionTexture": {"index": 0}, "diffuseTransmissionColorTexture": {"index": 0}"#;
    let texels = [[255, 0, 9, 102], [0, 0, 0, 255]];
    let (builder, report) = textured(&of(both), &texels).load();
    let found = &builder.materials[0].textures;
    let (share, color) = (found.diffuse_transmission.unwrap(), found.diffuse_transmission_color.unwrap());
    let image = &builder.textures[color.texture.0 as usize].image;
    assert_eq!((image.format, &image.texels[..]), (TexelFormat::Srgb8, &texels.map(u32::from_le_bytes)[..]));
    assert!(share == color && is_exact(&report), "{report}");
    let (builder, report) = textured(&of(both), &[[255, 0, 255, 102]; 2]).load();
    let found = &builder.materials[0];
    assert_eq!((found.diffuse_transmission, found.diffuse_transmission_color), (0.2, [1.0, 0.0, 1.0]));
    assert!(builder.textures.is_empty() && report.is_exact(), "{report}");
    // Glass has none, and a volume does not scatter.
    let with = |more: &str| format!("{}, {more}}}", of(r#""diffuseTransmissionFactor": 1"#).trim_end_matches('}'));
    let glass = with(r#""a": 0}, "KHR_materials_transmission": {"transmissionFactor": 1}"#);
    assert!(says(&read(&glass).1, "it", "its diffuse transmission, which glass"), "{}", read(&glass).1);
    let solid = with(r#""a": 0}, "KHR_materials_volume": {"thicknessFactor": 1}"#);
    assert!(says(&read(&solid).1, "it", "as a sheet"), "{}", read(&solid).1);
    for (rest, word) in [
        (r#""diffuseTransmissionFactor": 1.5"#, "diffuse_transmission"),
        (r#""diffuseTransmissionFactor": -1"#, "diffuse_transmission"),
        (
            r#""diffuseTransmissionFactor": 1, "diffuseTransmissionColorFactor": [0, 2, 0]"#,
            "diffuse_transmission_color",
        ),
    ] {
        let (builder, _) = super::file::File::new().material(&of(rest)).load();
        let error = builder.build().map(drop).unwrap_err().to_string();
        assert!(error.contains("material 'it'") && error.contains(word), "{error}");
    }
}

/// Colour, roughness and textures of a sheen are kept, over any opaque surface; glass has none.
#[test]
fn sheen_is_read() {
    let of = |rest: &str| {
        format!(
            r#""pbrMetallicRoughness": {{"metallicFactor": 0}}, "extensions": {{"KHR_materials_sheen": {{{rest}}}}}"#
        )
    };
    let (material, report) = read(&of(r#""sheenColorFactor": [0.25, 1, 0], "sheenRoughnessFactor": 0.5"#));
    assert_eq!((material.sheen_color, material.sheen_roughness), ([0.25, 1.0, 0.0], 0.5));
    assert!(report.lines.is_empty(), "{report}");
    // Black by default; a roughness alone is no sheen.
    let (material, report) = read(&of(r#""sheenRoughnessFactor": 0.5"#));
    assert_eq!((material.sheen_color, material.sheen_roughness), ([0.0; 3], 0.0));
    assert!(report.lines.is_empty(), "{report}");
    // The colour is sRGB, the roughness alpha, linear.
    let both = r#""sheenColorFactor": [1, 1, 0.5], "sheenColorTexture": {"index": 0}, "sheenRoughnessFactor": 0.5, "sheenRoughnessTexture": {"index": 0}"#;
    let texels = [[255, 0, 9, 102], [0, 0, 0, 255]];
    let (builder, report) = textured(&of(both), &texels).load();
    let found = &builder.materials[0].textures;
    let (color, roughness) = (found.sheen_color.unwrap(), found.sheen_roughness.unwrap());
    let image = &builder.textures[color.texture.0 as usize].image;
    assert_eq!((image.format, &image.texels[..]), (TexelFormat::Srgb8, &texels.map(u32::from_le_bytes)[..]));
    assert!(color == roughness && is_exact(&report), "{report}");
    let (builder, report) = textured(&of(both), &[[255, 0, 255, 102]; 2]).load();
    let found = &builder.materials[0];
    assert_eq!((found.sheen_color, found.sheen_roughness), ([1.0, 0.0, 0.5], 0.2));
    assert!(builder.textures.is_empty() && report.is_exact(), "{report}");
    let glass = r#""extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1]}}, "pbrMetallicRoughness": {"metallicFactor": 0}"#;
    assert!(says(&read(glass).1, "it", "its sheen, which glass"), "{}", read(glass).1);
    for (rest, word) in [
        (r#""sheenColorFactor": [0, 2, 0]"#, "sheen_color"),
        (r#""sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": -1"#, "sheen_roughness"),
    ] {
        let (builder, _) = super::file::File::new().material(&of(rest)).load();
        let error = builder.build().map(drop).unwrap_err().to_string();
        assert!(error.contains("material 'it'") && error.contains(word), "{error}");
    }
}

/// Emission under a clearcoat is read without loss.
#[test]
fn coated_emission_is_read() {
    let (material, report) =
        read(r#""emissiveFactor": [1, 0.5, 0], "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 0.5}}"#);
    assert_eq!((material.emission, material.clearcoat), ([1.0, 0.5, 0.0], 0.5));
    assert!(report.is_exact(), "{report}");
}

/// Strength, rotation and texture of an anisotropy are kept.
#[test]
fn anisotropies_are_read() {
    let of = |rest: &str| {
        format!(
            r#""pbrMetallicRoughness": {{"roughnessFactor": 0}}, "extensions": {{"KHR_materials_anisotropy": {{{rest}}}}}"#
        )
    };
    let (material, report) = read(&of(r#""anisotropyStrength": 0.5, "anisotropyRotation": 0.25"#));
    assert_eq!([material.anisotropy, material.anisotropy_rotation], [0.5, 0.25]);
    // No perfect mirror, although its roughness is 0.
    assert!(matches!(material.surface, Surface::Glossy { .. }) && report.lines.is_empty(), "{report}");
    // The strength is 0 unless it is given.
    let (material, report) = read(&of(r#""anisotropyRotation": 0.25, "anisotropyTexture": {"index": 9}"#));
    assert_eq!([material.anisotropy, material.anisotropy_rotation], [0.0; 2]);
    assert!(material == MaterialDesc::metal("it", [1.0; 3], 0.0) && report.lines.is_empty(), "{report}");

    let texture = r#""anisotropyStrength": 0.5, "anisotropyTexture": {"index": 0}"#;
    let texels = [[51, 102, 255, 255], [255, 0, 0, 255]];
    let (builder, report) = textured(&of(texture), &texels).load();
    let found = &builder.materials[0];
    let image = &builder.textures[found.textures.anisotropy.unwrap().texture.0 as usize].image;
    assert_eq!((image.format, &image.texels[..]), (TexelFormat::Linear8, &texels.map(u32::from_le_bytes)[..]));
    assert!(is_exact(&report), "{report}");
    let turned = r#""anisotropyStrength": 1, "anisotropyTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"rotation": 1}}}"#;
    assert!(says(&textured(&of(turned), &texels).load().1, "it", "anisotropy texture is turned"));
    // Glass has none.
    let glass = r#""pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_anisotropy": {"anisotropyStrength": 1}}"#;
    assert!(says(&read(glass).1, "it", "its anisotropy, which glass"));
}
