//! Alpha coverage: what see-through surfaces and lights reflect and emit, and scenes without alpha.

use std::f64::consts::PI;

use photon_core::{Direct, Features, Settings};
use photon_scene::{
    AlphaMode, CameraDesc, EnvironmentDesc, MaterialDesc, Projection, Scene, SceneBuilder, TextureDesc, TextureRef,
    TexturesDesc, VertexAttributes,
};

use crate::alpha::{FAINT, chequered, direct_light, look_down, mean_red, sheet, sun};
use crate::closed_room;
use crate::harness::{TestBackend, film, look_at_point, per_pass, trace, watts};
use crate::stats::{assert_agrees, moments, standard_error};

/// A white sheet of alpha a above a black floor reflects a of the light, by shadow rays and by photons: those stored on
/// it stand for all that arrive. The mirror and the pane likewise.
pub fn a_sheet_reflects_its_share<T: TestBackend>() {
    for (alpha, direct) in [(0.2, Direct::Nee), (0.2, Direct::Photons), (0.75, Direct::Photons)] {
        let mut builder = SceneBuilder::new();
        sheet(&mut builder, 0.5, MaterialDesc::lambert("sheet", [1.0; 3]).with_alpha(AlphaMode::Blend, alpha));
        sheet(&mut builder, 0.0, MaterialDesc::lambert("floor", [0.0; 3]));
        sun(&mut builder);
        look_down(&mut builder, 1.0, 0.5);
        let values = per_pass::<T>(&builder.build().unwrap(), &direct_light(direct), 32, 8);
        assert_agrees(&format!("{direct:?} {alpha}"), moments(&values).0, alpha, standard_error(&values), 1e-6);
    }
    // A mirror that is there for 0.4 of the views shows an area light above the camera; a black floor is behind it.
    let mut builder = SceneBuilder::new();
    sheet(&mut builder, 0.0, MaterialDesc::mirror("mirror", [1.0; 3]).with_alpha(AlphaMode::Blend, 0.4));
    sheet(&mut builder, -0.5, MaterialDesc::lambert("floor", [FAINT; 3]));
    sheet(&mut builder, 2.0, MaterialDesc::emissive("area light", [0.0; 3], [1.0; 3]).with_both_sides(true));
    look_down(&mut builder, 1.0, 0.5);
    let found = mean_red(&film::<T>(&builder.build().unwrap(), &direct_light(Direct::Nee), 64, 8));
    assert_agrees("mirror", found, 0.4, (0.24_f64 / 4096.0).sqrt(), 1e-6);
}

