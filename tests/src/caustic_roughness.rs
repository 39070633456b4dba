//! Light of area lights and environments that reaches a glossy surface by way of mirrors or glass: from photons where the
//! reflection is rough enough, by camera paths elsewhere, and never by both.

use photon_core::glam::DVec3;
use photon_core::{
    Area, Direct, Error, Estimator, Film, Filter, Layer, Pipeline, Render, Requirements, Settings, TransportBackend,
    View,
};
use photon_scene::{
    CameraDesc, LightDesc, MaterialDesc, Projection, Scene, SceneBuilder, Surface, TextureDesc, TextureRef,
    TexturesDesc, shapes,
};

use crate::clearcoat::columns;
use crate::closed_room;
use crate::gloss_caustics::{Floor, UP, through_a_pane, towards};
use crate::gloss_reference::Reference;
use crate::harness::{InFull, TestBackend, direct_settings, film, per_pass};
use crate::stats::{agrees, assert_agrees, moments, standard_error};
use crate::stripes;

/// Radiance of the square light, and irradiance of the sun across its direction.
const RADIANCE: f64 = 3.0;
const SUN: f64 = 0.5;
/// The mean over a disc of this radius differs from the value at its centre by less than .005 of it: light at a distance of
/// 1.4 in lobes of 17 degrees and more, of which the kernel weights a mean squared distance of a third of the radius squared.
const RADIUS: f64 = 0.1;

fn settings(caustic_roughness: Option<f32>) -> Settings {
    Settings { caustic_roughness, photons: 40_000, ..direct_settings(Direct::Nee, RADIUS) }
}

/// Those settings for a picture that camera paths make, or photons, and the side of the picture: more of what is needed.
fn of_paths_or_photons(caustic_roughness: Option<f32>, by_photons: bool) -> (Settings, u32) {
    let settings = settings(caustic_roughness);
    if by_photons { (settings, 4) } else { (Settings { photons: 500, ..settings }, 32) }
}

fn horizontal(y: f64, half: f64) -> [[f64; 3]; 4] {
    [[-half, y, half], [half, y, half], [half, y, -half], [-half, y, -half]]
}

/// A square at `centre`, which faces the origin: its corners.
fn facing_the_origin(centre: DVec3, half: f64) -> [DVec3; 4] {
    let normal = -centre.normalize_or_zero();
    let across = UP.cross(normal).normalize_or_zero() * half;
    let up = normal.cross(across);
    [centre - across - up, centre + across - up, centre + across + up, centre - across + up]
}

/// A floor of half side 1 at y = 0, seen in direction −`o` at the origin, before an upright pane of glass or a mirror at
/// x = −.4, in whose way all light to the origin is.
fn before_a_pane(floor: Floor, o: DVec3, pane: MaterialDesc) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let material = builder.material(floor.material());
    builder.quad("floor", horizontal(0.0, 1.0), material);
    let pane = builder.material(pane);
    builder.quad("pane", [[-0.4, 0.0, 1.0], [-0.4, 0.0, -1.0], [-0.4, 1.2, -1.0], [-0.4, 1.2, 1.0]], pane);
    let projection = Projection::Orthographic { half_height: 1e-4 };
    builder.camera("oblique", CameraDesc::new((o * 0.6).to_array(), (-o).to_array(), [0.0, 0.0, 1.0], projection));
    builder
}

fn add_light(builder: &mut SceneBuilder, corners: [DVec3; 4]) {
    let light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [RADIANCE; 3]));
    builder.quad("light", corners.map(|corner| corner.to_array()), light);
}

/// Radiance that a floor reflects towards `o` of a square light with these corners, whose light the factor `passed` of its
/// direction weakens.
fn reflected(floor: Floor, o: DVec3, corners: [DVec3; 4], passed: impl Fn(DVec3) -> f64) -> f64 {
    let [a, b, _, d] = corners;
    let (across, up) = (b - a, d - a);
    let normal = across.cross(up);
    let (area, normal) = (normal.length(), normal.normalize_or_zero());
    let reference = Reference::new(floor.alpha, floor.metallic, floor.color);
    let n = 200;
    let of = |k: i32| {
        let part = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
        let at = a + across * part(k % n) + up * part(k / n);
        let i = at.normalize_or_zero();
        let solid_angle = area * normal.dot(-i).max(0.0) / at.length_squared() / f64::from(n * n);
        reference.f(o, i) * i.y * RADIANCE * passed(i) * solid_angle
    };
    (0..n * n).map(of).sum()
}

