//! Materials and textures.

use super::file::{File, data_uri, png, says};
use crate::describe::{AlphaMode, Dispersion, MaterialDesc, Surface};
use crate::report::LoadReport;

pub(super) fn read(json: &str) -> (MaterialDesc, LoadReport) {
    let (builder, report) = File::new().material(json).load();
    (builder.materials[0].clone(), report)
}

#[track_caller]
pub(super) fn close(found: [f64; 3], expected: [f64; 3]) {
    let far = found.iter().zip(expected).any(|(found, expected)| (found - expected).abs() > 1e-6);
    assert!(!far, "{found:?} instead of {expected:?}");
}

/// A file whose only image is a PNG of these pixels, as texture 0.
pub(super) fn textured(material: &str, pixels: &[[u8; 4]]) -> File {
    let uri = data_uri("image/png", &png(pixels));
    File::new()
        .material(material)
        .with("textures", r#"[{"source": 0}]"#)
        .with("images", format!(r#"[{{"uri": "{uri}", "name": "tiles"}}]"#))
}

const CLEAR: &str =
    r#""pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0, "baseColorFactor": [1, 0.5, 1, 1]}"#;

fn glass(extensions: &str) -> (MaterialDesc, LoadReport) {
    read(&format!(
        r#"{CLEAR}, "extensions": {{"KHR_materials_transmission": {{"transmissionFactor": 1}}{extensions}}}"#
    ))
}

#[test]
fn transmission_is_a_sheet_without_a_volume_and_a_solid_with_one() {
    let (sheet, report) = glass("");
    assert_eq!(sheet.surface, Surface::Thin { ior: 1.5, tint: [1.0, 0.5, 1.0], roughness: 0.0 });
    assert!(report.lines.is_empty(), "{report}");
    let (solid, report) =
        glass(r#", "KHR_materials_volume": {"thicknessFactor": 0.1}, "KHR_materials_ior": {"ior": 1.25}"#);
    assert_eq!(
        solid.surface,
        Surface::Dielectric { ior: 1.25, absorption: [0.0; 3], tint: [1.0, 0.5, 1.0], roughness: 0.0 }
    );
    assert!(report.lines.is_empty(), "{report}");
    let (sheet, report) = glass(r#", "KHR_materials_volume": {"attenuationDistance": 2}"#);
    assert!(matches!(sheet.surface, Surface::Thin { .. }));
    assert!(says(&report, "it", "thicknessFactor"));
}

#[test]
fn solids_of_glass_disperse_light() {
    let of = |strength: &str, volume: &str| {
        glass(&format!(
            r#", "KHR_materials_dispersion": {{"dispersion": {strength}}}, "KHR_materials_volume": {{{volume}}}"#
        ))
    };
    let (solid, report) = of("0.33", r#""thicknessFactor": 1"#);
    assert_eq!(solid.dispersion, Some(Dispersion::Abbe(20.0 / 0.33)));
    assert!(report.lines.is_empty(), "{report}");
    assert_eq!(of("0", r#""thicknessFactor": 1"#).0.dispersion, None);
    let (sheet, report) = of("0.33", "");
    assert!(sheet.dispersion.is_none() && says(&report, "it", "KHR_materials_dispersion"), "{report}");
    let (matte, report) = read(r#""extensions": {"KHR_materials_dispersion": {"dispersion": 0.33}}"#);
    assert!(matte.dispersion.is_none() && says(&report, "it", "thicknessFactor"), "{report}");
}

/// The two drafts split the extinction; where no light scatters in a medium they are named.
#[test]
fn drafts_of_scattering_split_the_extinction() {
    let volume = r#""KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 0.25, 1]}"#;
    let of = |draft: &str| glass(&format!(", {volume}, {draft}"));
    let old = r#""KHR_materials_volume_scatter": {"multiscatterColor": [0.5, 0, 1], "scatterAnisotropy": 0.5}"#;
    let new = r#""KHR_materials_scatter": {"scatterStrengthFactor": 0.5, "multiscatterColorFactor": [1, 0, 1], "scatterAnisotropy": 0.5}"#;
    let extinction = [0.5, 0.25, 1.0].map(|color: f64| -color.ln() / 2.0);
    for draft in [old, new] {
        let (wax, report) = of(draft);
        let Surface::Dielectric { absorption, .. } = wax.surface else { panic!("{wax:?}") };
        // 0.953 816 is the albedo of 0.5 with g = 0.5; black is 6e-6, since its coefficients are rounded.
        let expected = [extinction[0] * 0.953_816, 0.0, 0.0];
        let far = wax.scattering.iter().zip(expected).any(|(found, expected)| (found - expected).abs() > 1e-5);
        assert!(!far && wax.phase == 0.5.into(), "{wax:?}");
        close(std::array::from_fn(|channel| absorption[channel] + wax.scattering[channel]), extinction);
        assert!(says(&report, "it", "draft") && report.lines.len() == 1, "{report}");
    }
    // Both: the newer one, whose strength is 0 unless it is given.
    let (clear, report) = of(&format!(r#"{old}, "KHR_materials_scatter": {{}}"#));
    assert!(clear.scattering == [0.0; 3] && report.lines.is_empty(), "{report}");
    let (forward, report) =
        of(r#""KHR_materials_volume_scatter": {"multiscatterColor": [1, 1, 1], "scatterAnisotropy": 1}"#);
    assert!(forward.phase == 0.999.into() && says(&report, "it", "0.999"), "{report}");
    let (textured, report) = of(
        r#""KHR_materials_volume_scatter": {"multiscatterColor": [1, 1, 1], "multiscatterColorTexture": {"index": 0}}"#,
    );
    assert!(textured.scattering[0] > 0.0 && says(&report, "it", "only their factors"), "{report}");
    let (sheet, report) = glass(&format!(", {old}"));
    assert!(sheet.scattering == [0.0; 3] && says(&report, "it", "thicknessFactor"), "{report}");
    let (empty, report) = glass(&format!(r#", "KHR_materials_volume": {{"thicknessFactor": 1}}, {old}"#));
    assert!(empty.scattering == [0.0; 3] && says(&report, "it", "attenuationDistance"), "{report}");
    let (matte, report) = read(&format!(r#""extensions": {{{volume}, {old}}}"#));
    assert!(matte.scattering == [0.0; 3] && says(&report, "it", "all glass"), "{report}");
}

#[test]
fn absorption_leaves_the_attenuation_colour_after_its_distance() {
    let (solid, report) = glass(
        r#", "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 4, "attenuationColor": [1, 0.5, 0.125]}"#,
    );
    let Surface::Dielectric { absorption, .. } = solid.surface else { panic!("{solid:?}") };
    close(absorption.map(|sigma| (-sigma * 4.0).exp()), [1.0, 0.5, 0.125]);
    assert!(report.lines.is_empty() && absorption[0].is_sign_positive());
    let (solid, report) = glass(
        r#", "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0, 1, 1]}"#,
    );
    let Surface::Dielectric { absorption, .. } = solid.surface else { panic!("{solid:?}") };
    close(absorption, [1e6_f64.ln() / 2.0, 0.0, 0.0]);
    assert!(says(&report, "it", "millionth"));
    let (solid, report) = glass(
        r#", "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 0, "attenuationColor": [0, 1, 1]}"#,
    );
    assert!(matches!(solid.surface, Surface::Dielectric { absorption: [0.0, 0.0, 0.0], .. }));
    assert!(says(&report, "it", "attenuation distance of 0"));
    let (_, report) = glass(r#", "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": -3}"#);
    assert!(says(&report, "it", "attenuation distance of -3"), "{report}");
}

#[test]
fn a_share_of_glass_is_kept() {
    let of = |factor: f64, pbr: &str| {
        read(&format!(
            r#""pbrMetallicRoughness": {{{pbr}}}, "extensions": {{"KHR_materials_transmission": {{"transmissionFactor": {factor}}}}}"#
        ))
    };
    for (factor, metallic) in [(0.75, 0.0), (0.25, 0.0), (0.5, 0.75), (1.0, 0.25)] {
        let (mixed, report) = of(factor, &format!(r#""metallicFactor": {metallic}, "roughnessFactor": 0.25"#));
        let Surface::Glossy { metallic: found, roughness: 0.25, specular: 1.0, ior: 1.5, .. } = mixed.surface else {
            panic!("{mixed:?}")
        };
        assert_eq!((mixed.transmission, found, mixed.transmission_absorption), (factor, metallic, None));
        assert!(report.is_exact(), "{report}");
    }
    // None, and all of it, are what they were before.
    assert_eq!(of(0.0, r#""metallicFactor": 0"#).0, MaterialDesc::plastic("it", [1.0; 3], 1.0));
    assert_eq!(of(1.0, r#""metallicFactor": 0, "roughnessFactor": 0"#).0, MaterialDesc::thin("it", 1.5));
    // Metal does not transmit.
    for factor in [0.5, 1.0] {
        let (metal, report) = of(factor, r#""metallicFactor": 1, "roughnessFactor": 0"#);
        assert!(metal == MaterialDesc::metal("it", [1.0; 3], 0.0) && report.is_exact());
    }
    let with = |rest: &str| {
        read(&format!(
            r#""pbrMetallicRoughness": {{"metallicFactor": 0}}, "extensions": {{"KHR_materials_transmission": {{"transmissionFactor": 0.5}}, {rest}}}"#
        ))
    };
    let (solid, report) = with(r#""KHR_materials_volume": {"thicknessFactor": 1}"#);
    assert!(solid.transmission == 0.5 && solid.transmission_absorption == Some([0.0; 3]) && report.is_exact());
    let (coated, report) = with(r#""KHR_materials_clearcoat": {"clearcoatFactor": 1}"#);
    assert!(
        coated.transmission == 0.5 && coated.clearcoat == 1.0 && says(&report, "it", "its clearcoat is left out for")
    );
    let (matte, report) = with(r#""KHR_materials_specular": {"specularFactor": 0}"#);
    assert!(matches!(matte.surface, Surface::Glossy { specular: 0.0, ior: 1.5, .. }) && matte.transmission == 0.5);
    assert!(says(&report, "it", "the specular factor of its glass"), "{report}");
    let (coat, _) = with(r#""KHR_materials_ior": {"ior": 0}"#);
    assert!(matches!(coat.surface, Surface::Glossy { ior: 0.0, .. }) && coat.transmission == 0.0);
}

#[test]
fn the_index_0_reflects_everything() {
    let (mirror, report) = glass(r#", "KHR_materials_ior": {"ior": 0}"#);
    assert_eq!(mirror.surface, Surface::Mirror { reflectance: [1.0; 3] });
    assert!(says(&report, "it", "index 0"));
    let json = format!(
        r#"{CLEAR}, "extensions": {{"KHR_materials_ior": {{"ior": 0}}, "KHR_materials_specular": {{"specularFactor": 0.5, "specularColorFactor": [1, 1, 0.5]}}}}"#
    );
    let (coat, report) = read(&json);
    let Surface::Glossy { base_color, specular, ior, .. } = coat.surface else { panic!("{coat:?}") };
    assert_eq!((base_color, specular, ior), ([1.0, 0.5, 1.0], 0.5, 0.0));
    assert!(coat.specular_color == [1.0, 1.0, 0.5] && report.is_exact(), "{report}");
}

#[test]
fn nits_are_radiance() {
    let (area_light, _) = read(
        r#""emissiveFactor": [1, 0.5, 0], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}}"#,
    );
    assert_eq!((area_light.emission, area_light.emits_both_sides), ([8.0, 4.0, 0.0], false));
    let (area_light, _) = read(r#""emissiveFactor": [1, 1, 1], "doubleSided": true"#);
    assert_eq!((area_light.emission, area_light.emits_both_sides), ([1.0; 3], true));
}

#[test]
fn alpha_is_coverage() {
    let blend = |alpha: f64, mode: &str| {
        let (material, report) = read(&format!(
            r#""alphaMode": "{mode}", "pbrMetallicRoughness": {{"metallicFactor": 0, "baseColorFactor": [0.5, 0.5, 0.5, {alpha}]}}"#
        ));
        assert!(report.is_exact() && matches!(material.surface, Surface::Glossy { .. }), "{report}");
        (material.alpha_mode, material.alpha)
    };
    assert_eq!(blend(0.25, "BLEND"), (AlphaMode::Blend, 0.25));
    assert_eq!(blend(0.0, "BLEND"), (AlphaMode::Blend, 0.0));
    assert_eq!(blend(0.25, "MASK"), (AlphaMode::Mask { cutoff: 0.5 }, 0.25));
    assert_eq!(blend(0.25, "MASK\", \"alphaCutoff\": 0.75, \"x\": \""), (AlphaMode::Mask { cutoff: 0.75 }, 0.25));
    assert_eq!(blend(0.25, "OPAQUE"), (AlphaMode::Opaque, 1.0));
    // The alpha of the base colour's texture, in its place.
    let json =
        r#""alphaMode": "BLEND", "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 0}}"#;
    let alpha_of = |json: &str, pixels: &[[u8; 4]]| {
        let (builder, report) = textured(json, pixels).load();
        assert!(!report.to_string().contains("alpha"), "{report}");
        let MaterialDesc { alpha, textures, .. } = builder.materials[0].clone();
        (alpha, textures.base_color.is_some(), textures.alpha == textures.base_color)
    };
    let holes = [[255, 0, 255, 0], [255, 255, 255, 204]];
    assert_eq!(alpha_of(json, &holes), (1.0, true, true));
    assert_eq!(alpha_of(&json.replace("BLEND", "MASK"), &holes), (1.0, true, true));
    assert_eq!(alpha_of(&json.replace("BLEND", "OPAQUE"), &holes), (1.0, true, false));
    assert_eq!(alpha_of(json, &[[255, 0, 255, 51]; 2]), (0.2, false, true));
    // Solids are closed.
    let json = r#""alphaMode": "BLEND", "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0, "baseColorFactor": [1, 1, 1, 0.5]}, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {"thicknessFactor": 1}}"#;
    let (solid, report) = read(json);
    assert!(matches!(solid.surface, Surface::Dielectric { .. }) && solid.alpha_mode == AlphaMode::Opaque);
    assert!(says(&report, "it", "its alpha: the boundary of a solid must be closed"), "{report}");
}

#[test]
fn shares_of_glass_are_textures() {
    let json = r#""pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1, "transmissionTexture": {"index": 0}}}"#;
    let (builder, report) = textured(json, &[[0, 255, 255, 255]]).load();
    assert!(builder.materials[0] == MaterialDesc::plastic("it", [1.0; 3], 1.0) && report.is_exact(), "{report}");
    let (builder, report) = textured(json, &[[0, 255, 255, 255], [255, 0, 0, 255]]).load();
    let found = &builder.materials[0];
    let texture = found.textures.transmission.expect("a texture");
    assert!(matches!(found.surface, Surface::Glossy { .. }) && found.transmission == 1.0, "{found:?}");
    assert!(report.lines.iter().all(|line| !line.subject.contains("material")), "{report}");
    assert_eq!(builder.textures[texture.texture.0 as usize].image.format, photon_core::TexelFormat::Linear8);
}

#[test]
fn pictures_that_cannot_be_read_leave_the_factor() {
    let json = r#""pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.5, 0.5, 0.5, 1], "baseColorTexture": {"index": 0}}"#;
    let file = textured(json, &[[1, 2, 3, 4]]);
    let jpeg = format!(r#"[{{"uri": "{}"}}]"#, data_uri("image/jpeg", b"\xff\xd8\xff\xe0"));
    for (file, text) in [
        (file.clone().with("images", jpeg), "JPEG"),
        (file.clone().with("images", r#"[{"uri": "no-such-file.png"}]"#), "does not exist"),
        (file.clone().with("images", r#"[{}]"#), "no data"),
        (file.clone().with("images", r#"[{"bufferView": 77}]"#), "buffer view 77"),
        (
            file.clone().with("textures", r#"[{"extensions": {"KHR_texture_basisu": {"source": 0}}}]"#),
            "KHR_texture_basisu",
        ),
        (file.clone().with("images", r#"[{"bufferView": 0, "mimeType": "image/png"}]"#), "unknown format"),
        (file.clone().with("images", r#"[{"uri": "../up.png"}]"#), "outside the folder"),
    ] {
        let (builder, report) = file.load();
        assert_eq!(builder.materials[0], MaterialDesc::plastic("it", [0.5; 3], 1.0));
        assert!(!report.is_exact() && says(&report, "it", text), "{text}: {report}");
    }
    let error = file.clone().with("textures", "[]").error();
    assert!(error.contains("material 0 'it'") && error.contains("texture 0"), "{error}");
    let error = file.with("images", "[]").error();
    assert!(error.contains("image 0"), "{error}");
}

#[test]
fn what_has_no_counterpart_is_named() {
    let (_, report) = read(
        r#""extensions": {"KHR_materials_iridescence": {}, "KHR_materials_dispersion": {"dispersion": 1}}, "occlusionTexture": {"index": 0}"#,
    );
    for text in ["KHR_materials_iridescence", "KHR_materials_dispersion", "occlusion"] {
        assert!(says(&report, "material 'it'", text), "{text}: {report}");
    }
    // Of an unlit material nothing but the base colour is left.
    let base = r#""pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.125, 1]}"#;
    let more = r#""KHR_materials_clearcoat": {"clearcoatFactor": 1}, "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": 0.5}, "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 1, "diffuseTransmissionColorFactor": [1, 0, 0]}, "KHR_materials_anisotropy": {"anisotropyStrength": 1}, "KHR_materials_transmission": {"transmissionFactor": 1}"#;
    let (unlit, report) =
        read(&format!(r#"{base}, "emissiveFactor": [1, 1, 1], "extensions": {{"KHR_materials_unlit": {{}}, {more}}}"#));
    assert_eq!(
        unlit,
        MaterialDesc { emits_both_sides: unlit.emits_both_sides, ..MaterialDesc::lambert("it", [0.5, 0.25, 0.125]) }
    );
    assert!(says(&report, "it", "unlit"));
}

#[test]
fn bad_materials_are_named() {
    for (json, words) in [
        (r#""pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [2, 0, 0, 1]}"#, ["material 'it'", "2.0"]),
        (r#""pbrMetallicRoughness": {"metallicFactor": 1.5}"#, ["material 'it'", "metallic"]),
        (r#""pbrMetallicRoughness": {"roughnessFactor": -0.5}"#, ["material 'it'", "roughness"]),
        (
            r#""pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_ior": {"ior": -1}}"#,
            ["material 'it'", "ior"],
        ),
        (
            r#""pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_ior": {"ior": -1}, "KHR_materials_specular": {"specularColorFactor": [0.5, 0.5, 0.5]}}"#,
            ["material 'it'", "ior"],
        ),
        (
            r#""pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_specular": {"specularFactor": -0.5}}"#,
            ["material 'it'", "specular"],
        ),
        (
            r#""extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": "one"}}"#,
            ["KHR_materials_clearcoat", "clearcoatFactor is \"one\""],
        ),
        (
            r#""extensions": {"KHR_materials_sheen": {"sheenColorFactor": [1, 1]}}"#,
            ["sheenColorFactor is [1,1]", "must be 3 numbers"],
        ),
        (
            r#""extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": -3}}"#,
            ["material 0 'it'", "clearcoatFactor is -3; it must be a number from 0 to 1"],
        ),
        (
            r#""extensions": {"KHR_materials_anisotropy": []}"#,
            ["material 0 'it'", "KHR_materials_anisotropy is no object"],
        ),
        (
            r#""extensions": {"KHR_materials_transmission": {"transmissionFactor": 5}}"#,
            ["material 0 'it'", "transmissionFactor is 5; it must be a number from 0 to 1"],
        ),
        (
            r#""extensions": {"KHR_materials_transmission": {"transmissionFactor": -5}}"#,
            ["material 0 'it'", "transmissionFactor is -5"],
        ),
        (r#""emissiveFactor": [-1, 0, 0]"#, ["material 'it'", "emission"]),
        (r#""emissiveFactor": [1e39, 0, 0]"#, ["material 'it'", "inf"]),
        (r#""alphaMode": "FOG""#, ["material 0 'it'", "alphaMode"]),
        (
            r#""extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": -1}}, "pbrMetallicRoughness": {"metallicFactor": 0}"#,
            ["material 'it'", "ior"],
        ),
    ] {
        let error = File::new().material(json).error();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
}
