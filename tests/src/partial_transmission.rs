//! Surfaces that are partly glass against closed forms: a share T of what glass shows, and 1 − T of what is opaque.

use std::f64::consts::PI;

use photon_core::glam::DVec3;
use photon_core::{Area, CausticPhotons, Direct, EnvironmentMap, Estimator, Features, Filter, Indirect, Settings};
use photon_scene::{
    AlphaMode, LightDesc, MaterialDesc, Scene, SceneBuilder, Surface, TextureDesc, TextureRef, TexturesDesc,
    VertexAttributes, shapes,
};

use crate::alpha::{FAINT, look_down, mean_red, sheet, sun};
use crate::clearcoat::columns;
use crate::closed_room;
use crate::gloss_caustics::through_a_pane;
use crate::harness::{InFull, TestBackend, direct_settings, film, look_at_point, per_pass};
use crate::stats::{agrees, assert_agrees, moments, standard_error};
use crate::stripes::{self, VIEW};

/// From the stripes towards the sun.
const SUN: DVec3 = DVec3::new(0.3, 0.8, 0.5);

/// A base without a coat, of which a share is a sheet of index 1.5.
fn mixed(albedo: f64, share: f64) -> MaterialDesc {
    glossy(albedo, 0.0, 0.0).with_transmission(share, None)
}

fn glossy(base: f64, metallic: f64, specular: f64) -> MaterialDesc {
    let surface = Surface::Glossy { base_color: [base; 3], metallic, roughness: 0.0, specular, ior: 1.5 };
    MaterialDesc::new("mixed", surface)
}

/// A material whose share is that of red texels, each over half of the first texture coordinate.
fn textured(builder: &mut SceneBuilder, albedo: f64, share: f64, texels: [u8; 2]) -> MaterialDesc {
    let texels = texels.map(|red| [red, 255, 0, 255]);
    let image = builder.texture(TextureDesc::linear8("shares", 2, 1, &texels).filtered(Filter::Nearest));
    let textures = TexturesDesc::default().with_transmission(TextureRef::new(image));
    mixed(albedo, share).with_textures(textures)
}

/// A sun on surfaces that are partly glass, above nothing: `(1 − T) ρ/π` times its irradiance, by shadow rays, by photons,
/// and by photons behind a pane. Metal does not transmit; alpha and diffuse transmission are beside it.
pub fn sunlit_surfaces<T: TestBackend>() {
    let make = |pane: bool| -> Scene {
        let mut builder = SceneBuilder::new();
        let halves = textured(&mut builder, 0.8, 1.0, [51, 255]);
        let descs = vec![
            (1, mixed(0.8, 0.25)),
            (1, glossy(0.8, 0.5, 0.0).with_transmission(0.5, None)),
            (2, halves),
            (1, mixed(0.8, 0.5).with_alpha(AlphaMode::Blend, 0.5)),
            (1, mixed(0.8, 0.5).with_diffuse_transmission(0.25, [1.0; 3])),
            (1, mixed(0.8, 0.0)),
            (1, mixed(0.8, 1.0)),
        ];
        stripes::add(&mut builder, descs, false);
        if pane {
            let glass = builder.material(MaterialDesc::thin("pane", 1.5));
            let [x, z] = [SUN.x, SUN.z].map(|part| 2.5 * part / SUN.y);
            let corner = |dx: f64, dz: f64| [x + 1.5 * dx, 2.5, z + 2.0 * dz];
            builder.quad("pane", [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)], glass);
        }
        builder.light("sun", LightDesc::Directional { direction: (-SUN).to_array(), irradiance: [PI; 3] });
        builder.build().unwrap()
    };
    let i = SUN.normalize_or_zero().y;
    let shares = [0.75, 0.25, 0.8, 0.0, 0.25, 0.375, 1.0, 0.0];
    let open = make(false);
    assert!(Features::of(&open.view()).contains(Features::PARTIAL_TRANSMISSION));
    for (scene, direct, factor) in
        [(&open, Direct::Nee, 1.0), (&open, Direct::Photons, 1.0), (&make(true), Direct::Nee, through_a_pane(i))]
    {
        let settings = Settings { area: Area::Surface, ..direct_settings(direct, 0.08) };
        let passes = if T::ONE_OF == 1 { 64 } else { 32 };
        let found = columns::<InFull<T>>(scene, &settings, passes);
        for (column, (values, share)) in found.iter().zip(shares).enumerate() {
            let (mean, truth, error) = (moments(values).0, 0.8 * share * i * factor, standard_error(values));
            // The metal's reflection of this width adds less than the first; by photons, what remains of the edges of the
            // stripe that is all glass.
            let bound = if direct == Direct::Nee && factor == 1.0 { 1e-4 } else { 1e-2 * truth };
            assert_agrees(&format!("{direct:?}, {factor}, column {column}"), mean, truth, error, bound);
            let other = truth * 0.5;
            assert!(truth == 0.0 || !agrees(mean, other, error, bound), "{column}: the error {error} is too large");
        }
    }
}

