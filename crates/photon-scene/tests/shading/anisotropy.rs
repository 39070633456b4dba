//! Records and tangents of anisotropic surfaces.

use glam::Vec3;
use photon_core::{Features, MaterialKind, octahedral};
use photon_scene::{MaterialDesc, Scene, SceneBuilder, TextureDesc, TextureRef, VertexAttributes};

use crate::{UVS, built, with_uvs};

fn brushed(strength: f64, rotation: f64) -> MaterialDesc {
    MaterialDesc::metal("brushed", [0.9; 3], 0.3).with_anisotropy(strength, rotation)
}

fn features(scene: &Scene) -> Features {
    Features::of(&scene.view())
}

#[test]
fn scenes_without_anisotropy_have_no_tables_for_it() {
    let none = [
        brushed(0.0, 1.0),
        MaterialDesc::lambert("diffuse", [0.5; 3]).with_anisotropy(1.0, 0.0),
        MaterialDesc::thin("pane", 1.5).with_anisotropy(1.0, 0.0),
        MaterialDesc::mirror("mirror", [0.5; 3]).with_anisotropy(1.0, 0.0),
        // As narrow as a mirror along the tangent too.
        MaterialDesc::metal("smooth", [0.5; 3], 0.0).with_anisotropy(0.03, 0.0),
    ];
    for desc in none {
        let scene = built(SceneBuilder::new(), with_uvs(UVS), desc);
        let tables = scene.view().shading;
        assert!(tables.anisotropies.is_empty() && tables.tangents.is_empty() && tables.material_textures.is_empty());
        assert!(!features(&scene).contains(Features::ANISOTROPY));
    }
}

#[test]
fn strength_and_direction_are_recorded() {
    let scene = built(SceneBuilder::new(), with_uvs(UVS), brushed(0.7, 0.5));
    let found = scene.view().shading.anisotropies[0];
    assert_eq!(found.strength, 0.7);
    assert!((found.direction[0] - 0.5_f32.cos()).abs() < 1e-6 && (found.direction[1] - 0.5_f32.sin()).abs() < 1e-6);
    assert!(features(&scene).contains(Features::ANISOTROPY));
    assert!(!features(&scene).contains(Features::TEXTURES));
    // A smooth metal is no mirror along its tangent.
    let smooth = MaterialDesc::metal("smooth", [0.5; 3], 0.0).with_anisotropy(1.0, 0.0);
    let scene = built(SceneBuilder::new(), with_uvs(UVS), smooth);
    assert_eq!(scene.view().materials[0].kind, MaterialKind::Glossy as u32);
}

/// A texture of one colour is the same as factors, another one stays.
#[test]
fn textures_of_one_colour_are_folded() {
    let with = |texels: [[u8; 4]; 2]| {
        let mut builder = SceneBuilder::new();
        let image = builder.texture(TextureDesc::linear8("directions", 2, 1, &texels));
        let mut desc = brushed(0.5, 0.5);
        desc.textures.anisotropy = Some(TextureRef::new(image));
        built(builder, with_uvs(UVS), desc)
    };
    // Along −y by far, of 40 % strength.
    let scene = with([[128, 0, 102, 255]; 2]);
    let found = scene.view().shading.anisotropies[0];
    let turned = 0.5 - std::f32::consts::FRAC_PI_2;
    assert!((found.strength - 0.2).abs() < 1e-6 && scene.view().shading.textures.is_empty());
    assert!((found.direction[0] - turned.cos()).abs() < 5e-3 && (found.direction[1] - turned.sin()).abs() < 5e-3);
    let scene = with([[128, 0, 102, 255], [255, 128, 255, 255]]);
    assert_eq!((scene.view().shading.anisotropies[0].texture, scene.view().shading.textures.len()), (0, 1));
    assert!(features(&scene).contains(Features::TEXTURES));
}

/// Tangents: those of the mesh, else by texture coordinates, else around the y axis, which a warning says.
#[test]
fn tangents_are_given_generated_or_around_an_axis() {
    let undirected = |scene: &Scene| scene.warnings().iter().filter(|w| w.starts_with("2 triangles are aniso")).count();
    let is_along = |scene: &Scene, axis: Vec3| {
        let tangents = scene.view().shading.tangents.as_flattened();
        tangents.iter().all(|packed| octahedral::unpack(*packed).distance(axis.normalize_or_zero()) < 1e-4)
    };
    let scene = built(SceneBuilder::new(), with_uvs(UVS), brushed(0.7, 0.0));
    assert!(is_along(&scene, Vec3::X) && undirected(&scene) == 0, "{:?}", scene.warnings());
    let given = with_uvs(UVS).with_tangents(vec![[3.0, 4.0, 0.0, 1.0]; 4]);
    let scene = built(SceneBuilder::new(), given, brushed(0.7, 0.0));
    assert!(is_along(&scene, Vec3::new(0.6, 0.8, 0.0)) && undirected(&scene) == 0);
    let alone = VertexAttributes::default().with_tangents(vec![[3.0, 4.0, 0.0, 1.0]; 4]);
    assert_eq!(undirected(&built(SceneBuilder::new(), alone, brushed(0.7, 0.0))), 0);
    let scene = built(SceneBuilder::new(), VertexAttributes::default(), brushed(0.7, 0.0));
    assert!(is_along(&scene, Vec3::X) && undirected(&scene) == 1, "{:?}", scene.warnings());
    // Coordinates that have no direction.
    let scene = built(SceneBuilder::new(), with_uvs([[0.5; 2]; 4]), brushed(0.7, 0.0));
    assert!(scene.warnings().iter().any(|warning| warning.contains("tangents are zero")), "{:?}", scene.warnings());
    features(&scene);
}
