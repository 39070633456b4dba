//! Metals around the least width of a reflection, [`photon_core::ggx::MIN_ALPHA`]: below it they are mirrors. A metal of
//! reflectance 1 reflects all light in all directions, so that both sides of the threshold are one picture.

use std::f64::consts::PI;

use photon_core::{CausticPhotons, Direct, Filter, Indirect, Layer, MapKind, Settings};
use photon_scene::{
    CameraDesc, EnvironmentDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, Sun, TextureDesc,
    TextureRef, TexturesDesc, VertexAttributes, shapes,
};

use crate::harness::{InFull, TestBackend, direct_settings, film, look_at_point, per_pass, trace};
use crate::stats::{agrees, assert_agrees, moments, standard_error};
use crate::{closed_room, rough_glass_photons};

/// A metal of reflectance 1 and the width `alpha`.
fn metal(alpha: f64) -> MaterialDesc {
    MaterialDesc::metal("metal", [1.0; 3], alpha.sqrt())
}

/// A room lit from its ceiling and by a point light, with a plate and a ball of the material in it.
fn room(material: MaterialDesc) -> Scene {
    let mut builder = SceneBuilder::new();
    let wall = builder.material(MaterialDesc::lambert("wall", [0.6, 0.5, 0.4]));
    let (positions, triangles) = shapes::flip(shapes::cuboid([-1.0; 3], [1.0; 3]));
    builder.mesh("room", positions, triangles, wall);
    let light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [4.0, 5.0, 6.0]));
    builder.quad("light", [[-0.3, 0.9, -0.3], [0.3, 0.9, -0.3], [0.3, 0.9, 0.3], [-0.3, 0.9, 0.3]], light);
    builder.light("point", LightDesc::Point { position: [0.6, 0.4, 0.5], intensity: [1.0, 0.5, 0.2] });
    let material = builder.material(material);
    builder.quad("plate", [[-0.7, -0.9, -0.2], [-0.1, -0.9, -0.8], [-0.1, 0.3, -0.8], [-0.7, 0.3, -0.2]], material);
    let (positions, triangles) = shapes::icosphere(2, [0.4, -0.6, 0.0], 0.3);
    builder.mesh("ball", positions, triangles, material);
    let projection = Projection::Perspective { vertical_fov: 1.5 };
    builder.camera("room", CameraDesc::new([0.1, 0.0, 0.95], [-0.1, -0.05, -1.0], [0.0, 1.0, 0.0], projection));
    builder.build().unwrap()
}

/// G15: a metal of reflectance 1 and α = 5e-4, and one of 0, are the mirror bit by bit: every layer of the picture by camera
/// paths, photons and final gathering, and the photons of every map.
pub fn g15_a_narrow_metal_is_a_mirror<T: TestBackend>() {
    let mirror = room(MaterialDesc::mirror("mirror", [1.0; 3]));
    let settings = || Settings { photons: 4000, gather_rays: 4, ..Settings::default() };
    let ways = [
        Settings { direct: Direct::Photons, caustic_photons: CausticPhotons::Shared, ..settings() },
        Settings { indirect: Indirect::Gather, ..settings() },
    ];
    for (settings, alpha) in ways.iter().zip([5e-4, 0.0]) {
        let layers = |scene: &Scene| {
            let found = film::<T>(scene, settings, 2, 16);
            Layer::ALL.map(|layer| found.layer(layer))
        };
        let expected = layers(&mirror);
        let is_lit = expected.iter().map(|layer| layer.iter().flatten().any(|&c| c > 0.0));
        assert_eq!(is_lit.collect::<Vec<_>>(), [true; 4]);
        assert!(layers(&room(metal(alpha))) == expected, "alpha {alpha}, {settings:?}");
        if settings.direct == Direct::Photons {
            // The comparison tells widths apart.
            assert!(layers(&room(metal(2e-3))) != expected);
        }
    }
    let photons = |scene: &Scene| trace::<T>(2, scene, &ways[0], &[4000]);
    let ((expected, tally), (found, found_tally)) = (photons(&mirror), photons(&room(metal(5e-4))));
    assert!(expected[MapKind::Caustic].len() > 100);
    assert!(MapKind::ALL.into_iter().all(|kind| expected[kind] == found[kind]) && tally == found_tally);
}