fn mean_of(film: &Film, layer: Layer) -> f64 {
    let values = film.layer(layer);
    values.iter().flatten().map(|&c| f64::from(c)).sum::<f64>() / (3 * values.len()) as f64
}

/// A square light behind a pane, over `floor`, and the radiance that the camera sees by a quadrature.
fn square_light_behind_a_pane(floor: Floor) -> (Scene, f64) {
    let (o, i) = (towards(0.7, 0.3), towards(0.6, 3.0));
    let corners = facing_the_origin(i * 1.4, 0.4);
    let mut builder = before_a_pane(floor, o, MaterialDesc::thin("pane", 1.5));
    add_light(&mut builder, corners);
    (builder.build().unwrap(), reflected(floor, o, corners, |i| through_a_pane(-i.x)))
}

/// A square light behind a pane, over metals and black plastic: the same radiance from photons and by camera paths, against a
/// quadrature, and in one layer alone.
pub fn area_light_behind_a_pane<T: TestBackend>() {
    for (k, (alpha, metallic, color)) in [(0.3, 1.0, 0.8), (0.5, 1.0, 0.4), (0.35, 0.0, 0.0)].into_iter().enumerate() {
        let floor = Floor { alpha, metallic, color };
        let (scene, truth) = square_light_behind_a_pane(floor);
        for (least, stored) in [(None, false), (Some(0.9), false), (Some(0.2), true), (Some(alpha.sqrt() as f32), true)]
        {
            let (mut settings, size) = of_paths_or_photons(least, stored);
            if k == 1 && stored {
                settings.estimator = Estimator::Knn { k: 150, max_radius: None };
            }
            let required = Requirements::of(&scene.view(), &settings);
            assert_eq!((required.gloss_caustics, required.gloss_caustics_of_all_lights), (stored, stored));
            let what = format!("alpha {alpha}, metallic {metallic}, {least:?}");
            let values = per_pass::<T>(&scene, &settings, 24, size);
            let (found, error) = (moments(&values).0, standard_error(&values));
            assert_agrees(&what, found, truth, error, 5e-3 * truth);
            // Light that is counted twice, or half of it, is found.
            assert!(
                !agrees(found, 2.0 * truth, error, 0.0) && !agrees(found, 0.5 * truth, error, 0.0),
                "{what}: {error}"
            );
            let film = film::<T>(&scene, &settings, 2, 8);
            let layers = [Layer::Emission, Layer::Caustic].map(|layer| mean_of(&film, layer) > 0.0);
            assert_eq!(layers, [!stored, stored], "{what}");
        }
    }
}

/// The same light in a mirror, hidden by a screen; with error statistics, which change nothing.
pub fn area_light_in_a_mirror<T: TestBackend>() {
    let floor = Floor { alpha: 0.4, metallic: 1.0, color: 0.8 };
    let (o, i) = (towards(0.7, 0.8), towards(0.65, 3.1));
    let mut builder = before_a_pane(floor, o, MaterialDesc::mirror("mirror", [0.9; 3]));
    // Its image faces the origin; mirroring turns the order of its corners over.
    let image = facing_the_origin(i * 1.3, 0.25);
    let [a, b, c, d] = image.map(|p| DVec3::new(-0.8 - p.x, p.y, p.z));
    add_light(&mut builder, [b, a, d, c]);
    let black = builder.material(MaterialDesc::lambert("black", [0.0; 3]));
    builder.quad("screen", [[-0.02, 0.4, 0.25], [0.25, 0.4, 0.25], [0.25, 0.4, -0.2], [-0.02, 0.4, -0.2]], black);
    let scene = builder.build().unwrap();
    let truth = 0.9 * reflected(floor, o, image, |_| 1.0);
    for least in [None, Some(0.5)] {
        let (mut settings, size) = of_paths_or_photons(least, least.is_some());
        let values = per_pass::<T>(&scene, &settings, 24, size);
        assert_agrees(&format!("{least:?}"), moments(&values).0, truth, standard_error(&values), 5e-3 * truth);
        let plain = film::<T>(&scene, &settings, 2, 4).beauty();
        settings.errors = true;
        assert_eq!(film::<T>(&scene, &settings, 2, 4).beauty(), plain);
    }
}