/// A light of alpha a emits a of its power, to photons, shadow rays and cameras; one that is a mask emits where it is.
pub fn a_light_emits_its_share<T: TestBackend>() {
    let emitter = MaterialDesc::emissive("area light", [0.0; 3], [1.0; 3]);
    let area_light = |masked: bool| {
        let mut builder = SceneBuilder::new();
        let material = if masked {
            chequered(&mut builder, emitter.clone(), AlphaMode::Mask { cutoff: 0.5 })
        } else {
            emitter.clone().with_alpha(AlphaMode::Blend, 0.5)
        };
        let material = builder.material(material);
        let positions = vec![[-0.5, 1.0, -0.5], [0.5, 1.0, -0.5], [0.5, 1.0, 0.5], [-0.5, 1.0, 0.5]];
        let uvs = positions.iter().map(|p: &[f64; 3]| [p[0], p[2]]).collect();
        let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
        builder.mesh_with("area light", positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
        builder
    };
    for masked in [false, true] {
        let mut builder = area_light(masked);
        sheet(&mut builder, 0.0, MaterialDesc::lambert("floor", [0.5; 3]));
        let mut seen_above = builder.clone();
        look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 0.5, 0.02);
        let scene = builder.build().unwrap();
        let (_, tally) = trace::<T>(2, &scene, &direct_light(Direct::Nee), &[20_000]);
        // Paths carry all or nothing of π at worst: a standard deviation of π/2.
        let power = watts(&scene, &tally, &tally.flux_emitted);
        assert_agrees("power", power, PI / 2.0, PI / 2.0 / 20_000.0_f64.sqrt(), 1e-6);
        // B4: on the axis of a square of side 1, at distance 1; half of its irradiance.
        let (a, s) = (0.5, 1.25_f64.sqrt());
        let truth = 0.5 / PI * 0.5 * 4.0 * (a / s) * f64::atan(a / s);
        for direct in [Direct::Nee, Direct::Photons] {
            let values = per_pass::<T>(&scene, &direct_light(direct), 32, 4);
            let what = format!("{direct:?}, masked: {masked}");
            // The chessboard differs from an even light by less than a hundredth there.
            let bound = if masked { 1e-2 } else { 2e-3 } * truth;
            assert_agrees(&what, moments(&values).0, truth, standard_error(&values), bound);
        }
        let projection = Projection::Orthographic { half_height: 0.5 };
        let (position, direction, up) = ([0.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        seen_above.camera("below", CameraDesc::new(position, direction, up, projection));
        let found = mean_red(&film::<T>(&seen_above.build().unwrap(), &direct_light(Direct::Nee), 64, 8));
        assert_agrees("seen", found, 0.5, (0.25_f64 / 4096.0).sqrt(), 1e-6);
    }
}

/// A camera sees the environment through the holes of a mask.
pub fn holes_show_the_environment<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let material = chequered(&mut builder, MaterialDesc::lambert("board", [FAINT; 3]), AlphaMode::Mask { cutoff: 0.5 });
    sheet(&mut builder, 0.0, material);
    builder.environment_from(&EnvironmentDesc::constant([2.0; 3])).unwrap();
    look_down(&mut builder, 1.0, 0.5);
    let found = mean_red(&film::<T>(&builder.build().unwrap(), &direct_light(Direct::Nee), 16, 16));
    // Independent rays of 0 or 2: 2 √(¼/N).
    assert_agrees("sky", found, 1.0, (1.0_f64 / 4096.0).sqrt(), 1e-6);
}

/// G5: in a closed room with e = 1 and ρ = ½, sheets that absorb nothing change nothing, whatever their alpha: radiosity
/// is 2, with shadow rays, photons and final gathering.
pub fn g5_furnace_with_sheets<T: TestBackend>() {
    let squares = [
        (0.0, 0.7, MaterialDesc::lambert("white", [1.0; 3])),
        (0.4, 0.6, MaterialDesc::mirror("mirror", [1.0; 3])),
        (-0.4, 0.6, MaterialDesc::thin("pane", 1.5)),
    ];
    let squares = squares.map(|(y, half, material)| (y, half, material.with_alpha(AlphaMode::Blend, 0.4)));
    closed_room::assert_unchanged::<T>(squares, ([0.0, 1.0, 0.0], 0.8), 0.0);
}

/// What is there everywhere needs nothing: the features, and every bit of the picture, are those of the scene without
/// alpha. A mask that is there nowhere, and one whose holes no ray meets, are the scene without it.
pub fn opaque_scenes_are_unchanged<T: TestBackend>() {
    let scene = |change: fn(MaterialDesc) -> MaterialDesc| -> Scene {
        let mut builder = photon_scene::builtin("cornell").unwrap();
        let texels = [[200, 100, 50, 255], [50, 100, 200, 7]];
        let image = TextureRef::new(builder.texture(TextureDesc::srgb8("two", 2, 1, &texels)));
        let leaf = builder.texture(TextureDesc::srgb8("leaf", 2, 1, &[[200, 100, 50, 70], [50, 100, 200, 7]]));
        let mut material = MaterialDesc::lambert("sheet", [0.5; 3]);
        material.textures.base_color = Some(image);
        material.textures.alpha = Some(TextureRef::new(leaf));
        let material = builder.material(change(material));
        let positions = vec![[-1.0, 3.0, 1.0], [1.0, 3.0, 1.0], [1.0, 3.5, -1.0], [-1.0, 3.5, -1.0]];
        let uvs = vec![vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
        let attributes = VertexAttributes::default().with_uvs(uvs);
        builder.mesh_with("sheet", positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
        builder.build().unwrap()
    };
    let settings = Settings { photons: 2000, direct: Direct::Photons, ..Settings::default() };
    let picture = |scene: &Scene| film::<T>(scene, &settings, 1, 16).beauty();
    let plain = scene(|mut material| {
        material.textures.alpha = None;
        material
    });
    let kinds: [fn(MaterialDesc) -> MaterialDesc; 3] = [
        |material| material.with_alpha(AlphaMode::Opaque, 0.5),
        |material| material.with_alpha(AlphaMode::Mask { cutoff: 7.0 / 255.0 - 1e-6 }, 1.0),
        |mut material| {
            material.textures.alpha = None;
            material.with_alpha(AlphaMode::Blend, 1.0)
        },
    ];
    for (number, kind) in kinds.into_iter().enumerate() {
        let scene = scene(kind);
        // The mask alone has alpha: no hole is met, but that shows at the hits.
        assert_eq!(Features::of(&scene.view()).contains(Features::ALPHA), number == 1);
        assert!(picture(&scene) == picture(&plain), "{number}");
    }
    // Nowhere: dropped, or met and passed.
    let nowhere = scene(|material| material.with_alpha(AlphaMode::Mask { cutoff: 1.0 }, 0.5));
    assert!(
        !Features::of(&nowhere.view()).contains(Features::ALPHA)
            && nowhere.view().triangles.len() == plain.view().triangles.len() - 2
    );
    let holes = scene(|material| material.with_alpha(AlphaMode::Mask { cutoff: 0.9 }, 1.0));
    assert!(Features::of(&holes.view()).contains(Features::ALPHA));
    assert!(picture(&holes) == picture(&nowhere) && picture(&holes) != picture(&plain));
}

/// For the comparison of backends: the glass balls of the Cornell box, with leaves, a veil, a see-through mirror, a pane
/// with holes and a masked light.
pub(crate) fn leaves() -> Scene {
    let mut builder = photon_scene::builtin("cornell-glass").unwrap();
    let mut texels = crate::harness::Uniform::new(12);
    let texels: Vec<[u8; 4]> = (0..256).map(|_| [(); 4].map(|()| (texels.draw() * 256.0) as u8)).collect();
    let image = TextureRef::new(builder.texture(TextureDesc::srgb8("leaves", 16, 16, &texels)));
    let textures = TexturesDesc::default().with_base_color(image).with_alpha(image);
    let mask = AlphaMode::Mask { cutoff: 0.5 };
    let materials = [
        MaterialDesc::lambert("leaves", [0.9; 3]).with_textures(textures).with_alpha(mask, 1.0),
        MaterialDesc::lambert("veil", [0.9, 0.5, 0.5]).with_textures(textures).with_alpha(AlphaMode::Blend, 0.8),
        MaterialDesc::mirror("mirror", [0.9; 3]).with_alpha(AlphaMode::Blend, 0.3),
        MaterialDesc::thin("pane", 1.5).with_textures(textures).with_alpha(mask, 1.0),
        MaterialDesc::emissive("area light", [0.2; 3], [5.0; 3]).with_textures(textures).with_alpha(mask, 1.0),
    ];
    for (number, material) in materials.into_iter().enumerate() {
        let (name, material) = (material.name.clone(), builder.material(material));
        let (x, y) = (-2.0 + number as f64, 2.2 + 0.4 * number as f64);
        let positions = vec![[x - 0.7, y, 0.7], [x + 0.7, y, 0.7], [x + 0.7, y + 0.5, -0.7], [x - 0.7, y + 0.5, -0.7]];
        let uvs = vec![vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
        let attributes = VertexAttributes::default().with_uvs(uvs);
        builder.mesh_with(name, positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
    }
    builder.build().unwrap()
}
