//! Alpha coverage of a builder, as tables.

use photon_core::{Features, Material, MaterialTextures};
use photon_scene::{AlphaMode, MaterialDesc, Scene, SceneBuilder, TextureDesc, TextureRef, VertexAttributes};

use crate::{UVS, built, square, with_uvs};

const MASK: AlphaMode = AlphaMode::Mask { cutoff: 0.5 };

/// A square, one of whose textures has these texels in a row, as base colour and as alpha.
fn textured(texels: &[[u8; 4]], mode: AlphaMode, alpha: f64) -> Scene {
    let mut builder = SceneBuilder::new();
    let image = builder.texture(TextureDesc::srgb8("leaf", texels.len() as u32, 1, texels));
    let mut material = MaterialDesc::lambert("leaf", [0.5; 3]).with_alpha(mode, alpha);
    (material.textures.base_color, material.textures.alpha) =
        (Some(TextureRef::new(image)), Some(TextureRef::new(image)));
    built(builder, with_uvs(UVS), material)
}

#[track_caller]
fn is_opaque(scene: &Scene) {
    let view = scene.view();
    assert!(!view.materials[0].has_alpha() && !Features::of(&view).contains(Features::ALPHA));
    assert!(view.shading.material_textures.iter().all(|textures| textures.alpha == MaterialTextures::NONE));
}

fn plain(mode: AlphaMode, alpha: f64) -> Scene {
    built(
        SceneBuilder::new(),
        VertexAttributes::default(),
        MaterialDesc::lambert("a", [0.5; 3]).with_alpha(mode, alpha),
    )
}

#[test]
fn what_is_there_everywhere_needs_no_alpha() {
    let holes = [[255, 0, 0, 255], [0, 255, 0, 10]];
    for scene in [
        plain(AlphaMode::Opaque, 0.3),
        plain(AlphaMode::Blend, 1.0),
        plain(MASK, 0.5),
        plain(AlphaMode::Mask { cutoff: 0.0 }, 0.1),
        textured(&holes, AlphaMode::Opaque, 0.3),
        textured(&holes, AlphaMode::Mask { cutoff: 0.0 }, 0.3),
        textured(&[[255, 0, 0, 255], [0, 255, 0, 255]], AlphaMode::Blend, 1.0),
        textured(&[[255, 0, 0, 200], [0, 255, 0, 200]], MASK, 0.9),
    ] {
        is_opaque(&scene);
        assert_eq!(scene.view().triangles.len(), 2);
    }
}

#[test]
fn what_is_nowhere_is_left_out() {
    let leaf = [[255, 0, 0, 100], [0, 255, 0, 10]];
    for scene in [
        plain(AlphaMode::Blend, 0.0),
        plain(MASK, 0.4),
        textured(&leaf, MASK, 0.4),
        textured(&leaf, AlphaMode::Mask { cutoff: 2.0 }, 1.0),
    ] {
        assert!(scene.view().triangles.is_empty());
        assert!(scene.warnings().iter().any(|warning| warning.contains("alpha of 0")), "{:?}", scene.warnings());
    }
}

#[test]
fn the_rest_is_in_the_tables() {
    let leaf = [[255, 0, 0, 255], [0, 255, 0, 10]];
    let material = |scene: &Scene| {
        let found = scene.view().materials[0];
        assert!(Features::of(&scene.view()).contains(Features::ALPHA));
        (found.flags, found.alpha, found.alpha_cutoff)
    };
    assert_eq!(material(&plain(AlphaMode::Blend, 0.25)), (Material::ALPHA, 0.25, 0.0));
    for (mode, cutoff) in [(AlphaMode::Blend, 0.0), (MASK, 0.5)] {
        let scene = textured(&leaf, mode, 0.75);
        assert_eq!(material(&scene), (Material::ALPHA, 0.75, cutoff));
        let textures = scene.view().shading.material_textures[0];
        assert_eq!((textures.alpha, textures.base_color), (0, 0), "one use serves both");
    }
    // An even alpha is a factor, and an even colour goes where the alpha stays.
    let scene = textured(&[[255, 0, 0, 51], [0, 255, 0, 51]], AlphaMode::Blend, 0.5);
    assert_eq!(material(&scene), (Material::ALPHA, 0.1, 0.0));
    assert_eq!(scene.view().shading.material_textures[0].alpha, MaterialTextures::NONE);
    let scene = textured(&[[255, 255, 255, 51], [255, 255, 255, 102]], AlphaMode::Blend, 1.0);
    let textures = scene.view().shading.material_textures[0];
    assert_eq!((textures.base_color, textures.alpha), (MaterialTextures::NONE, 0));
    assert_eq!(Features::of(&scene.view()), Features::DIFFUSE.union(Features::ALPHA));
    // Holes by vertex colours.
    let attributes = VertexAttributes::default().with_colors(vec![[1.0, 1.0, 1.0, 0.5]; 4]);
    let scene =
        built(SceneBuilder::new(), attributes, MaterialDesc::lambert("a", [0.5; 3]).with_alpha(AlphaMode::Blend, 1.0));
    assert_eq!((material(&scene), scene.view().shading.colors.len()), ((Material::ALPHA, 1.0, 0.0), 2));
}

#[test]
fn invalid_alpha_is_refused_by_name() {
    let refused = |material: MaterialDesc| {
        let mut builder = SceneBuilder::new();
        let material = builder.material(material);
        square(&mut builder, VertexAttributes::default(), material);
        builder.build().err().map(|error| error.to_string()).unwrap_or_default()
    };
    let with = |mode, alpha| refused(MaterialDesc::lambert("leaf", [0.5; 3]).with_alpha(mode, alpha));
    for bad in [f64::NAN, -0.1, 1.1, f64::INFINITY] {
        let error = with(AlphaMode::Blend, bad);
        assert!(error.contains("'leaf': alpha is") && error.contains("between 0 and 1"), "{error}");
    }
    for bad in [f64::NAN, -0.1, f64::INFINITY, 1e300] {
        let error = with(AlphaMode::Mask { cutoff: bad }, 0.5);
        assert!(error.contains("'leaf': the alpha cutoff is"), "{error}");
    }
    let error = refused(MaterialDesc::glass("gem", 1.5).with_alpha(AlphaMode::Blend, 0.5));
    assert!(error.contains("'gem': the alpha mode") && error.contains("closed"), "{error}");
    assert_eq!(refused(MaterialDesc::thin("pane", 1.5).with_alpha(AlphaMode::Blend, 0.5)), "");
}