/// A glowing floor seen through sheets that are lit from below alone: `T τ` times their tint.
pub fn seen_through<T: TestBackend>() {
    let mut builder = SceneBuilder::new();
    let halves = textured(&mut builder, 0.8, 0.5, [255, 0]);
    let descs = vec![
        (1, mixed(1.0, 0.25)),
        (1, mixed(0.5, 0.5)),
        (2, halves),
        (1, glossy(1.0, 0.5, 1.0).with_transmission(1.0, None)),
        (1, mixed(1.0, 0.5).with_alpha(AlphaMode::Blend, 0.5)),
        (1, mixed(1.0, 1.0)),
        (1, mixed(1.0, 0.0)),
    ];
    stripes::add(&mut builder, descs, false);
    let floor = builder.material(MaterialDesc::emissive("floor", [FAINT; 3], [1.0; 3]));
    builder.quad("floor", [[-9.0, -1.0, 9.0], [9.0, -1.0, 9.0], [9.0, -1.0, -9.0], [-9.0, -1.0, -9.0]], floor);
    let scene = builder.build().unwrap();
    let pane = through_a_pane(VIEW.normalize_or_zero().y);
    let truths = [0.25 * pane, 0.25 * pane, 0.4 * pane, 0.0, 0.5 * pane, 0.5 + 0.25 * pane, pane, 0.0];
    let found = columns::<T>(&scene, &direct_settings(Direct::Nee, 0.08), 128);
    for (column, (values, truth)) in found.iter().zip(truths).enumerate() {
        let (mean, error) = (moments(values).0, standard_error(values));
        assert_agrees(&format!("column {column}"), mean, truth, error, 1e-5);
        let other = truth * 0.8;
        assert!(truth == 0.0 || !agrees(mean, other, error, 1e-5), "{column}: the error {error} is too large");
    }
}

/// The light of a sun that arrives below black sheets is T τ, whether shadow rays or photons are asked for direct light:
/// the sheets block shadow rays, and what passes is a caustic.
pub fn light_on_a_floor<T: TestBackend>() {
    for share in [0.25, 0.5] {
        let mut builder = SceneBuilder::new();
        // Further away than the radius; indirect light is left out.
        sheet(&mut builder, 0.3, mixed(1.0, share));
        sheet(&mut builder, 0.0, MaterialDesc::lambert("floor", [1.0; 3]));
        sun(&mut builder);
        look_down(&mut builder, 0.05, 0.5);
        let scene = builder.build().unwrap();
        let truth = share * through_a_pane(1.0);
        for direct in [Direct::Nee, Direct::Photons] {
            let settings = Settings { photons: 51_200, ..direct_settings(direct, 0.2) };
            let values = per_pass::<InFull<T>>(&scene, &settings, 16, 4);
            let (mean, error) = (moments(&values).0, standard_error(&values));
            assert_agrees(&format!("{direct:?}, {share}"), mean, truth, error, 1e-6);
            assert!(!agrees(mean, 0.9 * truth, error, 1e-6), "{share}: the error {error} is too large");
        }
    }
}

/// Surfaces of which a part is clear and the rest white show the radiance 1 of an even environment, by shadow rays, by
/// photons, and behind panes, where only photons find it.
pub fn white_furnace<T: TestBackend>() {
    let make = |panes: bool| {
        let mut builder = SceneBuilder::new();
        let plastic = |roughness: f64| MaterialDesc::plastic("plastic", [1.0; 3], roughness);
        let halves = textured(&mut builder, 1.0, 1.0, [51, 204]);
        let descs = vec![
            (1, mixed(1.0, 0.25)),
            (1, mixed(1.0, 0.5)),
            (2, halves),
            (1, plastic(0.5).with_transmission(0.5, None)),
            (1, plastic(0.2).with_transmission(0.25, None)),
            (1, mixed(1.0, 0.5).with_alpha(AlphaMode::Blend, 0.5)),
            (1, mixed(1.0, 0.5).with_clearcoat(1.0, 0.3)),
        ];
        stripes::in_even_light(builder, descs, panes)
    };
    for (panes, direct) in [(false, Direct::Nee), (false, Direct::Photons), (true, Direct::Nee)] {
        let settings = Settings { shadow_rays: 16, area: Area::Surface, ..direct_settings(direct, 0.1) };
        let found = columns::<T>(&make(panes), &settings, 32);
        for (column, values) in found.iter().enumerate() {
            let least = if [4, 5, 7].contains(&column) { 1e-2 } else { 3e-3 };
            let what = format!("column {column}, panes: {panes}, {direct:?}");
            assert_agrees(&what, moments(values).0, 1.0, standard_error(values), least);
        }
    }
}

