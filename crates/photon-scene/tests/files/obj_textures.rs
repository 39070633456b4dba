//! Textures, texture coordinates, normals and colours of OBJ and MTL.

use crate::support::{Folder, names};
use photon_core::{Filter, Material, TexelFormat, Wrap, octahedral};
use photon_scene::{LoadReport, Scene, load};

/// A PNG of 8-bit RGB texels in one row.
pub(crate) fn png(texels: &[[u8; 3]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, texels.len() as u32, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().expect("a PNG").write_image_data(texels.as_flattened()).expect("a PNG");
    bytes
}

const TILES: [[u8; 3]; 2] = [[255, 0, 0], [0, 0, 255]];
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 0.75 5\n";

/// A textured square: the material is `a`, with these statements.
pub(crate) fn square(name: &str, statements: &str, face: &str) -> (Scene, LoadReport) {
    let folder = Folder::new(name);
    folder.file("wood grain.png", png(&TILES));
    folder.file("worn.png", png(&[[0, 50, 100], [0, 150, 200]]));
    folder.file("a.mtl", format!("newmtl a\n{statements}\n"));
    let obj = folder.file("a.obj", format!("mtllib a.mtl\nusemtl a\n{SQUARE}f {face}\n"));
    let (scene, report) = load(&obj, None).unwrap_or_else(|error| panic!("{error}"));
    scene.view().validate().expect("valid tables");
    (scene, report)
}

pub(crate) const FACE: &str = "1/1 2/2 3/3 4/4";

#[test]
fn diffuse_textures_have_their_coordinates_turned_over() {
    let (scene, report) = square("obj-map", "Kd 0.5 1 1\nmap_Kd wood grain.png", FACE);
    let tables = scene.view().shading;
    assert_eq!(tables.uvs[0], [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
    assert_eq!(tables.uvs[1][2], [0.0, 0.25]);
    let image = &tables.textures[0];
    assert_eq!((image.format, image.wrap, image.filter), (TexelFormat::Srgb8, [Wrap::Repeat; 2], Filter::Linear));
    assert_eq!(image.texels[..], [0xFF00_00FF, 0xFFFF_0000]);
    assert_eq!(scene.view().materials[0].albedo, [0.5, 1.0, 1.0]);
    assert!(report.is_exact(), "{report}");
    // Without Kd, the texture is the albedo.
    let (scene, report) = square("obj-only-map", "map_Kd wood grain.png", FACE);
    assert!(scene.view().materials[0].albedo == [1.0; 3] && report.is_exact(), "{report}");
}

#[test]
fn options_change_the_coordinates() {
    let statements = "Kd 1 1 1\nmap_Kd -s 2 3 1 -o 0.5 0.25 -clamp on -texres 64 wood grain.png";
    let (scene, report) = square("obj-options", statements, FACE);
    let tables = scene.view().shading;
    assert_eq!(tables.textures[0].wrap, [Wrap::Clamp; 2]);
    // v' = 1 − (3 (1 − v) + 0.25)
    assert_eq!(tables.uses[0].transform, [[2.0, 0.0, 0.5], [0.0, 3.0, -2.25]]);
    names(&report.to_string(), &["left out: material 'a': the options -texres 64 of its map_Kd"]);
}

#[test]
fn emission_and_normals_have_textures_too() {
    let (scene, report) = square("obj-emission", "Kd 0 0 0\nmap_Ke wood grain.png\nnorm -bm 0.5 wood grain.png", FACE);
    let view = scene.view();
    let formats: Vec<TexelFormat> = view.shading.textures.iter().map(|image| image.format).collect();
    assert_eq!(formats, [TexelFormat::Srgb8, TexelFormat::Linear8]);
    assert!(view.lights.len() == 2 && view.shading.tangents.len() == 2);
    assert_eq!(view.shading.material_textures[0].normal_scale, 0.5);
    names(&report.to_string(), &["note: material 'a': emits [1.0, 1.0, 1.0]"]);
}

#[test]
fn what_is_lost_of_textures_is_named() {
    let (scene, report) = square("obj-lost", "Kd 1 1 1\nmap_Kd gone.png\nmap_Bump -bm 1 bumps.png\nmap_Ks s.png", FACE);
    assert!(scene.view().shading.textures.is_empty());
    let text = report.to_string();
    names(&text, &["material 'a': its texture map_Kd gone.png: the file does not exist"]);
    names(&text, &["its textures (map_Bump -bm 1 bumps.png, map_Ks s.png)", "by `norm`"]);
    for outside in ["../a.png", "/etc/passwd", "..\\a.png"] {
        let (_, report) = square("obj-outside", &format!("Kd 1 1 1\nmap_Kd {outside}"), FACE);
        names(&report.to_string(), &["material 'a'", "outside the folder"]);
    }
    let (_, report) = square("obj-no-image", "Kd 1 1 1\nmap_Kd a.mtl", FACE);
    names(&report.to_string(), &["material 'a'", "map_Kd a.mtl", "unknown format"]);
    let (scene, report) = square("obj-no-vt", "Kd 1 1 1\nmap_Kd wood grain.png", "1 2/2 3/3 4/4");
    names(&report.to_string(), &["mesh 'a': 2 of its triangles have no texture coordinates"]);
    assert_eq!(scene.view().shading.uvs[0][0], [0.0; 2]);
    let (_, report) = square("obj-glass", "illum 7\nNi 1.5\nmap_Kd wood grain.png", FACE);
    names(&report.to_string(), &["its map_Kd: it is not diffuse"]);
}

#[test]
fn normals_smooth_and_shared_vertices_are_kept_where_they_can_be() {
    let smooth = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 1\nf 1//1 2//1 3//2\nf 1//1 3//1 4//1\n";
    let folder = Folder::new("obj-normals");
    let (scene, report) = load(&folder.file("a.obj", smooth), None).unwrap();
    let normals = scene.view().shading.normals;
    let tilted = octahedral::unpack(normals[0][2]);
    assert!((tilted.y - 0.5_f32.sqrt()).abs() < 1e-4, "{tilted}");
    // Position 3 has two normals.
    assert_eq!((scene.view().positions.len(), normals.len()), (5, 2));
    assert!(!report.to_string().contains("smoothed"), "{report}");
    // Flat normals change nothing at all.
    let flat = smooth.replace("vn 0 1 1", "vn 0 0 2");
    let (scene, _) = load(&folder.file("b.obj", flat), None).unwrap();
    assert!(scene.view().shading.normals.is_empty() && scene.view().positions.len() == 4);
}

#[test]
fn colours_of_vertices_are_srgb() {
    let folder = Folder::new("obj-colours");
    let text = "v 0 0 0 1 0.5 0\nv 1 0 0 1 1 1\nv 0 1 0\nf 1 2 3\n";
    let (scene, report) = load(&folder.file("a.obj", text), None).unwrap();
    let [first, second, third] = scene.view().shading.colors[0];
    let half = (0.214_041_14_f64 * 65_535.0).round() as u32;
    assert_eq!((first, second, third), ([half << 16 | 0xFFFF, 0xFFFF_0000], [u32::MAX; 2], [u32::MAX; 2]));
    // They alone are the albedo where there is no material.
    assert_eq!(scene.view().materials[0].albedo, [1.0; 3]);
    names(&report.to_string(), &["they are made diffuse, with the colours of its vertices as albedo"]);
    let (bytes, _) =
        load(&folder.file("b.obj", "v 0 0 0 255 0 0\nv 1 0 0 255 255 255\nv 0 1 0\nf 1 2 3\n"), None).unwrap();
    assert_eq!(bytes.view().shading.colors[0], [[0xFFFF, 0xFFFF_0000], [u32::MAX; 2], [u32::MAX; 2]]);
}

/// Some programs write `Tr 1` for opaque materials.
#[test]
fn a_transparency_of_one_is_opaque() {
    let (scene, report) = square("obj-tr", "Kd 1 1 1\nTr 1.0\nmap_Kd wood grain.png", FACE);
    assert_eq!(scene.view().materials[0].kind, 0);
    names(&report.to_string(), &["note: material 'a': its Tr is 1"]);
}

/// `map_d`: the mean of the channels of an image without alpha, and alpha itself of one that has it, which may be the
/// image of the colours too.
#[test]
fn dissolve_maps_are_alpha() {
    let (scene, report) = square("obj-dissolve", "Kd 1 1 1\nd 0.5\nmap_d wood grain.png", FACE);
    let material = scene.view().materials[0];
    // Both texels have a mean of a third, so that the texture is a factor.
    assert_eq!((material.flags, material.alpha_cutoff), (Material::ALPHA, 0.0));
    assert!((material.alpha - 0.5 * 85.0 / 255.0).abs() < 1e-6 && scene.view().shading.textures.is_empty());
    assert!(report.is_exact(), "{report}");

    let folder = Folder::new("obj-dissolve-alpha");
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header().expect("a PNG").write_image_data(&[255, 0, 0, 255, 0, 0, 255, 0]).expect("a PNG");
    folder.file("leaf.png", bytes);
    folder.file("a.mtl", "newmtl a\nKd 1 1 1\nmap_Kd leaf.png\nmap_d leaf.png\n");
    let obj = folder.file("a.obj", format!("mtllib a.mtl\nusemtl a\n{SQUARE}f {FACE}\n"));
    let (scene, report) = load(&obj, None).expect("a scene");
    let textures = scene.view().shading.material_textures[0];
    assert_eq!((textures.base_color, textures.alpha, scene.view().shading.textures.len()), (0, 0, 1));
    assert!(report.is_exact(), "{report}");
    // Without that, alpha is not read.
    folder.file("a.mtl", "newmtl a\nKd 1 1 1\nmap_Kd \"leaf.png\" # green\n");
    let (scene, report) = load(&obj, None).expect("a scene");
    assert!(!scene.view().materials[0].has_alpha() && scene.view().shading.textures.len() == 1);
    names(&report.to_string(), &["left out: material 'a': the alpha of its map_Kd"]);
}