/// A sun beside the square light, over two floors, of which only the rough one shows all light from photons: each floor shows
/// both, and photons of the sun alone where it is not rough enough.
pub fn lights_of_both_kinds<T: TestBackend>() {
    let least = 0.65;
    for (alpha, other) in [(0.3, 0.6), (0.6, 0.3)] {
        let [floor, aside] = [alpha, other].map(|alpha| Floor { alpha, metallic: 1.0, color: 0.8 });
        let (o, i) = (towards(0.7, 0.3), towards(0.6, 3.0));
        let corners = facing_the_origin(i * 1.4, 0.4);
        let to_sun = towards(0.5, 4.1);
        let mut builder = before_a_pane(floor, o, MaterialDesc::thin("pane", 1.5));
        add_light(&mut builder, corners);
        builder.light("sun", LightDesc::Directional { direction: (-to_sun).to_array(), irradiance: [SUN; 3] });
        let aside = builder.material(aside.material());
        builder.quad("aside", [[1.2, 0.0, 0.1], [1.4, 0.0, 0.1], [1.4, 0.0, -0.1], [1.2, 0.0, -0.1]], aside);
        let scene = builder.build().unwrap();
        let area = reflected(floor, o, corners, |i| through_a_pane(-i.x));
        let sun = SUN * through_a_pane(-to_sun.x) * to_sun.y * floor.f(o, to_sun, UP);
        let settings = settings(Some(least));
        assert!(Requirements::of(&scene.view(), &settings).gloss_caustics_of_all_lights);
        let stored = alpha.sqrt() > f64::from(least);
        let size = if stored { 4 } else { 24 };
        let values = per_pass::<T>(&scene, &settings, 32, size);
        let (found, error) = (moments(&values).0, standard_error(&values));
        assert_agrees(&format!("alpha {alpha}"), found, area + sun, error, 5e-3 * (area + sun));
        for wrong in [area, sun, 2.0 * area + sun, area + 2.0 * sun] {
            assert!(!agrees(found, wrong, error, 5e-3 * wrong), "alpha {alpha}: {found} {wrong} {error}");
        }
        // Each layer by itself, with the noise of the whole.
        let found = film::<T>(&scene, &settings, 32, size);
        let [emission, caustic] = [Layer::Emission, Layer::Caustic].map(|layer| mean_of(&found, layer));
        let (by_paths, by_photons) = if stored { (0.0, area + sun) } else { (area, sun) };
        let bound = 5e-3 * (area + sun);
        assert_agrees(&format!("alpha {alpha}, paths"), emission, by_paths, error, bound);
        assert_agrees(&format!("alpha {alpha}, photons"), caustic, by_photons, error, bound);
    }
}

/// White metal and plastic of many roughnesses behind panes in an even environment show its radiance, whatever is stored.
pub fn white_furnace<T: TestBackend>() {
    let textured = |builder: &mut SceneBuilder| {
        let image = TextureDesc::linear8("roughness", 2, 1, &[[0, 100, 255, 255], [0, 200, 255, 255]]);
        let image = builder.texture(image.filtered(Filter::Nearest));
        let textures = TexturesDesc::default().with_metallic_roughness(TextureRef::new(image));
        MaterialDesc::metal("halves", [1.0; 3], 1.0).with_textures(textures)
    };
    let mut builder = SceneBuilder::new();
    let halves = textured(&mut builder);
    let descs = vec![
        (1, MaterialDesc::metal("metal", [1.0; 3], 0.3)),
        (1, MaterialDesc::metal("metal", [1.0; 3], 0.6)),
        (1, MaterialDesc::plastic("plastic", [1.0; 3], 0.7)),
        (2, halves),
        (1, MaterialDesc::metal("brushed", [1.0; 3], 0.6).with_anisotropy(0.5, 0.3)),
        (1, MaterialDesc::plastic("coated", [1.0; 3], 0.8).with_clearcoat(1.0, 0.6)),
        (1, MaterialDesc::plastic("cloth", [1.0; 3], 0.8).with_sheen([1.0; 3], 0.6)),
    ];
    let scene = stripes::in_even_light(builder, descs, true);
    for least in [None, Some(0.5)] {
        let settings = Settings { photons: 60_000, area: Area::Surface, ..settings(least) };
        let found = columns::<T>(&scene, &settings, 16);
        for (column, values) in found.iter().enumerate() {
            let (mean, error) = (moments(values).0, standard_error(values));
            // Tables; anisotropy and layers lose or gain what docs/studies/surfaces.md says.
            let bound = if column < 5 { 4e-3 } else { 3e-2 };
            assert_agrees(&format!("{least:?}, column {column}"), mean, 1.0, error, bound);
        }
    }
}