/// G5: in a closed room with e = 1 and ρ = ½, sheets that absorb nothing change nothing: radiosity is 2 on the wall and on
/// the sheets, with shadow rays, photons and final gathering.
pub fn g5_closed_room<T: TestBackend>() {
    let coated = MaterialDesc::plastic("coated", [1.0; 3], 0.5).with_transmission(0.4, None);
    let squares = [(0.0, 0.7, mixed(1.0, 0.5)), (0.4, 0.6, mixed(1.0, 0.25)), (-0.4, 0.6, coated)];
    closed_room::assert_unchanged::<T>(squares, ([0.0, 1.0, 0.0], 0.3), 0.0);
}

/// A block of white surface and clear glass, closed and with an inside, absorbs nothing: in an even environment it shows
/// the radiance 1, by light that passes it and by light that its inner walls scatter.
pub fn furnace_of_a_solid<T: TestBackend>() {
    let radiance = |absorption: f64| {
        let mut builder = SceneBuilder::new();
        let block = builder.material(mixed(1.0, 0.5).with_transmission(0.5, Some([absorption; 3])));
        let (positions, triangles) = shapes::cuboid([-1.0, -0.2, -1.0], [1.0, 0.2, 1.0]);
        builder.mesh("block", positions, triangles, block);
        builder.environment(EnvironmentMap::constant([1.0; 3]).unwrap());
        look_at_point(&mut builder, [0.0, 0.2, 0.0], [0.0, 1.0, 0.0], 1.0, 0.3);
        let settings = Settings {
            photons: 20_000,
            max_bounces: 4096,
            alpha: 1.0,
            indirect: Indirect::Map,
            area: Area::Surface,
            estimator: Estimator::Radius { radius: Some(0.1) },
            ..Settings::default()
        };
        per_pass::<T>(&builder.build().unwrap(), &settings, 24, 8)
    };
    let clear = radiance(0.0);
    assert_agrees("clear", moments(&clear).0, 1.0, standard_error(&clear), 1e-2);
    // What is absorbed inside is missed.
    let dark = radiance(1.0);
    assert!(!agrees(moments(&dark).0, 1.0, standard_error(&dark), 1e-2), "{dark:?}");
}

/// A texture with shares of 0 and 1 is the same as two materials, bit for bit.
pub fn two_texels_are_two_materials<T: TestBackend>() {
    let make = |is_textured: bool, texels: [u8; 2]| {
        let mut builder = SceneBuilder::new();
        let plastic = MaterialDesc::plastic("opaque", [0.8; 3], 0.3);
        let image = textured(&mut builder, 0.8, 1.0, texels).textures;
        let both = builder.material(plastic.clone().with_transmission(1.0, None).with_textures(image));
        let opaque = builder.material(plastic);
        let glass =
            builder.material(MaterialDesc::new("glass", Surface::Thin { ior: 1.5, tint: [0.8; 3], roughness: 0.3 }));
        for (x, u, pure) in [(-1.0, 0.25, opaque), (0.0, 0.75, glass)] {
            let attributes = VertexAttributes::default().with_uvs(vec![vec![[u, 0.5]; 4]]);
            let positions = vec![[x, 0.0, 1.0], [x + 1.0, 0.0, 1.0], [x + 1.0, 0.0, -1.0], [x, 0.0, -1.0]];
            let material = if is_textured { both } else { pure };
            builder.mesh_with("half", positions, vec![[0, 1, 2], [0, 2, 3]], attributes, material);
        }
        let glow = builder.material(MaterialDesc::emissive("glow", [0.5; 3], [1.0; 3]));
        builder.quad("glow", [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, -1.0]], glow);
        builder.light("sun", LightDesc::Directional { direction: (-SUN).to_array(), irradiance: [PI; 3] });
        look_at_point(&mut builder, [0.0; 3], [0.0, 1.0, 0.0], 1.0, 0.9);
        builder.build().unwrap()
    };
    // Aimed photons depend on which triangles may be glass.
    let settings = Settings {
        photons: 4_000,
        caustic_photons: CausticPhotons::Shared,
        estimator: Estimator::Radius { radius: Some(0.2) },
        ..Settings::default()
    };
    let picture = |scene: &Scene| film::<T>(scene, &settings, 2, 16).beauty();
    let pure = picture(&make(false, [0, 255]));
    assert_eq!(picture(&make(true, [0, 255])), pure);
    let exchanged = picture(&make(true, [255, 0]));
    assert_ne!(exchanged, pure);
    assert!(mean_red(&film::<T>(&make(false, [0, 255]), &settings, 2, 16)) > 0.1);
}
