//! Records of surfaces that are partly glass.

use photon_core::{Features, Material, MaterialKind, MaterialTextures, MediaFeatures, Solids};
use photon_scene::{AlphaMode, MaterialDesc, Scene, SceneBuilder, Surface, TextureDesc, TextureRef, shapes};

use crate::{UVS, built, square, with_uvs};

const GLOSSY: Surface =
    Surface::Glossy { base_color: [0.5, 0.25, 1.0], metallic: 0.0, roughness: 0.5, specular: 0.75, ior: 1.25 };

fn surface(metallic: f64) -> MaterialDesc {
    let Surface::Glossy { base_color, roughness, specular, ior, .. } = GLOSSY else { unreachable!() };
    MaterialDesc::new("mixed", Surface::Glossy { base_color, metallic, roughness, specular, ior })
}

fn scene(desc: MaterialDesc) -> Scene {
    built(SceneBuilder::new(), with_uvs(UVS), desc)
}

fn textured(share: f64, texels: [[u8; 4]; 2]) -> Scene {
    let mut builder = SceneBuilder::new();
    let image = TextureRef::new(builder.texture(TextureDesc::linear8("shares", 2, 1, &texels)));
    let mut desc = surface(0.0).with_transmission(share, None);
    desc.textures.transmission = Some(image);
    built(builder, with_uvs(UVS), desc)
}

/// Shares of 0 and 1 are the surface without glass, and the glass, to the bit.
#[test]
fn surfaces_of_one_kind_are_what_they_are() {
    let same = |one: &Scene, other: &Scene| assert_eq!(one.view().digest(), other.view().digest());
    let plain = scene(surface(0.0));
    same(&scene(surface(0.0).with_transmission(0.0, Some([1.0; 3]))), &plain);
    same(&textured(0.5, [[0, 255, 9, 255]; 2]), &plain);
    let glass = Surface::Thin { ior: 1.25, tint: [0.5, 0.25, 1.0], roughness: 0.5 };
    let glass = scene(MaterialDesc::new("mixed", glass));
    same(&scene(surface(0.0).with_transmission(1.0, None)), &glass);
    same(&textured(1.0, [[255, 0, 9, 255]; 2]), &glass);
    let metal = scene(surface(1.0));
    same(&scene(surface(1.0).with_transmission(0.5, None)), &metal);
    for view in [plain.view(), glass.view(), metal.view()] {
        assert!(!Features::of(&view).contains(Features::PARTIAL_TRANSMISSION));
        assert!(view.shading.partial_transmissions.is_empty());
    }
    assert_ne!(plain.view().digest(), scene(surface(0.0).with_transmission(0.5, None)).view().digest());
}

#[test]
fn the_share_and_both_materials_are_recorded() {
    let mixed = scene(surface(0.25).with_transmission(0.5, None));
    let view = mixed.view();
    let [opaque, glass] = view.materials else { panic!("{:?}", view.materials) };
    assert_eq!((opaque.kind(), opaque.flags), (MaterialKind::Glossy, Material::PARTIAL_TRANSMISSION));
    assert_eq!((opaque.metallic, opaque.specular), (0.25, 0.75));
    assert_eq!((glass.kind(), glass.flags, glass.ior), (MaterialKind::Thin, 0, 1.25));
    assert_eq!((glass.albedo, glass.roughness), ([0.5, 0.25, 1.0], 0.5));
    let [entry] = view.shading.partial_transmissions else { panic!() };
    assert_eq!((entry.factor, entry.factor_texture, entry.glass), (0.5, MaterialTextures::NONE, 1));
    let needed = Features::GLOSSY | Features::THIN | Features::ROUGH_GLASS | Features::PARTIAL_TRANSMISSION;
    assert!(Features::of(&view).contains(needed));
    // Without a coat it is diffuse; the glass keeps its index.
    let matte = Surface::Glossy { base_color: [0.5; 3], metallic: 0.0, roughness: 0.0, specular: 0.0, ior: 1.25 };
    let mixed = scene(MaterialDesc::new("matte", matte).with_transmission(0.5, None));
    let view = mixed.view();
    assert_eq!(view.materials[0].kind(), MaterialKind::Lambert);
    assert_eq!((view.materials[1].kind(), view.materials[1].ior), (MaterialKind::Thin, 1.25));
    let mixed = textured(0.5, [[255, 0, 0, 255], [0; 4]]);
    assert_eq!(mixed.view().shading.partial_transmissions[0].factor_texture, 0);
}

/// A volume makes a solid, with a medium; unused materials have none.
#[test]
fn solids_have_an_inside() {
    let mut builder = SceneBuilder::new();
    let unused = builder.material(surface(0.0).with_transmission(0.5, Some([9.0; 3])));
    let gem = builder.material(surface(0.0).with_transmission(0.5, Some([2.0; 3])).with_priority(7));
    let glow = MaterialDesc::emissive("glow", [0.5; 3], [1.0; 3]);
    let glow = builder.material(glow.with_both_sides(true));
    assert_ne!(unused, gem);
    let (positions, triangles) = shapes::cuboid([-1.0; 3], [1.0; 3]);
    builder.mesh("gem", positions.clone(), triangles.clone(), gem);
    let inner = positions.iter().map(|at| at.map(|part| 0.5 * part)).collect();
    let glass = builder.material(MaterialDesc::glass("inner", 1.5));
    builder.mesh("inner", inner, triangles, glass);
    square(&mut builder, with_uvs(UVS), glow);
    let scene = builder.build().unwrap();
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    let view = scene.view();
    view.validate().unwrap();
    assert_eq!((view.media.len(), view.materials.len()), (3, 5));
    assert_eq!((view.materials[4].kind(), view.media[1].priority), (MaterialKind::Dielectric, 7));
    assert_eq!(Solids::of(&view).features(), MediaFeatures::NESTED);
    assert!(Features::of(&view).contains(Features::ABSORPTION));
    assert_ne!(Solids::of(&view).at([0.0, 0.0, 0.2]), photon_core::MediumStack::VACUUM);
}

#[test]
fn what_cannot_be_partly_glass_is_refused() {
    let fault = |desc: MaterialDesc| {
        let mut builder = SceneBuilder::new();
        let material = builder.material(desc);
        square(&mut builder, with_uvs(UVS), material);
        builder.build().err().map(|error| error.to_string()).expect("an error")
    };
    let lambert = fault(MaterialDesc::lambert("wall", [0.5; 3]).with_transmission(0.5, None));
    assert!(lambert.contains("'wall'") && lambert.contains("only a glossy surface"), "{lambert}");
    for (desc, part) in [
        (surface(0.0).with_transmission(1.5, None), "between 0 and 1"),
        (surface(0.0).with_transmission(f64::NAN, None), "between 0 and 1"),
        (surface(0.0).with_transmission(0.5, Some([-1.0; 3])), "transmission_absorption"),
        (surface(0.0).with_transmission(0.5, Some([0.0; 3])).with_alpha(AlphaMode::Blend, 0.5), "must be closed"),
    ] {
        let found = fault(desc);
        assert!(found.contains("'mixed'") && found.contains(part), "{found}");
    }
}
