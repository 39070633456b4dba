//! Glossy materials of MTL.

use crate::obj_textures::{FACE, square};
use crate::support::names;
use photon_core::{Material, MaterialKind, TexelFormat};

/// Base colour, and metallic, roughness, specular and index, of a glossy material.
fn glossy(material: &Material) -> ([f32; 3], [f32; 4]) {
    assert_eq!(material.kind, MaterialKind::Glossy as u32);
    (material.albedo, [material.metallic, material.roughness, material.specular, material.ior])
}

#[test]
fn the_physically_based_extension() {
    let of = |statements: &str| {
        let (scene, report) = square("obj-pbr", statements, FACE);
        (scene.view().materials[0], report)
    };
    let (material, report) = of("Kd 0.5 0.25 1\nPr 0.25\nPm 0.75\nNi 1.25");
    assert_eq!(glossy(&material), ([0.5, 0.25, 1.0], [0.75, 0.25, 1.0, 1.25]));
    assert!(report.is_exact(), "{report}");
    // It takes precedence over Ks and a model that would be a mirror; an index of 1 is one that was never set.
    let (material, report) = of("Kd 1 1 1\nKs 0.5 0.5 0.5\nillum 3\nNi 1\nPr 0.25");
    assert!(glossy(&material).1 == [0.0, 0.25, 1.0, 1.5] && report.is_exact(), "{report}");
    let (material, report) = of("Kd 1 1 1\nPm 1");
    assert_eq!(glossy(&material).1[..2], [1.0, 0.5]);
    names(&report.to_string(), &["approximated: material 'a': has no roughness Pr; 0.5 is taken"]);
    let (material, report) = of("Kd 1 1 1\nPm 1\nPr 0");
    assert!(material.kind == MaterialKind::Mirror as u32 && report.is_exact(), "{report}");
    let (glass, report) = of("Kd 1 1 1\nillum 7\nNi 1.5\nPr 0.5\nPm 1");
    assert_eq!((glass.kind, glass.roughness), (MaterialKind::Dielectric as u32, 0.5));
    names(&report.to_string(), &["left out: material 'a': its metal (Pm): it transmits"]);
}

#[test]
fn highlights() {
    let of = |statements: &str| {
        let (scene, report) = square("obj-highlight", statements, FACE);
        (scene.view().materials[0], report.to_string())
    };
    // α = √(2/(30 + 2)) = 1/4.
    let (coat, report) = of("Kd 0.5 0.25 1\nKs 0.2 0.4 0.6\nNs 30");
    assert_eq!(glossy(&coat), ([0.5, 0.25, 1.0], [0.0, 0.5, 0.4, 1.5]));
    names(&report, &["note: material 'a': its highlight (Ks [0.2, 0.4, 0.6], Ns 30) is taken as a coat of"]);
    let (metal, report) = of("Kd 0 0 0\nKs 0.5 2 0.25\nNs 30");
    assert_eq!(glossy(&metal), ([0.5, 1.0, 0.25], [1.0, 0.5, 1.0, 1.5]));
    names(&report, &["is taken as a metal of roughness 0.500"]);
    let (dull, _) = of("Kd 1 1 1\nKs 9 9 9");
    assert_eq!(glossy(&dull).1, [0.0, 1.0, 1.0, 1.5]);
    // A texture is diffuse whatever Kd is, and so are models without a highlight.
    let (black, report) = of("Kd 0 0 0\nKs 1 1 1\nmap_Kd wood grain.png");
    assert_eq!(glossy(&black).1[0], 0.0);
    names(&report, &["its Kd of 0 makes its texture black"]);
    for statements in ["Kd 1 1 1\nKs 1 1 1\nillum 1", "Kd 1 1 1\nKs 0 0 0\nillum 2"] {
        let (diffuse, report) = of(statements);
        assert!(diffuse.kind == MaterialKind::Lambert as u32 && report.lines().count() <= 1, "{report}");
    }
}

#[test]
fn roughness_and_metal_have_one_texture() {
    let of = |statements: &str| {
        let (scene, report) = square("obj-worn", &format!("Kd 1 1 1\n{statements}"), FACE);
        let images: Vec<(TexelFormat, Vec<u32>)> =
            scene.view().shading.textures.iter().map(|image| (image.format, image.texels.to_vec())).collect();
        (scene.view().materials[0], images, report)
    };
    let texels = |a: [u8; 4], b: [u8; 4]| -> Vec<(TexelFormat, Vec<u32>)> {
        vec![(TexelFormat::Linear8, vec![u32::from_le_bytes(a), u32::from_le_bytes(b)])]
    };
    let (material, images, report) = of("map_Pr worn.png\nPr 0.5\nPm 0.25");
    assert_eq!(glossy(&material).1[..2], [0.25, 0.5]);
    assert_eq!(images, texels([0, 50, 255, 255], [0, 150, 255, 255]));
    assert!(report.is_exact(), "{report}");
    let (material, images, _) = of("map_Pm worn.png\nPr 0.5");
    assert_eq!(glossy(&material).1[..2], [1.0, 0.5]);
    assert_eq!(images, texels([0, 255, 100, 255], [0, 255, 200, 255]));
    let (material, images, report) = of("map_Pr wood grain.png\nmap_Pm worn.png");
    assert_eq!(glossy(&material).1[..2], [1.0, 1.0]);
    assert_eq!(images, texels([0, 0, 100, 255], [0, 0, 200, 255]));
    assert!(report.is_exact(), "{report}");
    let (_, images, report) = of("map_Pr worn.png\nmap_Pm -s 2 2 worn.png\nPm 0.5");
    assert_eq!(images, texels([0, 50, 255, 255], [0, 150, 255, 255]));
    names(&report.to_string(), &["left out: material 'a': its texture map_Pm worn.png: its size and options"]);
    let (material, images, report) = of("map_Pr gone.png\nPr 0.5\nmap_Pm -clamp on -boost 2 worn.png");
    assert!(glossy(&material).1[1] == 0.5 && images.len() == 1);
    names(&report.to_string(), &["its texture map_Pr gone.png: the file does not exist", "the options -boost 2"]);
}