/// G5: in an even closed room, rough white metal below smooth and rough glass changes nothing, whatever is stored.
pub fn g5_closed_room<T: TestBackend>() {
    let rough = Surface::Thin { ior: 1.5, tint: [1.0; 3], roughness: 0.6 };
    for least in [None, Some(0.5)] {
        let squares = [
            (-0.3, 0.9, MaterialDesc::metal("metal", [1.0; 3], 0.6)),
            (0.1, 0.7, MaterialDesc::thin("pane", 1.5)),
            (0.3, 0.5, MaterialDesc::new("frosted", rough.clone())),
        ];
        closed_room::assert_unchanged_with::<T>(squares, ([0.0, 1.0, 0.0], 0.6), 1e-2, least);
    }
}

/// Metals, plastics and layers in all combinations, beneath a pane and partly beneath glass balls, under an area light and a
/// point light: the same expectation for all values of the setting.
pub fn all_values_have_the_same_expectation<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let image = TextureDesc::linear8("roughness", 2, 1, &[[0, 60, 255, 255], [0, 200, 255, 255]]);
    let image = builder.texture(image.filtered(Filter::Nearest));
    let textures = TexturesDesc::default().with_metallic_roughness(TextureRef::new(image));
    let descs = vec![
        (1, MaterialDesc::metal("narrow", [0.9; 3], 0.25)),
        (1, MaterialDesc::metal("metal", [0.9; 3], 0.55)),
        (2, MaterialDesc::plastic("halves", [0.5; 3], 1.0).with_textures(textures)),
        (1, MaterialDesc::metal("brushed", [0.9; 3], 0.4).with_anisotropy(0.6, 0.3)),
        (1, MaterialDesc::plastic("coated", [0.3; 3], 0.7).with_clearcoat(1.0, 0.3)),
        (1, MaterialDesc::plastic("cloth", [0.3; 3], 0.75).with_sheen([1.0; 3], 0.75)),
        (1, MaterialDesc::plastic("partly glass", [0.3; 3], 0.75).with_transmission(0.4, None)),
    ];
    stripes::add(&mut builder, descs, false);
    let pane = builder.material(MaterialDesc::thin("pane", 1.5));
    builder.quad("pane", horizontal(0.6, 3.0), pane);
    let glass = builder.material(MaterialDesc::glass("glass", 1.5));
    for x in [-0.6, 0.1, 0.7] {
        let (positions, triangles) = shapes::icosphere(2, [x, 0.3, -0.2], 0.2);
        builder.mesh("ball", positions, triangles, glass);
    }
    let light = builder.material(MaterialDesc::emissive("light", [0.0; 3], [RADIANCE; 3]).with_both_sides(true));
    builder.quad("light", horizontal(1.1, 0.6), light);
    builder.light("point", LightDesc::Point { position: [0.3, 0.9, -1.0], intensity: [0.3; 3] });
    let scene = builder.build().unwrap();
    let with = |least| {
        let settings = Settings { area: Area::Surface, photons: 4_000, ..settings(least) };
        let emission = mean_of(&film::<T>(&scene, &settings, 8, 24), Layer::Emission);
        (Requirements::of(&scene.view(), &settings), columns::<InFull<T>>(&scene, &settings, 32), emission)
    };
    let (required, off, all_emission) = with(None);
    assert!(required.gloss_caustics && !required.gloss_caustics_of_all_lights);
    // All on the CPU, with which others are compared.
    let values = if T::ONE_OF == 1 { &[0.3, 0.5, 0.7][..] } else { &[0.5] };
    for &least in values {
        let (required, found, emission) = with(Some(least));
        assert!(required.gloss_caustics_of_all_lights);
        // Both have the same random numbers, so that their difference has less noise than they.
        let mut whole = vec![0.0; 32];
        for (column, (found, off)) in found.iter().zip(&off).enumerate() {
            let moved: Vec<f64> = found.iter().zip(off).map(|(found, off)| found - off).collect();
            whole.iter_mut().zip(&moved).for_each(|(sum, moved)| *sum += moved / 8.0);
            let (mean, error) = (moments(off).0, standard_error(&moved));
            // Photons are averaged over a disc.
            assert_agrees(&format!("{least}, column {column}"), moments(&moved).0, 0.0, error, 5e-3 * mean);
        }
        let (found, error, moved) = (moments(&whole).0, standard_error(&whole), all_emission - emission);
        // Photons show so much instead of camera paths that the comparison would tell if it were lost or counted twice.
        for wrong in [moved, -moved] {
            assert!(!agrees(found, wrong, error, 5e-3 * wrong.abs()), "{least}: {moved} {error}");
        }
    }
}

