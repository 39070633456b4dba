//! Records of sheets that transmit diffusely.

use photon_core::{DiffuseTransmission, Features, Material, MaterialKind, MaterialTextures, PhotonFormat, Settings};
use photon_scene::{MaterialDesc, Scene, SceneBuilder, TextureDesc, TextureRef};

use crate::{UVS, built, with_uvs};

fn leaf(share: f64, color: [f64; 3]) -> MaterialDesc {
    MaterialDesc::lambert("leaf", [0.5; 3]).with_diffuse_transmission(share, color)
}

fn features(scene: &Scene) -> Features {
    Features::of(&scene.view())
}

#[test]
fn scenes_without_it_have_no_tables_for_it() {
    let none = [
        leaf(0.0, [0.3; 3]),
        MaterialDesc::metal("metal", [0.5; 3], 0.3).with_diffuse_transmission(1.0, [1.0; 3]),
        MaterialDesc::mirror("mirror", [0.5; 3]).with_diffuse_transmission(1.0, [1.0; 3]),
        MaterialDesc::thin("pane", 1.5).with_diffuse_transmission(1.0, [1.0; 3]),
    ];
    for desc in none {
        let scene = built(SceneBuilder::new(), with_uvs(UVS), desc);
        let view = scene.view();
        assert!(view.shading.diffuse_transmissions.is_empty() && view.shading.material_textures.is_empty());
        assert!(!features(&scene).contains(Features::DIFFUSE_TRANSMISSION) && view.materials[0].flags == 0);
    }
}

#[test]
fn shares_and_colours_are_recorded() {
    let scene = built(SceneBuilder::new(), with_uvs(UVS), leaf(0.25, [0.5, 0.25, 1.0]));
    let view = scene.view();
    let expected = DiffuseTransmission { color: [0.5, 0.25, 1.0], factor: 0.25, ..DiffuseTransmission::NONE };
    assert_eq!(view.shading.diffuse_transmissions, [expected]);
    let Material { kind, flags, specular, .. } = view.materials[0];
    assert_eq!((kind, flags, specular), (MaterialKind::Glossy as u32, Material::DIFFUSE_TRANSMISSION, 0.0));
    assert!(
        features(&scene).contains(Features::DIFFUSE_TRANSMISSION) && !features(&scene).contains(Features::TEXTURES)
    );
    // Black in front, but not from behind.
    assert!(Material { albedo: [0.0; 3], ..view.materials[0] }.stores_photons());
    // Coloured light needs colours of photons, and grey does not.
    let format = |color| {
        let scene = built(SceneBuilder::new(), with_uvs(UVS), leaf(0.25, color));
        PhotonFormat::of(&scene.view(), &Settings::default())
    };
    assert_eq!([[0.5, 0.25, 1.0], [0.5; 3]].map(format), [PhotonFormat::NoDirection, PhotonFormat::Mono]);
}

/// Textures of one colour are the same as factors, others stay.
#[test]
fn textures_of_one_colour_are_folded() {
    let with = |texels: [[u8; 4]; 2]| {
        let mut builder = SceneBuilder::new();
        let image = TextureRef::new(builder.texture(TextureDesc::srgb8("leaf", 2, 1, &texels)));
        let mut desc = leaf(0.5, [0.5; 3]);
        desc.textures.diffuse_transmission = Some(image);
        desc.textures.diffuse_transmission_color = Some(image);
        built(builder, with_uvs(UVS), desc)
    };
    let scene = with([[255, 0, 255, 102]; 2]);
    let found = scene.view().shading.diffuse_transmissions[0];
    assert_eq!((found.factor, found.color), (0.2, [0.5, 0.0, 0.5]));
    assert_eq!([found.color_texture, found.factor_texture], [MaterialTextures::NONE; 2]);
    let scene = with([[255, 0, 255, 102], [255, 1, 255, 103]]);
    let found = scene.view().shading.diffuse_transmissions[0];
    assert_eq!((found.factor, found.color, found.color_texture, found.factor_texture), (0.5, [0.5; 3], 0, 1));
    assert!(features(&scene).contains(Features::TEXTURES));
    // Transparent everywhere: none.
    assert!(with([[255, 0, 255, 0]; 2]).view().shading.diffuse_transmissions.is_empty());
}