/// Metals at both sides of the threshold, and one whose texture has widths below it, which is rendered with the least one.
fn around_the_threshold(builder: &mut SceneBuilder) -> [(&'static str, MaterialDesc); 4] {
    // Roughnesses .0274 and .0313: α = 7.5e-4 and 9.8e-4.
    let texels = [[0, 223, 255, 255], [0, 254, 255, 255]];
    let image = TextureDesc::linear8("narrow", 2, 1, &texels).filtered(Filter::Nearest);
    let image = TextureRef::new(builder.texture(image));
    let textures = TexturesDesc::default().with_metallic_roughness(image);
    [
        ("0", metal(0.0)),
        ("9.99e-4", metal(9.99e-4)),
        ("1.001e-3", metal(1.001e-3)),
        ("a texture", metal(9.85e-4).with_textures(textures)),
    ]
}

/// V1, light by photons: a plate reflects a point light to a wall, whose irradiance is that of the light's image.
pub fn v1_light_reflected_around_the_threshold<T: TestBackend>() {
    for k in 0..4 {
        let mut builder = SceneBuilder::new();
        let (name, material) = around_the_threshold(&mut builder).into_iter().nth(k).unwrap();
        let material = builder.material(material);
        let positions = vec![[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
        let uvs = positions.iter().map(|p: &[f64; 3]| [0.5 * p[0] + 0.5, 0.5]).collect();
        let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
        builder.mesh_with("plate", positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
        let white = builder.material(MaterialDesc::lambert("white", [1.0; 3]));
        // Faces −x.
        builder.quad("wall", [[1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [1.0, 1.5, 1.0], [1.0, 1.5, -1.0]], white);
        builder.light("point", LightDesc::Point { position: [-0.4, 0.9, 0.0], intensity: [1.0; 3] });
        look_at_point(&mut builder, [1.0, 0.6, 0.0], [-1.0, 0.0, 0.0], 0.2, 0.02);
        let mut settings = direct_settings(Direct::None, 0.2);
        settings.photons = 60_000;
        let values = per_pass::<InFull<T>>(&builder.build().unwrap(), &settings, 32, 2);
        // 1.4 away from the image of the light, and 1.5 above it. The mean over the disc of radius
        // .2 is larger by the Laplacian, .48 E, times r²/12: by 1.6e-3.
        let truth = 1.4 / (1.4_f64 * 1.4 + 1.5 * 1.5).powf(1.5) / PI;
        let (found, error) = (moments(&values).0, standard_error(&values));
        assert_agrees(name, found, truth, error, 3e-3 * truth);
        assert!(!agrees(found, 1.1 * truth, error, 3e-3 * truth), "the noise is small enough to tell: {error}");
    }
}

/// V1, camera paths: of what a plate shows, a part is a luminous wall, and its edge is where a mirror shows it.
pub fn v1_seen_around_the_threshold<T: TestBackend>() {
    for k in 0..4 {
        let mut builder = SceneBuilder::new();
        let (name, material) = around_the_threshold(&mut builder).into_iter().nth(k).unwrap();
        let material = builder.material(material);
        let positions = vec![[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
        let uvs = positions.iter().map(|p: &[f64; 3]| [0.5 * p[0] + 0.5, 0.5]).collect();
        let attributes = VertexAttributes::default().with_uvs(vec![uvs]);
        builder.mesh_with("plate", positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
        let light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [3.0; 3]).with_both_sides(true));
        // At 45°, the plate's points from x = −.2 to .2 show the wall at heights from .8 to 1.2.
        builder.quad("wall", [[1.0, 1.05, -1.0], [1.0, 1.05, 1.0], [1.0, 3.0, 1.0], [1.0, 3.0, -1.0]], light);
        let projection = Projection::Orthographic { half_height: 0.2 / 2.0_f64.sqrt() };
        builder.camera("oblique", CameraDesc::new([-1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0], projection));
        let scene = builder.build().unwrap();
        let values = per_pass::<T>(&scene, &direct_settings(Direct::Nee, 0.1), 16, 16);
        // Heights above 1.05: where x < −.05, that is 15 of 40 parts. The blur moves the edge by less than .0015.
        assert_agrees(name, moments(&values).0, 3.0 * 0.375, standard_error(&values), 3.0 * 0.004);
    }
}

/// V1, all ways of light: in a closed room, metals and sheets of glass at both sides of the threshold change nothing.
pub fn v1_furnace_around_the_threshold<T: TestBackend>() {
    let squares = [(0.4, 0.6, 9.99e-4), (-0.4, 0.6, 1.001e-3), (-0.7, 0.5, 0.0)];
    let squares = squares.map(|(y, half, alpha)| (y, half, metal(alpha)));
    let sheets = rough_glass_photons::sheets().into_iter().zip([0.0, 0.15, -0.2]);
    let squares = squares.into_iter().chain(sheets.map(|((_, sheet), y)| (y, 0.7, sheet)));
    closed_room::assert_unchanged::<T>(squares, ([1.0, 0.0, 0.0], 0.8), 0.0);
}

/// Metals of reflectance 0.5 at normal incidence, of widths on both sides of the threshold.
fn grey_metals() -> [(&'static str, MaterialDesc); 3] {
    [("0", 0.0), ("9.99e-4", 9.99e-4), ("1.001e-3", 1.001e-3_f64)]
        .map(|(name, alpha)| (name, MaterialDesc::metal("grey", [0.5; 3], alpha.sqrt())))
}

/// Cosine of the grazing directions below, and the reflectance there: `F = F0 + (1 − F0)(1 − cos θ)⁵` (Schlick 1994).
const GRAZING: f64 = 0.2;
const GRAZING_REFLECTANCE: f64 = 0.5 + 0.5 * 0.327_68;

/// V1: near grazing, metals on both sides of the threshold reflect an even sky and the sun alike, to a camera and as photons;
/// perfect mirrors reflect their reflectance.
pub fn v1_metals_brighten_towards_grazing<T: TestBackend>() {
    let along = (1.0 - GRAZING * GRAZING).sqrt();
    let plate = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
    let mirror = ("a mirror", MaterialDesc::mirror("grey", [0.5; 3]));
    let cases = grey_metals().map(|metal| (metal, GRAZING_REFLECTANCE)).into_iter().chain([(mirror, 0.5)]);
    for ((name, material), reflectance) in cases {
        let mut builder = SceneBuilder::new();
        let grey = builder.material(material.clone());
        builder.quad("plate", plate, grey);
        builder.environment_from(&EnvironmentDesc::constant([2.0; 3])).unwrap();
        let projection = Projection::Orthographic { half_height: 0.02 };
        builder.camera(
            "low",
            CameraDesc::new([-along, GRAZING, 0.0], [along, -GRAZING, 0.0], [0.0, 1.0, 0.0], projection),
        );
        let seen = per_pass::<T>(&builder.build().unwrap(), &direct_settings(Direct::Nee, 0.1), 16, 16);
        // The tables of gloss have errors of at most 0.0025.
        let (found, error) = (moments(&seen).0 / 2.0, standard_error(&seen) / 2.0);
        assert_agrees(name, found, reflectance, error, 2.5e-3);
        assert!(!agrees(found, reflectance + 0.1, error, 2.5e-3));

        let mut builder = SceneBuilder::new();
        let grey = builder.material(material);
        builder.quad("plate", plate, grey);
        let white = builder.material(MaterialDesc::lambert("white", [1.0; 3]));
        // Faces −x.
        builder.quad("wall", [[1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [1.0, 0.4, 1.0], [1.0, 0.4, -1.0]], white);
        builder.sun(Sun::new([along, -GRAZING, 0.0], [1.0; 3]));
        look_at_point(&mut builder, [1.0, 0.1, 0.0], [-1.0, 0.0, 0.0], 0.01, 0.002);
        let mut settings = direct_settings(Direct::None, 0.05);
        settings.photons = 60_000;
        let values = per_pass::<InFull<T>>(&builder.build().unwrap(), &settings, 16, 2);
        let truth = reflectance * along / PI;
        let (found, error) = (moments(&values).0, standard_error(&values));
        assert_agrees(name, found, truth, error, 3e-3 * truth);
        assert!(!agrees(found, 1.2 * truth, error, 3e-3 * truth), "the noise is small enough to tell: {error}");
    }
}

/// V1: roughnesses outside of their range are an error that names them.
pub fn v1_invalid_roughness<T: TestBackend>() {
    for roughness in [-1e-9, 2.0, f64::NAN, f64::INFINITY] {
        let mut builder = SceneBuilder::new();
        let material = builder.material(MaterialDesc::metal("steel", [0.5; 3], roughness));
        builder.quad("plate", [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], material);
        let error = builder.build().unwrap_err().to_string();
        assert!(error.contains("steel") && error.contains("roughness"), "{error}");
    }
    // 1e-4 is a mirror, and 1 the widest.
    for alpha in [1e-8, 1.0] {
        let values = film::<T>(&room(metal(alpha)), &Settings { photons: 1000, ..Settings::default() }, 1, 8).beauty();
        assert!(values.iter().flatten().all(|c| c.is_finite()), "{alpha}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texture_below_the_threshold_does_not_make_a_mirror() {
        let mut builder = SceneBuilder::new();
        let [_, below, above, texture] = around_the_threshold(&mut builder);
        for (material, is_mirror) in [(below.1, true), (above.1, false), (texture.1, false)] {
            let mut builder = builder.clone();
            let material = builder.material(material);
            let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            let attributes = VertexAttributes::default().with_uvs(vec![vec![[0.0; 2], [1.0, 0.0], [0.0, 1.0]]]);
            builder.mesh_with("plate", positions, vec![[0, 1, 2]], attributes, material);
            builder.light("point", LightDesc::Point { position: [0.0, 0.0, 1.0], intensity: [1.0; 3] });
            let scene = builder.build().unwrap();
            let kind = scene.view().materials[scene.view().primitives[0].material as usize].kind();
            assert_eq!(kind == photon_core::MaterialKind::Mirror, is_mirror, "{kind:?}");
        }
    }
}