/// Camera paths without the setting beside photons with it count twice, which these comparisons tell; without photons the
/// stages are refused.
pub fn counting_twice_is_seen<T: TestBackend>() {
    let floor = Floor { alpha: 0.4, metallic: 1.0, color: 0.8 };
    let (scene, truth) = square_light_behind_a_pane(floor);
    let [on, off] = [Some(0.5), None].map(settings);
    let required = Requirements::of(&scene.view(), &on);
    let mixed = |with_paths: bool, with_photons: bool| {
        let mut backend = T::make(2);
        let mut stages = backend.stages(&required, &on).unwrap();
        let others = backend.stages(&Requirements::of(&scene.view(), &off), &off).unwrap();
        if with_paths {
            stages.eye = others.eye;
        }
        if !with_photons {
            stages.gloss_caustics = None;
        }
        let view = View { camera: scene.camera(None, 8, 8).unwrap(), width: 8, height: 8 };
        Pipeline::with_stages(backend, &scene.view(), view, on.clone(), required, stages)
    };
    for (with_paths, factor) in [(false, 1.0), (true, 2.0)] {
        let mut renderer = mixed(with_paths, true).unwrap();
        let mut before = 0.0;
        let values: Vec<f64> = (0..24)
            .map(|pass| {
                renderer.pass(pass, &mut ()).unwrap();
                let film = renderer.film().unwrap();
                let beauty = film.beauty();
                let mean = beauty.iter().map(|c| f64::from(c[0])).sum::<f64>() / beauty.len() as f64;
                let sum = mean * f64::from(pass + 1);
                sum - std::mem::replace(&mut before, sum)
            })
            .collect();
        let (found, error) = (moments(&values).0, standard_error(&values));
        assert_agrees(&format!("{with_paths}"), found, factor * truth, error, 1e-2 * truth);
        assert_eq!(agrees(found, truth, error, 5e-3 * truth), !with_paths);
    }
    let refused = mixed(false, false).map(|_| ());
    assert!(matches!(refused, Err(Error::InvalidSetting { name: "caustic-roughness", .. })), "{refused:?}");
}

/// Scenes without glass, without gloss, without a light that has an extent, and with narrow reflections alone have the bits
/// that they have without the setting; and more than is required changes no bit.
pub fn only_what_it_is_for_is_changed<T: TestBackend>() {
    let (o, i) = (towards(0.7, 0.3), towards(0.6, 3.0));
    let make = |floor: MaterialDesc, pane: MaterialDesc, has_area_light: bool| {
        let gloss = Floor { alpha: 0.3, metallic: 1.0, color: 0.8 };
        let mut builder = before_a_pane(gloss, o, pane);
        // Above the floor of the others, which then nothing sees.
        let material = builder.material(floor);
        builder.quad("cover", horizontal(0.01, 1.0), material);
        if has_area_light {
            add_light(&mut builder, facing_the_origin(i * 1.4, 0.4));
        }
        builder.light("point", LightDesc::Point { position: [-0.8, 0.9, 0.1], intensity: [1.0; 3] });
        builder.build().unwrap()
    };
    let gloss = || MaterialDesc::plastic("plastic", [0.5; 3], 0.6);
    let pane = || MaterialDesc::thin("pane", 1.5);
    let opaque = || MaterialDesc::lambert("pane", [0.5; 3]);
    let cases = [
        (make(gloss(), pane(), true), 0.5, true),
        (make(gloss(), opaque(), true), 0.5, false),
        (make(gloss(), pane(), false), 0.5, false),
        (make(gloss(), pane(), true), 0.7, false),
    ];
    for (case, (scene, least, is_needed)) in cases.iter().enumerate() {
        let settings = |least| Settings { photons: 5000, ..settings(least) };
        let (with, without) = (settings(Some(*least)), settings(None));
        let derived = Requirements::of(&scene.view(), &with);
        assert_eq!(derived.gloss_caustics_of_all_lights, *is_needed, "{case}");
        let without_caustics = Settings { caustics: false, ..with.clone() };
        assert!(!Requirements::of(&scene.view(), &without_caustics).gloss_caustics);
        let picture = |settings: &Settings, required| {
            let view = View { camera: scene.camera(None, 8, 8).unwrap(), width: 8, height: 8 };
            let mut renderer =
                Pipeline::with_requirements(T::make(2), &scene.view(), view, settings.clone(), required).unwrap();
            for pass in 0..2 {
                renderer.pass(pass, &mut ()).unwrap();
            }
            renderer.film().unwrap().pixels
        };
        let found = picture(&with, derived);
        assert_eq!(found == picture(&without, Requirements::of(&scene.view(), &without)), !is_needed, "{case}");
        assert!(found == picture(&with, Requirements::everything(&with)), "{case}");
    }
}
